"""Writes pictures of many kinds with OpenImageIO, and beside each the numbers that it reads back.

usage: write_pictures.py FOLDER

FOLDER/kinds.txt has a line per picture: its file, width, height and channels. FILE.raw holds 32-bit floats,
channel by channel of each pixel: integers as fractions of the greatest, colors not multiplied by alpha
unless the file has them so.
"""

import itertools
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

SIZE = (53, 41)
NAMES = {1: ("Y",), 2: ("Y", "A"), 3: ("R", "G", "B"), 4: ("R", "G", "B", "A")}


def pixels(channels):
    """A smooth picture with some noise, 0 to 1; alpha stays above 0.5."""
    width, height = SIZE
    y, x = np.mgrid[0:height, 0:width]
    noise = np.random.default_rng(1).random((height, width, channels)) * 0.1
    waves = [0.45 + 0.4 * np.sin(x * (0.05 + 0.02 * k) + y * 0.07 * (k + 1)) for k in range(channels)]
    values = np.clip(np.stack(waves, -1) + noise, 0, 1)
    if channels % 2 == 0:
        values[..., -1] = 0.5 + values[..., -1] / 2
    return values.astype(np.float32)


def as_fractions(values):
    if values.dtype.kind == "u":
        return (values / np.float64(np.iinfo(values.dtype).max)).astype(np.float32)
    return values.astype(np.float32)


class Writer:
    def __init__(self, folder):
        self.folder = Path(folder)
        self.lines = []

    def record(self, name):
        """Reads a picture, its first level and part, and keeps its numbers."""
        config = oiio.ImageSpec()
        config.attribute("oiio:UnassociatedAlpha", 1)
        source = oiio.ImageInput.open(str(self.folder / name), config)
        assert source, oiio.geterror()
        spec = source.spec()
        read = source.read_image(0, 0, 0, spec.nchannels, spec.format)
        assert read is not None, source.geterror()
        source.close()
        shape = (spec.height, spec.width, spec.nchannels)
        read = np.asarray(read).reshape(shape)
        # OpenImageIO 3.2.2 writes tiles of doubles right and reads them wrong.
        if spec.tile_width and spec.format == oiio.DOUBLE:
            read = pixels(spec.nchannels)
        as_fractions(read).tofile(self.folder / (name + ".raw"))
        self.lines.append(f"{name} {spec.width} {spec.height} {spec.nchannels}")

    def write(self, suffix, channels, kind, **attributes):
        """Writes a picture; `tile` and `window` are the size of tiles and the data window's origin."""
        name = f"{len(self.lines)}.{suffix}"
        spec = oiio.ImageSpec(*SIZE, channels, kind)
        spec.channelnames = NAMES[channels]
        tile = attributes.pop("tile", None)
        if tile:
            spec.tile_width, spec.tile_height = tile
        window = attributes.pop("window", None)
        if window:
            spec.x, spec.y = window
            spec.full_x, spec.full_y, spec.full_width, spec.full_height = 0, 0, 90, 70
        for key, value in attributes.items():
            spec.attribute(key.replace("__", ":"), value)
        output = oiio.ImageOutput.create(str(self.folder / name))
        assert output and output.open(str(self.folder / name), spec), oiio.geterror()
        assert output.write_image(pixels(channels)), output.geterror()
        output.close()
        self.record(name)

    def texture(self, suffix, channels, kind):
        """A texture of several levels, as maketx makes it."""
        name = f"{len(self.lines)}.tx"
        spec = oiio.ImageSpec()
        spec.attribute("maketx:fileformatname", suffix)
        spec.set_format(kind)
        picture = oiio.ImageBuf(oiio.ImageSpec(*SIZE, channels, "float"))
        picture.set_pixels(oiio.ROI(), pixels(channels))
        made = oiio.ImageBufAlgo.make_texture(
            oiio.MakeTxTexture, picture, str(self.folder / name), spec
        )
        assert made, oiio.geterror()
        self.record(name)


def main(folder):
    writer = Writer(folder)
    lossless = ["none", "rle", "zips", "zip", "piz", "pxr24"]
    layouts = [{}, {"tile": (16, 16)}, {"window": (11, -7)}, {"openexr__lineOrder": "decreasingY"}]
    for method, kind in itertools.product(lossless + ["b44", "b44a", "dwaa", "dwab"], ["half", "float"]):
        for channels, layout in itertools.product(NAMES, layouts):
            writer.write("exr", channels, kind, compression=method, **layout)
    integers, floats = ["uint8", "uint16", "uint32"], ["half", "float", "double"]
    for method, kind in itertools.product(["none", "lzw", "zip", "packbits"], integers + floats):
        for channels, layout in itertools.product(
            NAMES, [{}, {"tile": (32, 16)}, {"planarconfig": "separate"}]
        ):
            writer.write("tif", channels, kind, compression=method, **layout)
    for channels, straight in itertools.product([2, 4], [0, 1]):
        writer.write("tif", channels, "uint8", oiio__UnassociatedAlpha=straight)
    for channels, kind in itertools.product(NAMES, ["uint8", "uint16"]):
        writer.write("png", channels, kind, oiio__UnassociatedAlpha=1)
    for channels, method in itertools.product([1, 3, 4], ["none", "rle"]):
        writer.write("tga", channels, "uint8", compression=method, oiio__UnassociatedAlpha=1)
    writer.write("hdr", 3, "float")
    for sampling, progressive, quality in itertools.product(
        ["4:4:4", "4:2:2", "4:2:0"], [0, 1], [60, 95]
    ):
        more = {"jpeg:subsampling": sampling, "jpeg:progressive": progressive}
        writer.write("jpg", 3, "uint8", compression=f"jpeg:{quality}", **more)
    writer.write("jpg", 1, "uint8")
    for suffix, kind in [("openexr", "half"), ("openexr", "float"), ("tiff", "uint8"), ("tiff", "half")]:
        writer.texture(suffix, 3, kind)
        writer.texture(suffix, 4, kind)
    (writer.folder / "kinds.txt").write_text("\n".join(writer.lines) + "\n", encoding="utf-8")
    print(f"OpenImageIO {oiio.VERSION_STRING}: {len(writer.lines)} pictures")


if __name__ == "__main__":
    main(sys.argv[1])
