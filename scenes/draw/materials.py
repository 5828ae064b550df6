"""Materials drawn at random: metals, plastics of all colours, and what lies between."""

from typing import Any

import numpy as np

from scenes.draw.dice import Rng, one_of, within
from scenes.draw.sphere import colour
from scenes.optics import load_constants

SOURCE = "drawn at random"


def draw_material(rng: Rng, measured: bool) -> tuple[str, dict[str, Any]]:
    """What it is in a word, and the fields of its file.

    Args:
        measured: metals by name alone, since a bare F0 has no eta and k.
    """
    kind = one_of(rng, "metal", "metal", "coloured", "plastic", "plastic", "plastic", "half")
    fields: dict[str, Any] = {"source": SOURCE, "roughness": within(rng, 0.05, 1), "metallic": 0.0}
    word = kind
    if kind in ("metal", "half"):
        metals = sorted(name for name, entry in load_constants().items() if entry["metal"])
        word = fields["metal"] = one_of(rng, *metals)
        fields["metallic"] = 1.0
    if kind == "coloured":
        word = "tinted_metal"
        fields |= {"metal": _rgb(0.3 + 0.7 * colour(rng, 0.8)), "metallic": 1.0}
        if measured:
            word = fields["metal"] = "Cu"
    if kind == "half":
        word = f"half_{word}"
        fields["metallic"] = within(rng, 0.1, 0.9)
    if kind in ("plastic", "half"):
        fields |= _dielectric(rng, 0.9)
    fields |= _weights(rng)
    return word, fields


def draw_paint(rng: Rng) -> tuple[str, dict[str, Any]]:
    """A floor or a wall: painted, mostly rough and grey, or polished, or of a strong colour."""
    roughness = within(rng, 0.3, 1) if rng.random() < 0.8 else within(rng, 0.1, 0.3)
    fields = {"source": SOURCE, "roughness": roughness, "metallic": 0.0}
    return "paint", fields | _dielectric(rng, one_of(rng, 0.2, 0.2, 0.9)) | _weights(rng)


def _dielectric(rng: Rng, saturation: float) -> dict[str, Any]:
    """Albedo from black to white, and F0 of a substance or as a number."""
    albedo = colour(rng, saturation, within(rng, 0.02, 0.9))
    substances = sorted(name for name, entry in load_constants().items() if not entry["metal"])
    f0 = one_of(rng, *substances) if rng.random() < 0.5 else within(rng, 0.02, 0.08)
    return {"albedo": _rgb(albedo), "f0": f0}


def _weights(rng: Rng) -> dict[str, float]:
    """GGX, Beckmann or a mixture; in one case of five the masking is of another."""
    fields = {"weight": one_of(rng, 0.0, 1.0, within(rng, 0, 1), within(rng, 0, 1))}
    if rng.random() < 0.2:
        fields["weight_g"] = within(rng, 0, 1)
    return fields


def _rgb(values: np.ndarray) -> list[float]:
    return [float(f"{v:.3g}") for v in values]
