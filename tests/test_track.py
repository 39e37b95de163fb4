"""Marks in frames: circles, outlines, what is reported of bad frames."""

import numpy as np
import pytest
from asperity import DimensionError, ParameterError
from asperity.track import Mark, PlaneView, Sight, fit_circle, track_mark
from asperity.track.image.segmentation import outline
from scipy.ndimage import gaussian_filter

PIXELS = PlaneView.from_scale(1.0)
PAINT = {
    "red": (200, 30, 40),
    "green": (40, 180, 60),
    "blue": (40, 60, 210),
    "yellow": (215, 205, 40),
    "magenta": (200, 40, 190),
    "cyan": (40, 190, 200),
    "white": (250, 250, 250),
    "black": (5, 5, 5),
}


def share(shape, centre, radius, parts=8):
    """Count which of many points in each pixel lie in a disk."""
    fine = (np.arange(parts) + 0.5) / parts - 0.5
    row = (np.arange(shape[0])[:, None] + fine).ravel()
    column = (np.arange(shape[1])[:, None] + fine).ravel()
    inside = np.hypot(column - centre[0], row[:, None] - centre[1]) < radius
    return inside.reshape(shape[0], parts, shape[1], parts).mean(axis=(1, 3))


def painted(shape, *disks, background=128.0, defocus=0.6, noise=0.0, rng=None):
    """Return a frame with disks (centre, radius, colour) drawn one over the other."""
    image = np.full((*shape, 3), background)
    for centre, radius, colour in disks:
        covered = gaussian_filter(share(shape, centre, radius), defocus)[..., None]
        image += covered * (np.array(colour, dtype=float) - image)
    if noise:
        image += noise * rng.standard_normal(image.shape)
    return np.clip(np.rint(image), 0.0, 255.0).astype(np.uint8)


def followed(frames, **mark):
    return track_mark(frames, fps=500.0, scene=PIXELS, mark=Mark(**mark))


@pytest.mark.parametrize("robust", [False, True])
@pytest.mark.parametrize("correlation", [0.0, 1.5])
def test_errors_of_circles_are_as_large_as_stated(robust, correlation):
    rng = np.random.default_rng(2)
    angle = np.arange(160) * 2.0 * np.pi / 160
    directions = np.column_stack([np.cos(angle), np.sin(angle)])
    off, stated = [], []
    for _ in range(400):
        noise = gaussian_filter(rng.standard_normal(160), correlation, mode="wrap")
        circle = fit_circle((20.0 + 0.1 * noise[:, None]) * directions, robust=robust)
        off.append(circle.centre)
        stated.append(np.diag(circle.covariance)[:2])
    ratio = np.sqrt(np.mean(np.square(off)) / np.mean(stated))
    assert 0.9 < ratio < 1.2


@pytest.mark.parametrize(
    ("points", "error", "message"),
    [
        ([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], DimensionError, "at least 4"),
        ([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]], ParameterError, "in line"),
        ([[1.0, 1.0]] * 5, ParameterError, "one point"),
        ([[1.0, np.nan]] * 5, ParameterError, "finite"),
        ([1.0, 2.0], DimensionError, "shape"),
    ],
)
def test_points_without_a_circle_are_refused(points, error, message):
    with pytest.raises(error, match=f"points: .*{message}"):
        fit_circle(points)


def test_centres_between_pixels():
    rng = np.random.default_rng(4)
    for _ in range(20):
        centre, radius = 32.0 + rng.uniform(-1.0, 1.0, 2), rng.uniform(5.0, 16.0)
        frame = painted((64, 64), (centre, radius, PAINT["red"]))
        track = followed([frame])
        assert track.pixel[0] == pytest.approx(centre, abs=0.02)
        assert track.diameter[0] == pytest.approx(2.0 * radius, abs=0.25)


def test_noise_moves_the_centre_as_much_as_stated():
    rng = np.random.default_rng(6)
    off, stated = [], []
    for _ in range(150):
        centre = 32.0 + rng.uniform(-0.5, 0.5, 2)
        frame = painted((64, 64), (centre, 14.0, PAINT["red"]), noise=8.0, rng=rng)
        track = followed([frame])
        off.append(track.pixel[0] - centre)
        stated.append(track.position_error[0])
    rms = np.sqrt(np.mean(np.square(off)))
    assert rms < 0.04
    assert 0.75 < rms / np.sqrt(np.mean(np.square(stated))) < 1.35


def test_reflections_are_reported_and_hardly_move_the_centre():
    red = ((40.2, 39.7), 18.0, PAINT["red"])
    inside, rim = ((45.0, 42.0), 6.0, (255, 255, 255)), ((55.0, 48.0), 6.0, (255, 255, 255))
    ghost = ((40.2, 60.0), 5.0, PAINT["red"])
    frames = [painted((80, 80), red, *extra) for extra in [(), (inside,), (rim,), (ghost,)]]
    tracks = [followed([frame]) for frame in frames]
    assert [Sight(int(track.status[0])) for track in tracks] == [
        Sight.GOOD,
        Sight.REFLECTION,
        Sight.REFLECTION,
        Sight.REFLECTION,
    ]
    for track in tracks:
        assert track.pixel[0] == pytest.approx([40.2, 39.7], abs=0.1)
    assert tracks[1].filling[0] == pytest.approx(1.0 - (6.0 / 18.0) ** 2, abs=0.03)
    assert tracks[2].coverage[0] < 1.0


def test_a_lost_mark_is_found_again_where_it_can_be():
    blank = painted((100, 160))
    places = [(30.0, 30.0), (34.0, 30.0), None, None, (44.0, 40.0), (48.0, 41.0)]
    frames = [
        blank if place is None else painted((100, 160), (place, 9.0, PAINT["red"]))
        for place in places
    ]
    track = followed(frames)
    assert track.frames(Sight.LOST).tolist() == [2, 3]
    assert track.quality == "4 good, 2 lost"
    assert np.isnan(track.position[2:4]).all()
    assert track.pixel[4:] == pytest.approx(np.array(places[4:]), abs=0.02)


def test_a_covered_mark_is_not_taken_for_another_one():
    """Another thing of its colour is in view; a gap, then the mark goes on."""
    frames = []
    for k in range(24):
        disks = [((250.0, 40.0), 9.0, PAINT["red"])] if k >= 3 else []
        if not 8 <= k < 16:
            disks.append(((30.0 + 3.0 * k, 80.0), 9.0, PAINT["red"]))
        frames.append(painted((120, 280), *disks))
    track = followed(frames)
    assert track.quality == "16 good, 8 lost"
    assert track.frames(Sight.LOST).tolist() == list(range(8, 16))
    assert track.pixel[16:, 0] == pytest.approx(30.0 + 3.0 * np.arange(16, 24), abs=0.05)


MEETINGS = [
    pytest.param(
        aside,
        speeds,
        scale,
        id=f"{aside}-{speeds}-{scale}",
        marks=()
        if (aside, speeds, scale) in ((0.0, (6.0, 6.0), 2e-4), (8.0, (2.0, 8.0), 2e-4))
        else pytest.mark.long,
    )
    for aside in (0.0, 3.0, 8.0, 15.0, 18.0, 22.0)
    for speeds in ((6.0, 6.0), (3.0, 3.0), (8.0, 2.0), (2.0, 8.0), (6.0, 0.0))
    for scale in (1.0, 2e-4)
]


@pytest.mark.parametrize(("aside", "speeds", "scale"), MEETINGS)
def test_equal_marks_that_cross_are_not_mistaken_silently(aside, speeds, scale):
    k = np.arange(36)[:, None]
    mine = [30.0, 50.0] + k * [speeds[0], 0.0]
    other = [270.0, 50.0 + aside] - k * [speeds[1], 0.0]
    frames = [
        painted((100, 300), *((place, 9.0, PAINT["red"]) for place in both))
        for both in zip(mine, other, strict=True)
    ]
    frames[0] = painted((100, 300), (mine[0], 9.0, PAINT["red"]))
    track = track_mark(frames, fps=500.0, scene=PlaneView.from_scale(scale), mark=Mark())
    off = np.hypot(*(track.pixel - mine).T)
    assert (track.status[off > 3.0] != 0).all()
    # Until they meet there is no doubt.
    apart = other[:, 0] - mine[:, 0] > 60.0
    assert not track.status[: apart.argmin()].any()


def film(places, noise=0.0, again=()):
    """Return frames of a mark, by four pixels per place, some of which are shown again."""
    rng, frames = np.random.default_rng(0), []
    for k, x in enumerate(places):
        disk = ((30.0 + 4.0 * x, 30.0), 9.0, PAINT["red"])
        new = painted((60, 260), disk, noise=noise, rng=rng)
        frames.append(frames[-1] if k in again else new)
    return frames


@pytest.mark.parametrize("pace", [1.0, 0.2])
@pytest.mark.parametrize("noise", [1.0, 3.0])
def test_frames_that_are_shown_again_have_no_position(pace, noise):
    for places, again in (
        ([0, 1, 2, 2, 4, 5, 6, 6, 6, 9, 10], [3, 7, 8]),
        ([0, 1, 2, 2, 3, 4, 5, 6, 7], [3]),
        ([0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 10, 11], [1, 3, 5, 7, 9]),
        # A rest in which one frame is shown again.
        ([0, 1, 2, 3, 4, 4, 4, 4, 5, 6, 7], [6]),
    ):
        track = followed(film(pace * np.array(places), noise, again))
        assert track.frames(Sight.REPEATED).tolist() == again
        assert np.isnan(track.position[again]).all()
        assert track.quality == f"{len(places) - len(again)} good, {len(again)} repeated"


def test_marks_that_stand_still_in_images_without_noise_are_reported():
    # Fillers for dropped frames, one and two in a row; a frame that is shown twice; every second.
    for places, repeated in (
        ([0, 1, 2, 2, 4, 5, 6, 6, 6, 9, 10], [3, 7, 8]),
        ([0, 1, 2, 2, 3, 4, 5], [3]),
        ([0, 0, 2, 2, 4, 4, 6, 6, 8], [3, 5, 7]),
    ):
        track = followed(film(places))
        assert track.frames(Sight.STILL).tolist() == repeated
        assert f"{len(repeated)} still" in track.quality
    # Rest before, between and after motions; a body that slows down, turns back, or is hidden.
    slow = np.cumsum([0.0, 2.0, 1.6, 1.2, 0.8, 0.4, 0.05, 0.0, 0.0, 0.4, 0.8, 1.2, 1.6])
    for places in (
        [0, 0, 0, 1, 2, 3, 4, 4, 4, 4],
        slow,
        [0, 2, 4, 4, 2, 0],
        [0, 1, 2, *[2] * 12, 3, 4, 5],
    ):
        assert "still" not in followed(film(places)).quality


def test_a_known_diameter_chooses_the_mark_and_reveals_a_wrong_scale():
    frame = painted(
        (100, 200), ((40.0, 50.0), 9.0, PAINT["red"]), ((150.0, 50.0), 16.0, PAINT["red"])
    )
    assert followed([frame], diameter=18.0).pixel[0] == pytest.approx([40.0, 50.0], abs=0.02)
    assert followed([frame], diameter=32.0).pixel[0] == pytest.approx([150.0, 50.0], abs=0.02)
    with pytest.raises(ParameterError, match=r"mark.diameter: .* scale"):
        followed([frame], diameter=24.0)


def test_no_mark_at_all_is_an_error():
    with pytest.raises(ParameterError, match="no green mark in any of 2 frames"):
        followed([painted((40, 40))] * 2, colour="green")
    with pytest.raises(ParameterError, match="holds no frame"):
        followed([])
    assert outline(np.zeros((2, 2, 3), dtype=np.uint8), Mark()) is None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"fps": 0.0}, "fps: must be positive"),
        ({"fps": float("nan")}, "fps"),
        ({"scene": None}, "scene: must be a PlaneView"),
        ({"mark": "red"}, "mark: must be a Mark"),
        ({"frames": 3}, "frames: must be"),
        ({"frames": [np.zeros((4, 4))]}, "frames: must be .*frame 0"),
        ({"frames": [np.zeros((4, 4, 3))]}, "frames: must be .*float64"),
        ({"frames": "nowhere.mp4"}, "nowhere.mp4: is neither"),
    ],
)
def test_bad_arguments_are_named(arguments, message):
    good = {"frames": [painted((40, 40))], "fps": 500.0, "scene": PIXELS}
    with pytest.raises(ParameterError, match=message):
        track_mark(**{**good, **arguments})
