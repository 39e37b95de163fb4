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
from drawn import drawn
from matplotlib.quiver import Quiver

LAW = asp.FrictionLaw(asp.Ellipse(0.6, 0.2, angle=0.3), asp.Ellipse(3.0, 1.0))
RECTANGLE = asp.Rectangle(2.0, 1.0)
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


def test_normal_arrows_are_the_generators_of_the_normal_cone():
    tails, vectors = arrows_of(drawn(plot_cones, RECTANGLE, x=[2.0, -1.0], tangent=False, size=0.5))
    np.testing.assert_allclose(tails, [[2.0, -1.0]] * 2)
    assert {tuple(vector) for vector in vectors.round(12)} == {(0.5, 0.0), (0.0, -0.5)}


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
