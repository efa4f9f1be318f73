"""The add-on examples/blender/nephele_addon.py within Blender; tests/blender_addon.sh runs this.

    blender -b --factory-startup --python-exit-code 1 --python tests/blender_addon.py -- PROGRAMS SOURCE FOLDER

Each cloud's bounds are compared with those that neph-info gives of the same command, run here without the add-on.
"""
import json
import math
import os
import subprocess
import sys
import time

import bpy
from mathutils import Vector

programs, source, folder = (os.path.abspath(word) for word in sys.argv[sys.argv.index("--") + 1:])
volumes = os.path.join(folder, "volumes")
VOXELS = 96
GRAMMAR = "axiom X\niterations 5\nradius 1\nlength 1\nphase two-lobe\ng 0.8\ng2 -0.4\nlobe-mix 0.25\nX -> F &(12) X\n"


def check(truth, *what):
    if not truth:
        raise AssertionError(" ".join(str(part) for part in what))


def near(a, b, tolerance):
    return abs(a - b) <= tolerance


def settings():
    return bpy.context.scene.nephele


def info(program, *words, given=None):
    made = subprocess.run([f"{programs}/{program}", "-q", *words], input=given, capture_output=True, check=True)
    said = subprocess.run([f"{programs}/neph-info", "--json", "-"], input=made.stdout, capture_output=True, check=True)
    return json.loads(said.stdout)["clouds"][0]


def check_bounds(cloud, expected):
    """Upright: y up becomes z up. Blender's box is that of the leaves, of eight voxels each."""
    low, high = expected["bounds"]
    voxel = max(b - a for a, b in zip(low, high)) / VOXELS
    corners = cloud.evaluated_get(bpy.context.evaluated_depsgraph_get()).bound_box
    for k, (a, b) in enumerate(((low[0], high[0]), (-high[2], -low[2]), (low[1], high[1]))):
        values = [corner[k] for corner in corners]
        check(near(min(values), a, 1.5 * voxel), cloud.name, "axis", k, "begins at", min(values), "not", a)
        check(-1.5 * voxel < max(values) - b < 8.5 * voxel, cloud.name, "axis", k, "ends at", max(values), "not", b)


def path_of(cloud):
    path = bpy.path.abspath(cloud.data.filepath)
    check(os.path.isfile(path), path, "is not there")
    return path


def everything():
    """What a failure must leave as it was."""
    files = sorted(name for _, _, names in os.walk(folder) for name in names)
    things = [(thing.name, thing.type, thing.hide_render, thing.display_type) for thing in bpy.data.objects]
    data = [[(block.name, block.users) for block in group] for group in
            (bpy.data.volumes, bpy.data.materials, bpy.data.meshes, bpy.data.worlds, bpy.data.texts)]
    return files, things, data, [volume.filepath for volume in bpy.data.volumes]


def refused(operator, *words):
    """The operator reports all the words, and changes nothing."""
    before = everything()
    try:
        operator()
    except RuntimeError as error:
        for word in words:
            check(word in str(error), "not said:", word, "but:", error)
    else:
        check(False, "not refused:", words)
    check(everything() == before, "a failure changed the scene:", before, everything())


def make(**values):
    for name, value in {"own_medium": False, "model": "SPHEROID", "extinction": 2, "albedo": 1, "g": 0.85, "seed": 1,
                        "preview": True, "preview_voxels": VOXELS, **values}.items():
        setattr(settings(), name, value)
    count = len(bpy.data.objects)
    check(bpy.ops.nephele.make() == {"FINISHED"})
    check(len(bpy.data.objects) == count + 1, "not one object more")
    cloud = bpy.context.object
    check(cloud.type == "VOLUME" and cloud.nephele.stem, "the new cloud is not active")
    return cloud


def make_again(cloud, **values):
    """The same object of another file; the former one stays, for undo."""
    former, count = path_of(cloud), len(bpy.data.objects)
    for name, value in values.items():
        setattr(cloud.nephele, name, value)
    bpy.context.view_layer.objects.active = cloud
    check(bpy.ops.nephele.make_again() == {"FINISHED"})
    check(bpy.context.object == cloud and len(bpy.data.objects) == count, "another object")
    check(path_of(cloud) != former and os.path.isfile(former), "not another file, or the former one is gone")


def look(eye, target, fov, towards_sun):
    data = bpy.data.cameras.new("eye")
    data.sensor_fit, data.angle = "VERTICAL", math.radians(fov)
    camera = bpy.data.objects.new("eye", data)
    camera.location = eye
    camera.rotation_euler = (Vector(target) - Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    sun = next(thing for thing in bpy.data.objects if thing.type == "LIGHT" and thing.data.type == "SUN")
    sun.rotation_euler = Vector(towards_sun).to_track_quat("Z", "Y").to_euler()


def render(only, name, samples):
    scene = bpy.context.scene
    for thing in scene.objects:
        if thing.type in ("VOLUME", "MESH"):
            thing.hide_render = thing != only
    scene.cycles.samples, scene.cycles.use_adaptive_sampling = samples, False
    scene.cycles.sample_clamp_indirect = 0
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 96, 54, 100
    scene.render.film_transparent = name.startswith("side")
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.view_settings.view_transform = "Raw"
    scene.render.filepath = os.path.join(folder, name + ".exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    width, values = image.size[0], list(image.pixels)
    bpy.data.images.remove(image)
    scene.render.image_settings.file_format, scene.view_settings.view_transform = "PNG", "Standard"
    image = bpy.data.images.load(scene.render.filepath)
    image.save_render(os.path.join(folder, name + ".png"), scene=scene)  # to look at
    bpy.data.images.remove(image)
    return [(i % width, values[4 * i], values[4 * i + 3]) for i in range(len(values) // 4)]


def check_picture(cloud, name):
    """Seen from the front with the sun far on the left: the cloud is there, and its left half is the brighter."""
    corners = [cloud.matrix_world @ Vector(corner) for corner in cloud.bound_box]
    middle = sum(corners, Vector()) / 8
    size = max((corner - middle).length for corner in corners)
    look(middle + Vector((0, -2.6 * size, 0.2 * size)), middle, 45, (-0.9, -0.25, 0.35))
    seen = [pixel for pixel in render(cloud, "side-" + name, 24) if pixel[2] > 0.5]
    check(0.03 * 96 * 54 < len(seen) < 0.7 * 96 * 54, name, "covers", len(seen), "pixels")
    seen.sort()
    half = len(seen) // 2
    left, right = (sum(pixel[1] for pixel in part) / half for part in (seen[:half], seen[-half:]))
    print(f"{name}: {len(seen)} pixels, sunny half {left:.3f}, other half {right:.3f}")
    check(left > 1.25 * right > 0, name, "left", left, "right", right)


# --- installed and enabled as by hand, into a folder of its own (BLENDER_USER_SCRIPTS, set by the shell)
bpy.ops.preferences.addon_install(filepath=os.path.join(source, "examples/blender/nephele_addon.py"))
bpy.ops.preferences.addon_enable(module="nephele_addon")
preferences = bpy.context.preferences.addons["nephele_addon"].preferences
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
bpy.ops.preferences.addon_enable(module="nephele_addon")
bpy.context.scene.world = bpy.data.worlds.new("mine")
preferences = bpy.context.preferences.addons["nephele_addon"].preferences

# --- programs that are not there
settings().kind = "GAUSS"
os.environ["PATH"], path = "/nowhere", os.environ["PATH"]
refused(bpy.ops.nephele.make, "neph-gauss is not on the search path", "preferences")
os.environ["PATH"] = path
preferences.programs = folder
refused(bpy.ops.nephele.make, "neph-gauss is not in " + folder)

# --- an unsaved .blend: a temporary folder, which the shell looks for in what was said
preferences.programs = programs
cloud = make(kind="GAUSS")
check(path_of(cloud).startswith(bpy.app.tempdir), path_of(cloud))
bpy.data.objects.remove(cloud)

# --- a saved one: beside it, by a relative path
bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "clouds.blend"))
bpy.context.scene.cursor.location = (10, -20, 3)
plain = {"model": "UNIFORM", "extinction": 1, "albedo": 0.8, "g": 0.4}
heap = make(kind="GAUSS", seed=5, spread=(4, 1.5, 1), **plain)
check(os.path.dirname(path_of(heap)) == folder and heap.data.filepath.startswith("//"), heap.data.filepath)
check(tuple(heap.location) == (10, -20, 3), "not at the cursor")
words = ["--sigma", "4,1,1.5", "--model", "uniform"]
check_bounds(heap, info("neph-gauss", "--seed", "5", *words))

# --- made again; in another folder, which is made
bpy.context.scene.nephele_folder = "//volumes"
make_again(heap, seed=6)
check(os.path.dirname(path_of(heap)) == volumes, path_of(heap))
check_bounds(heap, info("neph-gauss", "--seed", "6", *words))
make_again(heap, preset="HUMILIS")
check_bounds(heap, info("neph-gauss", "--seed", "6", "--preset", "humilis", "--model", "uniform"))
make_again(heap, preset="NONE", seed=5)

# --- the medium goes to the material at once; a copy that is made again leaves the first alone
shader = heap.data.materials[0].node_tree.nodes["Nephele cloud"].inputs
check(near(shader["Density"].default_value, 1, 1e-6) and near(shader["Anisotropy"].default_value, 0.4, 1e-6))
heap.nephele.extinction = 3
check(shader["Density"].default_value == 3, "extinction is not shown")
heap.nephele.extinction = 1
twin = heap.copy()
bpy.context.collection.objects.link(twin)
former = path_of(heap)
make_again(twin, seed=7)
check(path_of(heap) == former and twin.data != heap.data and twin.data.materials[0] != heap.data.materials[0])
bpy.data.objects.remove(twin)

# --- a mesh, mirrored, turned, and with a modifier. The other way: Blender's own OBJ, y up. No decimation, whose order
# hangs on the last digits of coordinates, which OBJ does not have.
bpy.ops.mesh.primitive_monkey_add(location=(-6, 2, 1), rotation=(0.3, 0.2, 0.9), scale=(2, -3, 2.5))
monkey = bpy.context.object
monkey.modifiers.new("smooth", "SUBSURF").levels = 1
obj = os.path.join(folder, "monkey.obj")
bpy.ops.wm.obj_export(filepath=obj, export_selected_objects=True, export_materials=False)
head = make(kind="MESH", faces=0, **plain)
check(head.nephele.source == monkey and monkey.hide_render, "the mesh is not kept, or not hidden")
check_bounds(head, info("neph-mesh", "--faces", "0", "--model", "uniform", obj))
make_again(head, size=1.5)
check_bounds(head, info("neph-mesh", "--faces", "0", "--scale", "1.5", "--model", "uniform", obj))
make_again(head, fit=True, fill=40, faces=200, size=1.2)
os.remove(obj)

# --- a grammar, whose medium is its own until it is overridden
text = bpy.data.texts.new("Stairs")
text.from_string(GRAMMAR)
stairs = make(kind="GRAMMAR", text=text)
check(stairs.name == "Stairs cloud", stairs.name)
check_bounds(stairs, info("neph-lsys", "-", given=GRAMMAR.encode()))
shader = stairs.data.materials[0].node_tree.nodes["Nephele cloud"].inputs
check(near(shader["Anisotropy"].default_value, 0.75 * 0.8 - 0.25 * 0.4, 1e-6), "not the lobes' mean cosine")
make_again(stairs, iterations=12)
check_bounds(stairs, info("neph-lsys", "--iterations", "12", "-", given=GRAMMAR.encode()))
make_again(stairs, own_medium=True, model="UNIFORM", g=0.4)
check(near(shader["Anisotropy"].default_value, 0.4, 1e-6), "the medium is not overridden")

# --- undo, of a cloud made again and of a new one
former, count = path_of(stairs), len(bpy.data.objects)
bpy.ops.ed.undo_push(message="before")
stairs.nephele.iterations = 3
bpy.context.view_layer.objects.active = stairs
bpy.ops.nephele.make_again("EXEC_DEFAULT", True)
check(path_of(bpy.data.objects["Stairs cloud"]) != former)
bpy.ops.ed.undo()
check(path_of(bpy.data.objects["Stairs cloud"]) == former, "undo does not bring the former file back")
settings().kind = "GAUSS"
bpy.ops.ed.undo_push(message="before")
bpy.ops.nephele.make("EXEC_DEFAULT", True)
bpy.ops.ed.undo()
check(len(bpy.data.objects) == count, "undo does not take the cloud away")
heap, head, stairs = (bpy.data.objects[name] for name in ("Cloud", "Suzanne cloud", "Stairs cloud"))

# --- failures: said with the place, and the scene is as it was. On a cloud that is there, too.
preferences = bpy.context.preferences.addons["nephele_addon"].preferences
wrong = bpy.data.texts.new("Wrong")
wrong.from_string("axiom X\niteratons 3\nX -> X [ Y\n")
settings().kind, settings().text = "GRAMMAR", wrong
refused(bpy.ops.nephele.make, "neph-lsys: Wrong:2:1: iteratons", "neph-lsys: Wrong:3:8: '['")
check(wrong.current_line_index == 1, "the cursor is not on the mistake")
settings().text = None
refused(bpy.ops.nephele.make, "there is no grammar")
text = stairs.nephele.text
text.from_string(GRAMMAR.replace("radius", "radios"))
bpy.context.view_layer.objects.active = stairs
refused(bpy.ops.nephele.make_again, "Stairs:3:1: radios")
text.from_string(GRAMMAR)
settings().kind = "MESH"
refused(bpy.ops.nephele.make, "no mesh is active")
points = bpy.data.objects.new("Points", bpy.data.meshes.new("Points"))
bpy.context.collection.objects.link(points)
bpy.context.view_layer.objects.active = points
refused(bpy.ops.nephele.make, "Points has no faces")
bpy.data.objects.remove(points)
settings().kind = "GAUSS"
bpy.context.scene.nephele_folder = "/proc/nowhere"
refused(bpy.ops.nephele.make, "/proc/nowhere cannot be written")
bpy.context.scene.nephele_folder = "//volumes"
preferences.programs = os.path.join(folder, "broken")  # programs that fail, hang, and are none; written by the shell
bpy.context.view_layer.objects.active = heap
refused(bpy.ops.nephele.make_again, "neph-gauss: the disk is full (make room)")
bpy.context.view_layer.objects.active = stairs
refused(bpy.ops.nephele.make_again, "neph-lsys cannot be started")
preferences.time_limit = 1
bpy.context.view_layer.objects.active = head
begun = time.monotonic()
refused(bpy.ops.nephele.make_again, "neph-mesh took longer than 1 s")
check(time.monotonic() - begun < 20, "the time limit does not hold")
preferences.programs, preferences.time_limit = programs, 600

# --- pictures, and one whose brightness the shell compares with neph-render's
bpy.ops.nephele.light(sky=(0, 0, 0))
bpy.context.scene.cycles.volume_step_rate = 1
for cloud, name in ((heap, "heap"), (head, "mesh"), (stairs, "grammar")):
    check_picture(cloud, name)
bpy.ops.nephele.light(sky=(0.1, 0.1, 0.1), bounces=1024)
check(sum(thing.type == "LIGHT" for thing in bpy.data.objects) == 1, "a second sun")
heap.location = (0, 0, 0)
sun, height = math.radians(20), math.radians(40)
look((0, -22, 2), (0, 0, 1), 40, (math.cos(height) * math.sin(sun), -math.cos(height) * math.cos(sun), math.sin(height)))
render(heap, "theirs", 32)

# --- former files are removed, those in use are not; and all is there in the saved .blend
kept = [path_of(thing) for thing in (heap, head, stairs)]
bpy.context.view_layer.objects.active = heap
stem = heap.nephele.stem
check(sum(name.startswith(stem) for name in os.listdir(volumes)) > 1)
bpy.ops.nephele.tidy()
check([name for name in os.listdir(volumes) if name.startswith(stem)] == [os.path.basename(kept[0])])
check(all(os.path.isfile(path) for path in kept))
bpy.ops.wm.save_mainfile()
bpy.ops.wm.open_mainfile(filepath=os.path.join(folder, "clouds.blend"))
heap = bpy.data.objects["Cloud"]
check(path_of(heap) == kept[0] and heap.nephele.seed == 5 and heap.data.grids.load())
make_again(heap, seed=8)
bpy.ops.preferences.addon_disable(module="nephele_addon")
check(not hasattr(bpy.types.Object, "nephele"), "not unregistered")
print("all is as it should be")
