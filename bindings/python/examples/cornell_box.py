"""A Cornell box with walls beyond sRGB: upsampled by the renderer, with reflectance, with fluorescence.

``python cornell_box.py --spp 256 --size 320 --out cornell_box.png`` renders it under daylight and under
an ultraviolet lamp, and prints what the magenta wall measures. It needs the packages mitsuba, pillow and
colour-science. The variant is ``llvm_ad_spectral``; ``--variant`` names another.
"""

from __future__ import annotations

import argparse
import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import colour
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

import upglow

# Linear ACEScg. No reflectance matches either.
MAGENTA, MINT = [0.94, 0.2, 0.46], [0.4, 1.0, 0.8]
WHITE = {"type": "diffuse", "reflectance": {"type": "uniform", "value": 0.7}}

LAMP = upglow.Illuminant.line(365.0, 12.0)
# Share of daylight in the power of the lamp scene: without it, only fluorescence is visible.
DAYLIGHT = 0.01
# Radiance of the lamp above the boxes, in that of the perfect diffuser under D65.
RADIANCE = {"daylight": 14.0, "lamp": 110.0}
# Factors from luminance to the display, one for each light: its white is 1.
EXPOSURE = {"daylight": 1.3, "lamp": 0.32}
# Factors of the samples: fluorescence reaches few of the wavelengths drawn, and is noisier.
PATIENCE = {"daylight": 1, "lamp": 2}

DEPTH, SEED = 9, 1
FLAT_SIZE, FLAT_SPP = 64, 256
# Samples per pixel that are drawn at once: they are all in memory.
PASS_SPP = 64

Color = list[float]
Scene = dict[str, Any]
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Upsampling:
    """One of the compared ways to get a material from a color."""

    title: str
    cube: upglow.Cube | None
    """The cube that has the materials; None for the renderer's own spectra."""
    contract: upglow.Contract
    """What the colors mean."""

    def surface(self, color: Color) -> Scene:
        """A diffuse surface of a color."""
        if self.cube is not None:
            name = upglow.mitsuba.in_memory(self.cube)
            return {"type": "twosided", "bsdf": {"type": "upglow", "cube": name, "color": color}}
        srgb = upglow.Contract(space="srgb").rgb_from_xyz @ self.contract.xyz_from_rgb @ color
        clipped = np.clip(srgb, 0, 1).tolist()
        return {"type": "diffuse", "reflectance": {"type": "rgb", "value": clipped}}


def light(name: str, scale: float = 1.0) -> Scene:
    """The spectrum of a light; `scale` is relative to D65 under which white has Y = 1."""
    daylight = upglow.Illuminant("D65")
    if name == "daylight":
        return upglow.mitsuba.spectrum(daylight, scale)
    power = LAMP.power / LAMP.power.sum() + DAYLIGHT * daylight.power / daylight.power.sum()
    return upglow.mitsuba.spectrum((upglow.FINE_NM, power), scale, by="power")


def box(upsampling: Upsampling, lamp: str, size: int) -> Scene:
    """The box: two units wide, open to the front."""
    at = mi.ScalarTransform4f
    white, turn = {"type": "ref", "id": "white"}, at().rotate
    walls = {
        "floor": ([0, -1, 0], [1, 0, 0], -90, white),
        "ceiling": ([0, 1, 0], [1, 0, 0], 90, white),
        "back": ([0, 0, -1], [0, 1, 0], 0, white),
        "left": ([-1, 0, 0], [0, 1, 0], 90, upsampling.surface(MAGENTA)),
        "right": ([1, 0, 0], [0, 1, 0], -90, upsampling.surface(MINT)),
    }
    scene: Scene = {"type": "scene", "white": WHITE, "integrator": integrator()}
    for name, (position, axis, angle, bsdf) in walls.items():
        where = at().translate(position) @ turn(axis, angle)
        scene[name] = {"type": "rectangle", "to_world": where, "bsdf": bsdf}
    tall = (
        at().translate([-0.36, -0.4, -0.32]) @ turn([0, 1, 0], 18) @ at().scale([0.28, 0.6, 0.28])
    )
    scene["tall"] = {"type": "cube", "to_world": tall, "bsdf": white}
    scene["ball"] = {"type": "sphere", "center": [0.42, -0.64, 0.28], "radius": 0.36, "bsdf": white}
    down = at().translate([0, 0.99, 0]) @ turn([1, 0, 0], 90) @ at().scale(0.3)
    emitter = {"type": "area", "radiance": light(lamp, RADIANCE[lamp])}
    scene["lamp"] = {"type": "rectangle", "to_world": down, "emitter": emitter}
    scene["sensor"] = camera([0, 0, 4.7], 28.5, size, "gaussian")
    return scene


def flat(upsampling: Upsampling, lamp: str) -> Scene:
    """The magenta wall alone, under light from all directions."""
    where = mi.ScalarTransform4f().scale(9)
    return {
        "type": "scene",
        "integrator": integrator(),
        "sensor": camera([0, 0, 1], 30, FLAT_SIZE, "box"),
        "light": {"type": "constant", "radiance": light(lamp)},
        "wall": {"type": "rectangle", "to_world": where, "bsdf": upsampling.surface(MAGENTA)},
    }


def integrator() -> Scene:
    return {"type": "upglow_path", "max_depth": DEPTH}


def camera(origin: Color, fov: float, size: int, pixel: str) -> Scene:
    film = {
        "type": "hdrfilm",
        "width": size,
        "height": size,
        "pixel_format": "xyz",
        "component_format": "float32",
        "rfilter": {"type": pixel},
    }
    look = mi.ScalarTransform4f().look_at(origin, [0, 0, 0], [0, 1, 0])
    return {"type": "perspective", "fov": fov, "to_world": look, "film": film}


def render(scene: Scene, spp: int) -> tuple[Array, float]:
    """X, Y, Z of each pixel; and the best pass's time on one core, µs per sample."""
    loaded, total, left, seed = mi.load_dict(scene), np.zeros(()), spp, SEED
    costs = []
    while left > 0:
        count = min(left, PASS_SPP)
        started = time.process_time()
        found = np.array(mi.render(loaded, spp=count, seed=seed), dtype=np.float64)
        costs.append(1e6 * (time.process_time() - started) / (count * found.shape[0] ** 2))
        total = total + count * found
        left, seed = left - count, seed + 1
    return total / spp, min(costs)


def displayed(xyz: Array, exposure: float) -> NDArray[np.uint8]:
    """The picture in sRGB: colors outside its gamut or too bright are clipped."""
    linear = np.clip(xyz @ upglow.Contract(space="srgb").rgb_from_xyz.T * exposure, 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.round(255 * encoded).astype(np.uint8)


def difference(contract: upglow.Contract, xyz: Array, color: Color) -> float:
    """CIEDE2000 of a measured color against the requested one."""
    white = contract.white_xyz
    chromaticity = white[:2] / white.sum()
    asked = contract.xyz_from_rgb @ color
    labs = [colour.XYZ_to_Lab(each / white[1], chromaticity) for each in (asked, xyz)]
    return float(colour.delta_E(*labs, method="CIE 2000"))


def measured(upsampling: Upsampling) -> list[str]:
    """Captions: the color of the magenta wall under each light."""
    told = []
    for lamp in RADIANCE:
        xyz = render(flat(upsampling, lamp), FLAT_SPP)[0].mean(axis=(0, 1))
        x, y = xyz[:2] / xyz.sum()
        line = f"Y {xyz[1]:.3f}, x {x:.3f}, y {y:.3f}"
        if lamp == "daylight":
            line = f"CIEDE2000 {difference(upsampling.contract, xyz, MAGENTA):.1f}, {line}"
        print(f"{upsampling.title}, {lamp}: magenta wall XYZ {np.round(xyz, 4).tolist()}, {line}")
        told.append(line)
    return told


def montage(
    pictures: list[list[NDArray[np.uint8]]], upsamplings: list[Upsampling], told: list[list[str]]
) -> Any:
    """Rows of lights and columns of upsamplings, with captions."""
    size = pictures[0][0].shape[0]
    unit = size / 320
    gap, head, foot, side = (round(value * unit) for value in (10, 34, 30, 34))
    width = side + len(upsamplings) * (size + gap)
    height = head + len(pictures) * (size + foot) + gap // 2
    sheet = Image.new("RGB", (width, height), "white")
    draw = ImageDraw.Draw(sheet)
    large, small = (ImageFont.load_default(size=round(pt * unit)) for pt in (17, 12.5))
    for column, upsampling in enumerate(upsamplings):
        left = side + column * (size + gap)
        middle = left + size / 2
        draw.text((middle, head / 2), upsampling.title, "black", large, anchor="mm")
        for row, line in enumerate(pictures):
            top = head + row * (size + foot)
            sheet.paste(Image.fromarray(line[column]), (left, top))
            caption = "magenta wall: " + told[column][row]
            draw.text((middle, top + size + foot * 0.45), caption, "#444444", small, anchor="mm")
    for row, title in enumerate(("daylight, D65", "ultraviolet lamp, 365 nm")):
        label = Image.new("RGB", (size, side), "white")
        ImageDraw.Draw(label).text((size / 2, side / 2), title, "black", large, anchor="mm")
        sheet.paste(label.rotate(90, expand=True), (0, head + row * (size + foot)))
    return sheet


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--spp", type=int, default=256, help="samples a pixel under daylight")
    parser.add_argument("--size", type=int, default=320, help="pixels along a side of each picture")
    parser.add_argument(
        "--resolution", type=int, default=32, help="nodes along an axis of the cubes"
    )
    parser.add_argument("--out", type=Path, default=Path("cornell_box.png"), help="the PNG")
    parser.add_argument("--exr", type=Path, help="folder for the six pictures as EXR in XYZ")
    parser.add_argument("--variant", default="llvm_ad_spectral", help="variant of the renderer")
    options = parser.parse_args()
    for name, least in (("spp", 1), ("size", 1), ("resolution", 2)):
        if (found := getattr(options, name)) < least:
            parser.error(f"--{name} is {found}, expected {least} or more")
    # Checked now, and not after minutes of rendering.
    if not options.out.parent.is_dir():
        parser.error(f"--out is {options.out}, expected a path in a folder that is there")
    return options


def main() -> None:
    options = arguments()
    mi.set_variant(options.variant)
    import upglow.mitsuba

    contract = upglow.Contract(space="acescg", illuminant="D65")
    n, plain = options.resolution, upglow.Reflectance()
    shining = upglow.build(contract, preset="konig2020", resolution=n)
    passive = upglow.build(contract, preset="konig2020", model=plain, resolution=n)
    for name, color in (("magenta", MAGENTA), ("mint", MINT)):
        ours, theirs = shining.check(color), passive.check(color)
        print(
            f"{name} {color}: {upglow.Kind(int(ours.kind)).name.lower()}, CIEDE2000 "
            f"{ours.de2000:.2f} with fluorescence, {theirs.de2000:.2f} with reflectance alone"
        )
    upsamplings = [
        Upsampling("sRGB, upsampled by the renderer", None, contract),
        Upsampling("upglow, reflectance", passive, contract),
        Upsampling("upglow, fluorescence", shining, contract),
    ]
    told = [measured(upsampling) for upsampling in upsamplings]
    pictures = []
    for lamp in RADIANCE:
        line = []
        for upsampling in upsamplings:
            spp = options.spp * PATIENCE[lamp]
            xyz, cost = render(box(upsampling, lamp, options.size), spp)
            print(f"{upsampling.title}, {lamp}: {spp} samples a pixel, {cost:.1f} µs each")
            line.append(displayed(xyz, EXPOSURE[lamp]))
            if options.exr:
                os.makedirs(options.exr, exist_ok=True)
                name = f"{lamp} {upsampling.title}.exr".replace(", ", "-").replace(" ", "-")
                mi.Bitmap(xyz.astype(np.float32), mi.Bitmap.PixelFormat.XYZ).write(
                    str(options.exr / name)
                )
        pictures.append(line)
    montage(pictures, upsamplings, told).save(options.out, optimize=True)
    print(f"wrote {options.out}")


if __name__ == "__main__":
    main()
