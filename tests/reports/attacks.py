"""An attack on the gate and its limits, by hand."""

from reports.attack.results import Attack, Mutant
from reports.limits.results import FalseAlarms, Limit, Limits, Point

EVIL = "<b onclick=x>&\"'@7"
FILES = (
    "shaders/ndf_ggx.glsl",
    "shaders/masking_smith.glsl",
    "shaders/brdf.glsl",
    "precompute/irradiance.py",
)
RULES = ("operator", "constant", "swizzle", "dropped factor", "comparison", "dropped call")
SEEN = "paper vs unoccluded, gold in spheres.studio: energy_local 0.31 over 0.05"


def mutant(id="m", **fields):
    base = {
        "kind": "rule", "rule": "operator", "file": FILES[0], "line": 12, "outcome": "caught",
        "before": "return a2 / (PI * d * d);", "after": "return a2 * (PI * d * d);",
        "exit_code": 1, "by": SEEN, "seconds": 6.1,
    }  # fmt: skip
    return Mutant(id=id, **base | fields)


def realistic(id, words, **fields):
    return mutant(id, kind="realistic", rule="", words=words, **fields)


def control(id, **fields):
    base = {
        "kind": "control", "rule": "", "words": "a product commuted", "outcome": "passed",
        "exit_code": 0, "by": "", "before": "a * b", "after": "b * a",
    }  # fmt: skip
    return mutant(id, **base | fields)


LOST = mutant(
    "lost 1", rule="constant", file=FILES[1], outcome="survived", exit_code=0, by="",
    before="max(n_dot_v, 1e-4)", after="max(n_dot_v, 2e-4)",
)  # fmt: skip
EQUAL = mutant(
    "equal-1", rule="comparison", file=FILES[2], outcome="survived", exit_code=0, by="",
    before="if (w <= 0.0)", after="if (w < 0.0)",
    equivalent="a weight of 0 adds a lobe times 0, which is the same sum",
)  # fmt: skip
DEAD = mutant(
    "dead-1", rule="swizzle", outcome="stillborn", exit_code=2, before="h.z", after="h.w",
    by="0:14(20): error: invalid swizzle / mask 'w'",
)  # fmt: skip


def full_attack(**fields):
    """Bugs of four files and six rules, one of each other outcome, and controls."""
    by_rule = [
        mutant(f"{r}-{i}-{j}", rule=r, file=f, line=7 + j, words=f"{r} changed")
        for i, f in enumerate(FILES) for r in RULES[: 6 - i] for j in range(3)
    ]  # fmt: skip
    people = [
        realistic("alpha", "roughness taken for alpha",
                  before="roughness * roughness", after="roughness"),
        realistic("pi", "the 1/π of the diffuse lobe is missing", file=FILES[2],
                  before="kd * albedo / PI", after="kd * albedo"),
        realistic("sun", "light is clipped at 65,504 " + EVIL, file=FILES[3], line=88,
                  before="radiance = texels", after="radiance = min(texels, 65504)"),
    ]  # fmt: skip
    base = {
        "created": "2026-01-01T00:00:00Z", "seconds": 812, "command": "shadeproof attack --out <x>",
        "suite": "guard", "seed": 1, "generated": 431,
        "provenance": {"device": "llvmpipe (LLVM 15.0.6)", "versions": {"moderngl": "5.13"}},
        "mutants": [
            *by_rule, *people, LOST, EQUAL, DEAD, *(control(f"c{i}") for i in range(20)),
        ],
    }  # fmt: skip
    return Attack(**base | fields)


def limit(parameter="roughness", sign="+", technique="all", smallest=0.012, unit="", **fields):
    middle = smallest or 0.05
    sizes = [middle * k for k in (0.25, 0.5, 0.8, 1, 1.5, 2)]
    share = (2, 21, 70, 95, 100, 100) if smallest else (0, 0, 1, 4, 9, 20)
    base = {
        "low": smallest and 0.9 * smallest, "high": smallest and 1.2 * smallest,
        "noiseless": 0.8 * middle, "seen_by": "sampled@64 vs unoccluded, silver: energy_local",
        "limited_by": "budget",
        "words": "the budget leaves 4 % of local energy above the technique's own error",
        "curve": [
            Point(size=s, caught=c, inconclusive=5, of=100)
            for s, c in zip(sizes, share, strict=True)
        ],
    }  # fmt: skip
    return Limit(
        parameter=parameter, sign=sign, technique=technique, smallest=smallest, unit=unit,
        **base | fields,
    )  # fmt: skip


def full_limits(**fields):
    """Limits of the whole suite and of two techniques, one of them out of reach."""
    found = [
        limit(p, s, t, v * k, u)
        for p, u, v in (("roughness", "", 0.012), ("gain", "relative", 0.013),
                        ("normal tilt", "degrees", 0.8))
        for s in "+-" for t, k in (("all", 1), ("paper", 8), ("sampled@64", 1.1))
    ]  # fmt: skip
    never = limit(
        "hue", "+", "all", None, "relative", noiseless=None, seen_by="", limited_by="noise"
    )
    base = {
        "created": "2026-01-01T00:00:00Z", "seconds": 620, "command": "shadeproof limits <y>",
        "suite": "guard", "pool": 64, "provenance": {"device": "llvmpipe"},
        "limits": [*found, never],
        "false_alarms": [
            FalseAlarms(what=what, sets=300, alarms=0, inconclusive=0, low=0, high=0.0122)
            for what in ("the renderer as it is", "other directions " + EVIL)
        ],
    }  # fmt: skip
    return Limits(**base | fields)
