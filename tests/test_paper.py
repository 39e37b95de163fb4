"""The two simulations of the paper at the tolerances of the demo, and the redrawn figures."""

import csv
import dataclasses
import functools

import asperity as asp
import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")

from asperity.commands.options import table
from asperity.demo import Check, belt, sliding
from paper.__main__ import FIGURES, main, redraw
from paper.curves import write_curves


@pytest.fixture(scope="module")
def cycle():
    return belt.run()


@pytest.fixture(scope="module")
def paths():
    return [sliding.run(dt) for dt in sliding.TIME_STEPS]


def assert_all_ok(checks):
    assert checks
    assert all(check.ok for check in checks), table(checks)


def test_fig17(cycle):
    assert_all_ok(belt.checks(cycle))


def test_fig27_end_points_times_and_deflections(paths):
    checks = sliding.checks(paths[-1])
    assert len(checks) == 32
    assert_all_ok(checks)


def test_fig27_converges_with_first_order(paths):
    checks = sliding.convergence(paths)
    assert len(checks) == 6
    assert_all_ok(checks)


# Those of laws are drawn in a moment; `make figures` and the long profile draw all.
NUMBERS = [n if n < 13 else pytest.param(n, marks=pytest.mark.long) for n in FIGURES]


@pytest.fixture(scope="module")
def redrawn():
    with mpl.rc_context({"figure.max_open_warning": 0}):
        yield functools.cache(redraw)
    mpl.pyplot.close("all")


@pytest.mark.parametrize("number", NUMBERS)
def test_statements_of_a_redrawn_figure_hold(redrawn, number):
    drawn = redrawn(number)
    assert_all_ok(drawn.checks)
    names = [check.quantity for check in drawn.checks]
    assert len(set(names)) == len(names)
    assert all(name.startswith(f"Fig. {number}") for name in names)


SCHEMATIC = {(4, "a"), (6, "a"), (10, "a"), (14, "a"), (14, "b")}
SCHEMATIC |= {(13, panel) for panel in "abcd"} | {(18, "a"), (22, "a")}
"""Panels that show nothing computed."""

FILLED = {"gauge", "contour of no growth", "eigenvalues", "orbit"}
"""Curves that bound a filling or have changing colours; neither lines nor arrows."""


def drawn_in(ax):
    """Points of all lines, and tails with vectors of all arrows, in the coordinates of the axes."""
    lines = [line for line in ax.lines if line.get_transform() == ax.transData]
    data = [line.get_data_3d() if ax.name == "3d" else line.get_data(orig=True) for line in lines]
    quivers = [one for one in ax.collections if isinstance(one, mpl.quiver.Quiver)]
    arrows = [np.column_stack([one.XY, one.U, one.V]) for one in quivers]
    return (
        {
            tuple(point)
            for line in data
            for point in np.transpose(line).tolist()
            if np.isfinite(point).all()
        },
        {tuple(arrow) for several in arrows for arrow in several.tolist()},
    )


def tabulated(path):
    """Header of a table, and points and arrows by panel and curve."""
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    found = {}
    for panel, curve, *row in rows:
        numbers = tuple(float(cell) for cell in row if cell)
        kind = "arrows" if row[-1] else "points"
        found.setdefault((panel, kind), {}).setdefault(curve, set()).add(numbers)
    return header, found


@pytest.mark.parametrize("number", NUMBERS)
def test_data_of_a_redrawn_figure_are_what_is_drawn(redrawn, number, tmp_path):
    """Every point of a line and every arrow is in the file, and nothing else is."""
    figure, curves = redrawn(number).figure, redrawn(number).curves
    write_curves(tmp_path / "data.csv", curves)
    header, found = tabulated(tmp_path / "data.csv")
    assert header == ["panel", "curve", "x", "y", *(["z"] if number == 2 else []), "dx", "dy"]
    titled = {ax.get_title("left") or ax.get_title(): ax for ax in figure.axes}
    # Bars of colours have no title.
    panels = {title[1]: ax for title, ax in titled.items() if title}
    computed = {panel for panel in panels if (number, panel) not in SCHEMATIC}
    assert {panel for panel, _ in found} == computed
    for panel in computed:
        points, arrows = drawn_in(panels[panel])
        lines = {
            name: rows
            for name, rows in found.get((panel, "points"), {}).items()
            if name.split(" at ")[0] not in FILLED
        }
        assert set().union(*lines.values()) == points
        assert set().union(*found.get((panel, "arrows"), {}).values()) == arrows


@pytest.mark.parametrize("number", NUMBERS)
def test_a_redrawn_figure_says_where_its_parameters_come_from(redrawn, number):
    heading, caption = redrawn(number).figure.texts
    assert heading.get_text().startswith(f"Fig. {number} ")
    given = {10: "parameters of the paper"} | dict.fromkeys((15, 16, 17), "parameters of §4.3")
    given |= {18: "synthetic data: virtual camera", 19: "synthetic: simulated disk"}
    given |= {20: "not to scale", 21: "not to scale", 22: "synthetic: invented law"}
    given |= dict.fromkeys((23, 24, 25, 26, 27), "synthetic data: virtual tribometer")
    assert caption.get_text().startswith(given.get(number, "own parameters"))


FORCES = {"5b": 12, "6b": 12, "7b": 20, "8a": 16, "8b": 16, "10b": 32, "11a": 4, "11b": 4}
FORCES |= {"12a": 20, "12b": 20, "12c": 8}
"""How many forces the figures of laws show."""


@pytest.mark.parametrize(("name", "count"), FORCES.items())
def test_data_hold_forces_on_the_boundary_with_their_sliding_directions(redrawn, name, count):
    """A polygon through the boundary's points has gauge 1 at the forces, up to its chords."""
    number, panel = int(name[:-1]), name[-1]

    def data(curve):
        curve = f"T {curve}" if name == "8a" else curve
        return np.vstack([rows for *at, rows in redrawn(number).curves if at == [panel, curve]])

    forces = data("force")
    forces = forces if forces.shape[1] == 2 else forces[:, 2:]
    assert len(forces) == count
    outline = data("bdry C")[:-1]
    # One chord of a rectangle's outline cuts off each corner.
    chords = 3e-3 if name == "6b" else 2e-4
    np.testing.assert_allclose(asp.Polygon(outline).gauge(forces), 1.0, atol=chords)
    slips = data("sliding direction")
    assert {tuple(tail) for tail in slips[:, :2]} == {tuple(force) for force in forces}
    assert (slips[:, :2] * slips[:, 2:]).sum(axis=1).min() > 0.0


def test_all_figures_but_the_sketch_of_springs_are_drawn():
    assert list(FIGURES) == [number for number in range(1, 28) if number != 9]


def test_figures_are_written_with_data_and_checks(tmp_path, capsys):
    assert main(["6", "8", "--out", str(tmp_path / "new")]) == 0
    names = sorted(file.name for file in (tmp_path / "new").iterdir())
    assert names == ["fig06.csv", "fig06.png", "fig08.csv", "fig08.png"]
    assert (tmp_path / "new" / "fig06.png").read_bytes().startswith(b"\x89PNG")
    shown = capsys.readouterr().out
    assert "Fig. 8 (42)" in shown
    assert " 0 off" in shown


def test_a_statement_that_is_off_exits_with_1(tmp_path, monkeypatch, capsys):
    drawn = redraw(6)
    wrong = dataclasses.replace(drawn, checks=[Check("wrong", 1.0, 0.0, 0.0)])
    monkeypatch.setattr("paper.laws.fig06.draw", lambda: wrong)
    assert main(["6", "--out", str(tmp_path)]) == 1
    assert "1 checks, 1 off" in capsys.readouterr().out
