"""How do I measure a sliding path with a camera?
==============================================

A round mark on the body and a film are enough for place, velocity and their errors. Learn what has
to be known beside the film, how a mark is followed, and what frames say of themselves.
"""

import tempfile
from pathlib import Path

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
from asperity import track

# %%
# A film
# ------
# A virtual camera films a disk that slides, and writes a folder of images.

law = asp.FrictionLaw(asp.Superellipse(0.537, 0.457, 2.94), asp.Superellipse(1.84, 1.19, 2.51))
run = asp.simulate(
    asp.SlidingPoint(0.018, law=law), dt=1e-4, t_end=1.0, u0=[1.29, 0.81], until_rest=True
)
camera = track.VirtualCamera(run, fps=100.0, size=(320, 260), tilt=0.2, glare=0.3, seed=1)
folder = tempfile.TemporaryDirectory()
camera.write(folder.name)

# %%
# What is known beside the film
# -----------------------------
# The rate of the frames, what the mark looks like, and where points of a target are in the images
# and in the plane. The diameter of the mark was measured by some points along its outline.

config = track.read_config(Path(folder.name) / "track.toml")
scene, mark = config.scene, config.mark
pixel = scene.pixel_size([160.0, 130.0])
print(f"{config.fps:.0f} frames per second, a pixel is {1e3 * pixel:.2f} mm")
random, angle = np.random.default_rng(1), np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
outline = 5e-3 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
circle = track.fit_circle(outline + 2e-5 * random.normal(size=outline.shape))
error = 2.0 * np.sqrt(circle.covariance[2, 2])
print(f"the mark is {mark.colour} and {2e3 * circle.radius:.2f} ± {1e3 * error:.2f} mm wide")

# %%
# Follow the mark
# ---------------
# Folders of images and videos are read alike.

film = track.open_frames(folder.name)
seen = track.track_mark(film, fps=config.fps, scene=scene, mark=mark)
for sight in track.Sight:
    number = np.sum(seen.status & sight > 0)
    if number:
        print(f"{number} frames: {sight.name.lower()}")
track.write_video(camera.frames(), Path(folder.name) / "film.mp4")
video = track.VideoFile(Path(folder.name) / "film.mp4")
again = track.track_mark(video, fps=config.fps, scene=scene, mark=mark)
apart = 1e3 * np.nanmax(np.abs(again.position - seen.position))
print(f"the video, which is compressed, gives places within {apart:.2f} mm of the images'")

# %%
# The path
# --------

path = seen.path()
print(asp.compare_path(run, path).summary())
image = next(iter(camera.frames()))
with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.4), layout="constrained")
    asp.plot.plot_track(seen, ax=left, image=image)
    left.set_title("Centres of the mark; pink: with a reflection")
    speed = np.linalg.norm(path.velocity, axis=-1)
    right.errorbar(path.time, speed, np.hypot(*path.velocity_error.T), fmt=".", label="film")
    right.plot(run.t, np.linalg.norm(run.u, axis=-1), label="truth")
    right.set(title="Speed", xlabel="time in s", ylabel="speed in m/s")
    right.legend()
plt.show()
folder.cleanup()
