"""Which picture of a technique stands against which truth: one with the switches to match."""

from collections.abc import Iterable
from dataclasses import dataclass

from renderer.techniques import Technique, technique
from reports.candidates import Candidate
from reports.ladder import MODEL_STEPS
from scenes.schema import PHYSICAL, Case, Model, model_steps


@dataclass(frozen=True)
class Shot:
    """One picture to draw.

    Attributes:
        name: in results.json: the technique's, followed by the truth that it matches where that
            takes the technique with a switch thrown or under another model.
        case: under the model that is drawn.
    """

    name: str
    candidate: Candidate
    case: Case


def shots(name: str, case: Case, truths: Iterable[str], timed: bool) -> dict[str, Shot]:
    """What a technique draws to stand against each of some truths; of one name if it is the same.

    Args:
        truths: by name; under the names in MODEL_STEPS those of the models on the way to PHYSICAL.
        timed: whether each is drawn until its time is known.
    """
    base = technique(name)
    return {t: _shot(base, base.matched(t), case, t, timed) for t in truths}


def _shot(base: Technique, how: Technique, case: Case, truth: str, timed: bool) -> Shot:
    model = drawn_model(base, case.model, truth)
    if model == case.model:
        label = base.name if how == base else f"{base.name}.{truth}"
        return Shot(label, ours(how, timed), case)
    label = f"{base.name}.{'physical' if model == PHYSICAL else truth}"
    return Shot(label, ours(how, timed), case.model_copy(update={"model": model}))


def ours(how: Technique, timed: bool) -> Candidate:
    """Our own renderer.

    It is imported here, when it draws: what others drew is measured where there is no OpenGL.
    """
    from renderer.draw import REPEATS, Renderer

    return Renderer(how, REPEATS if timed else 0)


def drawn_model(base: Technique, model: Model, truth: str) -> Model:
    """The model that a technique draws against a truth of a case.

    Against those beyond `global` it is theirs, if the technique can draw it and PHYSICAL, to which
    they lead; else it is the case's.
    """
    beyond = dict(zip(MODEL_STEPS, model_steps(model), strict=True))
    theirs = PHYSICAL if truth.startswith("physical") else beyond.get(truth, model)
    return model if base.cannot_draw(PHYSICAL) or base.cannot_draw(theirs) else theirs
