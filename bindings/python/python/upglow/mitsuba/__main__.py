"""``python -m upglow.mitsuba scene.xml`` renders a scene file, as Mitsuba's command ``mitsuba`` does,
which cannot load plugins in Python. Its options are those of the same names."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ._host import mi


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser("python -m upglow.mitsuba", description="Render a scene file.")
    parser.add_argument("scene", type=Path, help="scene file, in XML")
    parser.add_argument("-o", "--output", type=Path, help="picture [default: SCENE with .exr]")
    parser.add_argument(
        "-m", "--mode", default="llvm_ad_spectral", help="variant of Mitsuba [default: %(default)s]"
    )
    parser.add_argument("-s", "--sensor", type=int, default=0, help="number of the sensor, from 0")
    parser.add_argument(
        "-D",
        "--define",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="value of $KEY in the scene",
    )
    options = parser.parse_args()
    for text in options.define:
        if "=" not in text:
            parser.error(f"--define is {text}, expected KEY=VALUE")
    if options.mode not in mi.variants():
        parser.error(f"--mode is {options.mode}, expected one of {', '.join(mi.variants())}")
    return options


def main() -> None:
    options = arguments()
    if not options.scene.is_file():
        sys.exit(f"{options.scene}: no such file, expected a scene in XML")
    output = options.output or options.scene.with_suffix(".exr")
    # Checked now, and not after minutes of rendering.
    if not output.parent.is_dir():
        sys.exit(f"--output is {output}, expected a path in a folder that is there")
    mi.set_variant(options.mode)
    try:
        scene = mi.load_file(
            str(options.scene), **dict(text.split("=", 1) for text in options.define)
        )
        if not 0 <= options.sensor < len(scene.sensors()):
            count = len(scene.sensors())
            sys.exit(f"--sensor is {options.sensor}, expected less than {count}, the scene's sensors")
        sensor = scene.sensors()[options.sensor]
        scene.integrator().render(scene, sensor, develop=False)
        sensor.film().write(str(output))
    except (RuntimeError, ValueError) as error:
        # Mitsuba's lines before the last one say which of its parts were loading which.
        last = str(error).strip().splitlines()[-1].strip()
        sys.exit(f"{options.scene}: {last.removeprefix('ValueError: ')}")
    print(f"wrote {output}")


if __name__ == "__main__":
    main()
