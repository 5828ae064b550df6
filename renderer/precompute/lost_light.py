"""What a surface's specular lobe does not send back, over n.w, for the lobes that make up for it.

- kd `conserving`, Kelemen and Szirmay-Kalos 2001, eq. 4: f = albedo / pi (1 - E(wi)) (1 - E(wo)) /
  (1 - E_avg), E the albedo of the whole specular lobe seen from one direction, per channel.
- kd `interface`: f = albedo / pi T(wi) T(wo) / T_avg², T the share that passes a rough interface.
  What is lost below it scales all directions alike, and the albedo, which is that seen from
  outside, settles that scale.
- multiscatter `on`, Kulla and Conty 2017: f = F_ms / pi (1 - E(wi)) (1 - E(wo)) / (1 - E_avg), E
  with F = 1, F_ms = F_avg² E_avg / (1 - F_avg (1 - E_avg)), which counts that two facets or more
  reflect it (Hill 2018, "A Multi-Faceted Exploration", part 2).

Averages are over a hemisphere with the cosine, 2 ∫ E mu dmu. Under the masking `paper` E is
bilinear in the weights of D and G, so that those of the pairs (D_i, G_j) serve every weight; under
`smith` each surface has its own.
"""

from dataclasses import dataclass
from functools import lru_cache
from time import perf_counter
from typing import Any

import moderngl
import numpy as np
from scipy.interpolate import CubicSpline

from renderer.context import context
from renderer.features import features
from renderer.program import fill, program, set_uniforms
from renderer.surface import surface_uniforms
from renderer.targets import release
from scenes.schema import Material, Model

NODES = 64  # along the map, where n.w is integrated at
TEXELS = 2048  # read linearly; what a cubic spline makes of the nodes
SAMPLES = 32_768  # points of a pass: llvmpipe ends the loops of a shader after 65,535 turns
PASSES = 8
ONE_LOBE = ((1.0, 0.0), (0.0, 1.0))
PLACES = np.linspace(0, 1, NODES)  # x, for n.w = y (2 - y) with y = x^4: see lost_light.glsl


@dataclass(frozen=True, eq=False)
class LostLight:
    """The map `lost_light` of one surface under one model.

    Attributes:
        texture: float32 RGBA, see lost_light.glsl.
        multiscatter: F_ms, (3,).
        seconds: what it took to make.
    """

    texture: moderngl.Texture
    multiscatter: tuple[float, float, float]
    seconds: float


def lost_light(material: Material, model: Model) -> LostLight:
    """The map of a material under a model, made when first asked for."""
    told = surface_uniforms(material, model)
    return _lost_light(tuple(told.items()), features(material, model), model)


@lru_cache(maxsize=256)
def _lost_light(told: tuple, defines: frozenset[str], model: Model) -> LostLight:
    start = perf_counter()
    factors, multiscatter = np.zeros((TEXELS, 4)), np.zeros(3)
    fresnel = frozenset(name for name in defines if name.startswith("FRESNEL"))
    if {"KD_CONSERVING", "MULTISCATTER"} & defines:
        losses, F = _losses_and_fresnel(told, fresnel, model)
        lost, lost_white = losses[:, :3], losses[:, 3:]
        if model.multiscatter == "on":
            F_avg, lost_avg = _mean(F[:, :3]), _mean(lost_white)
            multiscatter = F_avg**2 * (1 - lost_avg) / (1 - F_avg * lost_avg)
            lost = lost - multiscatter * lost_white
            factors[:, 3:] = _halved(lost_white)
        factors[:, :3] = _halved(lost)
    if "KD_INTERFACE" in defines:
        passed = _run("interface.frag", frozenset(), dict(told), 1)[0, :, :2]
        factors[:, :2] = _texels(passed) / _mean(passed)
    texture = context().texture((TEXELS, 1), 4, factors.astype("f4").tobytes(), dtype="f4")
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    texture.repeat_x = texture.repeat_y = False
    return LostLight(texture, tuple(map(float, multiscatter)), perf_counter() - start)


def _losses_and_fresnel(
    told: tuple, fresnel: frozenset[str], model: Model
) -> tuple[np.ndarray, np.ndarray]:
    """What the specular lobe loses at the nodes, rgb and with F = 1, and F; (NODES, 4) each."""
    if model.masking == "smith":
        return tuple(_integrated(told, fresnel | {"MASKING_SMITH", "G_GGX", "G_BECKMANN"}))
    uniforms, losses = dict(told), np.zeros((NODES, 4))
    for D, share_d in zip(ONE_LOBE, uniforms["weight_d"], strict=True):
        for G, share_g in zip(ONE_LOBE, uniforms["weight_g"], strict=True):
            if share_d * share_g > 0:
                pair = tuple((uniforms | {"weight_d": D, "weight_g": G}).items())
                masking = {"G_GGX"} if ONE_LOBE[0] == G else {"G_BECKMANN"}
                of_pair, F = _integrated(pair, fresnel | masking)
                losses += share_d * share_g * of_pair
    return losses, F


@lru_cache(maxsize=256)  # what one pair serves are all weights
def _integrated(told: tuple, defines: frozenset[str]) -> np.ndarray:
    return _run("directional_loss.frag", defines, dict(told), 2)


def _run(shader: str, defines: frozenset[str], uniforms: dict[str, Any], rows: int) -> np.ndarray:
    """What a shader makes of the nodes, (rows, NODES, 4) in double precision."""
    texture = context().texture((NODES, rows), 4, dtype="f4")
    framebuffer = context().framebuffer([texture])
    integral = program("fullscreen.vert", shader, defines)
    set_uniforms(integral, **uniforms, nodes=float(NODES), count=SAMPLES, points=PASSES * SAMPLES)
    found = np.zeros((rows, NODES, 4))
    for number in range(PASSES):
        set_uniforms(integral, first=number * SAMPLES)
        fill(framebuffer, integral)
        found += np.frombuffer(texture.read(), np.float32).reshape(found.shape) / PASSES
    release(framebuffer, texture)
    return found


def _mean(values: np.ndarray) -> np.ndarray:
    """2 ∫ v mu dmu of values at the nodes, (NODES, k)."""
    y = PLACES[:, None] ** 4
    return CubicSpline(PLACES, values * 16 * (2 - y) * (1 - y) * PLACES[:, None] ** 7).integrate(
        0, 1
    )


def _halved(loss: np.ndarray) -> np.ndarray:
    """A loss at the nodes over the root of its mean, (TEXELS, k); 0 where nothing is lost.

    Rounding may make light of at most 1e-6, which counts as none lost.
    """
    mean = np.maximum(_mean(loss), 0)
    return np.maximum(_texels(loss), 0) / np.sqrt(np.where(mean > 0, mean, np.inf))


def _texels(values: np.ndarray) -> np.ndarray:
    """Values at the nodes read at the texels, (TEXELS, k)."""
    return CubicSpline(PLACES, values)(np.linspace(0, 1, TEXELS))
