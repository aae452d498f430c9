"""Pages in tests: their numbers, and the browser that opens them."""

import base64
import json
import re
import shutil

import numpy as np

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
# No sandbox, as in containers; no request of the browser's own.
ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-sync"]


def held(page):
    """The data in the file of a page."""
    return held_in(page.read_text(encoding="utf-8"))


def held_in(text):
    """The data in the text of a page."""
    return json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])


def numbers(packed):
    """An array of a page."""
    if "same" in packed:
        return np.full(packed["size"], packed["same"])
    ((kind, text),) = packed.items()
    return np.frombuffer(base64.b64decode(text), f"<{kind}").astype(float)


def assert_same(text, value):
    """The text of a page is a number to six digits."""
    assert float(text.replace("\N{MINUS SIGN}", "-")) == float(f"{value:.6g}")
