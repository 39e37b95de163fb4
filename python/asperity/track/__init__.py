"""Paths of sliding bodies from videos: mark, circle, scene, path; and a camera with known truth."""

from asperity.track.camera import VirtualCamera
from asperity.track.config import TrackConfig, read_config
from asperity.track.film.frames import ImageFolder, open_frames
from asperity.track.film.video import VideoFile, write_video
from asperity.track.following.sight import Sight
from asperity.track.image.circle import Circle, fit_circle
from asperity.track.image.scene import PlaneView
from asperity.track.image.segmentation import Mark
from asperity.track.path import MeasuredPath
from asperity.track.track import Track, track_mark

__all__ = [
    "Circle",
    "ImageFolder",
    "Mark",
    "MeasuredPath",
    "PlaneView",
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
