"""Draws the picture of docs/color-management.md: side_by_side.py PICTURE.exr OUTPUT.png LUT LUT [LUT LUT]...

A row for each two LUTs: a picture in linear ACEScg as it is, and through each of both, as ACES 2.0 shows them on a screen.
Every second pixel.
"""

import sys

import numpy
import OpenImageIO as oiio
import PyOpenColorIO as ocio

GAP = 8


def main(picture, output, *luts):
    rgb = numpy.ascontiguousarray(oiio.ImageBuf(picture).get_pixels(oiio.FLOAT)[::2, ::2, :3])
    config = ocio.Config.CreateFromBuiltinConfig("cg-config-v4.0.0_aces-v2.0_ocio-v2.5")
    view = ocio.DisplayViewTransform("ACEScg", "sRGB - Display", "ACES 2.0 - SDR 100 nits (Rec.709)")

    def panel(lut):
        shown = rgb.copy()
        for transform in [ocio.FileTransform(lut), view] if lut else [view]:
            config.getProcessor(transform).getDefaultCPUProcessor().applyRGB(shown)
        return numpy.pad(shown.clip(0, 1), ((0, GAP), (0, GAP), (0, 0)), constant_values=1)

    rows = [[None, *pair] for pair in zip(luts[::2], luts[1::2])]
    pixels = numpy.concatenate([numpy.concatenate([*map(panel, row)], axis=1) for row in rows])
    oiio.ImageBuf(numpy.ascontiguousarray(pixels[:-GAP, :-GAP])).write(output, oiio.UINT8)


main(*sys.argv[1:])
