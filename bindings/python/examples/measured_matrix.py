# %% [markdown]
# # From a measured fluorescent sample to its colors under any light
#
# A spectrophotometer with one lamp measures what a fluorescent sample looks like under that lamp. A
# bispectral instrument measures the cause: for each wavelength that arrives, how much light leaves at
# each wavelength. That is a re-radiation (Donaldson) matrix. This notebook fits a material to one, and
# compares their colors; then it looks at conditions of measurement, at whiteness, and at the colors of
# a cube, which nobody measured.
#
# Open it in an editor that knows `# %%` cells, or run it, with a file of your own if you have one:
#
#     python measured_matrix.py [SAMPLE.BFC | SAMPLE.csv]
#
# With matplotlib, it writes its plots beside the numbers, as `measured_matrix.png`.

# %%
import sys
from pathlib import Path

import numpy as np

import upglow

files = [Path(word) for word in sys.argv[1:] if word.lower().endswith((".bfc", ".csv"))]


def row(name, *cells):
    """One line of a table: numbers with three decimals where they are not whole."""
    shown = (f"{cell:9.3f}" if isinstance(cell, float) else f"{cell!s:>9}" for cell in cells)
    print(f"{name:26}", *shown)


# %% [markdown]
# ## A matrix
#
# Without a file, an instrument is simulated: a yellow textile whose dye absorbs around 450 nm and emits
# around 520 nm, over a reflectance that rises at 490 nm, in bands of 10 nm. Its axes are those of a
# BFC-450: light arrives from 300 to 780 nm and is measured from 380 to 780 nm. Reflected and re-emitted
# light are on the diagonal together, and there is noise everywhere, also where no light can be: a dye
# emits at longer wavelengths than it absorbs.


# %%
def simulated(absorbs_at, emits_at, edge_nm, floor, quantum_yield):
    """A dye over a reflectance, as a bispectral instrument measures it."""
    incident, outgoing = np.arange(300.0, 781.0, 10.0), np.arange(380.0, 781.0, 10.0)
    absorbed = 0.9 * np.exp(-(((incident - absorbs_at) / 65.0) ** 2))
    emitted = np.exp(-(((outgoing - emits_at) / 35.0) ** 2))
    emitted /= emitted.sum()
    # Photons of lower energy leave.
    back = quantum_yield * np.minimum(incident / emits_at, 1.0) * absorbed
    shares = np.outer(emitted, back) * (outgoing[:, None] >= incident)
    reflected = floor + (0.85 - floor) / (1.0 + np.exp(-(incident - edge_nm) / 12.0))
    shares += (outgoing[:, None] == incident) * (1.0 - absorbed) * reflected
    noise = np.random.default_rng(7).normal(0.0, 5e-4, shares.shape)
    return upglow.DonaldsonMatrix(incident, outgoing, shares + noise, unit="per band")


if files:
    read = upglow.DonaldsonMatrix
    measured = (read.from_csv if files[0].suffix.lower() == ".csv" else read.from_bfc)(files[0])
else:
    measured = simulated(absorbs_at=450.0, emits_at=520.0, edge_nm=490.0, floor=0.05, quantum_yield=0.7)
print(measured)
root_mean_square, greatest = measured.noise or (0.0, 0.0)
print(f"below the diagonal: {root_mean_square:.5f} root mean square, {greatest:.5f} at most")

# %% [markdown]
# ## The material, and its colors beside the measured ones
#
# `fit_matrix` takes what is below the diagonal for noise, separates reflected from re-emitted light, and
# fits a film of dye over a reflectance. The measured colors are the sums of ASTM E2152 over the matrix.
# `ΔE00` is between the two; `noise` is what leaving out all below the diagonal would change. Nobody can
# adapt to an ultraviolet lamp: there the colors are those that an observer adapted to D65 sees.

# %%
fit = upglow.fit_matrix(measured)
d65 = upglow.Illuminant("D65")
no_ultraviolet = upglow.Illuminant(
    (upglow.FINE_NM, d65.power * (upglow.FINE_NM >= 400.0)), name="D65 without UV"
)
lamp = upglow.Illuminant.line(365.0, 12.0)
lights = ["D65", "A", "E", no_ultraviolet, "FL2", "HP5", lamp]

row("light", "Y meas.", "Y fitted", "ΔE00", "noise")
for light in map(upglow.Illuminant, lights):
    found = fit.difference(light)
    row(light.name, found.measured[1], found.fitted[1], found.de2000, found.noise_de2000)

# %% [markdown]
# The matrices side by side, on a scale that shows re-emitted light; and the reflectance beside the total
# radiance factor under D65, which has what the dye emits in addition.

# %%
try:
    import matplotlib.pyplot as plt
except ImportError:
    print("no plots: they need matplotlib")
else:
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13.0, 3.8), layout="constrained")
    extent = [*measured.incident_nm[[0, -1]], *measured.outgoing_nm[[0, -1]]]
    for axes, matrix, title in ((left, measured, "measured"), (middle, fit.matrix, "fitted")):
        image = axes.imshow(
            matrix.per_band, origin="lower", extent=extent, vmin=0.0, vmax=0.1, cmap="magma"
        )
        axes.set(title=title, xlabel="incident, nm", ylabel="outgoing, nm")
    figure.colorbar(image, ax=middle, label="share per band, cut at 0.1")
    nm = np.arange(400.0, 701.0, 5.0)
    material = fit.cube()
    any_rgb = [0.5, 0.5, 0.5]
    right.plot(nm, material.reflectance(any_rgb, nm), label="reflectance")
    right.plot(nm, material.radiance_factor(any_rgb, nm), label="total radiance factor under D65")
    right.set(title="the material", xlabel="nm", ylim=(0.0, None))
    right.legend(loc="lower right")
    figure.savefig("measured_matrix.png", dpi=110)

# %% [markdown]
# ## Conditions of measurement, and whiteness
#
# ISO 13655 has conditions for samples that fluoresce: M0 is the light of an incandescent lamp, M1 is D50
# with its ultraviolet, M2 has none. An optically brightened paper differs most between the last two. It is
# simulated here; its dye absorbs ultraviolet and emits blue.
#
# The whiteness and tint of the CIE are for light like D65. `relight` gives NaN under others, and for colors
# that are no whites.

# %%
paper = simulated(absorbs_at=335.0, emits_at=440.0, edge_nm=310.0, floor=0.3, quantum_yield=0.4)
# All colors of this cube are the one material.
brightened = upglow.fit_matrix(paper).cube()
conditions = ["M0", "M1", "M2", "D65", no_ultraviolet]
seen = brightened.relight([0.5, 0.5, 0.5], conditions)

row("light", "L*", "a*", "b*", "dye, % Y", "whiteness", "tint")
for i, light in enumerate(conditions):
    share = 100.0 * float(seen.fluorescent_share[i])
    row(getattr(light, "name", light), *map(float, seen.lab[i]), share, float(seen.whiteness[i]), float(seen.tint[i]))

# %% [markdown]
# ## Colors that nobody measured
#
# A cube has a material for every RGB. By default a color that a smooth reflectance can show gets no dye:
# the brown does not fluoresce, the mint and the magenta do. `change` is the ΔE00 from the color under D65,
# each seen by an observer adapted to the light. The lamps FL2 and LED-B3 are published from 380 nm on; where
# a dye absorbs below, a warning says that this part is not counted.

# %%
cube = upglow.build(upglow.Contract(space="acescg"), resolution=9)
colors = {"brown": [0.35, 0.2, 0.1], "mint": [0.4, 1.0, 0.8], "magenta": [0.9, 0.2, 0.8]}
places = ["A", "FL2", "LED-B3", no_ultraviolet]
relit = cube.relight(list(colors.values()), places)

row("color, light", "R", "G", "B", "change", "dye, % Y")
for c, name in enumerate(colors):
    for i, light in enumerate(map(upglow.Illuminant, places)):
        share = 100.0 * float(relit.fluorescent_share[i, c])
        change = float(relit.de2000[i, c])
        row(f"{name}, {light.name}", *map(float, relit.rgb[i, c]), change, share)

# %% [markdown]
# ## On to colour-science
#
# What upglow computes goes there as its own objects, and the other way round. Here it integrates the
# total radiance factors under illuminant A, and gets what `cube.xyz` does.

# %%
try:
    import colour
except ImportError:
    print("no comparison: pip install colour-science")
else:
    spectra = cube.spectral_distributions(list(colors.values()), upglow.FINE_NM, light="A")
    shape = colour.SpectralShape(360, 830, 1)
    observer = cube.contract.observer.to_colour()
    illuminant = upglow.Illuminant("A").to_colour().align(shape)
    theirs = colour.msds_to_XYZ(spectra.align(shape), observer, illuminant, method="Integration")
    ours = cube.xyz(list(colors.values()), light="A", step_nm=1)
    print(f"greatest difference in XYZ: {np.abs(theirs / 100.0 - ours).max():.1e}")

# %% [markdown]
# ## A sample of which only colors are known
#
# Few samples were ever in a bispectral instrument. Of others there is a color under D65, and perhaps another from
# a photo through a filter that takes out ultraviolet: the difference of the two is what ultraviolet excites.
# `metamers` finds the materials that may have these colors, and how probable each is. Here the sample is taken for one of
# these, known to fluoresce; its matrix tells the truth under other lights. `ΔE00` is how far the best single material is
# from that, `mixture` how far the best blend. `band` is within which nine of ten of the materials are
# from the single one: that was known before the truth.

# %%
measured_xyz = upglow.Contract(space="xyz", adaptation="none")
under_d65 = measured.color("D65")
photo = {no_ultraviolet: measured.color(no_ultraviolet)}
found = {
    "D65": upglow.metamers(under_d65, measured_xyz, kind="fluorescent"),
    "D65 and photo": upglow.metamers(under_d65, measured_xyz, kind="fluorescent", known=photo),
}

row("light, known", "Y meas.", "Y single", "ΔE00", "band", "mixture")
for light in map(upglow.Illuminant, ["A", "E", "FL11", "LED-B3", lamp]):
    for name, paint in found.items():
        single = paint.single.difference(measured, light)
        mixture = paint.mixture.difference(measured, light)
        band = paint.band(light, "single")
        row(f"{light.name}, {name}", single.measured[1], single.fitted[1], single.de2000, band, mixture.de2000)
