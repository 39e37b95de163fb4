"""From pixels to the plane."""

import numpy as np
import pytest
from asperity import DimensionError, ParameterError
from asperity.track import Mark, PlaneView, track_mark

SIZE = (640, 480)
CAMERA = PlaneView.from_camera((0.1, -0.5, 0.8), target=(0.1, 0.05), focal_length=900.0, size=SIZE)
PLANE = np.stack(np.meshgrid([0.0, 0.1, 0.2], [0.0, 0.06, 0.12]), axis=-1).reshape(-1, 2)


def test_pixels_and_points_are_inverse():
    pixel = np.random.default_rng(1).uniform(0.0, 400.0, (5, 7, 2))
    assert CAMERA.to_pixels(CAMERA.to_plane(pixel)) == pytest.approx(pixel, abs=1e-9)


def test_a_camera_is_a_pinhole():
    eye, target = np.array([0.1, -0.5, 0.8]), np.array([0.1, 0.05, 0.0])
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.array([1.0, 0.0, 0.0])
    up = np.cross(right, forward)
    for point in PLANE:
        arm = np.append(point, 0.0) - eye
        column = 319.5 + 900.0 * (arm @ right) / (arm @ forward)
        row = 239.5 - 900.0 * (arm @ up) / (arm @ forward)
        assert CAMERA.to_pixels(point) == pytest.approx([column, row], abs=1e-9)


def test_a_scale_counts_rows_downwards_and_may_turn():
    scene = PlaneView.from_scale(1e-3, origin=(100.0, 200.0))
    assert scene.to_plane([110.0, 180.0]) == pytest.approx([0.01, 0.02])
    turned = PlaneView.from_scale(1e-3, origin=(100.0, 200.0), angle=np.pi / 2)
    assert turned.to_plane([100.0, 190.0]) == pytest.approx([0.01, 0.0])
    assert turned.to_plane([90.0, 200.0]) == pytest.approx([0.0, 0.01])


def test_the_centre_of_the_mark_is_not_the_centre_of_its_image():
    view = PlaneView.from_camera((0.0, -0.3, 0.2), target=(0.0, 0.0), focal_length=700.0, size=SIZE)
    centre, radius = np.array([0.01, 0.02]), 0.03
    row, column = np.mgrid[: SIZE[1], : SIZE[0]]
    fine = np.array([-0.375, -0.125, 0.125, 0.375])
    share = np.zeros(row.shape)
    for dy in fine:
        for dx in fine:
            points = view.to_plane(np.stack([column + dx, row + dy], axis=-1).reshape(-1, 2))
            share += (np.hypot(*(points - centre).T) < radius).reshape(row.shape) / 16.0
    frame = np.full((*row.shape, 3), 128.0)
    frame += share[..., None] * (np.array([200.0, 30.0, 40.0]) - 128.0)
    track = track_mark(
        [np.rint(frame).astype(np.uint8)],
        fps=1.0,
        scene=view,
        mark=Mark(diameter=2.0 * radius, smoothing=0.5),
    )
    assert track.pixel[0] == pytest.approx(view.to_pixels(centre), abs=0.05)
    middle = np.array([np.sum(share * column), np.sum(share * row)]) / share.sum()
    assert np.hypot(*(middle - view.to_pixels(centre))) > 1.0


@pytest.mark.parametrize(
    ("pixels", "plane", "error", "message"),
    [
        (PLANE[:3], PLANE[:3], DimensionError, "pixels: .*at least 4"),
        (PLANE[:5], PLANE[:4], DimensionError, "plane: .*shape"),
        (PLANE[:3].repeat(2, axis=0), PLANE[:6], ParameterError, "line"),
        (np.zeros((4, 2)), PLANE[:4], ParameterError, "pixels: .*one point"),
        (1e3 * PLANE[[0, 2, 8, 6]], PLANE[[0, 8, 2, 6]], ParameterError, "order"),
    ],
)
def test_points_that_do_not_determine_a_scene_are_refused(pixels, plane, error, message):
    with pytest.raises(error, match=message):
        PlaneView.from_points(pixels, plane)


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: PlaneView(np.zeros((3, 3))), "homography"),
        (lambda: PlaneView(np.eye(2)), "homography"),
        (lambda: PlaneView.from_scale(-1.0), "metres_per_pixel"),
        (lambda: PlaneView.from_scale(1.0, origin=(1.0,)), "origin"),
        (
            lambda: PlaneView.from_camera((0, 0, -1), target=(0, 0), focal_length=1.0, size=(9, 9)),
            "position",
        ),
    ],
)
def test_bad_scenes_are_refused(make, name):
    with pytest.raises(ParameterError, match=name):
        make()
