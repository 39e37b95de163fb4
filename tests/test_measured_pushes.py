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
from scipy.optimize import minimize

VARIABLE = "ASPERITY_MEASUREMENTS"
EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
SCRIPT = EXAMPLES / "measurements" / "measured_pushes.py"
PLATE = EXAMPLES / "bodies" / "pushed_plate.py"
FOLDER = os.environ.get(VARIABLE)
needs_data = pytest.mark.skipif(
    FOLDER is None, reason=f"set {VARIABLE} to the folder of real_pushes.npz"
)


def run(monkeypatch, *arguments, script=SCRIPT):
    """Run the example and return its variables."""
    monkeypatch.setattr(sys, "argv", [str(script), *map(str, arguments)])
    plt.switch_backend("Agg")
    try:
        return runpy.run_path(str(script), run_name="__main__")
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


def test_a_pushed_body_moves_so_that_the_finger_spends_least(monkeypatch, capsys):
    """Among the motions with the same speed along the line: Σ μ N ‖v‖ is convex in them."""
    monkeypatch.delenv(VARIABLE, raising=False)
    push = run(monkeypatch, script=PLATE)["push"]
    assert "set ASPERITY_MEASUREMENTS" in capsys.readouterr().out
    rng = np.random.default_rng(0)
    for case in range(12):
        points, loads = rng.uniform(-0.06, 0.06, (3, 2)), rng.uniform(2.0, 8.0, 3)
        angle, lever = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(-0.05, 0.05)
        line = np.array([np.cos(angle), np.sin(angle), lever])
        free = np.linalg.svd(line[None])[2][1:]

        def power(amounts, line=line, free=free, points=points, loads=loads):
            vx, vy, omega = line / (line @ line) + amounts @ free
            speeds = np.hypot(vx - omega * points[:, 1], vy + omega * points[:, 0])
            return 0.3 * loads @ speeds

        exact = {"xatol": 1e-11, "fatol": 1e-12, "maxiter": 20000, "maxfev": 20000}
        least = min(
            minimize(power, size * rng.normal(size=2), method="Nelder-Mead", options=exact).fun
            for size in (0.1, 1.0, 10.0, 10.0)
        )
        velocities, force = push(points, loads, 0.3, line)
        assert abs(force / least - 1.0) < 1e-9, case
        assert line @ velocities > 0.0, case


@needs_data
def test_a_plate_moves_as_coulomb_says(monkeypatch):
    found = run(monkeypatch, script=PLATE)
    assert {board: len(pairs) for board, pairs in found["moves"].items()} == {
        "plate": 230,
        "wood": 150,
    }
    assert np.median(found["errors"]["plate"]) < 7.0
    assert np.median(found["errors"]["wood"]) < 9.0
    # Fits of these pushes find coefficients that are 5 to 7 % larger than the published ones.
    assert 1.0 < np.median(found["ratios"]["plate"]) < 1.15
    assert 1.0 < np.median(found["ratios"]["wood"]) < 1.15


def test_without_the_data_the_example_says_what_it_needs(monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    with pytest.raises(SystemExit, match="ASPERITY_MEASUREMENTS"):
        run(monkeypatch)
