"""The file ``track.toml``."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage import toml
from asperity._base.storage.toml import NUMBER, NUMBERS, TEXT, Schema, TomlFile
from asperity.errors import ParameterError
from asperity.track.image.scene import PlaneView
from asperity.track.image.segmentation import Mark

_POINTS = {"pixels", "plane"}
_SCALE = {"metres_per_pixel", "origin", "angle"}
_SCHEMA: Schema = {
    **dict.fromkeys(("fps", "bandwidth", "start", "stop"), NUMBER),
    "mark": {
        "colour": TEXT,
        **dict.fromkeys(("diameter", "threshold", "smoothing", "blur_limit"), NUMBER),
    },
    "scene": dict.fromkeys(("pixels", "plane", "metres_per_pixel", "origin", "angle"), NUMBERS),
}
# Points that are further off than this, in pixels, have been mixed up.
_MISMATCH = 3.0


@dataclass(frozen=True)
class TrackConfig:
    """What a recording does not say itself.

    Attributes:
        fps: frames per second of the recording in 1/s.
        scene: from pixels to the plane.
        mark: what to look for.
        bandwidth: of velocity and acceleration in s, ``None`` for the default.
        start: time of the first frame in which the body moves in s, ``None`` for the default.
        stop: time of the last one in s.
        mismatch: of the scene's points in pixels, root mean square; 0 without points.
        file: where it was read, for messages.
    """

    fps: float
    scene: PlaneView
    mark: Mark
    bandwidth: float | None = None
    start: float | None = None
    stop: float | None = None
    mismatch: float = 0.0
    file: TomlFile | None = field(default=None, repr=False, compare=False)


def read_config(path: str | os.PathLike[str]) -> TrackConfig:
    """Read ``track.toml``: lengths in m, times in s, angles in rad.

    .. code:: toml

        fps = 500.0
        bandwidth = 0.03            # optional, like the times start and stop of the motion
        [mark]
        colour = "red"
        diameter = 0.010            # optional, like threshold, smoothing, blur_limit
        [scene]                     # points of a target at the height of the mark
        pixels = [[100, 980], [1800, 985], [1790, 90], [110, 95]]
        plane = [[0.0, 0.0], [0.25, 0.0], [0.25, 0.13], [0.0, 0.13]]

    A camera that looks straight down needs instead ``metres_per_pixel``, ``origin``, ``angle``.

    Args:
        path: of the file.

    Raises:
        ConfigurationError: naming file, line and key, if one is missing, unknown or not allowed.
    """
    file = TomlFile(path, _SCHEMA)
    given = file.values
    if "fps" not in given:
        raise file.error(
            "fps",
            "is missing: the frames per second while recording, since files state the playback",
        )
    if "scene" not in given:
        raise file.error("scene", "is missing: points (pixels, plane) or metres_per_pixel")
    with file.blamed():
        scene, mismatch = _scene(given["scene"])
        bandwidth = given.get("bandwidth")
        times = {name: given[name] for name in ("start", "stop") if name in given}
        config = TrackConfig(
            fps=arrays.positive(given["fps"], "fps"),
            scene=scene,
            mark=Mark(**given.get("mark", {})),
            bandwidth=None if bandwidth is None else arrays.positive(bandwidth, "bandwidth"),
            mismatch=mismatch,
            file=file,
            **{name: arrays.non_negative(value, name) for name, value in times.items()},
        )
    return config


def config_text(fps: float, mark: Mark, pixels: Array, plane: Array) -> str:
    """Return the text of a file that `read_config` reads."""
    return toml.text(
        {
            "fps": fps,
            "mark": {
                "colour": mark.colour,
                "diameter": mark.diameter,
                "threshold": mark.threshold,
                "smoothing": mark.smoothing,
            },
            "scene": {"pixels": pixels.tolist(), "plane": plane.tolist()},
        }
    )


def _scene(given: Mapping[str, Any]) -> tuple[PlaneView, float]:
    """Return the scene and how far its points are off."""
    points, scale = given.keys() & _POINTS, given.keys() & _SCALE
    if points and scale:
        raise ParameterError(
            "scene", f"gives points and a scale: leave {min(points)} or {min(scale)} out"
        )
    if "metres_per_pixel" in scale:
        return PlaneView.from_scale(**given), 0.0
    if points != _POINTS:
        raise ParameterError("scene", "must hold pixels and plane, or metres_per_pixel")
    scene = PlaneView.from_points(given["pixels"], given["plane"])
    mismatch = scene.mismatch(given["pixels"], given["plane"])
    if mismatch > _MISMATCH:
        raise ParameterError(
            "scene",
            f"points do not fit a plane, they are {mismatch:.1f} pixels off: check their order",
        )
    return scene, mismatch
