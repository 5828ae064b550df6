"""Does the GLSL compute the model? Per direction, beside Mitsuba and double precision."""

from reports.stability.agreement import FLOOR, TOLERANCE, Agreement, agreement
from reports.stability.directions import ALPHAS, MASKINGS, WEIGHTS, directions, materials
from reports.stability.oracle import Lambda, oracle

__all__ = [
    "ALPHAS",
    "FLOOR",
    "MASKINGS",
    "TOLERANCE",
    "WEIGHTS",
    "Agreement",
    "Lambda",
    "agreement",
    "directions",
    "materials",
    "oracle",
]
