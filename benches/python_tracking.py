"""Full-HD frames tracked per second of one core, and the errors of the centres.

Bars: 100 frames per second with a region of interest, 0.1 pixels, 0.2 mm. The frames are made
before the clock starts, which is the processor time of the process; the compression of videos moves
centres, too. Run `python benches/python_tracking.py`.
"""

import os
import tempfile
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

# Before NumPy: its threads would count as well.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import asperity as asp
import numpy as np
from asperity.track import Mark, VirtualCamera, track_mark, write_video
from report import ratio

LAW = asp.FrictionLaw(
    asp.Superellipse(4.99 / 9.3, 4.25 / 9.3, 2.94), asp.Superellipse(1.84, 1.19, 2.51)
)
ANGLE = np.deg2rad(32.0)
MARKS = {"mark of 10 mm": 0.010, "whole disk, 28 mm": 0.028}


def run() -> asp.Trajectory:
    """Return the sliding path of Fig. 27."""
    return asp.simulate(
        asp.SlidingPoint(0.018, law=LAW),
        dt=1e-4,
        t_end=1.0,
        u0=[1.52 * np.cos(ANGLE), 1.52 * np.sin(ANGLE)],
        until_rest=True,
    )


def timed(work: Callable[[], object]) -> float:
    """Return the shortest processor time of three in s."""
    times = []
    for _ in range(3):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def row(name: str, camera: VirtualCamera, frames) -> str:
    """Track, and return a line of the table."""
    best = np.inf
    for _ in range(3):
        start = time.process_time()
        track = track_mark(frames, fps=camera.fps, scene=camera.view, mark=camera.mark)
        best = min(best, time.process_time() - start)
    off = np.abs(track.pixel - camera.pixel).max()
    end = 1e3 * np.hypot(*(track.path().end - camera.position[-1]))
    radius = 0.5 * np.median(track.diameter) / camera.view.pixel_size(track.pixel[0])
    return f"{name:<34} {radius:8.1f} {len(track) / best:10.0f} {off:12.4f} {end:12.4f}"


def main() -> None:
    """Print the table."""
    print("1920 x 1080                     radius [px]   frames/s  centre [px]     end [mm]")
    for name, diameter in MARKS.items():
        camera = VirtualCamera(run(), fps=200.0, tilt=0.2, mark=Mark(diameter=diameter))
        frames = list(camera.frames())
        print(row(f"{name}, in memory", camera, frames))
        ratio(
            f"a full-HD frame tracked, {name}",
            timed(lambda c=camera, f=frames: track_mark(f, fps=c.fps, scene=c.view, mark=c.mark))
            / timed(lambda f=frames: [frame.sum() for frame in f]),
            "the sum of the frame's pixels by NumPy",
            "what a frame costs beside reading its pixels once",
        )
        if not find_spec("av"):
            print("videos: PyAV is not installed (pip install 'asperity[video]')")
            continue
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "slow.mp4"
            write_video(frames, path, quality=20)
            print(row(f"{name}, H.264 decoded", camera, path))
    print("bars                                             100       0.1000       0.2000")


if __name__ == "__main__":
    main()
