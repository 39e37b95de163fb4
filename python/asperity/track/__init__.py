"""Paths of sliding bodies from videos: mark, circle, scene, path; and a camera with known truth."""

from asperity.track.camera import VirtualCamera
from asperity.track.circle import Circle, fit_circle
from asperity.track.config import TrackConfig, read_config
from asperity.track.frames import ImageFolder, open_frames
from asperity.track.path import MeasuredPath
from asperity.track.scene import Scene
from asperity.track.segmentation import Mark
from asperity.track.sight import Sight
from asperity.track.track import Track, track_mark
from asperity.track.video import VideoFile, write_video

__all__ = [
    "Circle",
    "ImageFolder",
    "Mark",
    "MeasuredPath",
    "Scene",
    "Sight",
    "Track",
    "TrackConfig",
    "VideoFile",
    "VirtualCamera",
    "fit_circle",
    "open_frames",
    "read_config",
    "track_mark",
    "write_video",
]
