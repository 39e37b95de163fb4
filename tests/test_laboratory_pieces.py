"""Records that are cut, and strokes without load: each stroke is one, and the lifted ones none."""

from itertools import pairwise

import laboratory_files as lab
import numpy as np
import pytest
from asperity import identify

pandas = pytest.importorskip("pandas")

SPLIT = {"file": {"on_defect": "split"}}
PLAIN = {"time": "t", "tangential": "Ft", "radial": "Fr", "normal": "Fn"}


def stroke_record():
    time, place, velocity = lab.back_and_forth(
        "sine", length=20e-3, speed=10e-3, dwell=0.5, rate=200.0, repeats=6
    )
    way = np.sign(velocity)
    columns = {"t": time, "s": lab.encoded(place, step=5e-6)}
    columns |= {"Ft": 5.0 * way, "Fr": 0.3 * way, "Fn": np.full(time.size, lab.LOAD)}
    return pandas.DataFrame(columns), {"columns": PLAIN | {"position": "s"}}


def round_record():
    time, place, _, force, normal = lab.plane_path()
    place = lab.encoded(place, step=5e-6)
    columns = {"t": time, "x": place[:, 0], "y": place[:, 1], "Ft": force[:, 0], "Fr": force[:, 1]}
    names = {"time": "t", "force_x": "Ft", "force_y": "Fr", "normal": "Fn"}
    names |= {"position_x": "x", "position_y": "y"}
    return pandas.DataFrame(columns | {"Fn": normal}), {"columns": names}


def swing_record():
    time, angle, rate = lab.back_and_forth(
        "sine", length=1.6, speed=1.2, dwell=0.4, rate=200.0, repeats=4
    )
    way = np.sign(rate)
    columns = {"t": time, "a": lab.encoded(angle, step=2e-4), "Ft": 5.0 * way, "Fr": 0.3 * way}
    frame = pandas.DataFrame(columns | {"Fn": np.full(time.size, lab.LOAD)})
    return frame, {"columns": PLAIN | {"angle": "a"}}


RECORDS = {"strokes": (stroke_record, 12), "round": (round_record, 4), "swing": (swing_record, 8)}


def noisy(frame):
    """Return forces with noise, so that no channel is constant or clipped."""
    random = np.random.default_rng(1)
    changed = frame.copy()
    changed[["Ft", "Fr", "Fn"]] += 0.02 * random.normal(size=(len(frame), 3))
    return changed


@pytest.mark.parametrize("name", RECORDS)
@pytest.mark.parametrize("broken", [1, 6, 30])
def test_strokes_with_broken_lines_are_those_of_the_whole(name, broken):
    make, turns = RECORDS[name]
    frame, sections = make()
    frame = noisy(frame)
    rows = np.random.default_rng(broken).choice(len(frame), broken, replace=False)
    whole = identify.load(frame, sections)
    assert whole.turns == turns
    bad = frame.copy()
    bad.loc[rows, "Ft"] = np.nan
    cut = identify.load(bad, sections | SPLIT)
    assert len(cut.raw.recordings) > 1
    assert cut.turns == turns
    assert cut.goes_round == whole.goes_round
    at = np.searchsorted(frame["t"], cut.time)
    # Samples near an end may be in a stroke or not; those that are in one are in the same one.
    both = (cut.turn >= 0) & (whole.turn[at] >= 0)
    assert both.sum() > 0.95 * (whole.turn >= 0).sum()
    assert (np.abs(cut.turn - whole.turn[at])[both] <= (name == "round")).all()
    assert (cut.turn != whole.turn[at])[both].sum() <= 10
    # The same where the positions are broken.
    moved = next(one for one in ("s", "x", "a") if one in frame)
    lost = frame.copy()
    lost.loc[rows, moved] = np.nan
    assert identify.load(lost, sections | SPLIT).turns == turns


@pytest.mark.parametrize("name", RECORDS)
def test_strokes_go_on_in_the_next_file_and_in_the_next_window(name):
    make, turns = RECORDS[name]
    frame, sections = make()
    frame = noisy(frame)
    ends = np.linspace(0, len(frame), 6).astype(int)
    parts = [frame.iloc[a:b].reset_index(drop=True) for a, b in pairwise(ends)]
    assert identify.load(parts, sections).turns == turns
    if name != "swing":
        inner = frame["t"].to_numpy()[ends[1:-1]]
        window = {"from": [0.0, *inner.tolist()], "to": [*(inner - 1e-3).tolist(), 999.0]}
        assert identify.load(frame, sections | {"run": window}).turns == turns


def test_a_stroke_of_another_time_or_direction_is_another_one():
    frame, sections = stroke_record()
    frame = noisy(frame)
    cut = int(np.searchsorted(frame["t"], 1.5))
    parts = [frame.iloc[:cut].copy(), frame.iloc[cut:].copy().reset_index(drop=True)]
    assert identify.load(parts, sections).turns == 12
    later = [parts[0], parts[1].assign(t=parts[1]["t"] + 60.0)]
    assert identify.load(later, sections).turns == 13
    # A file for each stroke, whose clock starts anew, is a stroke each.
    anew = [parts[0], parts[1].assign(t=parts[1]["t"] - parts[1]["t"][0])]
    assert identify.load(anew, sections).turns == 13
    turned = sections | {"run": {"angles": [0.0, 0.5]}}
    assert identify.load(parts, turned).turns == 13


def lifted(angles, *, soft=0.0, dwell=0.3, zero=0.0):
    """Return records of strokes on whose way back the pin is lifted, by angle of the surface.

    Args:
        angles: how the surface lies.
        soft: time in s in which the load rises.
        dwell: at the ends of the strokes, in s.
        zero: of the normal channel in N.
    """
    random, frames = np.random.default_rng(0), []
    for angle in angles:
        time, place, velocity = lab.back_and_forth(
            "ramp", length=20e-3, speed=20e-3, dwell=dwell, rate=500.0, repeats=4
        )
        pressed = np.convolve((velocity > 0.0).astype(float), np.ones(41), "same") > 0.0
        rise = np.ones(1 + int(500 * soft))
        load = lab.LOAD * np.convolve(pressed.astype(float), rise / rise.size, "same")
        along = np.array([np.cos(angle), np.sin(angle)])
        across = np.array([-along[1], along[0]])
        slip = np.where(velocity[:, None] < 0.0, -along, along)
        force = -lab.ROUND.force(slip, normal_force=1.0) * (load * (velocity != 0.0))[:, None]
        force += 0.1 * random.normal(size=force.shape)
        normal = load + zero + 0.02 * random.normal(size=time.size)
        columns = {"t": time, "s": place, "Ft": force @ along, "Fr": force @ across, "Fn": normal}
        frames.append(pandas.DataFrame(columns))
    lie = {"angles": np.rad2deg(angles).tolist()}
    names = PLAIN | {"position": "s"}
    return frames, {"columns": names, "units": {"angle": "deg"}, "run": lie}


@pytest.mark.parametrize(
    "options", [{}, {"zero": 0.1}, {"zero": -0.1}, {"soft": 0.1}, {"dwell": 0.0}]
)
def test_strokes_without_load_are_left_out(options, caplog):
    angles = np.deg2rad(np.arange(0.0, 360.0, 30.0))
    data = identify.load(*lifted(angles, **options))
    assert (data.turns, data.lifted) == (48, 48)
    assert "48 of 96 strokes are left out: there the pin is lifted" in caplog.text
    assert "48 strokes (48 without load left out)" in repr(data)
    used = data.turn >= 0
    # The filter does not spread the lifting over the strokes.
    if "soft" not in options:
        assert np.ptp(data.normal_force[used]) < 0.15
    assert data.usual_load == pytest.approx(lab.LOAD + options.get("zero", 0.0), abs=0.06)
    fit = identify.fit_law(data, reservoir="ellipse", direction="ellipse")
    for name, value in {"reservoir.a": 0.54, "reservoir.b": 0.46, "direction.ratio": 1.5}.items():
        off = 0.012 if "zero" in options and name != "direction.ratio" else 0.002
        assert fit.parameters[name].value == pytest.approx(value, rel=off)


def test_lifting_between_strokes_does_not_reach_into_them():
    """The way back may be too fast to be a stroke."""
    frames, sections = lifted([0.0, 1.0])
    # Of the 62 samples on the way back, four are left.
    for at, whole in enumerate(frames):
        frame = whole.iloc[::8].reset_index(drop=True)
        back = np.flatnonzero((np.gradient(frame["s"]) < -1e-5) & (frame["Fn"] < 2.0))
        kept = np.setdiff1d(np.arange(len(frame)), back[np.arange(back.size) % 16 > 0])
        frames[at] = frame.iloc[kept].reset_index(drop=True)
        frames[at]["t"] = 16e-3 * np.arange(len(kept))
    data = identify.load(frames, sections)
    assert (data.turns, data.lifted) == (8, 0)
    used = data.turn >= 0
    assert np.ptp(data.normal_force[used]) < 0.2
