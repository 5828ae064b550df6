"""A diagnosis in words."""

from rich.console import Console

from reports.doctor.brdf import Answer
from reports.doctor.diagnosis import Diagnosis
from reports.doctor.scenes import CASES


def sentences(found: Diagnosis) -> list[str]:
    """What is wrong, one sentence each, the most important first."""
    told = [f"doctor.{name}: {why}" for name, why in found.lost.items()]
    if found.lost and not found.after:
        told.append("no case could be looked at; `shadeproof doctor --cases FOLDER` writes them")
    partly = "" if not found.after or max(found.after.values()) <= 1 else " in part"
    for mistake in found.found:
        told.append(f"it looks{partly} as if {mistake.words}; {mistake.remedy}")
    if found.sound:
        told.append("nothing wrong: light, view, normals and materials are as they should be")
    elif found.after and max(found.after.values()) > 1:
        name = max(found.after, key=lambda n: found.after[n])
        rest = "what is left" if found.found else "what is wrong"
        told.append(
            f"{rest} is none of the mistakes known here; most in doctor.{name}: {CASES[name][0]}"
        )
    return told


def print_diagnosis(found: Diagnosis, console: Console) -> None:
    """The sentences, and how far the pictures are off without and with what was found."""
    for line in sentences(found):
        console.print(line, soft_wrap=True, markup=False)
    if found.after:
        each = (f"{n} {found.before[n]:.2g} to {found.after[n]:.2g}" for n in found.after)
        told = (
            "how far off, without and with that explained (1 is what honest renderers differ by): "
        )
        console.print(told + ", ".join(each), style="dim", soft_wrap=True)


def print_answers(answers: list[Answer], console: Console) -> None:
    """Each material with its worst direction, and in words what explains a difference."""
    for answer in answers:
        off, surface = answer.off, answer.material
        name = surface.name or f"alpha {off.alpha:.3g}, weight {off.weight:g}"
        where = (f"{n}={','.join(f'{v:.4g}' for v in getattr(off, n))}" for n in ("wi", "wo"))
        state = "right" if off.passed else "off"
        told = f"{name}: {state}, by {off.worst:.1e} of f at worst ({' '.join(where)})"
        console.print(f"{told}, {answer.median:.1e} in the middle", soft_wrap=True, markup=False)
    mistakes = dict.fromkeys(a.mistake for a in answers if a.mistake)
    for mistake in mistakes:
        count = sum(a.mistake == mistake for a in answers)
        console.print(f"it looks as if {mistake} ({count} of {len(answers)})", soft_wrap=True)
