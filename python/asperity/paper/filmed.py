"""A filmed disk: run of the rigid body on three pads, virtual camera, tracked path."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from asperity._base.arrays import Array
from asperity.law import FrictionLaw
from asperity.paper.pairings import PVC
from asperity.runs.time_stepping import simulate
from asperity.runs.trajectory import Trajectory
from asperity.system import SlidingDisk
from asperity.track import MeasuredPath, Scene, Track, VirtualCamera, track_mark

SYNTHETIC = "synthetic data: virtual camera"
"""What a figure with such data says of them."""

SPEED, ANGLE = 1.52, 58.0
"""Initial speed in m/s and its angle to the grooves in degrees, of Fig. 27."""

_STEP = 1e-4


@dataclass(frozen=True)
class Filmed:
    """A disk that slides, frames of it, and what tracking makes of them."""

    disk: SlidingDisk
    run: Trajectory
    camera: VirtualCamera
    track: Track
    path: MeasuredPath


def slide(law: FrictionLaw, speed: float, angle: float) -> tuple[SlidingDisk, Trajectory]:
    """Simulate the disk of §5.1 until rest.

    Args:
        law: friction law of the pads.
        speed: initial speed in m/s.
        angle: of the initial velocity to the grooves, which lie along e₂, in degrees.
    """
    disk = SlidingDisk(law, velocity=initial_velocity(speed, angle))
    run = simulate(disk, dt=_STEP, t_end=1.0, until_rest=True, tolerance=1e-13)
    return disk, run


def initial_velocity(speed: float, angle: float) -> Array:
    """Return (v₁, v₂) for an angle to the grooves in degrees."""
    turned = np.deg2rad(angle)
    return speed * np.array([np.sin(turned), np.cos(turned)])


@cache
def filmed() -> Filmed:
    """Film and track the disk of Fig. 27, which obeys the law of PVC on ground steel."""
    disk, run = slide(PVC.law, SPEED, ANGLE)
    return film(disk, run, fps=500.0, size=(640, 560), seed=27)


def film(
    disk: SlidingDisk, run: Trajectory, *, fps: float, size: tuple[int, int], seed: int
) -> Filmed:
    """Film a disk and track its mark.

    Args:
        disk: that slides.
        run: its motion.
        fps: frames per second in 1/s.
        size: columns and rows of the image.
        seed: of the noise.
    """
    camera = VirtualCamera(run, fps=fps, size=size, seed=seed)
    scene = Scene.from_points(*reference_points(camera))
    track = track_mark(camera.frames(), fps=fps, scene=scene, mark=camera.mark)
    return Filmed(disk, run, camera, track, track.path())


def reference_points(camera: VirtualCamera) -> tuple[Array, Array]:
    """Return pixels of nine points, read to 0.1 pixel, and their places in m."""
    columns, rows = camera.size
    share = np.array([0.1, 0.5, 0.9])
    pixels = np.stack(np.meshgrid(columns * share, rows * share), axis=-1).reshape(-1, 2)
    places = camera.view.to_plane(pixels)
    read = pixels + 0.1 * np.random.default_rng(camera.seed).normal(size=pixels.shape)
    return read, places
