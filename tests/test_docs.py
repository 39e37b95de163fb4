"""Every example in the documentation runs."""

import ast
import doctest
import importlib
import pkgutil
import re
from pathlib import Path

import asperity as asp
import pytest
from pages import BLOCK, run_page
from samples import public_of

ROOT = Path(__file__).resolve().parents[1]
MODULES = [
    "asperity",
    *sorted(
        module.name
        for module in pkgutil.walk_packages(asp.__path__, "asperity.")
        if module.name not in ("asperity.__main__", "asperity._core")
    ),
]
FOLDERS = (ROOT / "docs", ROOT / "site" / "pages")
PAGES = sorted([ROOT / "README.md", *(page for one in FOLDERS for page in one.rglob("*.md"))])
SOURCES = sorted([*PAGES, *(ROOT / "python" / "asperity").rglob("*.py")])


def _avoided():
    """Return the phrases that CONTRIBUTING lists as ones to avoid."""
    table = (ROOT / "CONTRIBUTING.md").read_text().split("| write | not |\n|---|---|\n")[1]
    rows = table[: table.index("\n\n")].splitlines()
    return [phrase.strip() for row in rows for phrase in row.split("|")[2].split(",")]


def test_preferred_terms():
    avoided = _avoided()
    assert len(avoided) > 5
    found = [
        f"{path.relative_to(ROOT)}: {phrase}"
        for path in SOURCES
        for phrase in avoided
        if re.search(rf"\b{phrase}\b", " ".join(path.read_text().split()), re.IGNORECASE)
    ]
    assert not found


@pytest.mark.parametrize("name", MODULES)
def test_docstring_examples(name):
    failed, _ = doctest.testmod(importlib.import_module(name))
    assert failed == 0


def test_every_public_name_is_documented():
    for name, one in public_of(asp).items():
        assert name == "__version__" or (one.__doc__ or "").strip(), name


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages_import_what_they_use(page):
    nodes = [*ast.walk(ast.parse("\n".join(BLOCK.findall(page.read_text(encoding="utf-8")))))]
    imports = [node for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)]
    given = {one.asname or one.name for node in imports for one in node.names}
    assert given <= {node.id for node in nodes if isinstance(node, ast.Name)}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run_page(page)
