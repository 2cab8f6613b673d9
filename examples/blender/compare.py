"""Fluorescent colors in Blender by 4×4 matrices, beside a spectral render of the same scene.

    python compare.py CUBE --blender-python PYTHON --out FOLDER

bakes the maps of `scene.py`, has them rendered by Cycles in a Python with Blender's package bpy, renders
the same shapes, camera and lamps by `upglow_path` in Mitsuba, and prints how far apart the two are. It
needs the packages upglow, mitsuba, colour-science and pillow. docs/blender.md has the steps by hand.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import colour
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

import upglow

HERE = Path(__file__).resolve().parent
INCIDENT = ("red", "green", "blue", "ultraviolet")
# In which `scene.py` keeps light, and the cube its colors.
SPACE = "acescg"
# As `scene.py` names them.
LAMPS = {
    "daylight": upglow.Illuminant("D65"),
    "tungsten": upglow.Illuminant("A"),
    "ultraviolet": upglow.Illuminant.line(365.0, 12.0),
}
OBJECTS = {"floor": "pool", "wall": "white", "box": "chart", "globe": "bands", "ball": "white"}
# The eye is adapted to these; to daylight where a lamp is too dark to see by.
ADAPTED = {"daylight": "D65", "tungsten": "A"}
TITLES = {
    "daylight": "daylight, D65",
    "tungsten": "tungsten, A",
    "ultraviolet": "lamp of 365 nm",
    "all": "all three",
}
COLUMNS = ("red, green and blue alone", "Blender, by 4 by 4 matrices", "Mitsuba, spectral")
# Factors from luminance to the display.
EXPOSURE = {"daylight": 0.9, "tungsten": 0.9, "ultraviolet": 0.9, "all": 0.45}
# Linear gray of the wall and the ball, which show the light itself.
WHITE = 0.8
# Of what the whole lamp brings: surfaces with less are in its shadow, and are not compared.
LEAST_LIGHT = 0.05
# The least share of ultraviolet that a texel returns as visible light to count as fluorescent.
LEAST_GLOW = 0.01
# Greatest difference of normals in 3 by 3 pixels that are not at an edge. There passes are averages over
# several surfaces, whose product is not the average of the products.
SMOOTH = 0.1
# Samples per pixel of each pass of Mitsuba, whose multijittered sampler draws squares.
PASS_SPP = 144
SEED = 1

Array = NDArray[np.float64]


def read(path: Path) -> dict[str, Array]:
    """The layers of an OpenEXR file by their names."""
    bitmap = mi.Bitmap(str(path))
    pixels = np.array(bitmap).astype(np.float64)
    names = [field.name for field in bitmap.struct_()]
    layers = sorted({name.rpartition(".")[0] for name in names})
    at = {name: [names.index(f"{name}.{c}") for c in "RGB"] for name in layers}
    return {name: pixels[..., channels] for name, channels in at.items()}


def write(path: Path, rgb: Array) -> None:
    mi.Bitmap(rgb.astype(np.float32), mi.Bitmap.PixelFormat.RGB).write(str(path))


def pictures() -> dict[str, Array]:
    """Linear ACEScg of what covers the scene, row by row from the top."""
    rng = np.random.default_rng(SEED)
    y, x = np.mgrid[0:512, 0:512] + 0.5
    tiles = np.kron(rng.random((16, 16)), np.ones((32, 32)))
    pool = np.stack([0.05 + 0 * tiles, 0.25 + 0.35 * tiles, 0.45 + 0.3 * tiles], axis=-1)
    pool[np.minimum(x % 32, y % 32) < 2] = 0.6
    radius = np.hypot(x - 256, y - 256)
    pool[(radius > 130) & (radius < 190)] = [0.9, 0.0, 0.9]
    # Hues from left to right, from pale ones to the edge of the space downwards.
    hue, pale = np.linspace(0, 1, 12, endpoint=False), np.linspace(0.8, 0.0, 8)
    pure = 0.9 * np.clip(np.abs(6 * hue[:, None] - [3, 2, 4]) * [1, -1, -1] + [-1, 2, 2], 0, 1)
    chart = np.kron(np.maximum(pure, pale[:, None, None]), np.ones((32, 32, 1)))
    # Three colors that only fluorescence shows, and their blends.
    y, x = np.mgrid[0:256, 0:512] + 0.5
    turn = 2 * np.pi * (4 * y / 256 + x / 512)
    weights = np.stack([1 + np.cos(turn + k * 2 * np.pi / 3) for k in range(3)], axis=-1) ** 4
    bands = (
        weights
        / weights.sum(axis=-1, keepdims=True)
        @ [[0.95, 0.05, 0.3], [0.4, 1.0, 0.8], [0.9, 0.0, 0.9]]
    )
    return {"pool": pool, "chart": chart, "bands": bands, "white": np.full((2, 2, 3), WHITE)}


def bake(cube: upglow.Cube, folder: Path) -> None:
    """Four maps of each picture: what leaves of light that arrives as red, green, blue, ultraviolet."""
    for name, picture in pictures().items():
        matrices = cube.reduced_matrix(picture, engine=SPACE)
        write(folder / f"{name}.exr", picture)
        for column, incident in enumerate(INCIDENT):
            write(folder / f"{name}.{incident}.exr", matrices[..., :3, column])
    lamps = {
        name: cube.reduced_light(light, engine=SPACE).tolist() for name, light in LAMPS.items()
    }
    (folder / "lamps.json").write_text(json.dumps(lamps))


@dataclass(frozen=True)
class Spectral:
    """The scene of `scene.py` for Mitsuba."""

    shapes: Any
    folder: Path
    cube: str
    width: int

    def scene(self, lamp: str) -> dict[str, Any]:
        """Lit by one lamp, directly."""
        scene = {
            "type": "scene",
            "integrator": {"type": "upglow_path", "max_depth": 2, "hide_emitters": True},
            "sensor": self.camera(),
            "lamp": self.lamp(lamp),
        }
        for name, picture in OBJECTS.items():
            scene[name] = {
                "type": "ply",
                "filename": self.mesh(name),
                "bsdf": self.surface(picture),
            }
        return scene

    def surface(self, picture: str) -> dict[str, Any]:
        texture = {
            "type": "bitmap",
            "filename": str(self.folder / f"{picture}.exr"),
            "raw": True,
            "wrap_mode": "repeat",
        }
        return {"type": "twosided", "bsdf": {"type": "upglow", "cube": self.cube, "color": texture}}

    def mesh(self, name: str) -> str:
        places = self.shapes[f"{name}.places"]
        mesh = mi.Mesh(
            name, len(places), len(places) // 3, has_vertex_normals=True, has_vertex_texcoords=True
        )
        values = mi.traverse(mesh)
        values["vertex_positions"] = places.astype(np.float32).ravel()
        values["vertex_normals"] = self.shapes[f"{name}.normals"].astype(np.float32).ravel()
        uv = self.shapes[f"{name}.uv"].astype(np.float32)
        # Mitsuba counts rows from the top.
        values["vertex_texcoords"] = np.column_stack([uv[:, 0], 1 - uv[:, 1]]).ravel()
        values["faces"] = np.arange(len(places), dtype=np.uint32)
        values.update()
        path = self.folder / f"{name}.ply"
        mesh.write_ply(str(path))
        return str(path)

    def lamp(self, name: str) -> dict[str, Any]:
        world, strength = self.shapes[f"{name}.lamp"], float(self.shapes[f"{name}.strength"])
        by = "power" if name == "ultraviolet" else "white"
        side = float(self.shapes[f"{name}.side"])
        if side == 0.0:
            spectrum = upglow.mitsuba.spectrum(LAMPS[name], np.pi * strength, by=by)
            direction = (-world[:3, 2]).tolist()
            return {"type": "directional", "direction": direction, "irradiance": spectrum}
        spectrum = upglow.mitsuba.spectrum(LAMPS[name], strength, by=by)
        # Blender's lamps shine along −z, a rectangle along z; both are two units wide unscaled.
        turned = world @ np.diag([side / 2, -side / 2, -1.0, 1.0])
        emitter = {"type": "area", "radiance": spectrum}
        return {"type": "rectangle", "to_world": mi.ScalarTransform4f(turned), "emitter": emitter}

    def camera(self) -> dict[str, Any]:
        # Blender's cameras look along −z, Mitsuba's along z with x to the left.
        world = self.shapes["camera"] @ np.diag([-1.0, 1.0, -1.0, 1.0])
        film = {
            "type": "hdrfilm",
            "width": self.width,
            "height": self.width * 3 // 4,
            "pixel_format": "xyz",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        }
        return {
            "type": "perspective",
            "fov_axis": "x",
            "fov": float(np.degrees(self.shapes["angle"])),
            "to_world": mi.ScalarTransform4f(world),
            "film": film,
            "sampler": {"type": "multijitter", "sample_count": PASS_SPP},
        }

    def render(self, lamp: str, passes: int) -> Array:
        """X, Y, Z of each pass, `[pass][row][column]`."""
        loaded = mi.load_dict(self.scene(lamp))
        found = [np.array(mi.render(loaded, spp=PASS_SPP, seed=SEED + k)) for k in range(passes)]
        return np.array(found, dtype=np.float64)[..., :3]


def by_cycles(python: str, folder: Path, width: int, samples: int) -> dict[str, Array]:
    """The layers of two renders with different random numbers, `[render][row][column]`."""
    found = []
    for seed in (SEED, SEED + 1):
        options = ["--size", width, "--samples", samples, "--seed", seed]
        command = [python, HERE / "scene.py", folder, *options]
        done = subprocess.run(
            [str(word) for word in command], capture_output=True, text=True, check=False
        )
        if done.returncode != 0:
            last = (done.stderr.strip().splitlines() or ["nothing told"])[-1]
            sys.exit(f"compare.py: {python} could not render scene.py: {last}")
        found.append(read(folder / "render.exr"))
    print(done.stdout.strip().splitlines()[-1].partition(" wrote")[0])
    return {name: np.array([render[name] for render in found]) for name in found[0]}


def away_from_edges(normal: Array) -> NDArray[np.bool_]:
    """Pixels around which the normal hardly changes."""
    height, width, _ = normal.shape
    around = np.pad(normal, ((1, 1), (1, 1), (0, 0)), mode="edge")
    shifts = [around[y : y + height, x : x + width] for y in range(3) for x in range(3)]
    return np.max([np.linalg.norm(shift - normal, axis=-1) for shift in shifts], axis=0) < SMOOTH


@dataclass(frozen=True)
class Compared:
    """One lamp, or all: linear RGB of both halves of the samples, `[half][row][column]`."""

    name: str
    plain: Array
    matrix: Array
    spectral: Array
    light: Array
    """What arrives, in that of the whole lamp."""

    def means(self) -> list[Array]:
        return [half.mean(axis=0) for half in (self.plain, self.matrix, self.spectral)]

    def told(self, contract: upglow.Contract, white: Array, even: Any, glows: Any) -> str:
        """A row of the table: the differences, and what of them is noise."""
        lit = even & (self.light > LEAST_LIGHT)

        def differences(some: Array, others: Array) -> Array:
            labs = []
            for rgb in (some, others):
                xyz = np.maximum(rgb[lit] @ contract.xyz_from_rgb.T, 0.0)
                labs.append(colour.XYZ_to_Lab(xyz / white[1], white[:2] / white.sum()))
            return np.asarray(colour.delta_E(*labs, method="CIE 2000"))

        plain, matrix, spectral = self.means()
        found = differences(matrix, spectral)
        # Two halves differ by twice the error of their mean.
        noise = [differences(*halves).mean() / 2 for halves in (self.matrix, self.spectral)]
        numbers = [
            differences(plain, spectral).mean(),
            found.mean(),
            np.percentile(found, 95),
            found[glows[lit]].mean(),
            *noise,
        ]
        return " | ".join([TITLES[self.name], *(f"{number:.2f}" for number in numbers)])


def compare(
    cube: upglow.Cube, layers: dict[str, Array], spectral: dict[str, Array], lamps: Any
) -> list[Compared]:
    """Each lamp, and the sum."""
    color = sum(layers[f"map.{incident}"] for incident in INCIDENT)
    found = []
    for name in LAMPS:
        # Passes alternate between the halves.
        halves = np.array([spectral[name][k::2].mean(axis=0) for k in range(2)])
        found.append(
            Compared(
                name,
                color * layers[f"{name}.light"],
                layers[f"{name}.seen"],
                halves @ cube.contract.rgb_from_xyz.T,
                layers[f"{name}.ultraviolet"][..., 0].mean(axis=0) / lamps[name][3],
            )
        )
    sums = [
        sum(getattr(one, field) for one in found)
        for field in ("plain", "matrix", "spectral", "light")
    ]
    return [*found, Compared("all", *sums)]


def displayed(contract: upglow.Contract, rgb: Array, exposure: float) -> NDArray[np.uint8]:
    """The picture in sRGB: colors outside its gamut or too bright are clipped."""
    srgb = upglow.Contract(space="srgb").rgb_from_xyz @ contract.xyz_from_rgb
    linear = np.clip(rgb @ srgb.T * exposure, 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.round(255 * encoded).astype(np.uint8)


def montage(contract: upglow.Contract, compared: list[Compared]) -> Any:
    """Rows of lamps and columns of ways to render them."""
    height, width, _ = compared[0].means()[0].shape
    head, side, gap = 28, 28, 6
    size = side + len(COLUMNS) * (width + gap), head + len(compared) * (height + gap)
    sheet = Image.new("RGB", size, "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(size=15)
    for column, title in enumerate(COLUMNS):
        draw.text(
            (side + column * (width + gap) + width / 2, head / 2), title, "black", font, anchor="mm"
        )
    for row, one in enumerate(compared):
        top = head + row * (height + gap)
        label = Image.new("RGB", (height, side), "white")
        ImageDraw.Draw(label).text(
            (height / 2, side / 2), TITLES[one.name], "black", font, anchor="mm"
        )
        sheet.paste(label.rotate(90, expand=True), (0, top))
        for column, rgb in enumerate(one.means()):
            picture = Image.fromarray(displayed(contract, rgb, EXPOSURE[one.name]))
            sheet.paste(picture, (side + column * (width + gap), top))
    return sheet


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cube", type=Path, help="a cube in ACEScg")
    parser.add_argument("--out", type=Path, default=Path("blender"), help="folder for all files")
    blender = os.environ.get("UPGLOW_BLENDER_PYTHON", sys.executable)
    parser.add_argument("--blender-python", default=blender, help="a Python that has bpy")
    parser.add_argument("--size", type=int, default=256, help="width of the pictures in pixels")
    parser.add_argument(
        "--samples", type=int, default=512, help="samples per pixel of Cycles, twice"
    )
    parser.add_argument(
        "--passes", type=int, default=4, help=f"{PASS_SPP} samples each, of Mitsuba"
    )
    parser.add_argument("--variant", default="llvm_ad_spectral", help="variant of Mitsuba")
    options = parser.parse_args()
    for name, least in (("size", 8), ("samples", 1), ("passes", 2)):
        if (found := getattr(options, name)) < least:
            parser.error(f"--{name} is {found}, expected {least} or more")
    return options


def main() -> None:
    options = arguments()
    mi.set_variant(options.variant)
    import upglow.mitsuba

    try:
        cube = upglow.Cube.read(options.cube)
    except (OSError, ValueError) as error:
        sys.exit(f"compare.py: {error}")
    if cube.contract.space != SPACE:
        sys.exit(f"compare.py: {options.cube} is in {cube.contract.space}, expected {SPACE}")
    folder = options.out.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    bake(cube, folder)
    layers = by_cycles(options.blender_python, folder, options.size, options.samples)
    shapes = np.load(folder / "shapes.npz")
    scene = Spectral(shapes, folder, upglow.mitsuba.in_memory(cube), options.size)
    spectral = {name: scene.render(name, options.passes) for name in LAMPS}
    lamps = json.loads((folder / "lamps.json").read_text())
    compared = compare(cube, layers, spectral, lamps)
    even = away_from_edges(layers["map.normal"].mean(axis=0))
    glows = np.abs(layers["map.ultraviolet"]).max(axis=(0, -1)) > LEAST_GLOW
    heads = "RGB alone", "4×4", "95 % below", "fluorescent", "noise of Cycles", "noise of Mitsuba"
    print(" | ".join(["ΔE00 from Mitsuba", *heads]))
    for one in compared:
        white = cube.reduced_light(ADAPTED.get(one.name))[:3]
        print(one.told(cube.contract, white, even, glows))
    picture = folder / "compared.jpg"
    montage(cube.contract, compared).save(picture, quality=87, subsampling=0)
    print(f"wrote {picture}")


if __name__ == "__main__":
    main()
