"""Plots of runs: histories, portraits, polar plots, bodies, animations."""

import asperity as asp
import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")

import matplotlib.pyplot as plt
from asperity import mechanisms, plot, track
from drawn import drawn

LAW = asp.FrictionLaw(asp.Ellipse(0.6, 0.2, angle=0.3), asp.Ellipse(3.0, 1.0))
HALF = (0.1, 0.05, 0.05)


@pytest.fixture(autouse=True)
def _close():
    plt.close("all")
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def run():
    belt = asp.MassOnBelt(1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=[0.1, 0.05])
    return asp.simulate(belt, dt=1e-2, t_end=20.0)


@pytest.fixture(scope="module")
def bodies():
    box = asp.Body.box(
        1.0,
        half_sizes=HALF,
        position=(0.0, 0.0, 0.05),
        velocity=(1.2, 0.5, 0.0),
        angular_velocity=(0, 0, 6),
    )
    ball = asp.Body.ball(1.0, radius=0.06, position=(0.0, 0.4, 0.06), velocity=(0.6, 0.1, 0.0))
    table = asp.Plane()
    return asp.RigidBodies(
        [box, ball],
        pairs=[
            asp.BoxPlane(0, half_sizes=HALF, plane=table, law=LAW),
            asp.SpherePlane(1, radius=0.06, plane=table, law=LAW),
        ],
    )


@pytest.fixture(scope="module")
def slide(bodies):
    return asp.simulate(bodies, dt=2e-3, t_end=0.4)


@pytest.fixture(scope="module")
def measured():
    t = np.linspace(0.0, 0.3, 151)
    x = np.column_stack([1.5 * t - 2.5 * t**2, 0.5 * t])
    return track.MeasuredPath(t, x, np.full_like(x, 1e-5))


@pytest.mark.parametrize(
    ("quantity", "values"),
    [
        ("q", lambda run: run.q.T),
        ("u", lambda run: run.u.T),
        ("speed", lambda run: [np.hypot(*run.u.T)]),
        ("slip", lambda run: run.slip[:, 0].T),
        ("slip_speed", lambda run: [np.hypot(*run.slip[:, 0].T)]),
        ("force", lambda run: run.force[:, 0].T),
        ("friction", lambda run: [np.hypot(*run.force[:, 0].T)]),
        ("normal_force", lambda run: [run.normal_force[:, 0]]),
        ("coefficient", lambda run: [np.hypot(*run.force[:, 0].T) / run.normal_force[:, 0]]),
    ],
)
def test_histories_show_what_the_run_holds(run, quantity, values):
    ax = plot.plot_history(run, quantity=quantity)
    expected = values(run)
    assert len(ax.lines) == len(expected)
    for line, one in zip(ax.lines, expected, strict=True):
        np.testing.assert_array_equal(line.get_xdata(), run.t)
        np.testing.assert_allclose(line.get_ydata(), one, rtol=1e-14)


def bar_lengths(ax):
    """Time that each colour fills below the axes."""
    (strip,) = ax.child_axes
    return {
        mpl.colors.to_hex(bars.get_facecolor()[0]): sum(
            np.ptp(path.vertices[:, 0]) for path in bars.get_paths()
        )
        for bars in strip.collections
    }


def test_bars_of_trajectories_hold_the_steps_of_each_phase(run):
    lengths = bar_lengths(plot.plot_history(run))
    assert sum(lengths.values()) == pytest.approx(20.0, rel=1e-12)
    stick = lengths[plot.look.STICK.lower()]
    assert stick == pytest.approx(20.0 * run.stick_fraction[0], rel=1e-12)


def test_bars_of_motions_reach_from_event_to_event():
    motion = asp.integrate(
        asp.MassOnBelt(1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=[0.1, 0.05]),
        t_end=20.0,
    )
    times = [*(event.time for event in motion.events), 20.0]
    stick = sum(
        end - event.time
        for event, end in zip(motion.events, times[1:], strict=True)
        if event.phase is asp.Phase.STICK
    )
    lengths = bar_lengths(plot.plot_history(motion))
    assert lengths[plot.look.STICK.lower()] == pytest.approx(stick, rel=1e-12)
    assert sum(lengths.values()) == pytest.approx(20.0, rel=1e-12)


def test_histories_of_measured_paths_have_bands(measured):
    ax = plot.plot_history(measured, quantity="speed")
    np.testing.assert_allclose(ax.lines[0].get_ydata(), np.hypot(*measured.velocity.T))
    assert len(ax.collections) == 1
    assert len(plot.plot_history(measured, quantity="acceleration").lines) == 2
    np.testing.assert_array_equal(
        drawn(plot.plot_path, measured)[0].get_xydata(), measured.position
    )


def test_axes_and_legends_have_the_names_and_units_of_the_run(slide, run):
    portrait = plot.plot_phase_portrait(slide, coordinate=7)
    assert (portrait.get_xlabel(), portrait.get_ylabel()) == ("body 1 x in m", "body 1 vx in m/s")
    path = plot.plot_path(slide, coordinates=(0, 8))
    assert (path.get_xlabel(), path.get_ylabel()) == ("body 0 x in m", "body 1 y in m")
    history = plot.plot_history(slide, quantity="u", coordinates=[0, 3], phases=False)
    assert history.get_ylabel() == "velocities $u$ in m/s or rad/s"
    assert [line.get_label() for line in history.lines] == ["body 0 vx", "body 0 omega1"]
    turning = plot.plot_history(slide, quantity="u", coordinates=3, phases=False)
    assert turning.get_ylabel() == "velocities $u$ in rad/s"
    labels = run.labels.replace(coordinate_units=["SI", "-"])
    named = run.replace(labels=labels)
    path = plot.plot_path(named)
    assert (path.get_xlabel(), path.get_ylabel()) == ("x1 in SI units", "x2")


def test_a_portrait_draws_velocities_over_coordinates(bodies, slide):
    block = mechanisms.stribeck_block()
    motion = asp.integrate(block, t_end=5.0, q0=[1.0])
    line, start = plot.plot_phase_portrait(motion).lines
    np.testing.assert_array_equal(line.get_xydata(), np.column_stack([motion.q, motion.u]))
    np.testing.assert_array_equal(start.get_xydata(), [[motion.q[0, 0], motion.u[0, 0]]])
    # The second body's y: coordinate 8 of 14, velocity 7 of 12.
    line, _ = plot.plot_phase_portrait(slide, coordinate=8).lines
    np.testing.assert_array_equal(line.get_ydata(), slide.u[:, 7])
    with pytest.raises(asp.ParameterError, match="coordinate: must be one whose rate"):
        plot.plot_phase_portrait(slide, coordinate=3)


def test_bodies_are_outlined_where_they_are(bodies, slide):
    ax = plot.plot_bodies(slide, system=bodies, at=[0.4], forces=False, paths=False)
    box, center, circle, radius, middle = (line.get_xydata() for line in ax.lines)
    place, turn = bodies.positions(slide)[-1], bodies.rotations(slide)[-1]
    inside = (box - place[0, :2]) @ turn[0, :2, :2]
    np.testing.assert_allclose(np.abs(inside), np.tile(HALF[:2], (len(box), 1)), atol=1e-9)
    np.testing.assert_allclose(center, place[:1, :2])
    np.testing.assert_allclose(np.linalg.norm(circle - place[1, :2], axis=1), 0.06)
    np.testing.assert_allclose(middle, place[1:, :2])
    np.testing.assert_allclose(radius[0], place[1, :2])


@pytest.mark.parametrize(
    ("argument", "changes"),
    [
        ("system", {"system": asp.SlidingPoint(1.0, law=LAW)}),
        ("view", {"view": "below"}),
        ("at", {"at": [0.1, 7.0]}),
        ("at", {"at": 0}),
        ("bodies", {"bodies": [2]}),
        ("contacts", {"contacts": 9}),
        ("ax", {"view": "space", "ax": "flat"}),
        ("ax", {"ax": "space"}),
    ],
)
def test_what_bodies_cannot_be_drawn_is_said(bodies, slide, argument, changes):
    axes = {"flat": None, "space": "3d"}
    given = {"system": bodies, **changes}
    if "ax" in given:
        given["ax"] = plt.figure().add_subplot(projection=axes[given["ax"]])
    with pytest.raises(asp.ParameterError) as refused:
        plot.plot_bodies(slide, **given)
    assert refused.value.argument == argument


@pytest.mark.parametrize(
    ("argument", "call"),
    [
        ("quantity", lambda run: plot.plot_history(run, quantity="energy")),
        ("quantity", lambda run: plot.plot_history(run, quantity="acceleration")),
        ("coordinates", lambda run: plot.plot_history(run, coordinates=2)),
        ("contacts", lambda run: plot.plot_history(run, contacts=[1])),
        ("contacts", lambda run: plot.plot_history(run, contacts=[])),
        ("contact", lambda run: plot.plot_path(run, contact=1)),
        ("contact", lambda run: plot.plot_path(run, contact=0, color="red")),
        ("label", lambda run: plot.plot_path([run, run], label="one")),
        ("path", lambda run: plot.save_animation(run, "run.avi")),
        ("speed", lambda run: plot.save_animation(run, "run.gif", speed=1e-6)),
        ("system", lambda run: plot.save_animation(run, "run.gif", view="space")),
    ],
)
def test_what_cannot_be_drawn_is_said(run, argument, call):
    with pytest.raises(asp.AsperityError) as refused:
        call(run)
    assert refused.value.argument == argument
    assert not plt.get_fignums()


def test_an_animation_draws_all_that_the_run_knows_of(tmp_path, bodies, slide):
    from PIL import Image

    options = {"fps": 5, "size": (3.0, 2.4), "dpi": 50}
    plot.save_animation(slide, tmp_path / "told.gif", system=bodies, **options)
    plot.save_animation(slide, tmp_path / "known.gif", **options)
    assert (tmp_path / "known.gif").read_bytes() == (tmp_path / "told.gif").read_bytes()
    law = asp.FrictionLaw.isotropic(0.3, dimension=1)
    for count in (1, 8):
        lines = np.eye(count)
        chain = asp.LinearSystem(
            np.ones(count),
            stiffness=2.0 * lines - np.eye(count, k=1) - np.eye(count, k=-1),
            contacts=[asp.Contact(law, direction=line, normal_force=0.1) for line in lines],
        )
        moved = asp.simulate(chain, dt=0.01, t_end=0.5, q0=0.1 * np.arange(1.0, count + 1.0))
        plot.save_animation(moved, tmp_path / "chain.gif", **options)
        with Image.open(tmp_path / "chain.gif") as film:
            pixels = np.asarray(film.convert("RGB")).astype(int)
        green = np.abs(pixels - np.array(mpl.colors.to_rgb(plot.look.SLIDING)) * 255).sum(-1) < 60
        rows = green.any(axis=1).astype(int)
        assert np.count_nonzero(np.diff(rows, prepend=0) == 1) == count
