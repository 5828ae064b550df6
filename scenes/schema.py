"""The nouns of a scene, validated: Material, Mixture, Model, Camera, Environment, Object, Case."""

from __future__ import annotations

import cmath
import hashlib
import math
import reprlib
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, field_validator, model_validator

from scenes.optics import load_constants
from scenes.words import show

# Strict: neither true nor "0.2" is a number; integers are.
Unit = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False, strict=True)]
Finite = Annotated[float, Field(allow_inf_nan=False, strict=True)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False, strict=True)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False, strict=True)]
Pixels = Annotated[int, Field(gt=0, le=16384, strict=True)]
# Ten turns either way: float32 keeps a hundredth of a degree of them.
Degrees = Annotated[float, Field(ge=-3600, le=3600, allow_inf_nan=False, strict=True)]
Switch = Annotated[bool, Field(strict=True)]
RGB = tuple[Unit, Unit, Unit]
Vector = tuple[Finite, Finite, Finite]
Coordinate = Annotated[float, Field(ge=-1e15, le=1e15, allow_inf_nan=False, strict=True)]
Place = tuple[Coordinate, Coordinate, Coordinate]  # squares stay inside float32

PRIMITIVES = ("sphere", "plane", "globe", "cylinder")
# Rays are float32, told apart by 2^-24 of their length: so they hit within a 256th of a pixel.
LEAST_PIXEL = 2.0**-16  # radians
VERTEX = "vertex"  # in place of a map's path: what the vertices carry under the map's name
COSINE_82 = 1 / 7  # where F82 is given: Lazanyi and Szirmay-Kalos 2005
ALPHA_MIN = 1e-4  # Mitsuba's microfacet plugins floor alpha here, so both sides do.


class Strict(BaseModel):
    """A record that refuses unknown fields and cannot be changed."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Optics(Strict):
    """How a smooth interface reflects: F0, and where known eta and k, each (3,) linear sRGB.

    `eta` and `k` are None for a reflectance given as a bare number of a metal: such a material
    has no `physical` truth.
    """

    f0: RGB
    eta: tuple[Positive, Positive, Positive] | None = None
    k: tuple[NonNegative, NonNegative, NonNegative] | None = None
    name: str = ""

    @property
    def f82(self) -> RGB:
        """Reflectance where the cosine is 1/7, about 82 degrees, (3,): by the Fresnel equations.

        The tint of F82 is a share of Schlick's reflectance there (Kutz et al. 2021), so it is at
        most that; without eta and k it is just that.
        """
        schlick = [schlick_82(f) for f in self.f0]
        if self.eta is None or self.k is None:
            return tuple(schlick)
        exact = [reflectance(COSINE_82, *both) for both in zip(self.eta, self.k, strict=True)]
        return tuple(map(min, exact, schlick))


def schlick_82(f0: float) -> float:
    """Schlick's reflectance where the cosine is 1/7."""
    return f0 + (1 - f0) * (1 - COSINE_82) ** 5


def reflectance(cosine: float, eta: float, k: float) -> float:
    """Unpolarised reflectance of a smooth interface in vacuum, by complex amplitudes.

    Born and Wolf 1999, 7th ed., eq. 1.5.21.
    """
    n = complex(eta, k)
    inside = cmath.sqrt(n * n - (1 - cosine**2))
    s = (cosine - inside) / (cosine + inside)
    p = (n * n * cosine - inside) / (n * n * cosine + inside)
    return (abs(s) ** 2 + abs(p) ** 2) / 2


def _named_optics(value: Any, metal: bool) -> Any:
    """Turn a substance name, a number or an RGB triple into the fields of Optics."""
    if isinstance(value, str):
        constants = {n: c for n, c in load_constants().items() if c["metal"] == metal}
        if value not in constants:
            kind = "metal" if metal else "substance"
            named = ", ".join(sorted(constants))
            raise ValueError(f"unknown {kind} {show(value)}; use one of {named}")
        entry = constants[value]
        return Optics(f0=entry["f0"], eta=entry["eta"], k=entry["k"], name=value)
    if isinstance(value, int | float) and not isinstance(value, bool):
        value = [value] * 3
    if isinstance(value, list | tuple):
        optics = Optics(f0=value)
        if metal or max(optics.f0) >= 1:
            return optics
        # A lossless dielectric: F0 = ((eta - 1) / (eta + 1))^2 solved for eta.
        eta = tuple((1 + math.sqrt(f)) / (1 - math.sqrt(f)) for f in optics.f0)
        return optics.model_copy(update={"eta": eta, "k": (0.0, 0.0, 0.0)})
    if not isinstance(value, Optics | dict):
        raise ValueError(f"{show(value)} is no reflectance; give a name, a number or [r, g, b]")
    return value


Dielectric = Annotated[Optics, BeforeValidator(lambda v: _named_optics(v, metal=False))]
Metal = Annotated[Optics, BeforeValidator(lambda v: _named_optics(v, metal=True))]


def _ggx_share(value: Any) -> Any:
    """Accept the GGX share w, or the pair [w_ggx, w_beckmann] that must sum to 1."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if not isinstance(value, list | tuple):
        return value
    if len(value) != 2:
        raise ValueError(f"{len(value)} weights for two lobes; give [ggx, beckmann]")
    if not all(type(w) in (int, float, np.float64) and 0 <= w <= 1 for w in value):
        raise ValueError(f"weights {show(value)} leave [0, 1]; give each from 0 to 1")
    if not math.isclose(sum(value), 1, abs_tol=1e-6):
        raise ValueError(f"the weights sum to {sum(value):.6g}; make them sum to 1")
    return value[0]


Weight = Annotated[Unit, BeforeValidator(_ggx_share)]


class Maps(Strict):
    """What varies over a mesh: each a picture's absolute path, or "vertex" for what vertices carry.

    A value is the material's number times what the map holds, as in glTF 2.0, 3.9.2. `normal`
    turns the normal instead, by a picture. `repeat` multiplies texture coordinates.
    """

    albedo: str | None = None
    roughness: str | None = None
    metallic: str | None = None
    weight: str | None = None
    normal: str | None = None
    repeat: Annotated[float, Field(gt=0, le=1024, allow_inf_nan=False, strict=True)] = 1.0

    @model_validator(mode="after")
    def _normals_are_a_picture(self) -> Maps:
        if self.normal == VERTEX:
            raise ValueError("vertices carry no normal map; give normal = a picture's path")
        return self

    @property
    def given(self) -> dict[str, str]:
        """The maps that there are, by their names."""
        names = [n for n in type(self).model_fields if n != "repeat"]
        return {n: v for n in names if (v := getattr(self, n)) is not None}

    @property
    def pictures(self) -> dict[str, Path]:
        """Those of them that are pictures."""
        return {n: Path(v) for n, v in self.given.items() if v != VERTEX}


class Material(Strict):
    """A surface by albedo, roughness, metallic, F0 and its mixture of two microfacet lobes.

    `roughness` is the artist's perceptual parameter; the microfacet width is alpha = roughness²
    (Burley 2012). `weight` is the share of GGX in D, `weight_g` that of its masking in G; the
    rest is Beckmann. `metallic` between 0 and 1 mixes F0 and diffuse albedo linearly.

    `anisotropy` a stretches the facets' slopes along the tangent, from 0 to 1 (below 0 across it),
    by OpenPBR 1.1, "Microfacet model": alpha_x = alpha sqrt(2 / (1 + (1 - a)²)) and
    alpha_y = (1 - a) alpha_x, so that the mean of their squares stays alpha². `rotation` turns the
    tangent about the normal, in degrees, counter-clockwise as seen from outside.
    """

    name: str = ""
    description: str = ""
    source: str = ""
    albedo: RGB = (0.0, 0.0, 0.0)
    roughness: Unit
    metallic: Unit
    f0: Dielectric = Field(default=0.04, validate_default=True)
    metal: Metal | None = None
    weight: Weight = 1.0
    weight_g: Weight | None = None
    anisotropy: Annotated[float, Field(ge=-1, le=1, allow_inf_nan=False, strict=True)] = 0.0
    rotation: Degrees = 0.0
    maps: Maps = Maps()

    @model_validator(mode="after")
    def _parts_are_given(self) -> Material:
        if self.metallic > 0 and self.metal is None:
            raise ValueError("metallic > 0 without a metal; add metal = a name or its F0 [r, g, b]")
        partly = self.metallic < 1 or self.maps.metallic is not None
        if partly and "albedo" not in self.model_fields_set:
            raise ValueError("metallic < 1 without an albedo; add albedo = [r, g, b]")
        return self

    @property
    def alpha(self) -> float:
        """Microfacet width, floored at ALPHA_MIN."""
        return max(self.roughness**2, ALPHA_MIN)

    @property
    def stretch(self) -> tuple[float, float]:
        """alpha_x and alpha_y over alpha."""
        narrow = 1 - abs(self.anisotropy)
        wide = math.sqrt(2 / (1 + narrow**2))
        along, across = wide, narrow * wide
        return (along, across) if self.anisotropy >= 0 else (across, along)

    @property
    def alphas(self) -> tuple[float, float]:
        """Microfacet width along and across the tangent, floored at ALPHA_MIN."""
        if self.anisotropy == 0:
            return self.alpha, self.alpha
        return tuple(max(self.roughness**2 * s, ALPHA_MIN) for s in self.stretch)

    @property
    def varies(self) -> bool:
        """Whether it takes more than one number a parameter: it has a direction, or maps."""
        return self.anisotropy != 0 or bool(self.maps.given)

    @property
    def masking_weight(self) -> float:
        """The share of GGX's masking in G."""
        return self.weight if self.weight_g is None else self.weight_g

    @property
    def specular_f0(self) -> RGB:
        """F0 of the whole surface, (3,): the two parts mixed by metallic."""
        metal = self.metal.f0 if self.metal else self.f0.f0
        return tuple(
            (1 - self.metallic) * d + self.metallic * m
            for d, m in zip(self.f0.f0, metal, strict=True)
        )

    @property
    def specular_f82(self) -> RGB:
        """Reflectance of the whole surface at 82 degrees under F82, (3,), mixed by metallic.

        The dielectric part keeps Schlick's: F82 was made for metals. Of what bk7 sends back of
        even light Schlick's loses 7 %, and F82 with bk7's own reflectance at 82 degrees 11 %.
        """
        dielectric = [schlick_82(f) for f in self.f0.f0]
        metal = self.metal.f82 if self.metal else dielectric
        return tuple(
            (1 - self.metallic) * d + self.metallic * m
            for d, m in zip(dielectric, metal, strict=True)
        )

    @property
    def one_eta(self) -> float:
        """The dielectric part's eta as one number for all channels: their mean.

        Raises:
            ValueError: its F0 is 1, which no eta has.
        """
        if self.f0.eta is None:
            raise ValueError("a dielectric of F0 = 1 has no eta; give f0 below 1")
        return sum(self.f0.eta) / 3

    @property
    def metal_index(self) -> tuple[RGB, RGB]:
        """The metal part's eta and k, (3,) each.

        Raises:
            ValueError: it is given by its F0 alone.
        """
        if self.metal is None or self.metal.eta is None or self.metal.k is None:
            raise ValueError("a metal given as bare F0 has no eta and k; name a metal")
        return self.metal.eta, self.metal.k

    @property
    def diffuse_albedo(self) -> RGB:
        """Albedo of the diffuse lobe, (3,): none where the surface is metal."""
        return tuple((1 - self.metallic) * c for c in self.albedo)


class Model(Strict):
    """What the BRDF is, whoever integrates it. The default is the paper's.

    - fresnel: Schlick's from F0; `f82`, the same with the metal's own reflectance at 82 degrees
      (Kutz et al. 2021); or the `exact` equations from eta and k.
    - kd: diffuse light is (1 - F(h·wi)) albedo / pi under the integral; what an `interface`
      over a coloured layer gives back, each way through it paid for; or, `conserving`, what the
      specular lobe leaves of both directions' light (Kelemen and Szirmay-Kalos 2001).
    - masking: the `paper`'s is G = sum of w_j G_j with separable Smith for GGX and the V-cavity of
      Cook and Torrance 1982 for Beckmann; `smith` is separable with 1 / G1 = sum of w_j / G1_j,
      Smith's own rule for a mixture of facets (Heitz 2014, eq. 14, is linear in D).
    - multiscatter: `on` gives back what a second facet catches (Kulla and Conty 2017).
    """

    fresnel: Literal["schlick", "f82", "exact"] = "schlick"
    kd: Literal["one-minus-fresnel", "interface", "conserving"] = "one-minus-fresnel"
    masking: Literal["paper", "smith"] = "paper"
    multiscatter: Literal["off", "on"] = "off"

    @model_validator(mode="after")
    def _an_interface_is_exact(self) -> Model:
        if self.kd == "interface" and self.fresnel != "exact":
            problem = "kd = 'interface' lets light through by the exact Fresnel equations"
            raise ValueError(f"{problem}; add fresnel = 'exact'")
        return self


PAPER = Model()
PHYSICAL = Model(fresnel="exact", kd="interface", masking="smith")
NAMED_MODELS = {"paper": PAPER, "physical": PHYSICAL}


def _named_model(value: Any) -> Any:
    """Turn a model's name into the model."""
    if not isinstance(value, str):
        return value
    if value not in NAMED_MODELS:
        named = " or ".join(NAMED_MODELS)
        raise ValueError(f"unknown model {show(value)}; use {named}, or a table of its fields")
    return NAMED_MODELS[value]


ModelOrName = Annotated[Model, BeforeValidator(_named_model)]


def model_steps(model: Model) -> list[Model]:
    """From a model to PHYSICAL in steps: Fresnel, then kd, then masking and what it loses.

    A field that is physical already makes a step that changes nothing.
    """
    steps = []
    for fields in ({"fresnel"}, {"kd"}, {"masking", "multiscatter"}):
        # Rebuilt, not copied: every step is validated.
        model = Model(**model.model_dump() | PHYSICAL.model_dump(include=fields))
        steps.append(model)
    return steps


class Camera(Strict):
    """A pinhole; `fov` is vertical, in degrees; world is z up."""

    origin: Place
    target: Place
    up: Place = (0.0, 0.0, 1.0)
    fov: Annotated[float, Field(gt=0, lt=170, strict=True)]

    @model_validator(mode="after")
    def _looks_somewhere(self) -> Camera:
        to = [t - o for t, o in zip(self.target, self.origin, strict=True)]
        cross = math.hypot(
            to[1] * self.up[2] - to[2] * self.up[1],
            to[2] * self.up[0] - to[0] * self.up[2],
            to[0] * self.up[1] - to[1] * self.up[0],
        )
        if not cross > 1e-6 * math.hypot(*to) * math.hypot(*self.up):  # so it is too if up is 0
            raise ValueError("origin, target and up lie on one line; move the target or turn up")
        # Their squares must stay inside float32.
        if not math.hypot(*to) >= 1e-15:
            raise ValueError("target is less than 1e-15 from origin; move the target away")
        if not 1e-6 <= math.hypot(*self.up) <= 1e6:
            problem = f"up is {math.hypot(*self.up):.3g} long"
            raise ValueError(f"{problem}; only its direction counts: give 1e-6 to 1e6, such as 1")
        return self


class Environment(Strict):
    """A lat-long radiance map by absolute path; `rotation` turns it about z, in degrees."""

    name: str
    path: Path
    rotation: Degrees = 0.0


class Object(Strict):
    """One mesh with one material.

    `mesh` is a primitive ("sphere" of radius 1; "plane" of side 1 in z = 0; "globe", a sphere with
    texture coordinates; "cylinder" of radius 1 and height 2 about z) or an absolute path.
    It is scaled by `scale`, turned by `rotate` (degrees about x, then y, then z) and moved to
    `position`; with `height` it is instead scaled to that height and set with the middle of its
    base on `position`.
    """

    name: str
    mesh: str
    material: Material
    position: Vector = (0.0, 0.0, 0.0)
    rotate: tuple[Degrees, Degrees, Degrees] = (0.0, 0.0, 0.0)
    scale: Positive | tuple[Positive, Positive, Positive] = 1.0
    height: Positive | None = None
    judged: Switch = True
    small: str = ""

    @field_validator("name")
    @classmethod
    def _file_safe(cls, name: str) -> str:
        return file_safe(name)


class Case(Strict):
    """Everything needed to draw one picture, and nothing about how.

    Its JSON (`model_dump_json`) is what an outside renderer is given; scenes/FORMAT.md documents
    it.
    """

    id: str
    scene: str
    environment: Environment
    camera: Camera
    width: Pixels
    height: Pixels
    model: Model = Model()
    objects: Annotated[tuple[Object, ...], Field(min_length=1, max_length=254)]

    @model_validator(mode="after")
    def _names_are_unique(self) -> Case:
        unique_names([o.name for o in self.objects])
        return self

    @model_validator(mode="after")
    def _pixels_are_told_apart(self) -> Case:
        least = math.degrees(self.height * LEAST_PIXEL)
        if self.camera.fov < least:
            problem = f"camera.fov of {self.camera.fov:.3g} degrees over {self.height} pixels"
            remedy = f"give camera.fov from {1.01 * least:.3g} up, and move the camera nearer"
            raise ValueError(f"{problem} is finer than float32 rays; {remedy}")
        return self

    @property
    def judged(self) -> tuple[Object, ...]:
        """The objects that are measured; the others only give context."""
        return tuple(o for o in self.objects if o.judged)

    def index(self, name: str) -> int:
        """The id (1-based) under which an object stands in a mask; 0 is the background."""
        return 1 + [o.name for o in self.objects].index(name)


def unique_names(names: list[str]) -> None:
    """Raise ValueError if a name stands twice."""
    if twice := {n for n in names if names.count(n) > 1}:
        raise ValueError(f"objects share the name '{min(twice)}'; give each its own")


def file_safe(name: str) -> str:
    """Return the name if it can stand in a file name on any system, else raise ValueError."""
    safe = all(c.isalnum() or c in "-_.=" for c in name)
    if not safe or not 0 < len(name.encode()) <= 200 or name[0] == ".":
        allowed = "up to 200 letters (fewer with accents), digits, '-', '_', '.' and '='"
        raise ValueError(f"name {reprlib.repr(name)} is no file name; use {allowed}")
    return name


@cache
def file_digest(path: Path) -> str:
    """SHA-256 of a file's bytes, in hex."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()
