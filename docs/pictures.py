"""Makes the pictures of these pages from the report of `make compare`; needs Chromium.

Usage: .venv/bin/python docs/pictures.py [reports/out/report.html]
"""

import shutil
import sys
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

HERE = Path(__file__).parent
SETTLED = 1500  # milliseconds until the viewers have drawn
VIEWS = {"viewer": "slide", "maps": "blocks"}


def main(report: Path) -> None:
    """Write report.png, viewer.png, maps.png and weights.png beside this file."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium") or shutil.which("google-chrome"),
            args=["--no-sandbox"],
        )
        page = browser.new_page(viewport={"width": 1280, "height": 960})
        page.goto(report.resolve().as_uri())
        page.wait_for_timeout(SETTLED)
        page.screenshot(path=HERE / "report.png")
        for name, view in VIEWS.items():
            _viewer(page, name, view)
        page.locator("section.weights").screenshot(path=HERE / "weights.png")
        browser.close()


def _viewer(page: Page, name: str, view: str) -> None:
    """The first case's viewer in a view, with the pixel probe on an object."""
    viewer = page.locator(".viewer").first
    viewer.locator(f"input[value={view}]").check(force=True)
    stage = viewer.locator(".stage")
    box = stage.bounding_box()
    stage.click(position={"x": 0.2 * box["width"], "y": 0.55 * box["height"]})
    page.wait_for_timeout(SETTLED)
    viewer.screenshot(path=HERE / f"{name}.png")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else HERE.parent / "reports/out/report.html"))
