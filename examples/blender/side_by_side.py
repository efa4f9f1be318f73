"""Linear pictures beside one another as one PNG: sRGB, without a tone curve, one exposure for all.

    blender -b --python examples/blender/side_by_side.py -- both.png cycles.exr ours.pfm [--exposure STOPS]
"""
import sys

import bpy
import numpy


def pfm(path):
    with open(path, "rb") as file:
        assert file.readline().strip() == b"PF", path + " is no PFM of three channels"
        width, height = (int(n) for n in file.readline().split())
        order = "<f4" if float(file.readline()) < 0 else ">f4"
        values = numpy.frombuffer(file.read(), dtype=order).reshape(height, width, 3)
    return numpy.concatenate([values, numpy.ones((height, width, 1))], axis=2)


def pixels(path):
    if path.endswith(".pfm"):
        return pfm(path)
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Linear"
    values = numpy.empty(image.size[0] * image.size[1] * 4, dtype=numpy.float32)
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], 4)


def srgb(x):
    x = numpy.clip(x, 0, 1)
    return numpy.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


words = sys.argv[sys.argv.index("--") + 1:]
stops = float(words[words.index("--exposure") + 1]) if "--exposure" in words else 0.0
names = words[:words.index("--exposure")] if "--exposure" in words else words
rows = [pixels(name) for name in names[1:]]
both = numpy.concatenate(rows, axis=1).astype(numpy.float32)
both[..., :3] = srgb(both[..., :3] * 2 ** stops)
both[..., 3] = 1
result = bpy.data.images.new("both", both.shape[1], both.shape[0])
result.pixels.foreach_set(numpy.ascontiguousarray(both, dtype=numpy.float32).ravel())
result.update()
result.filepath_raw = names[0]
result.file_format = "PNG"
result.save()
