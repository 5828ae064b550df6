"""A suite of one small case, for tests that need a run and not its figures."""

import json

SUITE = """
description = "one small case"
techniques = ["paper"]
truths = {truths}

[reference]
samples_per_batch = {samples}
max_samples = {most}

[[run]]
scene = "contact"
environments = ["studio"]
resolution = {size}
"""
BUDGET = """
[[budget]]
technique = "paper"
truth = {truth}
{budget}
"""
BUNNY = """
description = "One small bunny."
techniques = ["paper", "sampled@4"]
truths = ["global"]
[reference]
samples_per_batch = 16
max_samples = 128
[[run]]
scene = "single"
environments = ["studio"]
resolution = [64, 64]
"""


def small_suite(truths=("unoccluded",), samples=16, most=128, size=(96, 72), budget=""):
    """The text of a suite, with a rule against its first truth where `budget` holds its fields."""
    told = {"truths": json.dumps(truths), "samples": samples, "most": most, "size": list(size)}
    rule = BUDGET.format(truth=json.dumps(truths[0]), budget=budget) if budget else ""
    return SUITE.format(**told) + rule
