"""A run by hand and its report, read as a browser would."""

import base64
import io
import json
import re
import zlib
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


def layer(text, *names, size=(HEIGHT, WIDTH)):
    """The places (h, w) of a map, or the radiance (h, w, 3) of a picture, of a page's case."""
    pattern = (
        rf'<script type="text/plain" id="layer--spheres.dusk--{"--".join(names)}">(.*?)</script>'
    )
    data = zlib.decompress(base64.b64decode(re.search(pattern, text)[1]))
    if names[0] in ("candidate", "truth"):
        (told,) = [t for t in told_layers(text) if t["id"].endswith("--".join(names))]
        return unpacked(data, size) * told["scale"]
    return np.frombuffer(data, np.uint8).reshape(size)


def unpacked(data, size):
    """What packing.js makes of a picture's bytes, (h, w, 3), before its scale."""
    high, low = np.frombuffer(data, np.uint8).reshape(2, 3, *size)
    zigzag = high.astype(int) << 8 | low
    off = (zigzag >> 1) ^ -(zigzag & 1)
    planes = np.zeros((3, *size), int)
    for y, x in np.ndindex(*size):
        left = planes[:, y, x - 1] if x else 0
        above = planes[:, y - 1, x] if y else 0
        planes[:, y, x] = (off[:, y, x] + ((left + above) >> 1)).astype(np.int16)
    green, red, blue = planes[0], planes[0] + planes[1], planes[0] + planes[2]
    bits = np.stack([red, green, blue], axis=2).astype(np.uint16)
    return bits.view(np.float16).astype(float)


def told_layers(text):
    """What a page's script is told of the layers of its cases."""
    told = re.findall(
        r'<div class="viewer">\s*<script type="application/json">(.*?)</script>', text
    )
    return [layer for case in told for layer in json.loads(case)["layers"]]


def problems(text):
    """Why layers are missing, by kind and technique or truth."""
    return {(t["kind"], t["name"]): t["problem"] for t in told_layers(text) if t["problem"]}


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
