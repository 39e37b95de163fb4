"""The examples in Python are scripts of a gallery: they run, print, and end in a picture."""

import contextlib
import io
import re
import runpy
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
# Those of measurements take data that are not included: tests/test_measured_pushes.py runs them.
ELSEWHERE = {*EXAMPLES.rglob("paper/**/*.py"), *EXAMPLES.rglob("measurements/*.py")}
GALLERY = sorted({*EXAMPLES.rglob("*.py")} - ELSEWHERE)
CHARTS = EXAMPLES / "charts"
SIZE = re.compile(r"^(SIZE\b.*? = )\d+", re.MULTILINE)


# Libraries of extras, without which a script is left out.
NEEDS = {
    "errors": ["xarray", "zarr"],
    "film_of_a_disk": ["av", "PIL"],
    "conveyor_in_mujoco": ["mujoco"],
    "skid_steer": ["mujoco"],
    "sweep_over_a_grid": ["xarray", "zarr"],
}


@pytest.mark.parametrize("script", GALLERY, ids=lambda path: path.stem)
def test_example(script):
    for library in NEEDS.get(script.stem, []):
        pytest.importorskip(library)
    text = script.read_text()
    # Charts take thousands of runs; a few show that the script works.
    text, found = SIZE.subn(r"\g<1>8", text)
    assert found or script.parent != CHARTS
    pictures, printed = [], io.StringIO()
    show, plt.show = plt.show, lambda: pictures.append(plt.gcf())
    plt.switch_backend("Agg")
    try:
        with tempfile.TemporaryDirectory() as folder:
            short, file = Path(folder) / script.name, io.BytesIO()
            short.write_text(text)
            with contextlib.redirect_stdout(printed):
                runpy.run_path(str(short), run_name="__main__")
            (picture,) = pictures
            picture.savefig(file)
    finally:
        plt.show = show
        plt.close("all")
    assert file.getvalue().startswith(b"\x89PNG")
    assert printed.getvalue()
