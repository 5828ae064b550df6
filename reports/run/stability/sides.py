"""Functions evaluated by the shaders and by Mitsuba, on the same float32 inputs."""

import numpy as np

from renderer.features import features
from renderer.probe import probe
from reports.stability.functions import FUNCTIONS, PARTS, Inputs
from scenes.schema import Material, Model


def _shaped(inputs: Inputs) -> Inputs:
    """Every input as (n, parts) or (1, parts) float32."""
    return {n: np.asarray(v, np.float32).reshape(-1, PARTS[n]) for n, v in inputs.items()}


def rows(inputs: Inputs) -> Inputs:
    """Every input as (n, parts) float32; what is given once holds for all rows."""
    shaped = _shaped(inputs)
    count = max(len(v) for v in shaped.values())
    return {n: np.broadcast_to(v, (count, PARTS[n])) for n, v in shaped.items()}


def shader(
    name: str, inputs: Inputs, masking: str = "paper", forced: tuple[str, ...] = ()
) -> np.ndarray:
    """What the GLSL returns, (n, parts) float32.

    The lobes that are compiled in are those that a material of these weights and albedo needs, as
    for a picture, and those forced; for a function without weights all are.
    """
    function, given = FUNCTIONS[name], _shaped(inputs)
    defines = frozenset({"D_GGX", "D_BECKMANN", "DIFFUSE"})
    if "weight" in function.inputs:
        defines = _compiled(given, masking, forced)
    kept = {n: given[n] for n in function.inputs}
    return probe(function.glsl, kept, function.includes, defines)[:, : function.parts]


def _compiled(given: Inputs, masking: str, forced: tuple[str, ...]) -> frozenset[str]:
    """The features that a material with these weights needs."""
    weight, weight_g = given["weight"][0], given.get("weight_g", given["weight"])[0]
    material = Material(
        albedo=(float(given["albedo"].max() > 0) if "albedo" in given else 0.0,) * 3,
        roughness=1.0,
        metallic=0.0,
        weight=_ggx_share(weight),
        weight_g=_ggx_share(weight_g),
    )
    return features(material, Model(masking=masking), forced=forced)


def _ggx_share(pair: np.ndarray) -> float:
    """GGX's share of a pair that need not sum to 1: at an end only where the other has none."""
    return float(pair[0] > 0) if 0 in pair else 0.5


def exact(name: str, inputs: Inputs, masking: str = "paper") -> np.ndarray:
    """The same in double precision, (n, parts)."""
    return FUNCTIONS[name].expected(rows(inputs), masking)


def mitsuba(inputs: Inputs, masking: str) -> np.ndarray:
    """The reference's own BSDF, f without the cosine, (n, 3), for the inputs of `brdf`."""
    import reference.mixture  # noqa: F401  registers the plugin
    from reference.variant import mitsuba as variant

    mi = variant()
    given = rows(inputs)
    bsdf = mi.load_dict(
        {
            "type": "mixture",
            "fresnel": "schlick",
            "kd": "one-minus-fresnel",
            "masking": masking,
            **{n: [float(x) for x in given[n][0]] for n in ("albedo", "f0")},
            **{n: _weight(given[n][0]) for n in ("weight", "weight_g")},
            "alpha": float(given["alpha"][0, 0]),
        }
    )
    bsdf.alpha = mi.Float(np.ascontiguousarray(given["alpha"][:, 0]))
    si, wo = _interaction(mi, given)
    return (bsdf.eval(mi.BSDFContext(), si, wo) / wo.z).numpy().T


def _weight(pair: np.ndarray) -> float:
    """GGX's share in double precision, from the smaller of the two: 1 - 1e-7 is no float32."""
    return float(pair[0]) if pair[0] <= pair[1] else 1 - float(pair[1])


def stock(inputs: Inputs, ndf: str) -> tuple[np.ndarray, np.ndarray]:
    """Mitsuba's own roughconductor with F = 1: f (n, 1) without the cosine, and pdf (n, 1).

    It samples all facets, not only visible ones, as the shaders do. Alpha may differ from row to
    row.
    """
    from reference.variant import mitsuba as variant

    mi = variant()
    given = rows(inputs)
    f, pdf = np.empty((2, len(given["alpha"]), 1))
    for alpha in np.unique(given["alpha"]):
        kept = given["alpha"][:, 0] == alpha
        kind = {"type": "roughconductor", "material": "none", "distribution": ndf}
        bsdf = mi.load_dict(kind | {"alpha": float(alpha), "sample_visible": False})
        si, wo = _interaction(mi, {n: given[n][kept] for n in ("wi", "wo")})
        context = mi.BSDFContext()
        f[kept, 0] = (bsdf.eval(context, si, wo) / wo.z).numpy()[0]
        pdf[kept, 0] = bsdf.pdf(context, si, wo).numpy()
    return f, pdf


def _interaction(mi, given: Inputs) -> tuple:
    """Mitsuba's wi looks to the eye and wo to the light."""
    import drjit as dr

    si = dr.zeros(mi.SurfaceInteraction3f, len(given["wi"]))
    si.wi = mi.Vector3f(np.ascontiguousarray(given["wo"].T))
    return si, mi.Vector3f(np.ascontiguousarray(given["wi"].T))
