"""Clouds by Nephele's programs, from within Blender (3.4 and later): 3D View > Sidebar > Nephele.

Makes a cloud of the selected mesh (neph-mesh), of a grammar in a text block (neph-lsys) or of a heap of spheres
(neph-gauss), writes it as OpenVDB (neph-vdb) and shows it as a Volume object with a material. The settings stay on the
object, so that it can be made again. Install: Edit > Preferences > Add-ons > Install, or from disk in 4.2 and later.

All work is done by the programs, in a temporary folder, before anything in the scene is touched: where one fails, its
message is reported and the scene is as it was. Each volume has a file name of its own, made of its content, so that undo
finds the former one.
"""
import contextlib
import glob
import hashlib
import json
import os
import re
import shutil
import subprocess
import tempfile
import uuid

import bpy
from bpy.props import (BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, PointerProperty,
                       StringProperty)
from mathutils import Vector

bl_info = {
    "name": "Nephele clouds",
    "author": "The Nephele project",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Nephele",
    "description": "Makes clouds of meshes, grammars and heaps of spheres by Nephele's programs, as volumes",
    "category": "Object",
}

SURFACES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
SHADER = "Nephele cloud"  # the node that settings reach; without it a material is the user's own
FEW_BOUNCES = 32


class Failure(Exception):
    """What went wrong, one line a mistake."""

    def __init__(self, *lines):
        super().__init__("\n".join(lines))
        self.lines = lines


# --- settings, kept on each cloud, and on the scene for the next one

def grammar_decides(settings):
    """The medium is the grammar's own."""
    return settings.kind == "GRAMMAR" and not settings.own_medium


def medium_changed(settings, _context):
    cloud = settings.id_data
    if isinstance(cloud, bpy.types.Object) and cloud.type == "VOLUME" and not grammar_decides(settings):
        set_shader(cloud.data, settings.extinction, settings.albedo, settings.g)


class NepheleSettings(bpy.types.PropertyGroup):
    stem: StringProperty(options={"HIDDEN"})  # what this cloud's files begin with; empty: no cloud
    kind: EnumProperty(name="From", items=[
        ("MESH", "Mesh", "An ellipsoid on each triangle of a mesh, by neph-mesh"),
        ("GRAMMAR", "Grammar", "A grammar in a text block, by neph-lsys"),
        ("GAUSS", "Heap", "A heap of spheres over a flat base, by neph-gauss")], default="GAUSS")
    seed: IntProperty(name="Seed", default=1, min=0, description="Of everything that is drawn by chance")

    source: PointerProperty(name="Mesh", type=bpy.types.Object, poll=lambda _, thing: thing.type in SURFACES,
                            description="With its modifiers as in the viewport, where it stands in the world")
    hide_source: BoolProperty(name="Hide Mesh in Renders", default=True,
                              description="The mesh would hide the cloud that is made of it")
    faces: IntProperty(name="Faces", default=370, min=0, max=10000000, description="Decimate to so many; 0: keep all")
    size: FloatProperty(name="Size", default=1.1, min=0.01, max=100, description="Of an ellipsoid to its triangle")
    fit: BoolProperty(name="Fit", description="Ellipsoids flat in their triangle's plane: follows the mesh closely")
    thickness: FloatProperty(name="Thickness", default=0.3, min=0.001, max=10, description="To the size in the plane")
    fill: IntProperty(name="Fill", default=0, min=0, max=1000000, description="Up to so many spheres inside")

    text: PointerProperty(name="Grammar", type=bpy.types.Text)
    iterations: IntProperty(name="Iterations", default=-1, min=-1, max=100000, description="-1: the grammar's own")

    preset: EnumProperty(name="Species", items=[
        ("NONE", "None", "By count, spread and radius"),
        ("HUMILIS", "Humilis", "Flat"),
        ("MEDIOCRIS", "Mediocris", "About as high as wide"),
        ("CONGESTUS", "Congestus", "A tower")])
    count: IntProperty(name="Spheres", default=35, min=1, max=1000000, description="Before hollowing and pruning")
    spread: FloatVectorProperty(name="Spread", default=(3.8, 3.7, 1.7), min=0, subtype="XYZ", unit="LENGTH",
                                description="Standard deviations of the spheres' places; z is height")
    radius: FloatProperty(name="Radius", default=2.9, min=0.001, unit="LENGTH", description="Of the middle sphere")

    own_medium: BoolProperty(name="Own Medium", description="In place of what the grammar says of its medium")
    model: EnumProperty(name="Density", items=[
        ("SPHEROID", "Noise", "Falls off towards the edge, with noise"),
        ("UNIFORM", "Plain", "1 inside, 0 outside"),
        ("METABALL", "Metaballs", "One field of all, with noise")])
    extinction: FloatProperty(name="Extinction", default=2, min=0, max=1000, update=medium_changed,
                              description="At density 1, 1/m. Shown at once; the volume stays")
    albedo: FloatProperty(name="Albedo", default=1, min=0, max=1, update=medium_changed,
                          description="Share of light that is scattered on. Shown at once")
    g: FloatProperty(name="Anisotropy", default=0.85, min=-0.99, max=0.99, update=medium_changed,
                     description="Mean cosine of the scattering angle. Shown at once")
    kappa: FloatProperty(name="Edge Noise", default=0.5, min=0, max=1)
    octaves: IntProperty(name="Octaves", default=5, min=1, max=16)
    noise_scale: FloatProperty(name="Noise Scale", default=0, min=0, unit="LENGTH",
                               description="Of the first octave; 0: a fifth of the median radius")
    billow: FloatProperty(name="Billows", default=0, min=0, max=1, description="Erosion towards the top")
    wisp: FloatProperty(name="Wisps", default=0, min=0, max=1, description="Erosion towards the base")

    preview: BoolProperty(name="Preview", default=True, description="Make it of the few voxels of the preview")
    preview_voxels: IntProperty(name="Preview Voxels", default=128, min=8, max=4096,
                                description="Along the longest side, while working")
    voxels: IntProperty(name="Final Voxels", default=320, min=8, max=4096, description="Along the longest side")
    half: BoolProperty(name="16 Bits", default=True, description="A voxel, in place of 32")


def copy_settings(there, here):
    for name, rna in NepheleSettings.bl_rna.properties.items():
        if name != "name" and not rna.is_readonly:
            setattr(here, name, getattr(there, name))


class NephelePreferences(bpy.types.AddonPreferences):
    bl_idname = __name__

    programs: StringProperty(name="Folder of the Programs", subtype="DIR_PATH",
                             description="Where neph-mesh and the others are. Empty: the search path (PATH)")
    time_limit: IntProperty(name="Time Limit (Seconds)", default=600, min=1,
                            description="A program that takes longer is ended")

    def draw(self, _context):
        self.layout.prop(self, "programs")
        self.layout.prop(self, "time_limit")


def preference(name):
    addon = bpy.context.preferences.addons.get(__name__)
    return getattr(addon.preferences, name) if addon else {"programs": "", "time_limit": 600}[name]


# --- the programs

def find(program):
    folder = preference("programs")
    path = shutil.which(program, path=bpy.path.abspath(folder) if folder else None)
    if not path:
        raise Failure(f"{program} is not {'in ' + folder if folder else 'on the search path'} "
                      "(install Nephele, or set its folder in the add-on's preferences)")
    return path


def run(program, arguments, folder, given=None, names=("", "")):
    """Standard output of the program. What its messages call names[0] the user knows as names[1]."""
    command = [find(program), "-q", *arguments]
    try:
        done = subprocess.run(command, input=given, stdin=None if given is not None else subprocess.DEVNULL,
                              capture_output=True, cwd=folder, timeout=preference("time_limit"), check=False)
    except subprocess.TimeoutExpired as late:
        raise Failure(f"{program} took longer than {late.timeout:g} s and was ended "
                      "(make less of it, or raise the limit in the add-on's preferences)") from late
    except OSError as error:
        raise Failure(f"{program} cannot be started: {error.strerror or error}") from error
    if done.returncode == 0:
        return done.stdout
    lines = done.stderr.decode("utf-8", "replace").strip().splitlines()
    before, after = f"{program}: {names[0]}:", f"{program}: {names[1]}:"
    raise Failure(*[after + line[len(before):] if names[0] and line.startswith(before) else line for line in lines]
                  or [f"{program} ended with {done.returncode}, without a message"])


def number(value):
    return f"{value:.7g}"  # what a single-precision number holds


def medium_arguments(s):
    if grammar_decides(s):
        return []
    words = ["--model", s.model.lower(), "--extinction", number(s.extinction), "--albedo", number(s.albedo),
             "--phase", "hg", "--g", number(s.g), "--kappa", number(s.kappa), "--octaves", str(s.octaves)]
    for option, value in (("--noise-scale", s.noise_scale), ("--billow", s.billow), ("--wisp", s.wisp)):
        if value > 0:
            words += [option, number(value)]
    return words


def write_mesh(thing, path):
    """The evaluated object in world space, z up, as OBJ. N-gons stay: neph-mesh cuts them."""
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    try:
        if not mesh or not mesh.polygons:
            raise Failure(f"{thing.name} has no faces (choose a mesh with faces; instances must be made real)")
        world = evaluated.matrix_world
        turn = -1 if world.determinant() < 0 else 1  # a mirrored object's faces would look inwards
        with open(path, "w", encoding="ascii") as file:
            for vertex in mesh.vertices:
                file.write("v {:.9g} {:.9g} {:.9g}\n".format(*(world @ vertex.co)))
            for polygon in mesh.polygons:
                file.write("f " + " ".join(str(i + 1) for i in list(polygon.vertices)[::turn]) + "\n")
    finally:
        evaluated.to_mesh_clear()


def make_shape(s, source, folder):
    common = ["--seed", str(s.seed), "-o", "cloud.neph", *medium_arguments(s)]
    if s.kind == "MESH":
        if not source:
            raise Failure("the cloud has no mesh any more (choose one in the panel)")
        write_mesh(source, os.path.join(folder, "mesh.obj"))
        words = ["--up", "z", "--faces", str(s.faces), "--scale", number(s.size), "--fill", str(s.fill)]
        words += ["--fit", "--thickness", number(s.thickness)] if s.fit else []
        run("neph-mesh", [*words, *common, "mesh.obj"], folder, names=("mesh.obj", source.name))
    elif s.kind == "GRAMMAR":
        if not s.text:
            raise Failure("there is no grammar (write one in the Text Editor and choose it in the panel)")
        words = ["--iterations", str(s.iterations)] if s.iterations >= 0 else []
        run("neph-lsys", [*words, *common, "-"], folder, s.text.as_string().encode(), ("standard input", s.text.name))
    else:
        x, y, z = (number(value) for value in s.spread)
        words = ["--preset", s.preset.lower()] if s.preset != "NONE" else [
            "--count", str(s.count), "--sigma", f"{x},{z},{y}", "--max-radius", number(s.radius)]
        run("neph-gauss", [*words, *common], folder)


def volume_folder(scene):
    """Where volumes go, and whether they are lost when Blender ends."""
    if scene.nephele_folder.startswith("//") and not bpy.data.filepath:
        return bpy.app.tempdir, True
    return os.path.abspath(bpy.path.abspath(scene.nephele_folder)), False


def keep(path, folder, stem):
    """Moves the volume to its folder, whole or not at all, by a name that says its content."""
    with open(path, "rb") as file:
        digest = hashlib.sha256(file.read()).hexdigest()[:8]
    kept = os.path.join(folder, f"{stem}-{digest}.vdb")
    try:
        os.makedirs(folder, exist_ok=True)
        part = kept + ".part"
        try:
            shutil.copyfile(path, part)
            os.replace(part, kept)
        finally:
            if os.path.exists(part):
                os.remove(part)
    except OSError as error:
        raise Failure(f"{folder} cannot be written: {error.strerror or error} (choose another folder)") from error
    return kept


def check_volume(path):
    volume = bpy.data.volumes.new("nephele check")
    try:
        volume.filepath = path
        if not volume.grids.load() or "density" not in [grid.name for grid in volume.grids]:
            raise Failure(f"Blender cannot read the volume: {volume.grids.error_message or 'no density in it'}")
    finally:
        bpy.data.volumes.remove(volume)


@contextlib.contextmanager
def waiting():
    """The pointer says that it takes a moment."""
    window = bpy.context.window
    if window:
        window.cursor_set("WAIT")
    try:
        yield
    finally:
        if window:
            window.cursor_set("DEFAULT")


def make_volume(s, source, scene, stem):
    """The volume's file, what neph-info says of its cloud, and what the user should know."""
    folder, passing = volume_folder(scene)
    with waiting(), tempfile.TemporaryDirectory(prefix="nephele-") as work:
        make_shape(s, source, work)
        cloud = json.loads(run("neph-info", ["--json", "cloud.neph"], work))["clouds"][0]
        voxels = s.preview_voxels if s.preview else s.voxels
        words = ["--resolution", str(voxels), "--up", "z", *(["--half"] if s.half else [])]
        run("neph-vdb", ["cloud.neph", *words, "-o", "cloud.vdb"], work)
        made = os.path.join(work, "cloud.vdb")
        check_volume(made)
        path = keep(made, folder, stem)
    said = f"{cloud['primitives']} primitives, {voxels} voxels, {os.path.getsize(path) / 1e6:.1f} MB: {path}"
    if passing:
        said += " - a temporary folder, emptied when Blender ends: save the .blend, then make it again"
    return path, cloud, said


# --- the scene

def mean_cosine(medium):
    """Cycles has Henyey and Greenstein's phase function alone: the one of the same mean cosine stands for others."""
    g, other, share = medium["g"], medium["g2"], medium["lobe_mix"]
    return {"isotropic": 0, "rayleigh": 0, "two-lobe": (1 - share) * g + share * other}.get(medium["phase"], g)


def new_material():
    """Principled Volume: density is the attribute `density` times extinction; its colour is the albedo."""
    material = bpy.data.materials.new(SHADER)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    shader = nodes.new("ShaderNodeVolumePrincipled")
    shader.name = shader.label = SHADER
    output = nodes.new("ShaderNodeOutputMaterial")
    output.location = (320, 0)
    material.node_tree.links.new(shader.outputs["Volume"], output.inputs["Volume"])
    return material


def set_shader(volume, extinction, albedo, g):
    for material in volume.materials:
        shader = material and material.node_tree and material.node_tree.nodes.get(SHADER)
        if shader:
            shader.inputs["Density"].default_value = extinction
            shader.inputs["Color"].default_value = (albedo, albedo, albedo, 1)
            shader.inputs["Anisotropy"].default_value = g


def show(cloud, path, medium):
    """The object's volume becomes the file; of data and material that others share it gets its own."""
    if cloud.data.users > 1:
        cloud.data = cloud.data.copy()
    volume = cloud.data
    volume.filepath = path
    if bpy.data.filepath:
        try:
            volume.filepath = bpy.path.relpath(path)
        except ValueError:  # another drive
            pass
    if not volume.materials:
        volume.materials.append(new_material())
    for i, material in enumerate(volume.materials):
        if material and material.users > 1 and material.node_tree and material.node_tree.nodes.get(SHADER):
            volume.materials[i] = material.copy()
    settings = cloud.nephele
    if grammar_decides(settings):
        settings.extinction, settings.albedo, settings.g = medium["extinction"], medium["albedo"], mean_cosine(medium)
    set_shader(volume, settings.extinction, settings.albedo, settings.g)
    if settings.kind == "MESH" and settings.hide_source:
        settings.source.hide_render = True
        settings.source.display_type = "WIRE"


def report_failure(operator, failure, settings):
    for line in failure.lines[:10]:
        operator.report({"ERROR"}, line)
    place = re.search(r":(\d+):(\d+): ", failure.lines[0])
    if settings.kind == "GRAMMAR" and settings.text and place:
        settings.text.cursor_set(int(place[1]) - 1, character=int(place[2]) - 1)
    return {"CANCELLED"}


def is_cloud(thing):
    return bool(thing and thing.type == "VOLUME" and thing.nephele.stem)


class NEPHELE_OT_make(bpy.types.Operator):
    """Make a cloud by the settings of the panel: of the active mesh where it stands, else at the 3D cursor"""
    bl_idname = "nephele.make"
    bl_label = "Make Cloud"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT"

    def execute(self, context):
        settings = context.scene.nephele
        source = context.active_object
        if settings.kind == "MESH" and (not source or source.type not in SURFACES):
            self.report({"ERROR"}, "no mesh is active (select a mesh, curve, surface, text or metaball)")
            return {"CANCELLED"}
        named = {"MESH": source, "GRAMMAR": settings.text}.get(settings.kind)
        name = f"{named.name} cloud" if named else "Cloud"
        stem = f"{bpy.path.clean_name(name)}-{uuid.uuid4().hex[:6]}"
        try:
            path, made, said = make_volume(settings, source, context.scene, stem)
        except Failure as failure:
            return report_failure(self, failure, settings)
        cloud = bpy.data.objects.new(name, bpy.data.volumes.new(name))
        context.collection.objects.link(cloud)
        copy_settings(settings, cloud.nephele)
        cloud.nephele.stem = stem
        if settings.kind == "MESH":
            cloud.nephele.source = source
        else:
            cloud.location = context.scene.cursor.location
        show(cloud, path, made["medium"])
        for thing in context.selected_objects:
            thing.select_set(False)
        cloud.select_set(True)
        context.view_layer.objects.active = cloud
        self.report({"INFO"}, said)
        return {"FINISHED"}


class NEPHELE_OT_make_again(bpy.types.Operator):
    """Make the active cloud again, by its settings as they are now"""
    bl_idname = "nephele.make_again"
    bl_label = "Make Again"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT" and is_cloud(context.object) and not context.object.library

    def execute(self, context):
        cloud = context.object
        settings = cloud.nephele
        try:
            path, made, said = make_volume(settings, settings.source, context.scene, bpy.path.clean_name(settings.stem))
        except Failure as failure:
            return report_failure(self, failure, settings)
        show(cloud, path, made["medium"])
        self.report({"INFO"}, said)
        return {"FINISHED"}


def can_denoise():
    try:
        import _cycles
    except ImportError:
        return True
    return getattr(_cycles, "with_openimagedenoise", True)


class NEPHELE_OT_light(bpy.types.Operator):
    """Set the scene up for clouds: Cycles with enough volume bounces, a sun if there is none, and a sky in place of the world"""
    bl_idname = "nephele.light"
    bl_label = "Sun, Sky and Cycles"
    bl_options = {"REGISTER", "UNDO"}

    bounces: IntProperty(name="Volume Bounces", default=64, min=0, max=1024)
    sky: FloatVectorProperty(name="Sky", default=(0.05, 0.12, 0.3), min=0, subtype="COLOR")

    def execute(self, context):
        scene = context.scene
        if not hasattr(scene, "cycles"):
            self.report({"ERROR"}, "there is no Cycles (enable its add-on)")
            return {"CANCELLED"}
        scene.render.engine = "CYCLES"
        scene.cycles.max_bounces = max(scene.cycles.max_bounces, self.bounces)
        scene.cycles.volume_bounces = max(scene.cycles.volume_bounces, self.bounces)
        if not can_denoise():
            scene.cycles.use_denoising = False  # Debian's Cycles has no denoiser, and renders nothing when asked for one
        if not any(thing.type == "LIGHT" and thing.data.type == "SUN" for thing in scene.objects):
            light = bpy.data.lights.new("Sun", "SUN")
            light.energy = 3.14159265  # irradiance: a white surface that faces it has radiance 1
            light.angle = 0.00925
            sun = bpy.data.objects.new("Sun", light)
            sun.rotation_euler = Vector((0.663, -0.383, 0.643)).to_track_quat("Z", "Y").to_euler()
            scene.collection.objects.link(sun)
        if not scene.world or scene.world.name != "Nephele sky":
            scene.world = bpy.data.worlds.get("Nephele sky") or bpy.data.worlds.new("Nephele sky")
        scene.world.use_nodes = True
        background = next(node for node in scene.world.node_tree.nodes if node.type == "BACKGROUND")
        background.inputs["Color"].default_value = (*self.sky, 1)
        return {"FINISHED"}


class NEPHELE_OT_tidy(bpy.types.Operator):
    """Remove the files of the active cloud's former volumes. Undo cannot bring them back, and another .blend may use them"""
    bl_idname = "nephele.tidy"
    bl_label = "Remove Former Volumes"

    @classmethod
    def poll(cls, context):
        return is_cloud(context.object)

    def invoke(self, context, event):
        return context.window_manager.invoke_confirm(self, event)

    def execute(self, context):
        used = {os.path.realpath(bpy.path.abspath(volume.filepath, library=volume.library))
                for volume in bpy.data.volumes if volume.users}
        current = bpy.path.abspath(context.object.data.filepath)
        stem = bpy.path.clean_name(context.object.nephele.stem)
        pattern = re.compile(re.escape(stem) + r"-[0-9a-f]{8}\.vdb")
        count = 0
        for path in glob.glob(os.path.join(glob.escape(os.path.dirname(current)), "*.vdb")):
            if pattern.fullmatch(os.path.basename(path)) and os.path.realpath(path) not in used:
                try:
                    os.remove(path)
                    count += 1
                except OSError as error:
                    self.report({"ERROR"}, f"{path}: {error.strerror or error}")
        self.report({"INFO"}, f"{count} files removed")
        return {"FINISHED"}


# --- the panel

def draw_shape(layout, s, own):
    """own: of a cloud that is there, not of the next one."""
    if s.kind == "MESH":
        if own:
            layout.prop(s, "source")
        layout.prop(s, "faces")
        layout.prop(s, "size")
        layout.prop(s, "fit")
        row = layout.row()
        row.enabled = s.fit
        row.prop(s, "thickness")
        layout.prop(s, "fill")
        layout.prop(s, "hide_source")
    elif s.kind == "GRAMMAR":
        layout.prop(s, "text")
        layout.prop(s, "iterations")
    else:
        layout.prop(s, "preset")
        column = layout.column()
        column.enabled = s.preset == "NONE"
        column.prop(s, "count")
        column.prop(s, "spread")
        column.prop(s, "radius")
    layout.prop(s, "seed")


def draw_medium(layout, s):
    if s.kind == "GRAMMAR":
        layout.prop(s, "own_medium")
    column = layout.column()
    column.enabled = not grammar_decides(s)
    for name in ("extinction", "albedo", "g", "model", "kappa", "octaves", "noise_scale", "billow", "wisp"):
        column.prop(s, name)


def draw_settings(layout, s, own):
    layout.use_property_split = True
    layout.use_property_decorate = False
    draw_shape(layout.column(), s, own)
    draw_medium(layout.column(), s)
    column = layout.column()
    column.prop(s, "preview")
    column.prop(s, "preview_voxels" if s.preview else "voxels", text="Voxels")
    column.prop(s, "half")


class Tab:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Nephele"


class NEPHELE_PT_cloud(Tab, bpy.types.Panel):
    bl_label = "Cloud"

    @classmethod
    def poll(cls, context):
        return is_cloud(context.object)

    def draw(self, context):
        self.layout.operator("nephele.make_again", icon="FILE_REFRESH")
        draw_settings(self.layout, context.object.nephele, True)
        self.layout.operator("nephele.tidy", icon="TRASH")


class NEPHELE_PT_new(Tab, bpy.types.Panel):
    bl_label = "New Cloud"

    def draw(self, context):
        settings = context.scene.nephele
        self.layout.row().prop(settings, "kind", expand=True)
        if settings.kind == "MESH":
            thing = context.active_object
            if thing and thing.type in SURFACES:
                self.layout.label(text=f"of {thing.name}", icon="OUTLINER_OB_MESH")
            else:
                self.layout.label(text="Select a mesh", icon="INFO")
        self.layout.operator("nephele.make", icon="OUTLINER_OB_VOLUME")
        draw_settings(self.layout, settings, False)
        self.layout.prop(context.scene, "nephele_folder")
        if volume_folder(context.scene)[1]:
            self.layout.label(text="Not saved: temporary", icon="INFO")


class NEPHELE_PT_light(Tab, bpy.types.Panel):
    bl_label = "Light and Rendering"

    def draw(self, context):
        scene = context.scene
        if scene.render.engine != "CYCLES":
            self.layout.label(text="Engine is not Cycles", icon="INFO")
        elif min(scene.cycles.volume_bounces, scene.cycles.max_bounces) < FEW_BOUNCES:
            self.layout.label(text="Few bounces: too dark", icon="INFO")
        self.layout.operator("nephele.light", icon="LIGHT_SUN")


classes = (NepheleSettings, NephelePreferences, NEPHELE_OT_make, NEPHELE_OT_make_again, NEPHELE_OT_light,
           NEPHELE_OT_tidy, NEPHELE_PT_cloud, NEPHELE_PT_new, NEPHELE_PT_light)


def register():
    for each in classes:
        bpy.utils.register_class(each)
    bpy.types.Object.nephele = PointerProperty(type=NepheleSettings)
    bpy.types.Scene.nephele = PointerProperty(type=NepheleSettings)
    bpy.types.Scene.nephele_folder = StringProperty(
        name="Volumes", subtype="DIR_PATH", default="//", description="Where .vdb files are kept; //: beside the .blend")


def unregister():
    del bpy.types.Scene.nephele_folder, bpy.types.Scene.nephele, bpy.types.Object.nephele
    for each in reversed(classes):
        bpy.utils.unregister_class(each)


if __name__ == "__main__":
    register()
