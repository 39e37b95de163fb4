"""The two simulations of the paper at the tolerances of the demo, and the redrawn figures."""

import csv

import asperity as asp
import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")

from asperity.paper import convexity, fig17, fig27, nonassociated, redraw, table1
from asperity.paper.checks import Check, table
from asperity.paper.data import write_csv
from asperity.paper.statements import (
    never_positive,
    proposition_1,
    proposition_2,
    propositions_3_and_4,
    truth,
    vanishes,
)


@pytest.fixture(scope="module")
def cycle():
    return fig17.run()


@pytest.fixture(scope="module")
def paths():
    return [fig27.run(dt) for dt in fig27.TIME_STEPS]


def assert_all_ok(checks):
    assert checks
    assert all(check.ok for check in checks), table(checks)


def test_fig17(cycle):
    assert_all_ok(fig17.checks(cycle, fig17.system()))


def test_fig17_is_periodic(cycle):
    motion = cycle.trajectory
    assert motion.t[-1] - motion.t[0] == pytest.approx(cycle.period, abs=2 * motion.dt)
    np.testing.assert_allclose(motion.q[-1], motion.q[0], atol=2e-3)


def test_higher_belt_speed_means_less_sticking(cycle):
    import asperity as asp

    fast = fig17.system(3.0)
    motion = asp.simulate(fast, dt=2e-3, t_end=300.0).slice(150.0, 300.0)
    assert fig17.measure(motion, float(fast.equilibrium[0])).stick_share < cycle.stick_share


def test_fig27_end_points_times_and_deflections(paths):
    checks = fig27.checks(paths[-1])
    assert len(checks) == 32
    assert_all_ok(checks)


def test_fig27_converges_with_first_order(paths):
    checks = fig27.convergence(paths)
    assert len(checks) == 6
    assert_all_ok(checks)


def test_expected_deflections_follow_from_the_expected_end_points():
    for (_, angle), (x, y, _, deflection) in fig27.EXPECTED.items():
        direction = np.deg2rad(angle)
        lateral = abs(y * np.cos(direction) - x * np.sin(direction))
        assert lateral == pytest.approx(deflection, abs=2e-4)


def test_table1_is_per_unit_normal_force():
    radius = table1.SUPERELLIPSE_C.radius(0.0) * table1.NORMAL_FORCE
    assert radius == pytest.approx(4.99)
    assert len(table1.laws()) == 4


def test_a_wrong_number_is_off():
    assert not Check("period", 28.703, 28.6, 0.02).ok
    assert not Check("period", 28.703, float("nan"), 0.02).ok
    assert "OFF" in table([Check("period", 28.703, 28.6, 0.02)])


@pytest.fixture(scope="module")
def redrawn():
    drawn = {number: draw() for number, draw in redraw.FIGURES.items()}
    yield drawn
    mpl.pyplot.close("all")


@pytest.mark.parametrize("number", redraw.FIGURES)
def test_statements_of_a_redrawn_figure_hold(redrawn, number):
    drawn = redrawn[number]
    assert_all_ok(drawn.checks)
    names = [check.quantity for check in drawn.checks]
    assert len(set(names)) == len(names)
    assert all(name.startswith(f"Fig. {number}") for name in names)


@pytest.mark.parametrize("number", redraw.FIGURES)
def test_data_of_a_redrawn_figure_are_what_is_drawn(redrawn, number, tmp_path):
    drawn = redrawn[number]
    columns = drawn.curves.columns()
    write_csv(tmp_path / "data.csv", columns)
    with (tmp_path / "data.csv").open(newline="") as file:
        header, *rows = csv.reader(file)
    assert header == ["panel", "curve", "x", "y"]
    values = np.array([row[2:] for row in rows], dtype=float)
    np.testing.assert_array_equal(values.T, [columns["x"], columns["y"]])
    seen = {point for ax in drawn.figure.axes for point in _drawn_points(ax)}
    for curve in ("boundary", "bdry C", "bdry D", "path [m]"):
        chosen = values[[row[1] == curve for row in rows]]
        assert {tuple(point) for point in chosen} <= seen


def _drawn_points(ax):
    return {
        tuple(point) for line in ax.lines for point in np.transpose(line.get_data(orig=True)[:2])
    }


@pytest.mark.parametrize(
    ("number", "panel"),
    [(5, "b"), (8, "b"), (10, "b"), (11, "a"), (11, "b"), (12, "a"), (12, "b"), (12, "c")],
)
def test_forces_among_the_data_lie_on_the_boundary_among_them(redrawn, number, panel):
    """A polygon through the boundary's points has gauge 1 at the forces, up to its chords."""
    columns = redrawn[number].curves.columns()
    points = np.stack([columns["x"], columns["y"]], axis=-1)
    labels = np.stack([columns["panel"], columns["curve"]], axis=-1)
    outline = points[(labels == [panel, "bdry C"]).all(axis=1)]
    forces = points[(labels == [panel, "force"]).all(axis=1)]
    assert len(forces) >= 16
    np.testing.assert_allclose(asp.Polygon(outline[:-1]).gauge(forces), 1.0, atol=2e-4)


def test_statements_fail_on_laws_they_do_not_hold_for():
    convex = asp.Ellipse(0.6, 0.3)
    associated, collinear = asp.FrictionLaw.associated(convex), asp.FrictionLaw.collinear(convex)
    assert not all(check.ok for check in proposition_1("wrong", collinear))
    assert not all(check.ok for check in proposition_2("wrong", collinear, [associated]))
    assert not all(check.ok for check in propositions_3_and_4("wrong", collinear, [associated]))
    assert not truth("wrong", False).ok
    assert not vanishes("wrong", np.array([0.0, -1.0]), 0.5).ok
    assert not never_positive("wrong", np.array([-2.0, 1.0]), 0.5).ok
    for nothing in (np.nan, np.array([0.0, np.nan])):
        assert not vanishes("wrong", nothing, 1.0).ok
        assert not never_positive("wrong", nothing, 1.0).ok


@pytest.mark.parametrize(
    ("text", "expected"),
    [("3", [3]), ("1-4,7", [1, 2, 3, 4, 7]), (" 12 , 10-11", [10, 11, 12]), ("8-10", [8, 9, 10])],
)
def test_numbers_of_figures(text, expected):
    assert redraw.numbers(text) == expected


@pytest.mark.parametrize(
    "text", ["", "1,,2", "a", "1-2-3", "-3", "4-1", "0", "13", "1-99999999", "¹"]
)
def test_unknown_numbers_of_figures_are_refused(text):
    with pytest.raises(asp.ParameterError, match="only: must"):
        redraw.numbers(text)


def test_numbers_of_figures_computed_elsewhere_say_so():
    with pytest.raises(asp.ParameterError, match=r"asperity demo computes Fig\. 17"):
        redraw.numbers("17")


def test_only_the_sketch_of_springs_is_left_out():
    assert sorted([*redraw.FIGURES, *redraw.LEFT_OUT]) == list(range(1, 13))
    assert redraw.left_out([8, 9, 10]) == [
        "Fig. 9, a sketch of a spring on an inclined plane, is not redrawn"
    ]


def test_the_outline_of_fig1c_overhangs():
    outline = convexity.hooked()
    angle = np.unwrap(np.arctan2(outline[:, 1], outline[:, 0]))
    turned = np.diff(angle)
    assert turned.min() < -1e-3
    assert angle[-1] - angle[0] == pytest.approx(2.0 * np.pi, abs=0.05)


def test_flanks_are_inclined_planes():
    """A block pushed up, down and along the level of an inclined plane with friction."""
    mu, beta = nonassociated.MU, float(nonassociated.BETA)
    sine, cosine = np.sin(beta), np.cos(beta)
    up, level, down = nonassociated._flank(np.array([0.0, 0.5, 1.0]) * np.pi, beta)
    np.testing.assert_allclose(up, [(sine + mu * cosine) / (cosine - mu * sine), 0.0], atol=1e-12)
    np.testing.assert_allclose(level, [sine / cosine, mu / cosine], atol=1e-12)
    np.testing.assert_allclose(down, [(sine - mu * cosine) / (cosine + mu * sine), 0.0], atol=1e-12)
