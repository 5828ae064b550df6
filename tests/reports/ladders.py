"""Errors by cause, by hand."""

from reports.html.causes import charts
from reports.results import Cause, Figured, Ladder


def figure(value, half=0.001):
    return Figured(value=value, low=value - half, high=value + half)


def cause(name, energy, local, diffuse=None, ssim=None, parent="", half=0.001):
    return Cause(
        name=name,
        parent=parent,
        energy=figure(energy, half),
        diffuse=None if diffuse is None else figure(diffuse, half),
        local=figure(local, half),
        ssim=None if ssim is None else figure(ssim),
    )


CAUSES = [
    cause("integration", -0.05, 0.1, -0.08, -0.02),
    cause("kd at n·v", -0.06, 0.04, -0.06, parent="integration"),
    cause("irradiance map", 0, 0, 0, parent="integration", half=0),
    cause("prefilter", 0.01, 0.06, 0.0, parent="integration"),
    cause("occlusion", 0.15, 0.35, 0.1, -0.1),
    cause("interreflection", -0.12, -0.05, -0.1, 0.03),
    cause("model", 0.0004, 0.0002, 0.0, 0.0004),
]


def made(**fields):
    """The ladder of an object `left`; fields can be given."""
    base = {
        "case": "spheres.dusk", "object": "left", "technique": "paper", "truth": "physical",
        "causes": CAUSES, "total": cause("total", -0.0196, 0.4002, -0.08, -0.0896),
        "energy_gap": figure(0.0004), "local_gap": figure(-0.0006), "closes": True,
        "missing": {"occlusion": figure(0.96, 0.2), "interreflection": figure(0.84, 0.1)},
    }  # fmt: skip
    return Ladder(**base | fields)


def chart(**fields):
    return charts([made(**fields)])[0]
