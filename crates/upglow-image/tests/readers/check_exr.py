"""Reads files that upglow-image wrote with other programs, and compares every sample.

usage: check_exr.py FULL.exr COMPACT.exr EXPECTED.txt
       check_exr.py --samples FILE.exr EXPECTED.txt
       check_exr.py --levels FILE.tx EXPECTED.txt
       check_exr.py --colors SPECTRAL.exr WEIGHTS.txt COLORS.txt

EXPECTED.txt holds one sample per line: column, row, channel, value. The full file must hold them as
channels; the compact one is expanded here, by the description in docs/spectral-exr.md alone.
For --levels each line of EXPECTED.txt begins with the level, its width and its height.
WEIGHTS.txt holds a wavelength and the power of the light per line, COLORS.txt column, row, X, Y, Z.
"""

import sys

import numpy as np
import OpenEXR

# Single precision keeps seven digits; a share is at most 1.
ROUNDING = 1e-6


def read(path):
    """Channels and attributes of a file, by OpenEXR's own library."""
    with OpenEXR.File(path, separate_channels=True) as file:
        part = file.parts[0]
        channels = {name: np.array(c.pixels, dtype=np.float64) for name, c in part.channels.items()}
        return channels, dict(part.header)


def spectrum(text):
    """Wavelengths and values of `400nm:0.5;410nm:0.6;`."""
    pairs = [pair.split("nm:") for pair in text.rstrip(";").split(";")]
    return np.array(pairs, dtype=np.float64).T


def expand(channels, header):
    """The shares [incident, outgoing, row, column] of a compact file, form `dyes`."""
    assert header["upglow.compact"] == "1"
    assert header["upglow.compact.form"] == "dyes"
    dyes = header["upglow.compact.dyes"].split(";")
    maps = np.stack([channels["dye." + dye] for dye in dyes])
    a = np.stack([spectrum(header[f"upglow.dye.{dye}.absorption"])[1] for dye in dyes])
    e = np.stack([spectrum(header[f"upglow.dye.{dye}.emission"])[1] for dye in dyes])
    q = np.array([float(header[f"upglow.dye.{dye}.quantumYield"]) for dye in dyes])
    mean_nm = np.array([float(header[f"upglow.dye.{dye}.meanEmission"]) for dye in dyes])
    nm = spectrum(header[f"upglow.dye.{dyes[0]}.absorption"])[0]
    if header["upglow.compact.mixing"] == "pooled":
        total = maps.sum(axis=0)
        share = np.divide(maps, total, out=np.zeros_like(maps), where=total > 0)
        lobes = [(total, share)]
    else:
        one = np.eye(len(dyes))[:, :, None, None] * np.ones_like(maps[0])
        lobes = [(maps[d], one[d]) for d in range(len(dyes))]
    per_density = 1.0
    if header["upglow.compact.mixing"] == "film":
        density = np.tensordot(a.T, maps, axes=1)
        thin = density < 1e-6
        density = np.where(thin, 1.0, density)
        per_density = np.where(thin, np.log(10.0), (1.0 - 10.0**-density) / density)
    result = 0.0
    for strength, share in lobes:
        mixed = lambda values: np.tensordot(values.T, share, axes=1)
        returned = strength * mixed(a) * mixed(q) * per_density
        if header["upglow.compact.accounting"] == "photon":
            mean = np.maximum(mixed(mean_nm), 1e-9)
            returned = returned * np.minimum(nm[:, None, None] / mean, 1.0)
        result = result + returned[:, None] * mixed(e)[None]
    for i, wave in enumerate(nm):
        name = f"T.{wave:.6f}nm".replace(".", ",").replace("T,", "T.", 1)
        result[i, i] = channels[name]
    return nm, result


def wavelength(text):
    return float(text.removesuffix("nm").replace(",", "."))


def expected(path):
    with open(path, encoding="utf-8") as file:
        return [line.split() for line in file]


def samples(path, expected_path):
    """Every channel of a file, and no other, as expected."""
    channels, _ = read(path)
    rows = expected(expected_path)
    assert sorted(channels) == sorted({name for _, _, name, _ in rows}), sorted(channels)
    for x, y, name, value in rows:
        found = channels[name][int(y), int(x)]
        assert found == np.float32(value), (x, y, name, found, value)
    print(f"OpenEXR {OpenEXR.__version__}: {len(rows)} samples")
    with_open_image_io(path, channels)


def levels(path, expected_path):
    """Every texel of every level, as OpenImageIO's texture system reads it for a footprint of its size."""
    try:
        import OpenImageIO as oiio
    except ImportError:
        print("skipped: OpenImageIO is not installed")
        return
    system = oiio.TextureSystem()
    options = oiio.TextureOpt()
    options.mipmode = oiio.MipMode.OneLevel
    options.interpmode = oiio.InterpMode.Closest
    source = oiio.ImageInput.open(path)
    names = source.spec().channelnames
    source.close()
    texels = {}
    for level, width, height, x, y, name, value in expected(expected_path):
        key = tuple(map(int, (level, width, height, x, y)))
        texels.setdefault(key, {})[name] = np.float32(value)
    for (level, width, height, x, y), values in texels.items():
        assert sorted(values) == sorted(names), names
        # A little less than one texel wide, so that rounding does not select the next smaller level. The
        # last level has none: two texels select it.
        texel = 2.0 if (width, height) == (1, 1) else 0.95
        footprint = (texel / width, 0, 0, texel / height)
        at = ((x + 0.5) / width, (y + 0.5) / height)
        found = system.texture(path, options, *at, *footprint, len(names))
        for name, sample in zip(names, found):
            assert np.float32(sample) == values[name], (level, x, y, name, sample, values[name])
    print(f"OpenImageIO {oiio.VERSION_STRING}: {len(texels)} texels of all levels")


# Two sums of the same products in another order.
COLOR_RELATIVE = 1e-4


def colors(path, light_path, colors_path):
    """Colors of a reflectance file, integrated by colour-science with its own observer."""
    try:
        import colour
    except ImportError:
        print("skipped: colour-science is not installed")
        return
    channels, _ = read(path)
    bands = {wavelength(name[2:]): name for name in channels if name.startswith("T.")}
    waves = np.array(sorted(bands))
    light = np.array(expected(light_path), dtype=np.float64)
    assert np.array_equal(light[:, 0], waves)
    shape = colour.SpectralShape(waves[0], waves[-1], waves[1] - waves[0])
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
    lamp = colour.SpectralDistribution(light[:, 1], waves)
    for x, y, *xyz in expected(colors_path):
        values = [channels[bands[wave]][int(y), int(x)] for wave in waves]
        found = colour.sd_to_XYZ(
            colour.SpectralDistribution(values, waves), observer, lamp, method="Integration"
        )
        ours = np.array(xyz, dtype=np.float64)
        assert np.all(abs(found / 100 - ours) <= COLOR_RELATIVE * ours), (x, y, found, ours)
    print(f"colour {colour.__version__}: colors of {len(waves)} bands")


def main(full_path, compact_path, expected_path):
    rows = expected(expected_path)
    full, header = read(full_path)
    assert header["spectralLayoutVersion"] == "1.0", header
    nm, matrix = expand(*read(compact_path))
    worst = 0.0
    for x, y, name, value in rows:
        found = full[name][int(y), int(x)]
        assert found == np.float32(value), (x, y, name, found, value)
        waves = [wavelength(part) for part in name.split(".")[1:]]
        i, o = [int(np.argmin(abs(nm - w))) for w in (waves[0], waves[-1])]
        worst = max(worst, abs(matrix[i, o, int(y), int(x)] - float(value)))
    assert worst < ROUNDING, worst
    print(f"OpenEXR {OpenEXR.__version__}: {len(rows)} samples, expanded within {worst:.1e}")
    with_open_image_io(full_path, full)
    with_colour(full_path, rows)


def with_open_image_io(path, channels):
    try:
        import OpenImageIO as oiio
    except ImportError:
        print("skipped: OpenImageIO is not installed")
        return
    source = oiio.ImageInput.open(path)
    assert source, oiio.geterror()
    spec = source.spec()
    pixels = source.read_image("float")
    source.close()
    assert sorted(spec.channelnames) == sorted(channels), spec.channelnames
    for k, name in enumerate(spec.channelnames):
        assert np.array_equal(pixels[:, :, k], channels[name]), name
    print(f"OpenImageIO {oiio.VERSION_STRING}: {spec.nchannels} channels")


def with_colour(path, rows):
    try:
        import colour
        from colour import read_spectral_image_Fichet2021
    except ImportError:
        print("skipped: colour-science is not installed, or reads no spectral images")
        return
    try:
        components = read_spectral_image_Fichet2021(path)
    except ImportError:
        print("skipped: colour-science reads spectral images with OpenImageIO, not installed")
        return
    waves, found = components["T"]
    plain = [row for row in rows if row[2].count(".") == 1]
    for x, y, name, value in plain:
        i = int(np.argmin(abs(waves - wavelength(name.split(".")[1]))))
        sample = found[int(y), int(x), i]
        assert abs(sample - float(value)) < ROUNDING, (x, y, name, sample, value)
    print(f"colour {colour.__version__}: {len(plain)} reflectances")


if __name__ == "__main__":
    modes = {"--samples": samples, "--levels": levels, "--colors": colors}
    if sys.argv[1] in modes:
        modes[sys.argv[1]](*sys.argv[2:])
    else:
        main(*sys.argv[1:])
