"""The two simulations of the paper at the tolerances of the demo, and the redrawn figures."""

import csv

import asperity as asp
import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")

from asperity._base.tables import write_columns
from asperity.paper import convexity, fig17, fig27, nonassociated, redraw, table1
from asperity.paper.checks import Check, table
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
    with mpl.rc_context({"figure.max_open_warning": 0}):
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


SCHEMATIC = {(4, "a"), (6, "a"), (10, "a"), (14, "a"), (14, "b")}
SCHEMATIC |= {(13, panel) for panel in "abcd"} | {(18, "a"), (22, "a")}
"""Panels that show nothing computed."""

FILLED = {"gauge", "edge of the half-plane", "contour of no growth", "eigenvalues", "orbit"}
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


@pytest.mark.parametrize("number", redraw.FIGURES)
def test_data_of_a_redrawn_figure_are_what_is_drawn(redrawn, number, tmp_path):
    """Every point of a line and every arrow is in the file, and nothing else is."""
    figure, curves = redrawn[number].figure, redrawn[number].curves
    write_columns(tmp_path / "data.csv", curves.columns())
    header, found = tabulated(tmp_path / "data.csv")
    assert header == ["panel", "curve", "x", "y", *(["z"] if number == 2 else []), "dx", "dy"]
    titled = {ax.get_title("left") or ax.get_title(): ax for ax in figure.axes}
    # Bars of colours have no title.
    panels = {title[1]: ax for title, ax in titled.items() if title}
    computed = {panel for panel in panels if (number, panel) not in SCHEMATIC}
    # The sketches of Figs. 20 and 21 have no panels; their tables hold what is labelled.
    assert {panel for panel, _ in found} == ({"a"} if number in (20, 21) else computed)
    for panel in computed:
        points, arrows = drawn_in(panels[panel])
        lines = {
            name: rows
            for name, rows in found.get((panel, "points"), {}).items()
            if name.split(" at ")[0] not in FILLED
        }
        assert set().union(*lines.values()) == points
        assert set().union(*found.get((panel, "arrows"), {}).values()) == arrows


@pytest.mark.parametrize("number", redraw.FIGURES)
def test_a_redrawn_figure_says_where_its_parameters_come_from(redrawn, number):
    heading, caption = redrawn[number].figure.texts
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
    columns = redrawn[number].curves.columns()
    rows = list(zip(*columns.values(), strict=True))

    def rows_of(curve):
        prefix = "T " if name == "8a" else ""
        return np.array([row[2:] for row in rows if row[:2] == (panel, prefix + curve)], float)

    forces = rows_of("force")
    forces = forces[:, :2] if np.isnan(forces[:, 2:]).all() else forces[:, 2:]
    assert len(forces) == count
    outline = rows_of("bdry C")[:-1, :2]
    # One chord of a rectangle's outline cuts off each corner.
    chords = 3e-3 if name == "6b" else 2e-4
    np.testing.assert_allclose(asp.Polygon(outline).gauge(forces), 1.0, atol=chords)
    slips = rows_of("sliding direction")
    assert {tuple(tail) for tail in slips[:, :2]} == {tuple(force) for force in forces}
    assert (slips[:, :2] * slips[:, 2:]).sum(axis=1).min() > 0.0


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
    "text", ["", "1,,2", "a", "1-2-3", "-3", "4-1", "0", "28", "1-99999999", "¹"]
)
def test_unknown_numbers_of_figures_are_refused(text):
    with pytest.raises(asp.ParameterError, match="only: must"):
        redraw.numbers(text)


def test_only_the_sketch_of_springs_is_left_out():
    assert sorted([*redraw.FIGURES, *redraw.LEFT_OUT]) == list(range(1, 28))
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
