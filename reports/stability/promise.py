"""The domain on which the renderer keeps its promise, read off the maps."""

from collections.abc import Iterable

from reports.stability.agreement import TOLERANCE
from reports.stability.grid import ALPHAS, COSINES, JUDGED, WEIGHTS
from reports.stability.results import HardCase, Map, Promise

EVERYWHERE = {
    "alpha": (float(ALPHAS[0]), float(ALPHAS[-1])),
    "n.v": (float(COSINES[0]), float(COSINES[-1])),
    "n.l": (1e-6, 1.0),
    "weight": (float(WEIGHTS[0]), float(WEIGHTS[-1])),
}
# The furnaces have no second direction; the white one is integrated where float32 places h.
SEEN = {k: v for k, v in EVERYWHERE.items() if k != "n.l"}
PLACED = 1e-5  # the least alpha n.v: mirrored to float32 directions, h is off by 3e-8 / wo.h
HARD_HOLDS = "Every hard case holds"
TERMS = ("D_", "G_", "G1_", "F_", "brdf")


def promises(maps: list[Map], hard: list[HardCase]) -> list[Promise]:
    """What holds, where, and how well."""
    terms = [m for m in maps if m.invariant == "against float64" and m.function.startswith(TERMS)]
    unfit = [m for m in maps if m.invariant in ("finite", "non-negative")]
    weak = [m for m in maps if m.invariant == "weak white furnace"]
    white = [m for m in maps if m.invariant == "white furnace" and m.function == "brdf"]
    return [
        _held("The BRDF is finite and not negative", EVERYWHERE, _most(unfit), 0.0),
        _held(
            "D, G, F and the whole BRDF agree with float64 within 1e-4",
            JUDGED,
            _most(terms),
            TOLERANCE,
        ),
        _held(
            "The same for narrower lobes and lower angles, beyond what was asked",
            EVERYWHERE,
            max(_most(terms), _most(terms, beyond=True)),
            TOLERANCE,
        ),
        _held(
            "Under masking smith the weak white furnace is 1 within 1e-3, at all weights",
            SEEN,
            max(abs(m.worst.value - 1) for m in weak if m.masking == "smith"),
            1e-3,
        ),
        _held(
            "The specular lobe sends back at most what comes, where F = 1",
            SEEN | {"alpha n.v": (PLACED, 1.0)},
            _most(white),
            1.001,
        ),
        _held(
            HARD_HOLDS,
            {},
            float(sum(not case.passed for case in hard)),
            0.0,
        ),
    ]


def _most(maps: Iterable[Map], beyond: bool = False) -> float:
    worst = [m.beyond if beyond else m.worst for m in maps]
    return max((w.value for w in worst if w), default=0.0)


def _held(claim: str, bounds: dict, worst: float, limit: float) -> Promise:
    return Promise(claim=claim, bounds=bounds, limit=limit, worst=worst, held=worst <= limit)
