"""A volume of neph-vdb in Blender, with the material, sun, sky and camera of a neph-render command.

    blender --python examples/blender/import_vdb.py -- cloud.vdb                       to look at and work on
    blender -b --python examples/blender/import_vdb.py -- cloud.vdb --render x.exr     a picture by Cycles
    blender -b --python examples/blender/import_vdb.py -- cloud.vdb --render x.png     the same, to look at
    blender -b --python examples/blender/import_vdb.py -- cloud.vdb --check            what Blender finds, as JSON

Options have neph-render's names, axes (y up) and units. Extinction, albedo and g are those noted in the file, unless they are
given here.
"""
import argparse
import json
import math
import re
import struct
import sys

import bpy
from mathutils import Vector


def arguments():
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    # A number that begins by a minus is no option.
    for i in range(len(words) - 1, 0, -1):
        if words[i - 1].startswith("--") and re.match(r"-[0-9.]", words[i]):
            words[i - 1:i + 1] = [words[i - 1] + "=" + words[i]]
    parser = argparse.ArgumentParser(prog="import_vdb.py")
    numbers = lambda text: [float(part) for part in text.split(",")]
    parser.add_argument("volume")
    parser.add_argument("--extinction", type=float, help="at density 1, 1/m [of the file, else 2]")
    parser.add_argument("--albedo", type=float, help="[of the file, else 1]")
    parser.add_argument("--g", type=float, help="mean cosine [of the file, else 0.85]")
    parser.add_argument("--eye", type=numbers, help="X,Y,Z in metres, y up")
    parser.add_argument("--target", type=numbers, help="X,Y,Z [the volume's middle]")
    parser.add_argument("--fov", type=float, default=45, help="vertical, degrees [45]")
    parser.add_argument("--sun", type=numbers, default=[60, 40], help="AZIMUTH,HEIGHT in degrees [60,40]")
    parser.add_argument("--sky", type=numbers, default=[0, 0, 0], help="R,G,B, one radiance all round [0,0,0]")
    parser.add_argument("--size", default="320x180", help="WxH [320x180]")
    parser.add_argument("--samples", type=int, default=32, help="a pixel [32]")
    parser.add_argument("--bounces", type=int, default=1024, help="within the volume [1024]")
    parser.add_argument("--step-rate", type=float, default=1, help="of Cycles' march, in voxels [1]")
    parser.add_argument("--seed", type=int, default=0, help="of the samples [0]")
    parser.add_argument("--filter", choices=["blackman-harris", "box"], default="blackman-harris",
                        help="of a pixel: Cycles' own, or that of neph-render [blackman-harris]")
    parser.add_argument("--threads", type=int, default=0, help="[all]")
    parser.add_argument("--render", metavar="FILE", help="render to linear OpenEXR, or to a .png (sRGB, no tone curve)")
    parser.add_argument("--check", action="store_true", help="print grids and bounds as JSON")
    return parser.parse_args(words)


def upright(v):
    """y up to z up, as neph-vdb --up z does it."""
    return Vector((v[0], -v[2], v[1]))


def notes(path):
    """What neph-vdb noted of the medium. In a .vdb a note is its name, its type and its value, each behind its length."""
    with open(path, "rb") as file:
        content = file.read()
    found = {}
    for name in ("extinction", "albedo", "g"):
        head = struct.pack("<I", len("neph_" + name)) + b"neph_" + name.encode()
        at = content.find(head)
        for kind, form in ((b"float", "<f"), (b"double", "<d")):
            head_of_kind = struct.pack("<I", len(kind)) + kind + struct.pack("<I", struct.calcsize(form))
            start = at + len(head)
            if at >= 0 and content.startswith(head_of_kind, start):
                found[name] = struct.unpack_from(form, content, start + len(head_of_kind))[0]
    return found


def import_volume(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.object.volume_import(filepath=path)
    volume = bpy.context.object
    volume.data.grids.load()
    return volume


def bounds(volume):
    corners = volume.evaluated_get(bpy.context.evaluated_depsgraph_get()).bound_box
    low = [min(c[k] for c in corners) for k in range(3)]
    return low, [max(c[k] for c in corners) for k in range(3)]


def medium(volume, extinction, albedo, g):
    """Scattering and absorption add up to density times extinction."""
    material = bpy.data.materials.new("cloud")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    density = nodes.new("ShaderNodeAttribute")
    density.attribute_name = "density"
    times = nodes.new("ShaderNodeMath")
    times.operation = "MULTIPLY"
    times.inputs[1].default_value = extinction
    scatter = nodes.new("ShaderNodeVolumeScatter")
    scatter.inputs["Color"].default_value = (albedo, albedo, albedo, 1)
    scatter.inputs["Anisotropy"].default_value = g
    absorb = nodes.new("ShaderNodeVolumeAbsorption")
    absorb.inputs["Color"].default_value = (albedo, albedo, albedo, 1)
    both = nodes.new("ShaderNodeAddShader")
    output = nodes.new("ShaderNodeOutputMaterial")
    links.new(density.outputs["Fac"], times.inputs[0])
    links.new(times.outputs[0], scatter.inputs["Density"])
    links.new(times.outputs[0], absorb.inputs["Density"])
    links.new(scatter.outputs[0], both.inputs[0])
    links.new(absorb.outputs[0], both.inputs[1])
    links.new(both.outputs[0], output.inputs["Volume"])
    volume.data.materials.append(material)


def add_sun(azimuth, height):
    a, h = math.radians(azimuth), math.radians(height)
    light = bpy.data.lights.new("sun", "SUN")
    light.energy = math.pi  # irradiance on a plane that faces it
    light.angle = math.radians(0.53)
    lamp = bpy.data.objects.new("sun", light)
    towards = upright((math.cos(h) * math.sin(a), math.sin(h), math.cos(h) * math.cos(a)))
    lamp.rotation_euler = towards.to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(lamp)


def add_sky(radiance):
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (*radiance, 1)
    bpy.context.scene.world = world


def add_camera(eye, target, fov):
    data = bpy.data.cameras.new("eye")
    data.sensor_fit = "VERTICAL"
    data.angle = math.radians(fov)
    data.clip_end = 1e6
    camera = bpy.data.objects.new("eye", data)
    camera.location = eye
    camera.rotation_euler = (target - eye).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def set_up(scene, wanted):
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.samples = wanted.samples
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.volume_bounces = wanted.bounces
    cycles.sample_clamp_indirect = 0  # clamping loses light
    cycles.volume_step_rate = wanted.step_rate
    cycles.seed = wanted.seed
    if wanted.filter == "box":
        cycles.pixel_filter_type = "BOX"
    scene.render.resolution_x, scene.render.resolution_y = (int(n) for n in wanted.size.split("x"))
    scene.render.resolution_percentage = 100
    to_look_at = (wanted.render or "").endswith(".png")
    scene.view_settings.view_transform = "Standard" if to_look_at else "Raw"
    scene.render.image_settings.file_format = "PNG" if to_look_at else "OPEN_EXR"
    scene.render.image_settings.color_depth = "8" if to_look_at else "32"
    if wanted.threads:
        scene.render.threads_mode, scene.render.threads = "FIXED", wanted.threads


def main():
    wanted = arguments()
    volume = import_volume(wanted.volume)
    low, high = bounds(volume)
    known = notes(wanted.volume)
    choose = lambda name, otherwise: getattr(wanted, name) if getattr(wanted, name) is not None else known.get(name, otherwise)
    chosen = {name: choose(name, otherwise) for name, otherwise in (("extinction", 2), ("albedo", 1), ("g", 0.85))}
    if wanted.check:
        print(json.dumps({"grids": [[g.name, g.data_type] for g in volume.data.grids], "min": low, "max": high, **chosen}))
        return
    medium(volume, **chosen)
    middle = (Vector(low) + Vector(high)) / 2
    size = (Vector(high) - Vector(low)).length
    target = upright(wanted.target) if wanted.target else middle
    add_camera(upright(wanted.eye) if wanted.eye else middle + Vector((0, -1.4 * size, 0)), target, wanted.fov)
    add_sun(*wanted.sun)
    add_sky(wanted.sky)
    set_up(bpy.context.scene, wanted)
    if wanted.render:
        bpy.context.scene.render.filepath = wanted.render
        bpy.ops.render.render(write_still=True)


main()
