"""Hard materials."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

from reports.stability.hard.case import DENSE, Hard, Make, twin
from reports.stability.hard.inputs import under_sky
from scenes.files import parse, read_toml
from scenes.schema import Case, Material, Model

ALPHA_MIN_ROUGHNESS = 0.01  # alpha 1e-4
BASE = {"albedo": (0.6, 0.3, 0.05), "roughness": 0.4, "metallic": 0.0, "weight": 0.5}
METAL = {"roughness": 0.4, "metallic": 1.0, "metal": (1.0, 0.77, 0.34), "weight": 0.5}
MOST = 2.5  # the light is at most 1.5, and Schlick's F with kd of n.v sends back up to 1.5 of it


def ball(masking: str = "paper", **fields: Any) -> Make:
    """A sphere of one material over a floor of it, that grazing angles are seen on."""
    material = Material(**fields)
    return under_sky(
        ("sphere", material, {"position": (0.0, 0.0, 0.1)}),
        ("plane", material, {"position": (0.0, 0.0, -0.6), "scale": 8.0}),
        model=Model(masking=masking),
    )


def out_of_gamut(folder: Path) -> Case:
    """A metal given by an F0 whose red is more than all."""
    path = folder / "gold.toml"
    path.write_text("roughness = 0.4\nmetallic = 1.0\nmetal = [1.02, 0.77, 0.34]\n")
    material = parse(Material, read_toml(path), path)
    return under_sky(("sphere", material, {}))(folder)


def rows() -> Iterator[Hard]:
    row = partial(Hard, kind="material", must_hold="no pixel is NaN, Inf or negative")
    for masking in ("paper", "smith"):
        for roughness in (0.0, ALPHA_MIN_ROUGHNESS, 0.1, 1.0):
            yield row(
                name=f"roughness-{roughness:g}-{masking}",
                why="D has a peak of 3e7 at alpha 1e-4, and tables end at 0 and 1",
                case=ball(masking, **METAL | {"roughness": roughness}),
            )
        for weight in (0.0, 1e-7, 1 - 1e-7, 1.0):
            yield row(
                name=f"weight-{weight:.7g}-{masking}",
                why="a lobe of no weight is compiled out; one of almost none must not be 0/0",
                case=ball(masking, **BASE | {"weight": weight}),
            )
        yield row(
            name=f"masking-of-the-other-lobe-{masking}",
            why="D of one lobe with the masking of the other meets no common limit",
            case=ball(masking, **METAL | {"weight": 1.0, "weight_g": 0.0, "roughness": 1.0}),
        )
    for end, near in ((0.0, 1e-7), (1.0, 1 - 1e-7)):
        yield row(
            name=f"weight-{near:.7g}-is-{end:g}",
            must_hold="the picture is that of the lobe alone",
            why="the weights' ends are compiled apart, and no step may show there",
            case=ball(**METAL | {"weight": near}),
            expect=twin(ball(**METAL | {"weight": end})),
            within={"paper": 1e-5, "paper-noaa": 1e-5, DENSE: 0.02},
        )
    yield row(
        name="weights-that-sum-off-by-rounding",
        must_hold="the picture is that of weights that sum to 1",
        why="0.1 + 0.9 in float32 is not 1",
        case=ball(**METAL | {"weight": (0.1, 0.9000005)}),
        expect=twin(ball(**METAL | {"weight": 0.1})),
    )
    for metallic in (0.0, 0.5, 1.0):
        yield row(
            name=f"metallic-{metallic:g}",
            why="the diffuse lobe is compiled out where there is none",
            case=ball(**BASE | {"metallic": metallic, "metal": "Au"}),
            between=(0.0, MOST),
        )
    yield row(
        name="F0-0",
        why="nothing is reflected head-on, and shares of samples are 0/0",
        case=ball(**BASE | {"f0": 0.0}),
    )
    yield row(
        name="F0-0-and-albedo-0",
        must_hold="no pixel is brighter than grazing Fresnel makes it",
        why="nothing is reflected but Schlick's last term",
        case=ball(**BASE | {"f0": 0.0, "albedo": (0.0, 0.0, 0.0)}),
        between=(0.0, 1.5),
    )
    yield row(
        name="F0-1",
        why="1 - F is 0 everywhere: no diffuse light",
        case=ball(**BASE | {"f0": 1.0, "albedo": (1.0, 1.0, 1.0)}),
    )
    yield row(
        name="albedo-1",
        why="a white surface has nothing left to lose",
        case=ball(**BASE | {"albedo": (1.0, 1.0, 1.0), "roughness": 1.0}),
    )
    yield row(
        name="gold",
        why="its spectral F0 leaves sRGB (red 1.0046); F0 of RGB eta and k does not",
        case=ball(**METAL | {"metal": "Au"}),
        between=(0.0, 1.6),
    )
    yield row(
        name="F0-out-of-gamut",
        must_hold="it is refused in one line",
        why="gold in saturated primaries has a red of 1.02: it would give back more than it gets",
        case=out_of_gamut,
        refused="metal",
    )
