"""The examples in Python are scripts of a gallery: they run, print, and end in a picture."""

import ast
import re
import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
FIGURES = sorted(EXAMPLES.glob("paper/*/fig*.py"))
SCRIPTS = [*(set(EXAMPLES.rglob("*.py")) - set(EXAMPLES.rglob("paper/**/*.py")))]
# They take data that are no part of the project: tests/test_measured_pushes.py runs them.
ON_DATA = set(EXAMPLES.rglob("measurements/*.py")) - set(EXAMPLES.rglob("paper/**/*.py"))
CHARTS = EXAMPLES / "charts"
LINES = 40
SIZE = re.compile(r"^(SIZE\b.*? = )\d+", re.MULTILINE)


@pytest.mark.parametrize("script", sorted(set(SCRIPTS) - ON_DATA), ids=lambda path: path.stem)
def test_example(script, tmp_path, monkeypatch, capsys):
    figure = tmp_path / "figure.png"
    monkeypatch.setattr(plt, "show", lambda: plt.gcf().savefig(figure))
    plt.switch_backend("Agg")
    if script.parent == CHARTS:
        # Charts take thousands of runs; a few show that the script works.
        script = shortened(script, tmp_path)
    try:
        runpy.run_path(str(script), run_name="__main__")
    finally:
        plt.close("all")
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert capsys.readouterr().out


def shortened(script, folder):
    """Return a chart with hardly any points."""
    text, found = SIZE.subn(r"\g<1>8", script.read_text())
    assert found == 1
    short = folder / script.name
    short.write_text(text)
    return short


@pytest.mark.parametrize("script", sorted(CHARTS.glob("*.py")), ids=lambda path: path.stem)
def test_charts_are_short(script):
    assert len(script.read_text().splitlines()) <= LINES


@pytest.mark.parametrize("script", [*sorted(SCRIPTS), *FIGURES], ids=lambda path: path.stem)
def test_examples_are_scripts_of_a_gallery(script):
    """A title, a question, and cells; every room has a header."""
    text = script.read_text()
    title, line, _, *rest = ast.get_docstring(ast.parse(text)).splitlines()
    assert set(line) == {"="}
    assert len(line) >= len(title)
    assert "?" in " ".join(rest)
    assert re.search(r"^# %%$", text, re.MULTILINE)
    assert (script.parent / "GALLERY_HEADER.rst").exists()


def test_rooms_have_headers():
    rooms = {path.parent for path in [*SCRIPTS, *FIGURES]} | {EXAMPLES, EXAMPLES / "paper"}
    for room in rooms:
        title, line, *_ = (room / "GALLERY_HEADER.rst").read_text().splitlines()
        assert len(line) >= len(title)
