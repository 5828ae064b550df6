"""A BRDF from outside, direction by direction, against double precision: no pictures, no light."""

import json
import math
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from reports.candidates import CandidateError, Command
from reports.stability.agreement import Agreement, agreement, off_by, peaks
from reports.stability.directions import directions
from reports.stability.directions import materials as usual
from reports.stability.models import model_brdf
from scenes.schema import Material, Model

PAIRS = 2000  # of directions, a material
EXPLAINS = 0.05  # of what is off is left, at most, where a mistake is named

Values = Callable[[Material, Model, np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Answer:
    """How far a candidate's values of one material are off, and what explains it, if anything."""

    material: Material
    off: Agreement
    median: float
    mistake: str = ""


def _with(**changes) -> Values:
    """The BRDF of a material with some fields changed by functions of it."""

    def values(material: Material, model: Model, wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
        update = {name: change(material) for name, change in changes.items()}
        return model_brdf(material.model_copy(update=update), wi, wo, model)

    return values


def _under(**fields: str) -> Values:
    return lambda m, model, wi, wo: model_brdf(m, wi, wo, model.model_copy(update=fields))


def _times(factor: Callable[[np.ndarray], np.ndarray | float]) -> Values:
    return lambda m, model, wi, wo: model_brdf(m, wi, wo, model) * factor(wi)


MISTAKES: dict[str, Values] = {
    "it holds the cosine n·wi, which f does not": _times(lambda wi: wi[:, 2:]),
    "it is pi times too large": _times(lambda _: math.pi),
    "it is by pi too small": _times(lambda _: 1 / math.pi),
    "roughness is used as alpha; alpha = roughness²": _with(roughness=lambda m: m.roughness**0.5),
    "roughness is squared twice": _with(roughness=lambda m: m.roughness**2),
    "the weights of GGX and Beckmann are exchanged": _with(
        weight=lambda m: 1 - m.weight, weight_g=lambda m: 1 - m.masking_weight
    ),
    "the diffuse lobe is missing": _with(albedo=lambda _: (0.0, 0.0, 0.0)),
    "red and blue are exchanged": lambda *given: model_brdf(given[0], given[2], given[3], given[1])[
        :, ::-1
    ],
    "masking is Smith's for the mixed facets, and not the model's": _under(masking="smith"),
    "masking is the paper's, and not the model's": _under(masking="paper"),
    "Fresnel is exact, and not the model's": _under(fresnel="exact"),
    "Fresnel is Schlick's, and not the model's": _under(fresnel="schlick", kd="one-minus-fresnel"),
}


def examine_brdf(command: Command, model: Model, chosen: Sequence[Material] = ()) -> list[Answer]:
    """Ask a program for f of each material at pairs of directions, and hold it against float64.

    Args:
        command: called with {case} and {out}, both JSON (`docs/candidates.md`).
        chosen: the materials; of none some over alpha and weight, half metal.

    Raises:
        CandidateError: it gave no values, or not as many as it was asked for.
    """
    return [_answer(command, model, m) for m in chosen or usual()]


def _answer(command: Command, model: Model, material: Material) -> Answer:
    wi, wo = directions(material.alpha)
    every = max(len(wi) // PAIRS, 1)
    wi, wo = wi[::every], wo[::every]
    theirs = _asked(command, model, material, wi, wo)
    right = model_brdf(material, wi, wo, model)
    off = agreement(material, model.masking, "double precision", theirs, right, wi, wo)
    median = _median_off(theirs, right, wo)
    mistake = "" if off.passed else _mistake(theirs, model, material, wi, wo, median)
    return Answer(material, off, median, mistake)


def _mistake(
    theirs: np.ndarray,
    model: Model,
    material: Material,
    wi: np.ndarray,
    wo: np.ndarray,
    median: float,
) -> str:
    """The mistake that gives the same values, if one does."""
    ranked = []
    for words, values in MISTAKES.items():
        with np.errstate(all="ignore"):
            wrong = values(material, model, wi, wo)
        ranked.append((_median_off(theirs, wrong, wo), words))
    least, words = min(ranked)
    return words if least < EXPLAINS * median else ""


def _median_off(ours: np.ndarray, theirs: np.ndarray, wo: np.ndarray) -> float:
    return float(np.median(off_by(ours, theirs, peaks(theirs, wo[:, 2]))))


def _asked(
    command: Command, model: Model, material: Material, wi: np.ndarray, wo: np.ndarray
) -> np.ndarray:
    """What the program says of f, (n, 3)."""
    question = {
        "material": material.model_dump(mode="json"),
        "alpha": material.alpha,
        "model": model.model_dump(),
        "wi": wi.tolist(),
        "wo": wo.tolist(),
    }
    with tempfile.TemporaryDirectory() as name:
        asked, answer = Path(name) / "asked.json", Path(name) / "answer.json"
        asked.write_text(json.dumps(question), encoding="utf-8")
        command.run(asked, answer)
        if not answer.exists():
            raise CandidateError("ended with exit code 0 but wrote no values")
        try:
            values = np.array(json.loads(answer.read_text(encoding="utf-8")), float)
        except (ValueError, TypeError, UnicodeDecodeError) as error:
            raise CandidateError(f"wrote no list of [r, g, b]: {error}") from error
    if values.shape != wi.shape:
        raise CandidateError(f"wrote values of shape {values.shape}, not {wi.shape}")
    return values
