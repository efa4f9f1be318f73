"""The add-on by script: a grammar becomes a cloud, with sun and sky, and a picture by Cycles.

    PATH=build/release/bin:$PATH blender -b --factory-startup --python-exit-code 1 \
        --python examples/blender/addon_picture.py -- picture.png [WxH [SAMPLES]]

The buttons of the panel are operators, and its settings stand in scene.nephele for the next cloud, and in object.nephele of
each that is there.
"""
import os
import sys

import bpy
from mathutils import Vector

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, here)
import nephele_addon  # not needed where the add-on is enabled

words = sys.argv[sys.argv.index("--") + 1:] + [None, None]
width, height = (int(n) for n in (words[1] or "480x270").split("x"))
nephele_addon.register()
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
scene = bpy.context.scene

settings = scene.nephele
settings.kind = "GRAMMAR"
settings.text = bpy.data.texts.load(os.path.join(here, "..", "castellanus.lsys"))
settings.own_medium = True
settings.extinction, settings.g = 10, 0.4
settings.preview, settings.voxels = False, 400
bpy.ops.nephele.make()
cloud = bpy.context.object

bpy.ops.nephele.light()
middle = sum((Vector(corner) for corner in cloud.bound_box), Vector()) / 8
camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
camera.location = middle + Vector((-27, -33, -4))
camera.rotation_euler = (middle - camera.location).to_track_quat("-Z", "Y").to_euler()
scene.collection.objects.link(camera)
scene.camera = camera
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
scene.cycles.samples = int(words[2] or 128)
scene.view_settings.view_transform = "Standard"
scene.render.filepath = os.path.abspath(words[0])
bpy.ops.render.render(write_still=True)
