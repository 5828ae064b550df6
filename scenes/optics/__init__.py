"""Optical constants of real substances: measured spectra of n and k, turned once into linear sRGB.

Both renderers read the same RGB figures from `constants.toml`, so that neither converts a spectrum
its own way. `python -m scenes.optics` rewrites that file from the CSV files beside this one.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

HERE = Path(__file__).parent
CONSTANTS = HERE / "constants.toml"
DIGITS = 6  # significant digits of every figure in constants.toml

# CIE XYZ (D65 white) to linear sRGB: IEC 61966-2-1:1999, Amendment 1 (2003), annex F.
XYZ_TO_SRGB = np.array(
    [
        [3.2406255, -1.5372080, -0.4986286],
        [-0.9689307, 1.8757561, 0.0415175],
        [0.0557101, -0.2040211, 1.0569959],
    ]
)

HEADER = """\
# Generated from the spectra in this folder; do not edit. To regenerate: python -m scenes.optics
# eta, k: refractive index and extinction coefficient, linear sRGB under equal-energy white.
# f0 = ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2), from the rounded eta and k of the same table.
"""


def _table(name: str) -> NDArray[np.float64]:
    """Read the numbers of a CSV file of this folder, (rows, columns) float."""
    return np.loadtxt(HERE / f"{name}.csv", delimiter=",", comments=["#", "wavelength_nm"])


def _rounded(values: ArrayLike) -> list[float]:
    """Round each value to DIGITS significant digits."""
    return [float(f"{v:.{DIGITS}g}") for v in np.asarray(values)]


def spectrum_to_rgb(wavelength_nm: ArrayLike, values: ArrayLike) -> NDArray[np.float64]:
    """Project a spectrum onto linear sRGB so that a constant spectrum maps to that constant.

    The spectrum is read linearly between its samples, held constant beyond its ends, weighted
    with the CIE 1931 2-degree observer under an equal-energy illuminant (X = Σ v x̄ / Σ ȳ at 5 nm),
    turned into sRGB (IEC 61966-2-1), and divided per channel by what the constant 1 gives: the
    same as white-balancing equal-energy white to RGB (1, 1, 1). Channels may be negative.

    Args:
        wavelength_nm: (n,) increasing, nanometres.
        values: (n,) the spectrum, in any unit.

    Returns:
        (3,) float, in the unit of `values`.

    Raises:
        ValueError: if the wavelengths do not increase or the shapes differ.
    """
    wavelength, v = np.asarray(wavelength_nm, float), np.asarray(values, float)
    if wavelength.ndim != 1 or wavelength.shape != v.shape or np.any(np.diff(wavelength) <= 0):
        raise ValueError("a spectrum needs increasing wavelengths and one value for each")
    observer = _table("cie1931")
    to_rgb = XYZ_TO_SRGB @ observer[:, 1:].T  # Σ ȳ cancels in the division below
    return to_rgb @ np.interp(observer[:, 0], wavelength, v) / to_rgb.sum(axis=1)


def substances() -> list[str]:
    """Name every substance with a spectrum in this folder, sorted."""
    return sorted(p.stem for p in HERE.glob("*.csv") if p.stem != "cie1931")


def derive(name: str) -> dict[str, Any]:
    """Derive eta, k and F0 of a substance, (3,) linear sRGB each, from its spectrum.

    F0 is the normal-incidence Fresnel reflectance of the RGB eta and k, rounded as they are in
    constants.toml (Born and Wolf 1999, Principles of Optics, 7th ed., section 14.2); it is not
    the projection of the spectral F0, which for gold leaves sRGB (red 1.0046).

    Raises:
        FileNotFoundError: if the substance has no spectrum here.
    """
    lines = (HERE / f"{name}.csv").read_text(encoding="utf-8").splitlines()
    facts = dict(s[2:].split(": ", 1) for s in lines if s.startswith(("# source: ", "# metal: ")))
    wavelength, n, k = _table(name).T
    eta = np.array(_rounded(spectrum_to_rgb(wavelength, n)))
    k = np.array(_rounded(spectrum_to_rgb(wavelength, k)))
    f0 = ((eta - 1) ** 2 + k**2) / ((eta + 1) ** 2 + k**2)
    entry = {"eta": eta.tolist(), "k": k.tolist(), "f0": _rounded(f0)}
    return entry | {"metal": facts["metal"] == "true", "source": facts["source"]}


def load_constants() -> dict[str, dict[str, Any]]:
    """Read constants.toml: per substance `eta`, `k`, `f0` (3,), `metal` and `source`."""
    return tomllib.loads(CONSTANTS.read_text(encoding="utf-8"))
