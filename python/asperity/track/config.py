"""The file ``track.toml``."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import ParameterError
from asperity.track.scene import Scene
from asperity.track.segmentation import Mark

_TOP = {"fps", "bandwidth", "start", "stop", "mark", "scene"}
_MARK = {"colour", "diameter", "threshold", "smoothing", "blur_limit"}
_POINTS = {"pixels", "plane"}
_SCALE = {"metres_per_pixel", "origin", "angle"}
# Points that are further off than this, in pixels, have been mixed up.
_MISMATCH = 3.0


@dataclass(frozen=True)
class TrackConfig:
    """What a recording does not say itself.

    Attributes:
        fps: frames per second of the recording in 1/s.
        scene: from pixels to the plane.
        mark: what to look for.
        bandwidth: of velocity and acceleration in s, `None` for the default.
        start: time of the first frame in which the body moves in s, `None` for the default.
        stop: time of the last one in s.
        mismatch: of the scene's points in pixels, root mean square; 0 without points.
    """

    fps: float
    scene: Scene
    mark: Mark
    bandwidth: float | None = None
    start: float | None = None
    stop: float | None = None
    mismatch: float = 0.0


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
        ParameterError: naming file and key, if one is missing, unknown or not allowed.
    """
    name = Path(path).name
    contents = _contents(Path(path))
    _known(contents, _TOP, name)
    if "fps" not in contents:
        raise ParameterError(
            name, "must state fps, the frames per second while recording: files state the playback"
        )
    if "scene" not in contents:
        raise ParameterError(name, "must have [scene]: points (pixels, plane) or metres_per_pixel")
    mark, scene = _table(contents, "mark", name), _table(contents, "scene", name)
    _known(mark, _MARK, f"{name} [mark]")
    for table in (contents, mark, scene):
        _no_flags(table, name)
    try:
        view, mismatch = _scene(scene, f"{name} [scene]")
        bandwidth = contents.get("bandwidth")
        times = {
            key: arrays.non_negative(contents[key], key)
            for key in ("start", "stop")
            if key in contents
        }
        return TrackConfig(
            fps=arrays.positive(contents["fps"], "fps"),
            scene=view,
            mark=Mark(**mark),
            bandwidth=None if bandwidth is None else arrays.positive(bandwidth, "bandwidth"),
            mismatch=mismatch,
            **times,
        )
    except ParameterError as error:
        if error.argument.startswith(name):
            raise
        raise ParameterError(name, str(error)) from None


def _contents(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError:
        problem = "is no TOML file: save it as UTF-8"
    except tomllib.TOMLDecodeError as error:
        problem = f"is no TOML file: {error}"
    except IsADirectoryError:
        problem = "is a folder: name the file in it, such as track.toml"
    except FileNotFoundError:
        problem = "is missing: write it, or name another configuration"
    raise ParameterError(os.fspath(path), problem)


def config_text(fps: float, mark: Mark, pixels: Array, plane: Array) -> str:
    """Return the text of a file that `read_config` reads."""
    lines = [f"fps = {fps!r}", "", "[mark]", f'colour = "{mark.colour}"']
    if mark.diameter is not None:
        lines.append(f"diameter = {mark.diameter!r}")
    lines += [f"threshold = {mark.threshold!r}", f"smoothing = {mark.smoothing!r}"]
    lines += ["", "[scene]", f"pixels = {pixels.tolist()}", f"plane = {plane.tolist()}", ""]
    return "\n".join(lines)


def _scene(table: Mapping[str, Any], where: str) -> tuple[Scene, float]:
    """Return the scene and how far its points are off."""
    if "metres_per_pixel" in table:
        _known(table, _SCALE, where)
        return Scene.from_scale(**table), 0.0
    _known(table, _POINTS, where)
    if not table.keys() >= _POINTS:
        raise ParameterError(where, "must hold pixels and plane, or metres_per_pixel")
    scene = Scene.from_points(table["pixels"], table["plane"])
    mismatch = scene.mismatch(table["pixels"], table["plane"])
    if mismatch > _MISMATCH:
        raise ParameterError(
            where,
            f"points do not fit a plane, they are {mismatch:.1f} pixels off: check their order",
        )
    return scene, mismatch


def _table(contents: Mapping[str, Any], key: str, name: str) -> dict[str, Any]:
    table = contents.get(key, {})
    if not isinstance(table, dict):
        raise ParameterError(name, f"must hold [{key}] as a table, got {table!r}")
    return table


def _known(table: Mapping[str, Any], allowed: set[str], where: str) -> None:
    unknown = sorted(table.keys() - allowed)
    if unknown:
        raise ParameterError(
            where, f"holds an unknown key {unknown[0]!r}; known are {', '.join(sorted(allowed))}"
        )


def _no_flags(table: Mapping[str, Any], name: str) -> None:
    """Refuse true and false, which Python counts as 1 and 0."""
    for key, value in table.items():
        if isinstance(value, bool):
            raise ParameterError(name, f"{key}: must not be {str(value).lower()}")
