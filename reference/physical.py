"""Truth `physical`: a material as Mitsuba's own plugins, which nobody here wrote.

- A metal is `roughconductor` with eta and k.
- A dielectric is `roughplastic` under vacuum. The plugin takes one index of refraction, so RGB
  eta becomes its mean (a note says by how much F0 then differs, where it does). Its diffuse
  reflectance is the albedo of the layer below; `solve_reflectance` finds the one with which the
  surface, seen from outside, has the material's albedo.
- Anisotropy is the `alpha_u` and `alpha_v` of `roughconductor`, along u of the mesh.
- metallic between 0 and 1 is a `blendbsdf` of the two, and so is the mixture of the two NDFs by
  its weight in D. The weight in G is ignored: each NDF keeps its own Smith masking.
"""

from functools import cache

import drjit as dr
import numpy as np

from reference.variant import mitsuba
from scenes.errors import InputError
from scenes.mesh import load_mesh
from scenes.schema import Material, Object, Optics

mi = mitsuba()

DISTRIBUTIONS = {"beckmann": 0.0, "ggx": 1.0}  # the weight at which only this one is left
NOTABLE = 0.002  # a change of F0 worth a note; below it no figure moves


def physical_bsdf(obj: Object) -> tuple[dict, list[str]]:
    """The object's material as a Mitsuba dictionary, with notes on what could not be matched.

    Raises:
        InputError: a metal is given by its F0 alone, or a dielectric has an F0 of 1, so that eta
            and k are unknown; or no stock plugin is like the material.
    """
    material = obj.material
    if material.varies:
        _check_stock(obj)
    if material.metallic > 0:
        named_metal(obj)
    if material.metallic < 1:
        one_eta(obj)
    patches = {}
    for distribution in DISTRIBUTIONS:
        if material.weight == 1 - DISTRIBUTIONS[distribution]:
            continue  # the mixture has none of it
        metal = _metal(material, distribution) if material.metallic > 0 else None
        layered = plastic(material, distribution) if material.metallic < 1 else None
        patches[distribution] = blend(layered, metal, material.metallic)
    return blend(patches.get("beckmann"), patches.get("ggx"), material.weight), eta_notes(obj)


def _check_stock(obj: Object) -> None:
    """Refuse what no stock plugin has: maps, turned tangents, and plastic with a direction."""
    material = obj.material
    stock = material.metallic == 1 and not material.maps.given and material.rotation == 0
    if not stock or "uv" not in load_mesh(obj.mesh).carried:
        problem = (
            "Mitsuba's own materials have anisotropy in bare metals along u alone, and no maps"
        )
        remedy = "leave the truth `physical` out"
        raise InputError(f"object '{obj.name}'", "material", problem, remedy)


def named_metal(obj: Object) -> Optics:
    """The object's metal with its eta and k.

    Raises:
        InputError: it is given by its F0 alone.
    """
    metal = obj.material.metal
    if metal is None or metal.eta is None:
        problem = "a metal given as bare F0 has no eta and k, which exact Fresnel needs"
        raise InputError(f"object '{obj.name}'", "material.metal", problem, "name a metal")
    return metal


def one_eta(obj: Object) -> float:
    """The eta of the object's dielectric as the one number that `roughplastic` takes.

    Raises:
        InputError: its F0 is 1, which no eta has.
    """
    try:
        return obj.material.one_eta
    except ValueError as error:
        problem = "a dielectric of F0 = 1 has no eta, which exact Fresnel needs"
        where = f"object '{obj.name}'"
        raise InputError(where, "material.f0", problem, "give f0 below 1") from error


def eta_notes(obj: Object) -> list[str]:
    """A note if `one_eta` changes what the object reflects."""
    if obj.material.metallic == 1:
        return []
    f0 = ((one_eta(obj) - 1) / (one_eta(obj) + 1)) ** 2
    gap = max(abs(f0 - f) for f in obj.material.f0.f0)
    if gap <= NOTABLE:
        return []
    return [f"{obj.name}: F0 is {f0:.4f} in every channel, off by up to {gap:.4f}"]


def blend(first: dict | None, second: dict | None, weight: float) -> dict:
    """(1 - weight) first + weight second; at the ends the one that is left.

    `blendbsdf` orders its children by id and its weight 0 is the first: hence `a_` and `b_`.
    """
    if weight == 0 or weight == 1:
        return second if weight == 1 else first
    return {"type": "blendbsdf", "weight": weight, "a_first": first, "b_second": second}


def _metal(material: Material, distribution: str) -> dict:
    along, across = material.alphas
    width = {"alpha": along} if along == across else {"alpha_u": along, "alpha_v": across}
    return {
        "type": "roughconductor",
        "distribution": distribution,
        **width,
        "eta": {"type": "rgb", "value": list(material.metal.eta)},
        "k": {"type": "rgb", "value": list(material.metal.k)},
    }


def plastic(material: Material, distribution: str) -> dict:
    """`roughplastic` of one NDF whose albedo, seen from outside, is the material's."""
    eta = material.one_eta
    reflectance = solve_reflectance(eta, material.alpha, distribution, material.albedo)
    return _rough_plastic(eta, material.alpha, distribution, reflectance)


def _rough_plastic(eta: float, alpha: float, distribution: str, reflectance) -> dict:
    return {
        "type": "roughplastic",
        "distribution": distribution,
        "alpha": alpha,
        "int_ior": eta,
        "ext_ior": 1.0,
        # Light that returns from the interface meets the coloured layer again.
        "nonlinear": True,
        "diffuse_reflectance": _unbounded(reflectance),
    }


def solve_reflectance(
    eta: float, alpha: float, distribution: str, albedo: tuple[float, float, float]
) -> np.ndarray:
    """The inner reflectance with which `roughplastic` has a given outer diffuse albedo.

    The outer albedo is A(rho) = T rho / (1 - rho r), light that enters, bounces under the
    interface and leaves; T and r follow from measuring the plugin at two values of rho.

    Returns:
        The reflectance, (3,). It may exceed 1, and the series still converges, since rho r < 1:
        the plugin's rough interface loses what a second bounce on it would give back, a third of
        the light at alpha .5, and the layer below must make up for that.
    """
    half, one = (
        outer_albedo(eta, alpha, distribution, 0.5),
        outer_albedo(eta, alpha, distribution, 1),
    )
    r = (one - 2 * half) / (one - half)
    T = one * (1 - r)
    wanted = np.asarray(albedo, float)
    return wanted / (T + wanted * r)


def _unbounded(reflectance) -> dict:
    """A constant texture whose values may exceed 1, which `rgb` refuses."""
    pixel = np.asarray(reflectance, np.float32).reshape(1, 1, 3)
    return {"type": "bitmap", "bitmap": mi.Bitmap(pixel), "raw": True, "filter_type": "nearest"}


@cache
def outer_albedo(eta: float, alpha: float, distribution: str, rho: float) -> float:
    """Hemispherical-hemispherical albedo of the plugin's diffuse component, by quadrature.

    1/pi times the integral of f cos(theta_i) cos(theta_o) over both hemispheres; the component
    does not depend on azimuth, which leaves 4 pi f cos cos over both cosines.
    """
    nodes, weights = np.polynomial.legendre.leggauss(48)
    cosine, weight = (nodes + 1) / 2, weights / 2
    z_in, z_out = (a.ravel().astype(np.float32) for a in np.meshgrid(cosine, cosine))
    bsdf = mi.load_dict(_rough_plastic(eta, alpha, distribution, [rho] * 3))
    diffuse = [
        i for i in range(bsdf.component_count()) if mi.has_flag(bsdf.flags(i), mi.BSDFFlags.Diffuse)
    ]
    context = mi.BSDFContext()
    context.component = diffuse[0]
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(np.sqrt(1 - z_in**2), 0, z_in)
    wo = mi.Vector3f(np.sqrt(1 - z_out**2), 0, z_out)
    f_cos = np.array(bsdf.eval(context, si, wo))[0].astype(float)  # grey: one channel serves
    return float(np.sum(f_cos * z_in * np.outer(weight, weight).ravel()) * 4 * np.pi)
