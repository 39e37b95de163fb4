"""Strokes from positions of encoders: against the motion that made them."""

from itertools import product

import laboratory_files as lab
import numpy as np
import pytest
from asperity import identify
from asperity.errors import RecordError
from profiles import counts

pandas = pytest.importorskip("pandas")

MICRO = 1e-6
MOTIONS = [
    (kind, length, speed, dwell, rate, step, noise)
    for kind, length, speed, dwell, rate, step, noise in product(
        ("sine", "ramp"),
        (2e-3, 20e-3),
        (1e-3, 10e-3, 100e-3),
        (0.0, 0.5, 5.0),
        (20.0, 200.0, 2000.0),
        (0.0, 0.1 * MICRO, MICRO, 5 * MICRO, 10 * MICRO, 50 * MICRO),
        (0.0, MICRO, 10 * MICRO),
    )
    if 10 <= length / speed * rate <= 5000 and dwell * rate <= 4000
]


def on_a_line(time, place, velocity):
    """Return the record of a stage along its tangential channel, with how it is read."""
    random = np.random.default_rng(1)
    way = np.sign(velocity)
    columns = {"t": time, "s": 1e3 * place, "Ft": 5.0 * way, "Fr": 0.3 * way}
    columns["Fn"] = np.full(time.size, lab.LOAD)
    frame = pandas.DataFrame(columns)
    frame[["Ft", "Fr", "Fn"]] += 0.02 * random.normal(size=(time.size, 3))
    names = {"time": "t", "position": "s", "tangential": "Ft", "radial": "Fr", "normal": "Fn"}
    return frame, {"columns": names, "units": {"position": "mm"}}


def check_strokes(data, velocity, strokes):
    """Assert that strokes are those of the motion: their number, their way, and no rest in them."""
    assert data.turns == strokes
    used, fast = data.turn >= 0, np.abs(velocity).max()
    slides = np.abs(velocity) > 0.1 * fast
    assert (np.cos(data.phi) * np.sign(velocity) > 0.99)[used & slides].all()
    # A sample at either end of a short stroke may be at rest.
    assert np.count_nonzero(used & ~slides) <= 0.02 * np.count_nonzero(used)
    lost = np.count_nonzero(~used & (np.abs(velocity) > 0.35 * fast))
    assert lost <= 0.25 * np.count_nonzero(slides)


@counts(40, len(MOTIONS))
def test_strokes_of_an_encoder_are_those_of_the_motion(count):
    chosen = np.random.default_rng(3).permutation(len(MOTIONS))[:count]
    for kind, length, speed, dwell, rate, step, noise in (MOTIONS[at] for at in chosen):
        time, place, velocity = lab.back_and_forth(
            kind, length=length, speed=speed, dwell=dwell, rate=rate
        )
        read = lab.encoded(place, step=step, noise=noise)
        data = identify.load(*on_a_line(time, read, velocity))
        check_strokes(data, velocity, 8)
        found = data.raw.recordings[0].velocity[:, 0]
        inside = (data.turn >= 0) & (np.abs(velocity) > 0.5 * speed)
        error = np.sqrt(np.mean((found - velocity)[inside] ** 2)) / np.abs(velocity).max()
        # Windows follow a sine over 2 mm in 40 steps to 3 %, and with noise of 10 µm to 8 %.
        assert error < (0.05 if length / max(step, 5.0 * noise, MICRO) > 100 else 0.1)


@pytest.mark.parametrize("dwell", [0.0, 0.5])
@pytest.mark.parametrize("step", [10 * MICRO, 50 * MICRO])
def test_positions_that_do_not_tell_strokes_are_refused_in_these_words(step, dwell):
    """What is read is right, what is refused says why: ten steps a stroke are too few."""
    for steps in (5, 10, 40, 100):
        motion = lab.back_and_forth(
            "sine", length=steps * step, speed=steps * step, dwell=dwell, rate=200.0
        )
        time, place, velocity = motion
        given = on_a_line(time, lab.encoded(place, step=step), velocity)
        if steps <= 10:
            words = (
                rf"column 's' \(position\): steps of {1e6 * step:.0f} µm "
                "(tell the velocity of|are not small).*"
                " positions in finer steps, longer strokes or columns of velocities are needed"
            )
            with pytest.raises(RecordError, match=words):
                identify.load(*given)
        else:
            check_strokes(identify.load(*given), velocity, 8)


def path(segments, *, speed, rate):
    """Return time, place, velocity and segment of a path of straight lines.

    A segment that goes nowhere rests for 0.3 s.
    """
    lengths = np.hypot(*np.transpose(segments))
    lasts = np.where(lengths > 0.0, lengths / speed, 0.3)
    ends = np.cumsum(lasts)
    time = (np.arange(int(ends[-1] * rate)) + 0.4) / rate
    number = np.searchsorted(ends, time, side="right")
    begin = np.concatenate([np.zeros((1, 2)), np.cumsum(segments, axis=0)])
    share = 1.0 - (ends[number] - time) / lasts[number]
    place = begin[number] + share[:, None] * np.asarray(segments)[number]
    return time, place, (segments / lasts[:, None])[number]


def in_the_plane(time, place, velocity):
    """Return the record of a table of x and y, with how it is read."""
    speed = np.hypot(*velocity.T)
    along = np.where(speed[:, None] > 0.0, velocity, [1.0, 0.0])
    force = -lab.ROUND.force(along, normal_force=lab.LOAD) * (speed > 0.0)[:, None]
    force += 0.05 * np.random.default_rng(2).normal(size=force.shape)
    columns = {"t": time, "x": 1e3 * place[:, 0], "y": 1e3 * place[:, 1]}
    frame = pandas.DataFrame(columns | {"Fx": force[:, 0], "Fy": force[:, 1]})
    names = {"time": "t", "position_x": "x", "position_y": "y", "force_x": "Fx", "force_y": "Fy"}
    sections = {"columns": names, "units": {"position_x": "mm", "position_y": "mm"}}
    return frame, sections | {"tribometer": {"normal_load": lab.LOAD}}


def errors_of_direction(data, velocity):
    """Return by how much directions of sliding are off, in degrees."""
    inside = (data.turn >= 0) & velocity.any(axis=1)
    off = data.phi - np.arctan2(velocity[:, 1], velocity[:, 0])
    return np.rad2deg(np.abs(off - 2.0 * np.pi * np.rint(off / (2.0 * np.pi))))[inside]


@pytest.mark.parametrize("step", [0.0, MICRO, 10 * MICRO, 50 * MICRO])
@pytest.mark.parametrize("noise", [0.0, 5 * MICRO])
@pytest.mark.parametrize("rests", [False, True])
def test_directions_of_an_encoder_are_those_of_the_path(step, noise, rests):
    angles = 0.05 + np.arange(12) * np.pi / 12
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    star = 10e-3 * np.repeat(ways, 2, axis=0) * np.tile([[1.0], [-1.0]], (12, 1))
    loop = 10e-3 * np.tile([[0.98, 0.2], [-0.2, 0.98], [-0.98, -0.2], [0.2, -0.98]], (3, 1))
    for segments in (star, loop):
        parts = np.stack([segments, np.zeros_like(segments)], axis=1) if rests else segments
        motion = path(parts.reshape(-1, 2), speed=10e-3, rate=200.0)
        time, place, velocity = motion
        read = lab.encoded(place, step=step, noise=noise)
        data = identify.load(*in_the_plane(time, read, velocity))
        assert data.turns == len(segments)
        assert not data.goes_round
        used = data.turn >= 0
        assert not (used & ~velocity.any(axis=1)).sum() > 0.02 * used.sum()
        assert errors_of_direction(data, velocity).max() < 0.5


@pytest.mark.parametrize("step", [0.0, MICRO, 10 * MICRO, 50 * MICRO])
def test_a_stage_that_goes_round_with_an_encoder_makes_turns(step):
    angle = np.arange(0.0, 8.0 * np.pi, 0.01)
    slip = np.stack([np.cos(angle), 0.5 * np.sin(angle)], axis=-1)
    place = 10e-3 * np.stack([np.sin(angle), -0.5 * np.cos(angle)], axis=-1)
    read = lab.encoded(place, step=step, noise=0.2 * step)
    data = identify.load(*in_the_plane(angle, read, 10e-3 * slip))
    assert data.turns == 4
    assert data.goes_round
    off = errors_of_direction(data, slip)
    assert np.sqrt(np.mean(off**2)) < 0.7
    assert off.max() < 2.5


def test_the_law_of_strokes_of_an_encoder_is_that_of_the_motion():
    angles = np.deg2rad(np.arange(0.0, 180.0, 15.0))
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    once = 10e-3 * np.repeat(ways, 2, axis=0) * np.tile([[1.0], [-1.0]], (len(ways), 1))
    parts = np.stack([np.tile(once, (3, 1)), np.zeros((3 * len(once), 2))], axis=1)
    time, place, velocity = path(parts.reshape(-1, 2), speed=10e-3, rate=200.0)
    read = lab.encoded(place, step=10 * MICRO)
    data = identify.load(*in_the_plane(time, read, velocity))
    fit = identify.fit_law(data, reservoir="ellipse", direction="ellipse")
    truth = {"reservoir.a": 0.54, "reservoir.b": 0.46, "direction.ratio": 1.5}
    for name, value in truth.items():
        one = fit.parameters[name]
        assert abs(one.value - value) < 4.0 * one.standard_error, name
