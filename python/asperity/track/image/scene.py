"""From pixels to the plane of the mark: scale and homography."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Given, Record, field, shaped
from asperity.errors import DimensionError, ParameterError

_ROUNDING = 1e-9


class PlaneView(Record):
    """Homography H from pixels to the plane in which the centre of the mark moves.

    Pixels are counted from the centre of the first one, columns to the right, rows downwards. With
    (a, b, c) = H (column, row, 1) the point is (a/c, b/c) in m. Lenses are taken as free of
    distortion.

    Args:
        homography: H, regular, shape ``(3, 3)``; its factor is free.

    >>> scene = PlaneView.from_scale(2e-4, origin=(100.0, 50.0))
    >>> scene.to_plane([110.0, 40.0]).round(9).tolist()
    [0.002, 0.002]
    """

    homography: Annotated[Given[ArrayLike, Array], shaped(3, 3)]
    _inverse: Array = field(init=False)

    def _derive(self) -> None:
        self._keep(_inverse=arrays.inverse(self.homography, "homography", 3))

    @classmethod
    def from_scale(
        cls, metres_per_pixel: float, *, origin: ArrayLike = (0.0, 0.0), angle: float = 0.0
    ) -> PlaneView:
        """Return the scene of a camera that looks straight down on the plane.

        Args:
            metres_per_pixel: length of a pixel in m.
            origin: pixel (column, row) where x₁ = x₂ = 0.
            angle: from the rows, rightwards, to e₁, counter-clockwise as seen in the image, in rad.
        """
        scale = arrays.positive(metres_per_pixel, "metres_per_pixel")
        column, row = arrays.array(origin, "origin", (2,))
        # Rows are counted downwards: the image is left-handed.
        turn = scale * arrays.rotation(-arrays.number(angle, "angle")) @ np.diag([1.0, -1.0])
        shift = -turn @ [column, row]
        return cls(np.vstack([np.column_stack([turn, shift]), [0.0, 0.0, 1.0]]))

    @classmethod
    def from_points(cls, pixels: ArrayLike, plane: ArrayLike) -> PlaneView:
        """Return the scene that maps known points best, by least squares in the image.

        Args:
            pixels: (column, row) of the points, shape ``(n, 2)``, n ≥ 4, no three of four in line.
            plane: their places in m at the height of the mark, shape ``(n, 2)``.

        Raises:
            ParameterError: if the points do not determine a homography.

        >>> square = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]]
        >>> corners = [[20.0, 980.0], [990.0, 985.0], [930.0, 40.0], [60.0, 50.0]]
        >>> scene = PlaneView.from_points(corners, square)
        >>> scene.to_plane([930.0, 40.0]).round(9).tolist()
        [0.1, 0.1]
        """
        image = arrays.array(pixels, "pixels", (None, 2))
        points = arrays.array(plane, "plane", (len(image), 2))
        if len(image) < 4:
            raise DimensionError("pixels", f"must hold at least 4 points, got {len(image)}")
        to_unit, back = _normalisation(image, "pixels"), _normalisation(points, "plane")
        start = _direct(_mapped(back, points), _mapped(to_unit, image))
        projection = np.linalg.inv(to_unit) @ _refined(start, points, image, to_unit, back) @ back
        # The horizon must not run between the points.
        depth = (projection @ np.column_stack([points, np.ones(len(points))]).T)[2]
        if depth.min() * depth.max() <= 0.0:
            raise ParameterError("pixels", "do not belong to the points of the plane in this order")
        return cls(np.linalg.inv(projection))

    @classmethod
    def from_camera(
        cls,
        position: ArrayLike,
        *,
        target: ArrayLike,
        focal_length: float,
        size: tuple[int, int],
    ) -> PlaneView:
        """Return the scene of a pinhole camera, upright, that looks at a point of the plane.

        Args:
            position: of the camera (x₁, x₂, height) in m.
            target: point of the plane in the middle of the image, in m.
            focal_length: in pixels.
            size: columns and rows of the image.
        """
        eye = arrays.array(position, "position", (3,))
        aim = np.append(arrays.array(target, "target", (2,)), 0.0)
        focal = arrays.positive(focal_length, "focal_length")
        if eye[2] <= 0.0:
            raise ParameterError("position", f"must be above the plane, got {eye.tolist()}")
        forward = (aim - eye) / np.linalg.norm(aim - eye)
        right = np.cross(forward, [0.0, 1.0, 0.0])
        right /= np.linalg.norm(right)
        down = np.cross(forward, right)
        columns, rows = (arrays.count(part, "size") for part in arrays.pair(size, "size"))
        inner = np.array(
            [[focal, 0.0, 0.5 * (columns - 1)], [0.0, focal, 0.5 * (rows - 1)], [0.0, 0.0, 1.0]]
        )
        turn = np.stack([right, down, forward])
        return cls(np.linalg.inv(inner @ np.column_stack([turn[:, 0], turn[:, 1], -turn @ eye])))

    def to_plane(self, pixels: ArrayLike) -> Array:
        """Return the points in m, shape ``(..., 2)``, of pixels (column, row)."""
        return _mapped(self.homography, arrays.array(pixels, "pixels"))

    def to_pixels(self, points: ArrayLike) -> Array:
        """Return the pixels (column, row), shape ``(..., 2)``, of points in m."""
        return _mapped(self._inverse, arrays.array(points, "points"))

    def pixel_size(self, pixel: ArrayLike) -> float:
        """Return the length of a pixel in m at a pixel (column, row): the root of its area."""
        column, row = arrays.array(pixel, "pixel", (2,))
        depth = self.homography[2] @ [column, row, 1.0]
        return math.sqrt(abs(float(np.linalg.det(self.homography)) / depth**3))

    def mismatch(self, pixels: ArrayLike, plane: ArrayLike) -> float:
        """Return how far known points are off in the image, root mean square in pixels."""
        known = arrays.array(plane, "plane", (None, 2))
        off = self.to_pixels(known) - arrays.array(pixels, "pixels", known.shape)
        return float(np.sqrt(np.mean(np.sum(off**2, axis=-1))))


def _mapped(matrix: Array, points: Array) -> Array:
    lifted = points @ matrix[:, :2].T + matrix[:, 2]
    return lifted[..., :2] / lifted[..., 2:]


def _normalisation(points: Array, argument: str) -> Array:
    """Return the similarity to mean 0 and size 1, without which the equations are ill-posed."""
    middle = points.mean(axis=0)
    spread = float(np.sqrt(np.mean((points - middle) ** 2)))
    if spread == 0.0:
        raise ParameterError(argument, "must not all be one point")
    return np.array(
        [
            [1.0 / spread, 0.0, -middle[0] / spread],
            [0.0, 1.0 / spread, -middle[1] / spread],
            [0.0, 0.0, 1.0],
        ]
    )


def _direct(points: Array, image: Array) -> Array:
    """Solve the linear equations for the homography from `points` to `image`."""
    lifted = np.column_stack([points, np.ones(len(points))])
    zero = np.zeros_like(lifted)
    equations = np.vstack(
        [
            np.hstack([lifted, zero, -image[:, :1] * lifted]),
            np.hstack([zero, lifted, -image[:, 1:] * lifted]),
        ]
    )
    _, singular, right = np.linalg.svd(equations)
    homography: Array = right[-1].reshape(3, 3)
    stretch = np.linalg.svd(homography, compute_uv=False)
    if singular[7] < _ROUNDING * singular[0] or stretch[2] < _ROUNDING * stretch[0]:
        raise ParameterError("pixels", "do not determine the scene: too many points lie in line")
    return homography


def _refined(start: Array, points: Array, image: Array, to_unit: Array, back: Array) -> Array:
    """Return the homography with the least squared distances in the image."""
    from scipy.optimize import least_squares

    source, target = _mapped(back, points), _mapped(to_unit, image)

    def off(entries: Array) -> Array:
        return (_mapped(entries.reshape(3, 3), source) - target).ravel()

    solution = least_squares(off, start.ravel() / np.linalg.norm(start), x_scale="jac")
    return solution.x.reshape(3, 3)
