# Makes the meshes in this folder with Blender, without a display:
#   blender -b --factory-startup --python examples/meshes/make.py [-- FOLDER]
# Blender 3.4 has no OFF exporter; those files are written here from Blender's mesh data.
import math
import os
import sys

import bpy

here = os.path.dirname(os.path.abspath(__file__))
out = sys.argv[sys.argv.index("--") + 1] if "--" in sys.argv else here


def path(name):
    return os.path.join(out, name)


def clear():
    bpy.ops.wm.read_factory_settings(use_empty=True)


def gltf(name, form, **options):
    bpy.ops.export_scene.gltf(filepath=path(name), export_format=form, export_materials="NONE", export_normals=False,
                              export_texcoords=False, export_colors=False, **options)


def obj(name):
    bpy.ops.wm.obj_export(filepath=path(name), export_materials=False, export_normals=False, export_uv=False)


def ply(name, ascii_text):
    bpy.ops.export_mesh.ply(filepath=path(name), use_ascii=ascii_text, use_normals=False, use_uv_coords=False,
                            use_colors=False)


def stl(name, ascii_text):
    bpy.ops.export_mesh.stl(filepath=path(name), ascii=ascii_text)


def off(name, thing):
    """OFF in Blender's own axes (z up), n-gons kept."""
    mesh = thing.data
    with open(path(name), "w") as file:
        file.write("OFF\n%d %d 0\n" % (len(mesh.vertices), len(mesh.polygons)))
        for vertex in mesh.vertices:
            file.write("%.6f %.6f %.6f\n" % tuple(thing.matrix_world @ vertex.co))
        for polygon in mesh.polygons:
            file.write("%d %s\n" % (len(polygon.vertices), " ".join(str(v) for v in polygon.vertices)))


def mesh_object(name, points, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    mesh.update()
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    thing.select_set(True)
    return thing


def suzanne():
    clear()
    bpy.ops.mesh.primitive_monkey_add(size=2)
    thing = bpy.context.object
    obj("suzanne.obj")
    ply("suzanne.ply", False)
    ply("suzanne-text.ply", True)
    stl("suzanne.stl", False)
    off("suzanne.off", thing)
    gltf("suzanne.gltf", "GLTF_SEPARATE")
    gltf("suzanne.glb", "GLB")


def torus():
    clear()
    bpy.ops.mesh.primitive_torus_add(major_radius=1, minor_radius=0.35, major_segments=48, minor_segments=16)
    obj("torus.obj")
    stl("torus-text.stl", True)


def text():
    clear()
    bpy.ops.object.text_add(rotation=(math.pi / 2, 0, 0))
    words = bpy.context.object
    words.data.body = "cloud"
    words.data.extrude = 0.15
    words.data.bevel_depth = 0.02
    words.data.align_x = "CENTER"
    bpy.ops.object.convert(target="MESH")
    gltf("text.glb", "GLB")


def ngon():
    """A star prism: two concave ten-gons and ten quads."""
    clear()
    points, count = [], 10
    for height in (-0.2, 0.2):
        for i in range(count):
            radius = 1 if i % 2 == 0 else 0.4
            angle = 2 * math.pi * i / count
            points.append((radius * math.sin(angle), radius * math.cos(angle), height))
    faces = [list(range(count)), list(reversed(range(count, 2 * count)))]
    faces += [[i, i + count, (i + 1) % count + count, (i + 1) % count] for i in range(count)]
    thing = mesh_object("star", points, faces)
    obj("ngon.obj")
    ply("ngon.ply", True)
    off("ngon.off", thing)
    gltf("ngon.gltf", "GLTF_EMBEDDED")


def open_mesh():
    """A hemisphere without a floor: a boundary, no inside."""
    clear()
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=1)
    thing = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.bisect(plane_co=(0, 0, 0), plane_no=(0, 0, 1), clear_inner=True)
    bpy.ops.object.mode_set(mode="OBJECT")
    obj("open.obj")


def mirrored():
    """A Suzanne with scale x = -1: a node whose transform has a negative determinant."""
    clear()
    bpy.ops.mesh.primitive_monkey_add(size=2, location=(1, 0, 0))
    bpy.context.object.scale = (-1, 1, 1)
    gltf("mirrored.glb", "GLB")


def instances():
    """One cube mesh, used by five nodes: a parent with turn and scale, and four others, one of them a child."""
    clear()
    bpy.ops.mesh.primitive_cube_add(size=1)
    first = bpy.context.object
    first.rotation_euler = (0, 0, math.radians(45))
    first.scale = (2, 1, 1)
    for i in range(4):
        copy = bpy.data.objects.new("copy%d" % i, first.data)
        copy.location = (3 * i + 3, 0, i)
        copy.rotation_euler = (math.radians(20 * i), 0, 0)
        bpy.context.scene.collection.objects.link(copy)
        if i == 3:
            copy.parent = first
    gltf("instances.gltf", "GLTF_SEPARATE")


def skinned():
    """A cylinder on two bones, with an animation that bends it."""
    clear()
    bpy.ops.mesh.primitive_cylinder_add(vertices=16, radius=0.4, depth=4, location=(0, 0, 2))
    body = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    for height in (1, 2, 3):
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.bisect(plane_co=(0, 0, height), plane_no=(0, 0, 1))
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.armature_add(location=(0, 0, 0))
    rig = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    low = rig.data.edit_bones[0]
    low.head, low.tail = (0, 0, 0), (0, 0, 2)
    high = rig.data.edit_bones.new("high")
    high.head, high.tail, high.parent = (0, 0, 2), (0, 0, 4), low
    bpy.ops.object.mode_set(mode="OBJECT")
    body.select_set(True)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    bone = rig.pose.bones["high"]
    bone.rotation_mode = "XYZ"
    for frame, degrees in ((1, 0), (20, 60)):
        bone.rotation_euler = (math.radians(degrees), 0, 0)
        bone.keyframe_insert("rotation_euler", frame=frame)
    bpy.context.scene.frame_set(1)
    gltf("skinned.glb", "GLB")


for make in (suzanne, torus, text, ngon, open_mesh, mirrored, instances, skinned):
    make()
