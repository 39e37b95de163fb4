"""What measured pushes say, by the example that reads them.

The data are not part of the project: `ASPERITY_MEASUREMENTS` names their folder.
"""

import os
import runpy
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

VARIABLE = "ASPERITY_MEASUREMENTS"
SCRIPT = Path(__file__).resolve().parents[1] / "examples" / "measurements" / "measured_pushes.py"
FOLDER = os.environ.get(VARIABLE)
needs_data = pytest.mark.skipif(
    FOLDER is None, reason=f"set {VARIABLE} to the folder of real_pushes.npz"
)


def run(monkeypatch, *arguments):
    """Run the example and return its variables."""
    monkeypatch.setattr(sys, "argv", [str(SCRIPT), *map(str, arguments)])
    plt.switch_backend("Agg")
    try:
        return runpy.run_path(str(SCRIPT), run_name="__main__")
    finally:
        plt.close("all")


def check_boards(boards):
    """Both boards are isotropic as far as the pushes tell, within the ranges of earlier fits."""
    plate, wood = boards["plate"], boards["wood"]
    assert 0.288 < plate.parameters["mu"].value < 0.306
    assert 0.343 < wood.parameters["mu"].value < 0.355
    assert not plate.anisotropic
    bics = {one.name: one.bic for one in plate.comparison.candidates}
    assert bics["isotropic"] < bics["ellipse in the ground"] - 5.0
    assert not wood.anisotropic
    for fit in (plate, wood):
        assert len(fit.pairs) == {0: 230, 1: 150}[fit is wood]
        assert (fit.pairs.wrench * fit.pairs.twist).sum(axis=1).min() > 0.0


@pytest.mark.long
@needs_data
def test_the_example_on_one_set(tmp_path, monkeypatch, capsys):
    found = run(monkeypatch, FOLDER, "--sets", 1, "--figure", tmp_path / "pushes.png")
    assert (tmp_path / "pushes.png").read_bytes().startswith(b"\x89PNG")
    assert "relative error of left-out wrenches" in capsys.readouterr().out
    check_boards(found["boards"])
    errors = dict(zip(found["MODELS"], found["errors"][0], strict=True))
    # The set is that of the butterfly on ABS, which is no ellipsoid.
    assert errors["5 points"] < 0.19 < 0.23 < errors["ellipsoids C and D"] < errors["ellipsoid"]


@pytest.mark.long
@needs_data
def test_errors_of_left_out_wrenches_over_all_sets(tmp_path, monkeypatch):
    found = run(monkeypatch, FOLDER, "--figure", tmp_path / "pushes.png")
    assert len(found["names"]) == 16
    mean = dict(zip(found["MODELS"], found["errors"].mean(axis=0), strict=True))
    assert mean["ellipsoid"] <= 0.255
    assert mean["ellipsoids C and D"] <= 0.248
    assert mean["5 points"] <= 0.232
    assert mean["5 points, elliptic"] <= 0.232
    (extended, points) = found["gains"].values()
    assert np.mean([one.value for one in extended]) > 0.0
    # What D gains is less than what the shape of C does, of an associated law.
    assert np.mean([one.value for one in points]) > 0.1


def test_without_the_data_the_example_says_what_it_needs(monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    with pytest.raises(SystemExit, match="ASPERITY_MEASUREMENTS"):
        run(monkeypatch)
