"""Applies LUTs to colors as OpenColorIO does: apply.py INTERPOLATION FILE...

Colors are single-precision RGB on standard input; on standard output are those that each file makes of them. What
OpenColorIO has to say against a file is an error or on standard error.
"""

import sys

import numpy
import PyOpenColorIO as ocio


def applied(path, interpolation, colors):
    transform = ocio.FileTransform(path, interpolation=interpolation)
    transform.validate()
    processor = ocio.Config.CreateRaw().getProcessor(transform)
    processor.createGroupTransform().validate()
    result = colors.copy()
    processor.getDefaultCPUProcessor().applyRGB(result)
    return result


def main(interpolation, *paths):
    interpolation = ocio.InterpolationFromString(interpolation)
    colors = numpy.frombuffer(sys.stdin.buffer.read(), dtype="<f4")
    for path in paths:
        sys.stdout.buffer.write(applied(path, interpolation, colors).astype("<f4").tobytes())


main(*sys.argv[1:])
