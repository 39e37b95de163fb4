"""A disk on three pads slides, is filmed by a virtual camera, and its mark is tracked."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import asperity as asp
from asperity.track import MeasuredPath, PlaneView, Track, VirtualCamera, track_mark

STEP = 1e-4
"""Time step in s."""


@dataclass(frozen=True)
class Film:
    """A disk that slides, frames of it, and what tracking makes of them."""

    disk: asp.SlidingDisk
    run: asp.Trajectory
    camera: VirtualCamera
    track: Track
    path: MeasuredPath


def slide(
    law: asp.FrictionLaw, speed: float, angle: float
) -> tuple[asp.SlidingDisk, asp.Trajectory]:
    """Simulate the disk of [WL19] §5.1 until rest.

    Args:
        law: friction law of the pads.
        speed: initial speed in m/s.
        angle: of the initial velocity to the grooves, which lie along e₂, in degrees.
    """
    turned = np.deg2rad(angle)
    disk = asp.SlidingDisk(law, velocity=speed * np.array([np.sin(turned), np.cos(turned)]))
    return disk, until_rest(disk)


def until_rest(disk: asp.SlidingDisk) -> asp.Trajectory:
    """Simulate a disk until it rests."""
    return asp.simulate(disk, dt=STEP, t_end=1.0, until_rest=True, tolerance=1e-13)


def film(
    disk: asp.SlidingDisk, run: asp.Trajectory, *, fps: float, size: tuple[int, int], seed: int
) -> Film:
    """Film a disk and track its mark.

    Args:
        disk: that slides.
        run: its motion.
        fps: frames per second in 1/s.
        size: columns and rows of the image.
        seed: of the noise.
    """
    camera = VirtualCamera(run, fps=fps, size=size, seed=seed)
    scene = PlaneView.from_points(*_reference_points(camera))
    track = track_mark(camera.frames(), fps=fps, scene=scene, mark=camera.mark)
    return Film(disk, run, camera, track, track.path())


def _reference_points(camera: VirtualCamera) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return pixels of nine points, read to 0.1 pixel, and their places in m."""
    columns, rows = camera.size
    share = np.array([0.1, 0.5, 0.9])
    pixels = np.stack(np.meshgrid(columns * share, rows * share), axis=-1).reshape(-1, 2)
    places = camera.view.to_plane(pixels)
    read = pixels + 0.1 * np.random.default_rng(camera.seed).normal(size=pixels.shape)
    return read, places
