"""A run by hand and its report, read as a browser would."""

import base64
import io
from html.parser import HTMLParser

import numpy as np
from PIL import Image

from reports.gate import conclude, judge
from reports.html import write_report
from reports.results import CaseRecord, Results, Row
from scenes.suite import Budget

HEIGHT, WIDTH = 48, 96
BUDGET = Budget(technique="paper", truth="global", energy_local=0.2, ssim=0.9)
VOID = {"area", "base", "br", "col", "hr", "img", "input", "link", "meta", "source", "wbr"}


class Page(HTMLParser):
    """A page's elements; tells of tags that are not closed in order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.elements, self.text = [], [], {}
        self.feed(text)
        self.close()
        assert not self.open, f"never closed: {self.open}"

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, f"</{tag}> closes something else"

    def handle_data(self, data):
        for tag in set(self.open):
            self.text[tag] = self.text.get(tag, "") + data


def row(**fields):
    """A judged row of the object `left`; figures and names can be given."""
    base = {
        "case": "spheres.dusk", "scene": "spheres", "environment": "dusk", "object": "left",
        "material": "copper", "roughness": 0.4, "metallic": 1, "weight": 0.25, "weight_g": 0.25,
        "technique": "paper", "picture": fields.get("technique", "paper"), "truth": "global",
        "exposure": 0.3, "ssim": 0.95, "ssim_ci95": (0.949, 0.951),
        "energy_error": 0.01, "energy_ci95": (0.009, 0.011), "energy_local": 0.1,
        "energy_local_ci95": (0.09, 0.11), "frame_ms": 3.2,
    }  # fmt: skip
    return judge(Row(**with_noise(base | fields)), [BUDGET])


def with_noise(fields):
    """Standard errors, of many degrees of freedom, that give a row's 95 % intervals."""
    told = {}
    for stem, power in (("ssim", 1), ("energy", 1), ("energy_local", 2)):
        low, high = fields[f"{stem}_ci95"]
        told[f"{stem}_se"] = (high**power - low**power) / 2 / 1.96
        told[f"{stem}_dof"] = 1e4
    return told | fields


def results(rows, **fields):
    """A run with the given rows and two-object cases to go with them."""
    cases = [
        CaseRecord(
            id=case, scene="spheres", environment="dusk", width=WIDTH, height=HEIGHT,
            objects=["left", "right"], candidates={"paper": "paper.exr"},
            truths={"global": ("a.exr", "b.exr")},
        )
        for case in dict.fromkeys(r.case for r in rows)
    ]  # fmt: skip
    base = {
        "suite": "tiny", "suite_path": "tiny.toml", "description": "Two spheres.",
        "command": "shadeproof compare --suite tiny", "created": "2026-01-01T00:00:00Z",
        "seconds": 1.0, "allow_inconclusive": False, "expected_rows": len(rows), "missing": [],
        "provenance": {"device": "llvmpipe", "parity": [
            {"name": "silhouettes", "passed": True, "detail": "overlap 99 %"},
            {"name": "background", "passed": False, "detail": "off by 3 %"},
        ]},
        "skipped": [], "cases": cases, "budgets": [BUDGET], "rows": rows, "verdict": "fail",
        "reasons": [],
    }  # fmt: skip
    return conclude(Results(**base | fields))


def written(run, folder):
    return write_report(run, folder).read_text(encoding="utf-8")


def pixels(uri):
    data = base64.b64decode(uri.removeprefix("data:image/png;base64,"))
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))


def image(page, words):
    """The pixels of the one image whose alternative text starts with `words`."""
    (found,) = [a for t, a in page.elements if t == "img" and a["alt"].startswith(words)]
    return pixels(found["src"])


def bare_report(folder):
    """The report of a run that compared nothing, beside what lies in a folder."""
    run = Results(
        suite="s", suite_path="s.toml", description="d", command="c", created="t", seconds=1,
        provenance={}, allow_inconclusive=False, expected_rows=0, missing=[], skipped=[],
        cases=[], budgets=[], rows=[], verdict="fail", reasons=["nothing"],
    )  # fmt: skip
    return Page(written(run, folder))


def plain(string):
    """Text with plain spaces."""
    return string.replace("\u202f", " ")


def shown_text(page):
    """The text that a page shows."""
    return plain(" ".join(page.text["body"].replace(page.text["script"], "").split()))
