"""Records of the shaders on hard inputs, by hand."""

import math

from reports.stability.results import Axis, HardCase, Map, Promise, Stability, Worst

EVIL = "<b onclick=x>&\"'@7"
ALPHAS = [10 ** (k / 4 - 4) for k in range(17)]
COSINES = [10 ** (k / 2 - 6) for k in range(13)]
WEIGHTS = [0, 1e-7, 0.25, 0.5, 0.75, 1 - 1e-7, 1]
JUDGED = {"alpha": (0.01, 1.0), "n.v": (1e-4, 1.0)}


def axes(weights=WEIGHTS, cosines=COSINES, alphas=ALPHAS):
    return (
        Axis(name="weight", values=weights),
        Axis(name="n.v", values=cosines, log=True),
        Axis(name="alpha", values=alphas, log=True),
    )


def worst(value, **inputs):
    told = {"alpha": "0.01", "wi": "0,0.6,0.8"} | inputs
    point = " ".join(["brdf", *(f"{k}={v}" for k, v in told.items())])
    return Worst(value=value, inputs=told, command=f"shadeproof stability --at '{point}'")


def rounding(weight, cosine, alpha):
    """Errors as rounding makes them: larger where the lobe is narrow and the angle grazing."""
    return 2e-7 * (1 + weight) * (0.01 / alpha) ** 1.5 * (1 + 0.01 / cosine) ** 0.3


def made(function="brdf", invariant="against float64", of=rounding, **fields):
    """A map of a figure of weight, n.v and alpha."""
    values = [[[of(w, c, a) for a in ALPHAS] for c in COSINES] for w in WEIGHTS]
    pairs = [
        (v, a > 0.0099 and c > 0.99e-4)
        for rows in values
        for c, row in zip(COSINES, rows, strict=True)
        for a, v in zip(ALPHAS, row, strict=True)
        if v is not None
    ]
    limit = fields.get("limit", 1e-4)
    inside = max((v for v, judged in pairs if judged), default=0)
    base = {
        "why": "One model from the same inputs: what is left is rounding.",
        "unit": "|difference| over max(|f|, 1e-4 of the peak)", "axes": axes(), "values": values,
        "limit": limit, "judged": JUDGED, "worst": worst(inside),
        "beyond": worst(max(v for v, judged in pairs if not judged), alpha="0.0001"),
        "passed": limit is None or inside <= limit,
    }  # fmt: skip
    return Map(function=function, invariant=invariant, **base | fields)


def small(values, limit=1e-4, function="D_ggx", **fields):
    """A map of one slice, of the rows that are given, all of it judged."""
    known = [v for row in values for v in row if v is not None]
    base = {
        "why": "It must.", "unit": "an error", "limit": limit, "judged": {}, "values": [values],
        "axes": axes([1.0], COSINES[: len(values)], ALPHAS[: len(values[0])]),
        "worst": worst(max(known)), "passed": limit is None or max(known) <= limit,
    }  # fmt: skip
    return Map(function=function, invariant="finite", **base | fields)


def hard(name="wi = -wo", kind="function", passed=True, **fields):
    base = {
        "must_hold": "finite, at least 0", "why": "h has no direction there.",
        "measured": {"NaN or Inf": 0.0, "worst": 3.2e-7},
        "command": f"shadeproof stability --hard '{name}'",
    }  # fmt: skip
    return HardCase(name=name, kind=kind, passed=passed, **base | fields)


def promise(held=True, worst=3.1e-5):
    return Promise(
        claim="D, G, F and the whole BRDF agree with double precision",
        bounds={"alpha": (0.01, 1.0), "n.v": (1e-4, 1.0)}, limit=1e-4, worst=worst, held=held,
    )  # fmt: skip


def furnace(weight, cosine, alpha):
    """A furnace as Smith's masking keeps it, but at weight .5 and grazing angles."""
    return 1 - (0.0031 if weight == 0.5 and cosine < 1e-3 else 2e-5)


def broken(weight, cosine, alpha):
    """NaN at one corner, nothing tried at another."""
    if alpha < 2e-4 and cosine < 1e-5:
        return math.nan if weight < 0.5 else math.inf
    return None if cosine > 0.5 and alpha > 0.5 else 2e-3 * alpha * cosine


def full_stability(**fields):
    """Maps that hold, miss, are reported or broken; cases of every kind."""
    maps = [
        made("D_ggx"), made("D_beckmann", of=lambda w, c, a: rounding(w, c, a) / 30),
        made(), made("brdf", "against Mitsuba", masking="smith"),
        made("brdf", "reciprocal", of=lambda *_: 0.0, limit=1e-6),
        made("G_smith_mixture", "weak white furnace", of=furnace, masking="smith", at_least=0.999,
             limit=1.001, unit="facets seen; 1 is the whole", judged={}, beyond=None,
             worst=worst(1 - 0.0031, weight="0.5"), passed=False),
        made("brdf", "white furnace", masking="paper", limit=None, judged={}, beyond=None,
             of=lambda w, c, a: 0.02 * a),
        made("sample_ggx", "finite " + EVIL, of=broken, judged={}, limit=0.0, beyond=None,
             worst=worst(math.inf), passed=False),
    ]  # fmt: skip
    cases = [
        hard(), hard("alpha 1e-4"), hard("one texel of 1e6", "environment"),
        hard("normals that are NaN " + EVIL, "mesh", passed=False, measured={"NaN pixels": 12.0}),
        hard("1x1", "image"), hard("F0 out of gamut", "material"),
    ]  # fmt: skip
    base = {
        "created": "2026-01-01T00:00:00Z", "seconds": 71.0, "command": "shadeproof stability <all>",
        "provenance": {"device": "llvmpipe (LLVM 15.0.6)", "versions": {"moderngl": "5.13"}},
        "maps": maps, "hard": cases, "domain": [promise(), promise(held=False, worst=0.0031)],
    }  # fmt: skip
    return Stability(**base | fields)
