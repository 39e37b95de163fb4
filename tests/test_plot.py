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
    plot_history,
    plot_law,
    plot_path,
    plot_phase_portrait,
    plot_projection,
    plot_set,
    save_figure,
)
from asperity.runs.event_driven import integrate
from drawn import drawn
from matplotlib.patches import Polygon
from matplotlib.quiver import Quiver

LAW = asp.FrictionLaw(asp.Ellipse(0.6, 0.2, angle=0.3), asp.Ellipse(3.0, 1.0))
RECTANGLE = asp.Rectangle(2.0, 1.0)
CROSS = asp.Rectangle(2.0, 0.5) | asp.Rectangle(0.5, 2.0)
DEGREES = np.linspace(0.0, 360.0, 721)


@pytest.fixture(scope="module")
def motion():
    belt = asp.MassOnBelt(1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=[0.1, 0.05])
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
    "set": lambda run, **options: drawn(plot_set, RECTANGLE, **options),
    "cones": lambda run, **options: drawn(plot_cones, RECTANGLE, x=[2.0, 1.0], **options),
    "projection": lambda run, **options: drawn(plot_projection, RECTANGLE, z=[3.0, 0.0], **options),
    "law": lambda run, **options: drawn(plot_law, LAW, **options),
    "coefficient": lambda run, **options: drawn(plot_friction_coefficient, LAW, **options),
    "deflection": lambda run, **options: drawn(plot_deflection, LAW, **options),
    "path": lambda run, **options: drawn(plot_path, run, **options),
    "phases": lambda run, **options: drawn(plot_path, run, contact=0, **options),
    "portrait": lambda run, **options: drawn(plot_phase_portrait, run, **options),
    "history": lambda run, **options: drawn(plot_history, run, **options),
    "forces": lambda run, **options: drawn(plot_forces_in_reservoir, run, law=LAW, **options),
}
RUNS = ("path", "phases", "portrait", "history", "forces")


@pytest.mark.parametrize("plot", PLOTS.values(), ids=PLOTS)
def test_every_plot_draws_into_the_axes_given_and_into_new_ones_alike(plot, motion):
    import matplotlib.pyplot as plt

    _, ax = plt.subplots()
    artists = plot(motion, ax=ax)
    assert artists
    assert all(one.axes is ax for one in artists)
    assert len(plot(motion)) == len(artists)
    assert len(plt.get_fignums()) == 2


@pytest.mark.parametrize("plot", RUNS)
def test_motions_are_drawn_as_trajectories_are(plot, motion):
    belt = asp.MassOnBelt(1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=[0.1, 0.05])
    exact = integrate(belt, t_end=20.0, sample_every=1e-2)
    shown, stepped = PLOTS[plot](exact), PLOTS[plot](motion)
    assert [type(one) for one in shown] == [type(one) for one in stepped]
    limits = [one[0].axes.dataLim.get_points() for one in (shown, stepped)]
    np.testing.assert_allclose(*limits, atol=6e-3)


@pytest.mark.parametrize("plot", RUNS)
def test_several_runs_are_drawn_with_their_labels(plot, motion):
    half = motion.slice(0.0, 10.0)
    one = len(PLOTS[plot](motion))
    assert len(PLOTS[plot]([motion, half])) == 2 * one - (plot == "forces") * 2
    artists = PLOTS[plot]({"whole": motion, "half": half})
    named = " ".join(text.get_text() for text in artists[0].axes.get_legend().get_texts())
    assert ("half" in named) == (plot != "phases")


@pytest.mark.parametrize("plot", RUNS)
def test_a_cycle_is_drawn_as_its_period(plot):
    law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=0.5), asp.Ellipse(3.0, 1.0))
    belt = asp.MassOnBelt(
        1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[0.643, 0.766]
    )
    cycle = asp.limit_cycle(belt)
    shown, period = PLOTS[plot](cycle), PLOTS[plot](cycle.motion)
    # A cycle has neither beginning nor end, which a dot would mark.
    assert len(period) - len(shown) == (plot in ("portrait", "path", "phases"))
    np.testing.assert_array_equal(*(one[0].axes.dataLim.get_points() for one in (shown, period)))


def test_set_outline_lies_on_the_boundary():
    star = asp.Superellipse(2.0, 1.0, 0.5)
    outline, filling = drawn(plot_set, star, label="C")
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
        one
        for one in drawn(plot_cones, star, x=x, normal=False, size=0.7)
        if isinstance(one, Polygon)
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
    point, *others = drawn(plot_cones, CROSS, x=[0.5, 0.5], normal=False, size=0.3)
    edges = [one.get_xydata() for one in others if isinstance(one, mpl.lines.Line2D)]
    np.testing.assert_allclose(point.get_xydata(), [[0.5, 0.5]])
    ends = {tuple(end.round(9)) for start, end in edges if (start == 0.5).all()}
    assert ends == {(0.8, 0.5), (0.5, 0.8)}


def test_normal_arrows_are_the_generators_of_the_normal_cone():
    tails, vectors = arrows_of(drawn(plot_cones, RECTANGLE, x=[2.0, -1.0], tangent=False, size=0.5))
    np.testing.assert_allclose(tails, [[2.0, -1.0]] * 2)
    assert {tuple(vector) for vector in vectors.round(12)} == {(0.5, 0.0), (0.0, -0.5)}


def test_cones_in_the_interior_are_the_plane_and_the_origin():
    _, plane = drawn(plot_cones, RECTANGLE, x=[0.5, 0.5], size=1.0)
    np.testing.assert_allclose(np.ptp(plane.get_xy(), axis=0), 2.0, atol=1e-2)


def test_cones_where_there_are_none_are_refused():
    with pytest.raises(asp.ParameterError, match="x: must lie in the set"):
        plot_cones(RECTANGLE, x=[2.0, 1.1])
    with pytest.raises(asp.ParameterError, match="convex"):
        plot_cones(CROSS, x=[0.5, 0.5])
    assert not mpl.pyplot.get_fignums()
    assert len(drawn(plot_cones, CROSS, x=[0.5, 0.5], normal=False)) == 5


def test_projections_satisfy_their_variational_inequality():
    rng = np.random.default_rng(4)
    ellipse = asp.Ellipse(2.0, 1.0, angle=0.4)
    z = rng.normal(size=(6, 2)) * 4.0
    *lines, points, feet = drawn(plot_projection, ellipse, z=z)
    np.testing.assert_array_equal(points.get_xydata(), z)
    x = feet.get_xydata()
    gaps = (z - x)[:, None] * (ellipse.boundary(90) - x[:, None])
    assert gaps.sum(-1).max() <= 1e-9
    for line, start, end in zip(lines, z, x, strict=True):
        np.testing.assert_array_equal(line.get_xydata(), [start, end])


def test_law_draws_forces_on_the_reservoir_spread_along_it():
    artists = drawn(plot_law, LAW, angles=12)
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
    artists = drawn(plot_law, LAW, angles=theta, forces="arrows", legend=False)
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
    _, vectors = arrows_of(drawn(plot_law, law, angles=[np.arctan2(0.3, 0.6)]))
    assert {tuple(np.sign(vector.round(9))) for vector in vectors} == {(1.0, 0.0), (0.0, 1.0)}
    labels = [one.get_label() for one in drawn(plot_law, law)]
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

    given, own = [], Axes3D.plot_surface

    def plot_surface(self, *arrays, **kwargs):
        given.extend(arrays)
        return own(self, *arrays, **kwargs)

    monkeypatch.setattr(Axes3D, "plot_surface", plot_surface)
    surface, level, image, filling = drawn(plot_gauge, CROSS, height=1.5)
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
        plot_gauge(RECTANGLE, ax=plt.subplots()[1])


def test_friction_coefficient_and_deflection_are_those_of_the_force():
    phi = np.deg2rad(DEGREES)
    force = -LAW.force(e(phi))
    along, across = drawn(plot_friction_coefficient, LAW)
    np.testing.assert_allclose(along.get_xdata(), DEGREES)
    np.testing.assert_allclose(along.get_ydata(), (force * e(phi)).sum(-1), atol=1e-12)
    np.testing.assert_allclose(across.get_ydata() ** 2 + along.get_ydata() ** 2, (force**2).sum(-1))
    (line,) = drawn(plot_deflection, LAW)
    theta = np.arctan2(force[:, 1], force[:, 0])
    turned = np.exp(1j * (theta - phi - np.deg2rad(line.get_ydata())))
    np.testing.assert_allclose(turned, 1.0, atol=1e-12)


def test_a_positive_deflection_turns_the_path_clockwise():
    (line,) = drawn(plot_deflection, LAW)
    for degrees in (50.0, 140.0):
        direction = e(np.deg2rad(degrees))
        path = asp.simulate(asp.SlidingPoint(1.0, law=LAW), dt=1e-3, t_end=0.02, u0=direction)
        turn = np.linalg.det([path.u[0], path.u[-1]])
        assert np.sign(turn) == -np.sign(np.interp(degrees, DEGREES, line.get_ydata()))


def test_labels_of_several_laws_stay_apart():
    ax = plot_friction_coefficient(LAW, label="tilted")
    plot_friction_coefficient(
        asp.FrictionLaw.isotropic(0.3), ax=ax, across=False, label="isotropic"
    )
    _, labels = ax.get_legend_handles_labels()
    assert labels == ["$l_t$, tilted", "$l_p$, tilted", "$l_t$, isotropic"]


def test_short_names_of_options_are_understood():
    along, across = drawn(plot_friction_coefficient, LAW, ls=":", c="r", lw=0.5)
    assert (along.get_linestyle(), across.get_linestyle()) == (":", "--")
    assert {(one.get_color(), one.get_linewidth()) for one in (along, across)} == {("r", 0.5)}
    assert plot_set(RECTANGLE, c="r").lines[0].get_color() == "r"
    with pytest.raises(TypeError, match="color"):
        plot_friction_coefficient(LAW, c="r", color="b")


@pytest.mark.parametrize(
    ("argument", "plot"),
    [
        ("set", lambda: plot_set(3)),
        ("set", lambda: plot_cones(3, x=[1.0, 0.0])),
        ("set", lambda: plot_projection(3, z=[1.0, 0.0])),
        ("set", lambda: plot_gauge(3)),
        ("law", lambda: plot_law(3)),
        ("law", lambda: plot_friction_coefficient(3)),
        ("law", lambda: plot_deflection(3)),
        ("run", lambda: plot_path(3)),
        ("run", lambda: plot_phase_portrait("run")),
        ("run", lambda: plot_history({"run": LAW})),
        ("run", lambda: plot_forces_in_reservoir(3, law=LAW)),
        ("ax", lambda: plot_set(RECTANGLE, ax=3)),
        ("ax", lambda: plot_law(LAW, ax=3)),
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
        ("law", lambda: plot_forces_in_reservoir(motion, law=line)),
        ("set", lambda: plot_projection(space, z=[1.0, 0.0, 0.0])),
        ("set", lambda: plot_gauge(space)),
    ):
        with pytest.raises(asp.DimensionError, match="planar") as refused:
            plot()
        assert refused.value.argument == argument
    assert not mpl.pyplot.get_fignums()


def test_path_and_phase_show_every_sample(motion):
    path, end = drawn(plot_path, motion, label="mass")
    np.testing.assert_array_equal(path.get_xydata(), motion.q)
    np.testing.assert_array_equal(end.get_xydata(), motion.q[-1:])
    coloured = plot_path(motion, contact=0).collections
    shown = np.vstack([s for lines in coloured for s in lines.get_segments()])
    assert {tuple(point) for point in shown} == {tuple(point) for point in motion.q}
    assert {lines.get_label() for lines in coloured} == {"stick", "slip"}


def test_forces_are_drawn_per_unit_of_normal_force():
    # Pressed by a load that grows: λ_N changes, the law does not.
    half = (0.1, 0.05, 0.05)
    load = asp.Signal([0.0, 1.0], [[0.0, 0.0, 0.0], [0.0, 0.0, -20.0]], interpolation="linear")
    box = asp.Body.box(
        1.0, half_sizes=half, position=(0.0, 0.0, 0.05), velocity=(4.0, 1.0, 0.0), force=load
    )
    system = asp.RigidBodies(
        [box], pairs=[asp.BoxPlane(0, half_sizes=half, plane=asp.Plane(), law=LAW)]
    )
    run = asp.simulate(system, dt=1e-3, t_end=0.5)
    assert np.nanmax(run.normal_force) > 1.5 * np.nanmin(run.normal_force[1:, :4])
    ax = plot_forces_in_reservoir(run, law=LAW, contacts=[0, 1, 2, 3])
    slip = next(line for line in ax.lines if line.get_label() == "slip")
    gauge = LAW.reservoir.gauge(slip.get_xydata())
    np.testing.assert_allclose(gauge, 1.0, atol=1e-7)
    everything = np.vstack([line.get_xydata() for line in ax.lines[1:]])
    assert LAW.reservoir.contains(everything, tolerance=1e-7).all()
    assert len(everything) == np.count_nonzero(run.normal_force[:, :4] > 0.0)


def test_contacts_without_load_are_refused():
    ball = asp.Body.ball(1.0, radius=0.1, position=(0.0, 0.0, 5.0))
    system = asp.RigidBodies(
        [ball], pairs=[asp.SpherePlane(0, radius=0.1, plane=asp.Plane(), law=LAW)]
    )
    with pytest.raises(asp.ParameterError, match="contacts: must have carried load"):
        plot_forces_in_reservoir(asp.simulate(system, dt=0.01, t_end=0.1), law=LAW)


def test_nothing_is_set_globally():
    before = dict(mpl.rcParams)
    with look.style():
        plot_set(asp.Disk(1.0))
    plot_law(LAW)
    assert dict(mpl.rcParams) == before


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_figures_are_written_whole(tmp_path, suffix):
    path = tmp_path / f"set.{suffix}"
    save_figure(plot_set(asp.Disk(1.0)).figure, path)
    assert path.stat().st_size > 1000
    assert [file.name for file in tmp_path.iterdir()] == [path.name]
