"""The peak memory of the program upglow for each format and command, as a table; `cargo xtask memory` runs it.

    python memory.py UPGLOW FOLDER SIDE…      pictures of these sides, in pixels, are made in FOLDER
"""

import os
import struct
import subprocess
import sys
import time
from pathlib import Path

COMMANDS = {
    "check": ["check", "IN"],
    "material": ["bake", "CUBE", "IN", "-o", "OUT", "--repair", "clip", "--as", "material"],
    "radiance": ["bake", "CUBE", "IN", "-o", "OUT", "--repair", "clip", "--as", "radiance", "--light", "A"],
    "spectral": ["bake", "CUBE", "IN", "-o", "OUT", "--repair", "clip", "--as", "spectral", "--bands", "400:700:25"],
}
AFTER = {"lint": ["lint", "OUT"], "read": ["read", "OUT", "--at", "0,0"]}


def make(folder, side):
    """Writes a picture of this side in every format; in a process of its own, whose memory does not count."""
    import numpy as np
    import OpenEXR
    from PIL import Image, TiffImagePlugin

    Image.MAX_IMAGE_PIXELS = None
    y, x = np.mgrid[0:side, 0:side]
    rgb = np.stack([(x * 7 + y * 3) % 97, (x * 5 + y * 11) % 89, (x + y) % 101], -1)
    picture = Image.fromarray((rgb * 2 + 20).astype(np.uint8))
    half = (rgb / 120).astype(np.float16)
    picture.save(folder / "png.png")
    picture.save(folder / "jpeg.jpg")
    picture.save(folder / "jpeg, progressive.jpg", progressive=True)
    picture.save(folder / "tga, packed.tga", compression="tga_rle")
    TiffImagePlugin.STRIP_SIZE = 1 << 40
    for compression in (None, "tiff_lzw", "tiff_adobe_deflate", "packbits"):
        name = f"tiff, one strip, {(compression or 'plain').removeprefix('tiff_').removeprefix('adobe_')}.tif"
        picture.save(folder / name, compression=compression)
    with open(folder / "radiance.hdr", "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (side, side))
        shared = np.full((side, 1), 128, np.uint8)
        for row in np.asarray(picture):
            file.write(packed_row(np.hstack([row, shared])))
    tile = OpenEXR.TileDescription()
    tile.xSize = tile.ySize = side
    for compression in ("NO", "ZIP", "PIZ", "B44", "DWAA"):
        code = getattr(OpenEXR, f"{compression}_COMPRESSION")
        word = compression.replace("NO", "plain")
        rows = {"compression": code, "type": OpenEXR.scanlineimage}
        OpenEXR.File(rows, {"RGB": half}).write(str(folder / f"exr, rows, {word}.exr"))
        tiles = {"compression": code, "type": OpenEXR.tiledimage, "tiles": tile}
        OpenEXR.File(tiles, {"RGB": half}).write(str(folder / f"exr, one tile, {word}.exr"))


def packed_row(row):
    """A row of Radiance in packets without repetition."""
    width = len(row)
    parts = [bytes([2, 2, width >> 8, width & 255])]
    for channel in row.T:
        for start in range(0, width, 128):
            part = channel[start : start + 128].tobytes()
            parts += [bytes([len(part)]), part]
    return b"".join(parts)


def write_channels(path, names):
    """Writes an OpenEXR of one pixel with these channels, sorted, in half precision; libraries take time for each two."""
    listed = b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", 1, 0, 1, 1) for name in names) + b"\0"
    window = struct.pack("<4i", 0, 0, 0, 0)
    attributes = [
        ("channels", "chlist", listed),
        ("compression", "compression", b"\0"),
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1)),
        ("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
        ("screenWindowWidth", "float", struct.pack("<f", 1)),
        ("spectralLayoutVersion", "string", b"1.0"),
        ("emissiveUnits", "string", b"W.m^-2.sr^-1"),
    ]
    head = struct.pack("<ii", 20000630, 2)
    for name, kind, value in attributes:
        head += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    head += b"\0"
    row = struct.pack("<e", 0.25) * len(names)
    path.write_bytes(head + struct.pack("<Q", len(head) + 8) + struct.pack("<ii", 0, len(row)) + row)


def channels(upglow, folder):
    """The table of files with very many channels."""
    path = folder / "channels.exr"
    commands = {"lint": ["lint", path], "read": ["read", path, "--at", "0,0"], "check": ["check", "--layer", "c0", "--space", "srgb", path]}
    print("\n| channels | file, kB | " + " | ".join(commands) + " |\n| ---: |" + " ---: |" * (1 + len(commands)))
    for count in (1_000, 10_000, 100_000):
        cells = []
        write_channels(path, [f"S0.{300 + i // 1000},{i % 1000:03d}nm" for i in range(count)])
        for words in commands.values():
            if "check" in words:
                write_channels(path, sorted(f"c{i}.{color}" for i in range(count // 3) for color in "BGR"))
            peak, seconds = measured([upglow, "-q", *words])
            cells.append(f"{seconds:.2f} s, {peak:.0f} MiB")
        print(f"| {count:,} | {path.stat().st_size / 1e3:.0f} | " + " | ".join(cells) + " |", flush=True)


def measured(command):
    """Peak memory in MiB and time in s of a command that must succeed."""
    start = time.time()
    running = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(running.pid, 0)
    running.returncode = status
    if status != 0:
        sys.exit(f"{' '.join(map(str, command))}: status {status}")
    return used.ru_maxrss / 1024, time.time() - start


def main():
    upglow, folder, *sides = sys.argv[1:]
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    cube, out = folder / "cube.safetensors", folder / "out.exr"
    channels(upglow, folder)
    subprocess.run([upglow, "build", "-q", "--space", "srgb", "--resolution", "8", "-o", cube], check=True, stdout=subprocess.DEVNULL)
    for side in map(int, sides):
        pictures = folder / str(side)
        pictures.mkdir(exist_ok=True)
        subprocess.run([sys.executable, __file__, "make", pictures, str(side)], check=True)
        columns = [*COMMANDS, *AFTER]
        print(f"\n| {side}² pixels, MiB | " + " | ".join(columns) + " |")
        print("| --- |" + " ---: |" * len(columns))
        for picture in sorted(pictures.iterdir()):
            stated = ["--space", "srgb", "-q"]
            if picture.suffix not in (".exr", ".hdr"):
                stated += ["--encoding", "srgb"]
            peaks = []
            for words in COMMANDS.values():
                paths = {"CUBE": str(cube), "IN": str(picture), "OUT": str(out)}
                peaks.append(measured([upglow, *[paths.get(word, word) for word in words], *stated])[0])
            for words in AFTER.values():
                paths = {"OUT": str(out)}
                peaks.append(measured([upglow, *[paths.get(word, word) for word in words], "-q"])[0])
            print(f"| {picture.stem} | " + " | ".join(f"{peak:.0f}" for peak in peaks) + " |", flush=True)
            picture.unlink()


if sys.argv[1:2] == ["make"]:
    make(Path(sys.argv[2]), int(sys.argv[3]))
else:
    main()
