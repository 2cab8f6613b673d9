"""A tour of upglow, cell by cell: build, look up, color under lights, sampling, textures.

Open it in an editor that knows ``# %%`` cells, or run it: ``python tour.py``.
"""

# %% A contract says what RGB means; a cube holds a material for any such RGB.
import numpy as np

import upglow

contract = upglow.Contract(space="acescg", illuminant="D65")
cube = upglow.build(contract, resolution=16, progress=True)
summary = cube.summary()
print(cube)
print(f"{summary.exact} of {summary.nodes} nodes show their color exactly")

# %% A brown needs no fluorescence. A mint does, and the cube matches it. The dyes are too weak for a
# strong magenta, and no material at all can reproduce the green of the space.
mint, brown = [0.4, 1.0, 0.8], [0.35, 0.2, 0.1]
colors = {"brown": brown, "mint": mint, "magenta": [0.9, 0.1, 0.8], "green": [0.0, 1.0, 0.0]}
for name, rgb in colors.items():
    check = cube.check(rgb)
    kind = upglow.Kind(int(check.kind)).name.lower().replace("_", " ")
    print(f"{name}: {kind}, ΔE00 {check.de2000:.3f}")

# %% Spectra: light reflected at the same wavelength, and light that leaves at any wavelength.
nm = np.arange(400.0, 701.0, 25.0)
reflectance, albedo = cube.reflectance(mint, nm), cube.albedo(mint, nm)
for at, r, a in zip(nm, reflectance, albedo, strict=True):
    print(f"{at:.0f} nm  {'#' * round(40 * r):<40} {r:.3f}  in all {a:.3f}")

# %% Where light at 440 nm goes: the re-radiation matrix, one column of it.
bands = np.arange(380, 781, 20)
matrix = cube.reradiation_matrix(mint, bands)
column = matrix[:, list(bands).index(440)]
print("of light at 440 nm:", ", ".join(f"{b} nm {v:.3f}" for b, v in zip(bands, column) if v > 1e-3))
assert np.all(matrix.sum(axis=0) <= 1.0 + 1e-9)

# %% Color under other lights. Under an ultraviolet lamp only fluorescence is bright.
lamp = upglow.Illuminant.line(365.0, 12.0)
for light in ("D65", "A", "E"):
    print(f"{light:>3}: RGB {np.round(cube.rgb_under(mint, light), 3)}")
white, shining = cube.xyz([[1.0, 1.0, 1.0], mint], light=lamp, scale="power")
print(f"under the lamp: white has Y = {white[1]:.5f}, mint Y = {shining[1]:.5f}")

# %% Sampling, as a path from the camera does it: light at 520 nm due to all incident wavelengths.
rng = np.random.default_rng(1)
out_nm, power = 520.0, contract.illuminant.power
light_at = lambda at: np.interp(at, upglow.FINE_NM, power, left=0.0, right=0.0)  # noqa: E731
drawn = cube.sample_incident(mint, out_nm, rng.random((200_000, 2)))
estimate = np.mean(drawn.throughput * light_at(drawn.nm))
reradiated = cube.reradiation(mint, upglow.FINE_NM, out_nm) @ power
exact = cube.reflectance(mint, out_nm) * light_at(out_nm) + reradiated
print(f"radiance at 520 nm: {estimate:.3f} by sampling, {exact:.3f} by summing")
assert abs(estimate / exact - 1.0) < 0.01

# %% The same by multiple importance sampling: half of the draws from the material, half uniform.
count, (low, high) = 100_000, (300.0, 830.0)
mine = cube.sample_incident(mint, out_nm, rng.random((count, 2)))
theirs = rng.uniform(low, high, count)
f = lambda at: cube.reradiation(mint, at, out_nm) * light_at(at)  # noqa: E731
p = lambda at: cube.incident_pdf_per_nm(mint, at, out_nm)  # noqa: E731
shifted = mine.nm[~mine.is_elastic]
balance = lambda at: f(at) / (p(at) + 1.0 / (high - low))  # noqa: E731
fluorescent = (balance(shifted).sum() + balance(theirs).sum()) / count
elastic = cube.reflectance(mint, out_nm) * light_at(out_nm)
print(f"by MIS: {elastic + fluorescent:.3f}, with the elastic part taken as it is")
assert abs((elastic + fluorescent) / exact - 1.0) < 0.01

# %% A picture: ten thousand texels to spectra, and to one material per texel.
picture = rng.random((100, 100, 3), dtype=np.float32)
spectra = cube.reflectance(picture, np.arange(400.0, 701.0, 10.0))
texels = cube.material(picture)
fluorescent_texels = int((texels.dose > 0).sum())
print(f"spectra {spectra.shape} {spectra.dtype}; {fluorescent_texels} texels fluoresce")

# %% The file is safetensors, which any program can read. It is written completely or not at all.
content = cube.to_bytes()
assert upglow.Cube.from_bytes(content).to_bytes() == content
print(f"{len(content) / 1e6:.2f} MB; dyes: {', '.join(cube.dye_names)}")
