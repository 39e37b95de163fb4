"""Plots: what is drawn, not how it looks."""

import asperity as asp
import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")

from asperity.plot import (
    look,
    plot_cones,
    plot_deflection,
    plot_forces_in_reservoir,
    plot_friction_coefficient,
    plot_gauge,
    plot_law,
    plot_path,
    plot_phase,
    plot_projection,
    plot_set,
    save_figure,
)
from asperity.runs.event_driven import integrate
from matplotlib.artist import Artist
from matplotlib.patches import Polygon
from matplotlib.quiver import Quiver

LAW = asp.FrictionLaw(asp.Ellipse(0.6, 0.2, angle=0.3), asp.Ellipse(3.0, 1.0))
RECTANGLE = asp.Rectangle(2.0, 1.0)
CROSS = asp.Rectangle(2.0, 0.5) | asp.Rectangle(0.5, 2.0)
DEGREES = np.linspace(0.0, 360.0, 721)


@pytest.fixture(scope="module")
def motion():
    belt = asp.MassOnBelt(1.0, 1.0, LAW, 1.0, [0.1, 0.05])
    return asp.simulate(belt, dt=1e-2, t_end=20.0)


@pytest.fixture(autouse=True)
def _close():
    import matplotlib.pyplot as plt

    plt.close("all")
    yield
    plt.close("all")


def e(angle):
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def lines_with(artists, marker):
    return [
        one for one in artists if isinstance(one, mpl.lines.Line2D) and one.get_marker() == marker
    ]


def arrows_of(artists):
    """Tails and vectors of all arrows."""
    quivers = [one for one in artists if isinstance(one, Quiver)]
    tails = np.vstack([quiver.get_offsets() for quiver in quivers])
    return tails, np.vstack([np.stack([quiver.U, quiver.V], axis=-1) for quiver in quivers])


PLOTS = {
    "set": lambda ax, motion: plot_set(RECTANGLE, ax),
    "cones": lambda ax, motion: plot_cones(RECTANGLE, [2.0, 1.0], ax),
    "projection": lambda ax, motion: plot_projection(RECTANGLE, [3.0, 0.0], ax),
    "law": lambda ax, motion: plot_law(LAW, ax),
    "coefficient": lambda ax, motion: plot_friction_coefficient(LAW, ax),
    "deflection": lambda ax, motion: plot_deflection(LAW, ax),
    "path": lambda ax, motion: plot_path(motion, ax),
    "phase": lambda ax, motion: plot_phase(motion, ax),
    "forces": lambda ax, motion: plot_forces_in_reservoir(motion, LAW, ax),
}


@pytest.mark.parametrize("plot", PLOTS.values(), ids=PLOTS)
def test_every_plot_returns_the_artists_it_drew_into_the_axes_given(plot, motion):
    import matplotlib.pyplot as plt

    _, ax = plt.subplots()
    artists = plot(ax, motion)
    assert isinstance(artists, list)
    assert artists
    assert all(isinstance(one, Artist) and one.axes is ax for one in artists)
    assert len(plot(None, motion)) == len(artists)
    assert len(plt.get_fignums()) == 2


@pytest.mark.parametrize("plot", ["path", "phase", "forces"])
def test_motions_are_drawn_as_trajectories_are(plot, motion):
    belt = asp.MassOnBelt(1.0, 1.0, LAW, 1.0, [0.1, 0.05])
    exact = integrate(belt, t_end=20.0, dt=1e-2)
    drawn, stepped = PLOTS[plot](None, exact), PLOTS[plot](None, motion)
    assert [type(one) for one in drawn] == [type(one) for one in stepped]
    limits = [one[0].axes.dataLim.get_points() for one in (drawn, stepped)]
    np.testing.assert_allclose(*limits, atol=5e-3)


def test_set_outline_lies_on_the_boundary():
    star = asp.Superellipse(2.0, 1.0, 0.5)
    outline, filling = plot_set(star, label="C")
    x, y = outline.get_data()
    np.testing.assert_allclose(star.gauge(np.stack([x, y], -1)), 1.0, rtol=1e-12)
    assert (x[0], y[0]) == (x[-1], y[-1])
    assert outline.get_label() == "C"
    assert filling.axes.get_aspect() == 1.0


@pytest.mark.parametrize(
    ("star", "point"),
    [
        (RECTANGLE, [2.0, 1.0]),
        (RECTANGLE, [-2.0, 0.3]),
        (asp.Ellipse(2.0, 1.0, angle=0.4), None),
        (asp.Superellipse(2.0, 1.0, 0.5), None),
        (asp.Superellipse(2.0, 1.0, 1.0), [0.0, -1.0]),
        (CROSS, [0.5, 0.5]),
        (CROSS, [0.5, 2.0]),
        (CROSS, [0.1, 0.3]),
    ],
    ids=repr,
)
def test_tangent_sectors_hold_the_directions_that_lead_into_the_set(star, point):
    x = float(star.radius(1.0)) * e(1.0) if point is None else np.array(point)
    sectors = [
        one for one in plot_cones(star, x, normal=False, size=0.7) if isinstance(one, Polygon)
    ]
    angle = 2.0 * np.pi * (np.arange(720) + 0.5) / 720
    within = np.any(
        [sector.get_path().contains_points(x + 0.3 * e(angle)) for sector in sectors], 0
    )
    into = star.contains(x + 1e-5 * e(angle), tolerance=0.0)
    # Directions next to an edge of the cone may go either way on a curved boundary.
    assert np.count_nonzero(within != into) <= 4
    reach = [np.linalg.norm(sector.get_xy() - x, axis=1).max() for sector in sectors]
    np.testing.assert_allclose(reach, 0.7)


def test_parts_of_a_tangent_cone_have_no_edge_between_them():
    point, *others = plot_cones(CROSS, [0.5, 0.5], normal=False, size=0.3)
    edges = [one.get_xydata() for one in others if isinstance(one, mpl.lines.Line2D)]
    np.testing.assert_allclose(point.get_xydata(), [[0.5, 0.5]])
    ends = {tuple(end.round(9)) for start, end in edges if (start == 0.5).all()}
    assert ends == {(0.8, 0.5), (0.5, 0.8)}


def test_normal_arrows_are_the_generators_of_the_normal_cone():
    tails, vectors = arrows_of(plot_cones(RECTANGLE, [2.0, -1.0], tangent=False, size=0.5))
    np.testing.assert_allclose(tails, [[2.0, -1.0]] * 2)
    assert {tuple(vector) for vector in vectors.round(12)} == {(0.5, 0.0), (0.0, -0.5)}


def test_cones_in_the_interior_are_the_plane_and_the_origin():
    _, plane = plot_cones(RECTANGLE, [0.5, 0.5], size=1.0)
    np.testing.assert_allclose(np.ptp(plane.get_xy(), axis=0), 2.0, atol=1e-2)


def test_cones_where_there_are_none_are_refused():
    with pytest.raises(asp.ParameterError, match="x: must lie in the set"):
        plot_cones(RECTANGLE, [2.0, 1.1])
    with pytest.raises(asp.ParameterError, match="convex"):
        plot_cones(CROSS, [0.5, 0.5])
    assert not mpl.pyplot.get_fignums()
    assert len(plot_cones(CROSS, [0.5, 0.5], normal=False)) == 5


def test_projections_satisfy_their_variational_inequality():
    rng = np.random.default_rng(4)
    ellipse = asp.Ellipse(2.0, 1.0, angle=0.4)
    z = rng.normal(size=(6, 2)) * 4.0
    *lines, points, feet = plot_projection(ellipse, z)
    np.testing.assert_array_equal(points.get_xydata(), z)
    x = feet.get_xydata()
    gaps = (z - x)[:, None] * (ellipse.boundary(90) - x[:, None])
    assert gaps.sum(-1).max() <= 1e-9
    for line, start, end in zip(lines, z, x, strict=True):
        np.testing.assert_array_equal(line.get_xydata(), [start, end])


def test_law_draws_forces_on_the_reservoir_spread_along_it():
    artists = plot_law(LAW, angles=12)
    (dots,) = lines_with(artists, "o")
    force = dots.get_xydata()
    assert len(force) == 12
    np.testing.assert_allclose(LAW.reservoir.gauge(force), 1.0, rtol=1e-9)
    # Chords are shorter than arcs, by a quarter at the sharp ends of this ellipse.
    steps = np.linalg.norm(np.diff(np.vstack([force, force[:1]]), axis=0), axis=1)
    assert steps.min() > 0.75 * steps.max()
    assert dots.axes.get_legend() is not None


def test_law_draws_the_sliding_directions_of_chosen_forces():
    theta = np.array([0.0, 1.0, 2.5, -0.3])
    artists = plot_law(LAW, angles=theta, forces="arrows", legend=False)
    tails, vectors = arrows_of(artists)
    from_origin = np.linalg.norm(tails, axis=1) == 0.0
    forces, slips = vectors[from_origin], vectors[~from_origin]
    np.testing.assert_allclose(np.arctan2(forces[:, 1], forces[:, 0]), theta, atol=1e-12)
    np.testing.assert_allclose(tails[~from_origin], forces)
    unit = slips / np.linalg.norm(slips, axis=1)[:, None]
    np.testing.assert_allclose(unit, LAW.slip_direction(-forces), atol=1e-9)
    np.testing.assert_allclose(-LAW.force(unit), forces, atol=1e-7)
    assert artists[0].axes.get_legend() is None


def test_law_draws_all_sliding_directions_at_a_corner():
    law = asp.FrictionLaw.associated(asp.Rectangle(0.6, 0.3))
    _, vectors = arrows_of(plot_law(law, angles=[np.arctan2(0.3, 0.6)]))
    assert {tuple(np.sign(vector.round(9))) for vector in vectors} == {(1.0, 0.0), (0.0, 1.0)}
    labels = [one.get_label() for one in plot_law(law)]
    assert labels[0] == "reservoir $C$ = direction set $D$"


def test_law_refuses_what_it_cannot_draw():
    with pytest.raises(asp.ParameterError, match="forces"):
        plot_law(LAW, forces="lines")
    with pytest.raises(asp.ParameterError, match="angles"):
        plot_law(LAW, angles=0)
    with pytest.raises(asp.DimensionError, match="planar"):
        plot_law(asp.FrictionLaw.isotropic(0.3, dimension=3))


def test_gauge_surface_has_the_height_of_the_gauge(monkeypatch):
    from mpl_toolkits.mplot3d import Axes3D

    given, drawn = [], Axes3D.plot_surface

    def plot_surface(self, *arrays, **kwargs):
        given.extend(arrays)
        return drawn(self, *arrays, **kwargs)

    monkeypatch.setattr(Axes3D, "plot_surface", plot_surface)
    surface, level, image, filling = plot_gauge(CROSS, height=1.5)
    x, y, height = given
    np.testing.assert_allclose(CROSS.gauge(np.stack([x, y], -1)), height, atol=1e-12)
    assert (height.min(), height.max()) == (0.0, 1.5)
    x, y, height = level.get_data_3d()
    np.testing.assert_allclose(CROSS.gauge(np.stack([x, y], -1)), height, rtol=1e-12)
    assert not np.any(image.get_data_3d()[2])
    assert filling.axes is surface.axes


def test_gauge_needs_axes_in_space():
    import matplotlib.pyplot as plt

    with pytest.raises(asp.ParameterError, match="3d"):
        plot_gauge(RECTANGLE, plt.subplots()[1])


def test_friction_coefficient_and_deflection_are_those_of_the_force():
    phi = np.deg2rad(DEGREES)
    force = -LAW.force(e(phi))
    along, across = plot_friction_coefficient(LAW)
    np.testing.assert_allclose(along.get_xdata(), DEGREES)
    np.testing.assert_allclose(along.get_ydata(), (force * e(phi)).sum(-1), atol=1e-12)
    np.testing.assert_allclose(across.get_ydata() ** 2 + along.get_ydata() ** 2, (force**2).sum(-1))
    (line,) = plot_deflection(LAW)
    theta = np.arctan2(force[:, 1], force[:, 0])
    turned = np.exp(1j * (theta - phi - np.deg2rad(line.get_ydata())))
    np.testing.assert_allclose(turned, 1.0, atol=1e-12)


def test_a_positive_deflection_turns_the_path_clockwise():
    (line,) = plot_deflection(LAW)
    for degrees in (50.0, 140.0):
        direction = e(np.deg2rad(degrees))
        path = asp.simulate(asp.SlidingPoint(1.0, LAW), dt=1e-3, t_end=0.02, u0=direction)
        turn = np.linalg.det([path.u[0], path.u[-1]])
        assert np.sign(turn) == -np.sign(np.interp(degrees, DEGREES, line.get_ydata()))


def test_labels_of_several_laws_stay_apart():
    ax = plot_friction_coefficient(LAW, label="tilted")[0].axes
    plot_friction_coefficient(asp.FrictionLaw.isotropic(0.3), ax, across=False, label="isotropic")
    _, labels = ax.get_legend_handles_labels()
    assert labels == ["$l_t$, tilted", "$l_p$, tilted", "$l_t$, isotropic"]


def test_short_names_of_options_are_understood():
    along, across = plot_friction_coefficient(LAW, ls=":", c="r", lw=0.5)
    assert (along.get_linestyle(), across.get_linestyle()) == (":", "--")
    assert {(one.get_color(), one.get_linewidth()) for one in (along, across)} == {("r", 0.5)}
    assert plot_set(RECTANGLE, c="r")[0].get_color() == "r"
    with pytest.raises(TypeError, match="color"):
        plot_friction_coefficient(LAW, c="r", color="b")


@pytest.mark.parametrize(
    ("argument", "plot"),
    [
        ("set", lambda: plot_set(3)),
        ("set", lambda: plot_cones(3, [1.0, 0.0])),
        ("set", lambda: plot_projection(3, [1.0, 0.0])),
        ("set", lambda: plot_gauge(3)),
        ("law", lambda: plot_law(3)),
        ("law", lambda: plot_friction_coefficient(3)),
        ("law", lambda: plot_deflection(3)),
        ("trajectory", lambda: plot_path(3)),
        ("trajectory", lambda: plot_phase(3)),
        ("trajectory", lambda: plot_forces_in_reservoir(3, LAW)),
        ("ax", lambda: plot_set(RECTANGLE, 3)),
        ("ax", lambda: plot_law(LAW, 3)),
    ],
)
def test_what_cannot_be_drawn_is_refused_by_name(argument, plot):
    with pytest.raises(asp.ParameterError, match="must be") as refused:
        plot()
    assert refused.value.argument == argument
    assert not mpl.pyplot.get_fignums()


def test_what_is_not_planar_is_refused_by_name(motion):
    line, space = asp.FrictionLaw.isotropic(0.3, dimension=1), asp.Ball(1.0)
    for argument, plot in (
        ("law", lambda: plot_deflection(line)),
        ("law", lambda: plot_friction_coefficient(line)),
        ("law", lambda: plot_forces_in_reservoir(motion, line)),
        ("set", lambda: plot_projection(space, [1.0, 0.0, 0.0])),
        ("set", lambda: plot_gauge(space)),
    ):
        with pytest.raises(asp.DimensionError, match="planar") as refused:
            plot()
        assert refused.value.argument == argument
    assert not mpl.pyplot.get_fignums()


def test_path_and_phase_show_every_sample(motion):
    path, end = plot_path(motion, label="mass")
    np.testing.assert_array_equal(path.get_xydata(), motion.q)
    np.testing.assert_array_equal(end.get_xydata(), motion.q[-1:])
    coloured = plot_phase(motion)
    drawn = np.vstack([s for lines in coloured for s in lines.get_segments()])
    assert {tuple(point) for point in drawn} == {tuple(point) for point in motion.q}
    assert {lines.get_label() for lines in coloured} == {"stick", "slip"}


def test_forces_lie_within_the_reservoir(motion):
    artists = plot_forces_in_reservoir(motion, LAW)
    dots = np.vstack([line.get_xydata() for line in lines_with(artists, ".")])
    assert len(dots) == motion.steps
    assert LAW.reservoir.contains(dots, tolerance=1e-9).all()


def test_nothing_is_set_globally():
    before = dict(mpl.rcParams)
    with look.style():
        plot_set(asp.Disk(1.0))
    plot_law(LAW)
    assert dict(mpl.rcParams) == before


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_figures_are_written_whole(tmp_path, suffix):
    path = tmp_path / f"set.{suffix}"
    save_figure(plot_set(asp.Disk(1.0))[0].figure, path)
    assert path.stat().st_size > 1000
    assert [file.name for file in tmp_path.iterdir()] == [path.name]
