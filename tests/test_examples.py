"""The examples in Python are scripts of a gallery: they run, print, and end in a picture."""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
FIGURES = sorted(EXAMPLES.glob("paper/*/fig*.py"))
SCRIPTS = [*(set(EXAMPLES.rglob("*.py")) - set(EXAMPLES.rglob("paper/**/*.py")))]
SAVED = """
import runpy, sys
from matplotlib import pyplot
pyplot.switch_backend("Agg")
pyplot.show = lambda: pyplot.gcf().savefig(sys.argv[2])
runpy.run_path(sys.argv[1], run_name="__main__")
"""


@pytest.mark.parametrize("script", sorted(SCRIPTS), ids=lambda path: path.stem)
def test_example(script, tmp_path):
    figure = tmp_path / "figure.png"
    done = subprocess.run(
        [sys.executable, "-c", SAVED, str(script), str(figure)],
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(EXAMPLES), *sys.path])},
    )
    assert done.returncode == 0, done.stderr
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert done.stdout


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
