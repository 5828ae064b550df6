"""What an attack found, in the terminal: the score, then what it missed."""

from collections import Counter

from rich.console import Console

from reports.attack.results import Attack, Mutant

NAMES = {"realistic": "realistic bugs", "rule": "mutants by rule", "control": "controls"}


def print_attack(found: Attack, console: Console) -> None:
    """The score by kind, survivors and alarms one by one, and the verdict."""
    for kind, name in NAMES.items():
        if own := [m for m in found.mutants if m.kind == kind]:
            console.print(f"{name}: {score(own)}", soft_wrap=True)
    for mutant in [*found.alarms, *found.having("survived")]:
        mark = "yellow" if mutant.equivalent else "red"
        told = mutant.equivalent or mutant.by or "nobody has said why it does not matter"
        console.print(f"[{mark}]{mutant.outcome}[/]: {mutant.id}", soft_wrap=True)
        for line in (f"- {mutant.before.strip()}", f"+ {mutant.after.strip()}", told):
            console.print(f"    {line}", markup=False, soft_wrap=True)
    word = "[green bold]PASS[/]" if found.passed else "[red bold]FAIL[/]"
    missed, alarms = len(found.unexplained), len(found.alarms)
    console.print(f"{word}: {missed} bugs missed that could be seen, {alarms} false alarms")


def told(mutant: Mutant) -> str:
    """A line about one verdict: its outcome, and the first reason."""
    return f"{mutant.outcome}: {mutant.id} {mutant.by.partition('; ')[0]}".rstrip()


def score(mutants: list[Mutant]) -> str:
    """How many of them had which outcome, in words."""
    count = Counter(
        "equivalent" if m.outcome == "survived" and m.equivalent else m.outcome for m in mutants
    )
    named = ", ".join(f"{n} {outcome}" for outcome, n in count.most_common())
    return f"{named} of {len(mutants)}"
