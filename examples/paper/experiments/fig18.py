"""Figure 18: Tracking of a sliding disk
========================================

How is a sliding path measured? A camera films a mark on the disk. The film is synthetic, from a
virtual camera, so that the truth is known.
"""

import numpy as np
from asperity.demo import Check
from asperity.demo.film import Film
from matplotlib.axes import Axes
from paper.drawing import ORANGE
from paper.frame import Redrawn, panels, show
from paper.measurements.filmed import SYNTHETIC, filmed
from paper.sketches import experiments as setup_sketches


def _draw_frame(film: Film, ax: Axes) -> None:
    *_, last = film.camera.frames()
    ax.imshow(last)
    seen = film.track.pixel
    ax.plot(*seen.T, ".", color=ORANGE, markersize=2.0, label="centres, 2 ms apart")
    ax.grid(False)
    ax.set(title="(b) tracked path over the last frame", xticks=[], yticks=[])
    ax.legend(loc="upper left", labelcolor="white", markerscale=3.0)


def _frame_checks(film: Film) -> list[Check]:
    seen = film.path.seen
    off = np.linalg.norm(film.track.pixel[seen] - film.camera.pixel[seen], axis=1)
    end = np.linalg.norm(film.path.end - film.disk.path(film.run)[-1])
    return [
        Check("Fig. 18 frames with the mark", float(len(film.camera)), float(seen.sum()), 0.0),
        Check("Fig. 18 centre off, rms", 0.0, float(np.sqrt(np.mean(off**2))), 0.1, "pixel"),
        Check("Fig. 18 end point off", 0.0, 1e3 * float(end), 0.2, "mm"),
    ]


def draw() -> Redrawn:
    """Draw (a) the experiment and (b) the tracked points over the last frame of the camera."""
    figure, axes = panels(
        18, "tracking of a sliding disk", 2, figsize=(11.0, 4.9), parameters=SYNTHETIC
    )
    film = filmed()
    setup_sketches.sliding_experiment(axes[0])
    axes[0].set_title("(a) experiment")
    _draw_frame(film, axes[1])
    return Redrawn(figure, _frame_checks(film))


# %%
if __name__ == "__main__":
    show(draw)
