"""``asperity track``: from a video to a measured path."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from asperity._base.progress import bar_if_there
from asperity.commands.options import DOUBTFUL, SUCCESS, Commands, add_out


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "track",
        help="track a round mark in a video and measure its path",
        description="Find a round mark in every frame of a video or of a folder of images, and "
        "turn its pixels into a path in metres with velocities. The configuration, a TOML file, "
        "states fps, the frames per second of the recording, not of the playback; [mark], the "
        "colour of the mark; and [scene], how large things are: four known points of the plane or "
        "metres per pixel. Written are path.csv (positions and velocities with their errors), "
        "frames.csv (what was seen in each frame), overlay.png, motion.png and report.html. Exit "
        "code 1 if no position is known for more than a tenth of the frames, or the body does not "
        "come to rest in view.",
        epilog="example: asperity track frames/ --config track.toml --out out/track",
    )
    parser.add_argument("video", metavar="VIDEO", type=Path, help="video file or folder of images")
    parser.add_argument(
        "--config",
        metavar="FILE",
        type=Path,
        required=True,
        help="TOML file of the recording, such as track.toml",
    )
    add_out(parser)
    return parser


def run(options: argparse.Namespace) -> int:
    """Track and print; return the exit code."""
    from asperity.track.recording import track_recording

    start = time.perf_counter()
    with bar_if_there() as move:
        result = track_recording(options.video, options.config, options.out, progress=move)
    print(result.summary())
    print(f"\nfigures and tables in {options.out}; {time.perf_counter() - start:.1f} s")
    return SUCCESS if result.complete else DOUBTFUL
