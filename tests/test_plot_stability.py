"""Root loci, charts of growth rates, bifurcation diagrams: what is drawn, not how it looks."""

from types import SimpleNamespace

import asperity as asp
import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")

import matplotlib.pyplot as plt
from asperity.plot import plot_bifurcation, plot_growth_chart, plot_root_locus
from drawn import drawn
from matplotlib.collections import LineCollection, QuadMesh
from matplotlib.contour import QuadContourSet

DAMPING = np.linspace(-0.5, 3.0, 71)
ROOTS = np.array([np.roots([1.0, d, 1.0]) for d in DAMPING])


def belt():
    """Something like a diagram: unstable for 2 and 3, a cycle there and at 1."""
    values = np.arange(6.0)
    cycle = np.isin(values, [1.0, 2.0, 3.0])
    return SimpleNamespace(
        parameter="speed",
        values=values,
        equilibria=np.column_stack([values, -values]),
        coordinate_names=["tip", "turn"],
        coordinate_units=["m", "rad"],
        kinds=["neutral", "neutral", "unstable", "unstable", "asymptotically stable", "none"],
        cycle_stable=cycle,
        branches=np.where(cycle, 0, -1),
        cycle_minima=np.where(cycle, values - 1.0, np.nan)[:, None] * [1.0, 2.0],
        cycle_maxima=np.where(cycle, values + 1.0, np.nan)[:, None] * [1.0, 2.0],
    )


@pytest.fixture(autouse=True)
def _close():
    plt.close("all")
    yield
    plt.close("all")


def points(lines):
    segments = np.array(lines.get_segments())
    return np.vstack([segments[:, 0], segments[-1:, 1]]) @ [1.0, 1.0j]


def test_branches_of_a_root_locus_are_continuous_whatever_the_order_of_the_eigenvalues():
    first, second = 1.0j + DAMPING * np.exp(1.0j), -1.0j + DAMPING * np.exp(-0.5j)
    # The branches swap places at random; they come as near to each other as 0.35.
    random = np.random.default_rng(3)
    shuffled = random.permuted(np.column_stack([first, second]), axis=1)
    artists = drawn(plot_root_locus, shuffled, values=DAMPING)
    found = [points(one) for one in artists if isinstance(one, LineCollection)]
    assert len(found) == 2
    found.sort(key=lambda branch: -branch[0].imag * np.sign(first[0].imag - second[0].imag))
    np.testing.assert_allclose(found, [first, second])


def test_growth_chart_draws_the_border_where_growth_begins():
    x, y = np.linspace(0.0, 1.0, 41), np.linspace(0.0, 1.0, 31)
    mesh, border = drawn(plot_growth_chart, x[:, None] - y, x=x, y=y)
    assert isinstance(mesh, QuadMesh)
    assert isinstance(border, QuadContourSet)
    low, high = mesh.get_clim()
    assert low == -high == -1.0
    assert len(drawn(plot_growth_chart, x[:, None] - y, x=x, y=y, border=False)) == 1
    assert drawn(plot_growth_chart, x[:, None] - y, x=x, y=y, limit=0.5)[0].get_clim() == (
        -0.5,
        0.5,
    )
    for path in border.get_paths():
        np.testing.assert_allclose(*path.vertices.T, atol=1e-5)


def test_bifurcation_shows_every_kind_of_equilibrium_once():
    filling, lower, upper, *equilibria = drawn(plot_bifurcation, belt(), coordinate=1)
    assert [line.get_label() for line in equilibria] == [
        "stable equilibrium",
        "neutral equilibrium",
        "unstable equilibrium",
    ]
    stable, neutral, unstable = (line.get_ydata() for line in equilibria)
    # Lines of different kinds touch at the first value of the next kind.
    np.testing.assert_allclose(stable, [np.nan, np.nan, np.nan, -3.0, -4.0, np.nan])
    np.testing.assert_allclose(neutral, [0.0, -1.0, *[np.nan] * 4])
    np.testing.assert_allclose(unstable, [np.nan, -1.0, -2.0, -3.0, np.nan, np.nan])
    np.testing.assert_allclose(lower.get_ydata(), [np.nan, 0.0, 2.0, 4.0, np.nan, np.nan])
    np.testing.assert_allclose(upper.get_ydata(), [np.nan, 4.0, 6.0, 8.0, np.nan, np.nan])
    assert filling.axes.get_xlabel() == "speed"


def test_lines_do_not_cross_from_one_branch_of_cycles_to_another():
    diagram = belt()
    # The cycle at 1 is alone on its branch; those at 2 and 3 lie on another one.
    diagram.cycle_stable = diagram.values == 1.0
    diagram.branches = np.array([-1, 0, 1, 1, -1, -1])
    filling, *lines = drawn(plot_bifurcation, diagram)[:5]
    paths = [path.get_extents().intervalx.tolist() for path in filling.get_paths()]
    assert [2.0, 3.0] in paths
    assert not any(low < 2.0 < high for low, high in paths)
    for line, own in ((lines[0], [1.0]), (lines[2], [2.0, 3.0])):
        there = np.isfinite(line.get_ydata())
        assert line.get_xdata()[there].tolist() == own
    assert (lines[0].get_marker(), lines[2].get_marker()) == (".", "None")


def nowhere():
    return asp.BifurcationDiagram("phi", [0.0], [None], [None], ["no system"])


@pytest.mark.parametrize(
    ("draw", "argument"),
    [
        (lambda: plot_root_locus(ROOTS, values=DAMPING[:-1]), "eigenvalues"),
        (lambda: plot_root_locus([[1.0, 2.0], [1.0]], values=[0.0, 1.0]), "eigenvalues"),
        (lambda: plot_root_locus([[np.nan], [1.0]], values=[0.0, 1.0]), "eigenvalues"),
        (lambda: plot_root_locus([[1.0]], values=[0.0]), "eigenvalues"),
        (lambda: plot_growth_chart([[1.0, 2.0]], x=[0.0, 1.0], y=[0.0]), "growth"),
        (lambda: plot_growth_chart([["x"]], x=[0.0], y=[0.0]), "growth"),
        (lambda: plot_growth_chart([[1.0]], x=[0.0], y=[0.0], tolerance=0.0), "tolerance"),
        (lambda: plot_growth_chart([[1.0]], x=[0.0], y=[0.0], limit=-1.0), "limit"),
        (lambda: plot_growth_chart([[1.0]], x=[np.nan], y=[0.0]), "x"),
        (lambda: plot_bifurcation(belt(), coordinate=2), "coordinate"),
        (lambda: plot_growth_chart([[]], x=[], y=[]), "x"),
        (lambda: plot_growth_chart([[]], x=[0.0], y=[]), "y"),
        (lambda: plot_growth_chart([[np.inf]], x=[0.0], y=[0.0]), "growth"),
        (lambda: plot_bifurcation("x"), "diagram"),
        (lambda: plot_bifurcation(nowhere()), "diagram"),
    ],
)
def test_what_cannot_be_drawn_is_named(draw, argument):
    with pytest.raises(asp.ParameterError) as raised:
        draw()
    assert raised.value.argument == argument
