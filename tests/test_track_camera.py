"""The round trip: a simulated path is filmed, the film is tracked."""

import asperity as asp
import numpy as np
import pytest
from asperity import ParameterError
from asperity.track import (
    Mark,
    PlaneView,
    Sight,
    VirtualCamera,
    track_mark,
)
from filmed import RUN, SMALL
from table_1 import TABLE_1


@pytest.mark.parametrize(
    "options",
    [
        {"exposure": 2e-3, "fps": 500.0, "size": (320, 270)},
        {"glare": 0.6},
        {"tilt": 0.4, "noise": 6.0, "defocus": 1.5, "mark": Mark("blue", diameter=0.014)},
        *(
            pytest.param(one, marks=pytest.mark.long)
            for one in (
                {},
                {"tilt": 0.4, "seed": 1},
                {"noise": 6.0, "defocus": 1.5},
                {"mark": Mark("blue", diameter=0.014)},
            )
        ),
    ],
    ids=str,
)
def test_centres_and_end_point_of_the_round_trip(options):
    camera = VirtualCamera(RUN, **{**SMALL, **options})
    track = track_mark(camera.frames(), fps=camera.fps, scene=camera.view, mark=camera.mark)
    assert len(track) == len(camera)
    assert track.time == pytest.approx(camera.time)
    assert np.abs(track.pixel - camera.pixel).max() < 0.1
    reflected = len(track.frames(Sight.REFLECTION))
    assert reflected == (len(track) if "glare" in options else 0)
    path = track.path()
    assert 1e3 * np.abs(path.end - RUN.q[-1]).max() < 0.02
    off = np.abs(path.velocity[0] - RUN.u[0])
    assert (off < 4.0 * path.velocity_error[0] + 2e-3).all()


def test_stated_errors_of_centres_are_of_the_right_size():
    camera = VirtualCamera(RUN, noise=5.0, **SMALL)
    track = track_mark(camera.frames(), fps=camera.fps, scene=camera.view, mark=camera.mark)
    score = (track.position - camera.position) / track.position_error
    assert 0.7 < np.sqrt(np.mean(score**2)) < 1.5


def test_the_camera_shows_what_its_scene_says():
    run = asp.simulate(asp.SlidingPoint(1.0, law=TABLE_1), dt=1e-3, t_end=0.01, q0=[0.02, 0.01])
    scene = PlaneView.from_scale(5e-4, origin=(30.0, 80.0))
    camera = VirtualCamera(
        run, fps=100.0, size=(120, 100), scene=scene, noise=0.0, mark=Mark(diameter=0.012)
    )
    frame = next(camera.frames()).astype(float)
    red = np.clip((frame[..., 0] - frame[..., 1]) / 160.0, 0.0, 1.0)
    row, column = np.mgrid[:100, :120]
    assert red.sum() == pytest.approx(np.pi * 12.0**2, rel=0.03)
    assert np.sum(red * column) / red.sum() == pytest.approx(70.0, abs=0.05)
    assert np.sum(red * row) / red.sum() == pytest.approx(60.0, abs=0.05)


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"fps": 0.0}, "fps"),
        ({"exposure": 0.1}, "exposure"),
        ({"coordinates": (0, 2)}, "coordinates"),
        ({"coordinates": (0,)}, "coordinates"),
        ({"size": (640,)}, "size"),
        ({"mark": Mark("red")}, "mark"),
        ({"noise": -1.0}, "noise"),
        ({"run": 3}, "run"),
    ],
)
def test_bad_cameras_are_refused(options, name):
    with pytest.raises(ParameterError, match=name):
        VirtualCamera(**{"run": RUN, **options})
