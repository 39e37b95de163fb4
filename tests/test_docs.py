"""Every example in the documentation runs."""

import doctest
import importlib
import pkgutil
import re
from pathlib import Path

import asperity as asp
import pytest

ROOT = Path(__file__).resolve().parents[1]
MODULES = [
    "asperity",
    *sorted(
        module.name
        for module in pkgutil.walk_packages(asp.__path__, "asperity.")
        if module.name not in ("asperity.__main__", "asperity._core")
    ),
]
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
BLOCK = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("name", MODULES)
def test_docstring_examples(name):
    failed, _ = doctest.testmod(importlib.import_module(name))
    assert failed == 0


@pytest.mark.parametrize("name", asp.__all__)
def test_every_public_name_is_documented(name):
    if name != "__version__":
        assert (getattr(asp, name).__doc__ or "").strip()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    namespace = {"__name__": "__main__"}
    text = page.read_text()
    for block in BLOCK.finditer(text):
        line = text[: block.start()].count("\n") + 1
        # Blank lines keep the line numbers of a failure those of the page.
        exec(compile("\n" * line + block[1], str(page), "exec"), namespace)
