"""The three worst rows as pictures beside the Markdown summary: candidate, reference, error."""

import base64
import io
import shutil
from dataclasses import dataclass
from pathlib import Path

from PIL import Image

from reports.change.ranking import by_row, verdict_of
from reports.frames import CaseFrames
from reports.gate import worst_first
from reports.html.images import close_ups
from reports.results import Results, Row
from scenes.frame import written_aside

COUNT = 3
FOLDER = "crops"
APART = 4  # pixels between the pictures


@dataclass(frozen=True)
class Crop:
    """A row and its picture, relative to the run's folder."""

    row: Row
    path: str


def write_crops(results: Results, folder: Path) -> list[Crop]:
    """Write the pictures of the worst rows; those whose frames cannot be shown are left out.

    The worst are those that got worse, where that is judged; then by verdict and margin.

    Raises:
        InputError: the folder cannot be written.
    """
    shutil.rmtree(folder / FOLDER, ignore_errors=True)
    made = []
    for row in worst_rows(results)[:COUNT]:
        record = next((c for c in results.cases if c.id == row.case), None)
        if record is None:
            continue
        frames = CaseFrames(record, folder, [r for r in results.rows if r.case == row.case])
        shown = [p.uri for p in close_ups(frames, row) if p.uri]
        if not shown:
            continue
        path = f"{FOLDER}/{len(made) + 1}.png"
        with written_aside(folder / path) as aside:
            _strip(shown).save(aside, "PNG")
        made.append(Crop(row, path))
    return made


def worst_rows(results: Results) -> list[Row]:
    """The rows, the worst first."""
    ranked = worst_first(results.rows)
    if not results.changed or not results.changed.judged:
        return ranked
    changed = by_row(results.changed)
    worse = [key for key, own in changed.items() if verdict_of(own) == "worse"]
    place = {key: number for number, key in enumerate(worse)}
    return sorted(ranked, key=lambda r: place.get(r.key, len(place)))


def _strip(uris: list[str]) -> Image.Image:
    """Pictures, as data URIs of PNGs, side by side."""
    images = [
        Image.open(io.BytesIO(base64.b64decode(uri.partition(",")[2]))).convert("RGBA")
        for uri in uris
    ]
    width = sum(i.width for i in images) + APART * (len(images) - 1)
    # Grey, as around the maps of the page: white is what a map shows where nothing is wrong.
    strip = Image.new("RGBA", (width, max(i.height for i in images)), "#7d7f82")
    left = 0
    for image in images:
        strip.paste(image, (left, 0), image)
        left += image.width + APART
    return strip
