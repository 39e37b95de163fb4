"""Every example in the documentation runs."""

import ast
import doctest
import importlib
import pkgutil
import re
from pathlib import Path

import asperity as asp
import pytest
import words
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
# Libraries without which a page is left out.
NEEDS = {"pinocchio.md": ["pinocchio", "coal"]}
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


@pytest.mark.parametrize("folder", sorted({name.split(".")[1] for name in MODULES[1:]}))
def test_docstring_examples(folder):
    for name in MODULES:
        if name.split(".")[1:2] == [folder]:
            failed, _ = doctest.testmod(importlib.import_module(name))
            assert failed == 0, name


def test_every_public_name_is_documented():
    for name, one in public_of(asp).items():
        assert name == "__version__" or (one.__doc__ or "").strip(), name


def test_pages_import_what_they_use():
    for page in PAGES:
        nodes = [*ast.walk(ast.parse("\n".join(BLOCK.findall(page.read_text(encoding="utf-8")))))]
        imports = [node for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)]
        given = {one.asname or one.name for node in imports for one in node.names}
        assert given <= {node.id for node in nodes if isinstance(node, ast.Name)}, page


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages(page, tmp_path, monkeypatch):
    for library in NEEDS.get(page.name, []):
        pytest.importorskip(library)
    monkeypatch.chdir(tmp_path)
    run_page(page)


def test_every_page_is_in_a_list_of_the_site():
    lists = "\n".join(path.read_text(encoding="utf-8") for path in FOLDERS[1].glob("*.md"))
    pages = [path.relative_to(ROOT).with_suffix("").as_posix() for path in FOLDERS[0].rglob("*.md")]
    assert [page for page in pages if f"{page}\n" not in lists] == []


def test_no_docstring_names_what_is_not_public():
    found = []
    for path, text in words.PACKAGE.docstrings():
        named = re.findall(r"(?<!`)`([^`]+)`(?!`)", text)
        found += [f"{path}: {word}" for word in named if words.PACKAGE.dangles(word)]
    assert not found
