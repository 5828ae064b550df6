"""A page in a real browser, as a script in it finds it."""

import json
import shutil
import subprocess

import pytest

from tests.reports.pages import Page

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")


def seen(page, checks, fragment=""):
    """What a script in a page reports on a narrow screen.

    Args:
        page: the file; it is changed.
        checks: JavaScript that fills the object `out`.
        fragment: of the address, with its #.
    """
    if CHROMIUM is None:
        pytest.skip("needs chromium or google-chrome")
    script = f"""{{const out = {{}}; {checks}
      document.body.innerHTML = ""; document.body.dataset.out = JSON.stringify(out);}}"""
    text = page.read_text(encoding="utf-8")
    page.write_text(text.replace("</body>", f"<script>{script}</script></body>"), encoding="utf-8")
    command = [
        CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
        "--disable-background-networking", "--force-prefers-reduced-motion",
        f"--user-data-dir={page.parent / 'profile'}", "--window-size=500,900",
        "--virtual-time-budget=5000", "--dump-dom", page.as_uri() + fragment,
    ]  # fmt: skip
    made = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    (body,) = [a for t, a in Page(made.stdout).elements if t == "body"]
    return json.loads(body["data-out"])
