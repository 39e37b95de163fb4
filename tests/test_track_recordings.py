"""Recordings as cameras write them: clocks of videos, depth and orientation of images."""

import fractions

import av
import numpy as np
import pytest
from asperity import ParameterError
from asperity.track import ImageFolder, Mark, PlaneView, Sight, track_mark, write_video
from PIL import Image

SCENE = PlaneView.from_scale(1e-3)
ROWS, COLUMNS = np.mgrid[:120, :160]


def coloured(place):
    image = np.full((120, 160, 3), 120, np.uint8)
    image[np.hypot(COLUMNS - 30.0 - 2.0 * place, ROWS - 60.0) < 10.0] = 220, 30, 30
    return image


def film(path, stamps, places=None, ticks=100):
    """Write a video whose frames are shown at stamps/ticks seconds."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=ticks)
        stream.width, stream.height, stream.pix_fmt = 160, 120, "yuv420p"
        # At constant quality: PyAV 13 gave a second of a film so many bits, however
        # many frames it has.
        stream.options = {"bf": "0", "crf": "18"}
        for place, stamp in zip(places or range(len(stamps)), stamps, strict=True):
            frame = av.VideoFrame.from_ndarray(coloured(place), format="rgb24")
            frame.pts, frame.time_base = int(stamp), fractions.Fraction(1, ticks)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path


def followed(source):
    return track_mark(source, fps=100.0, scene=SCENE, mark=Mark("red"))


N = np.arange(40)
VARYING = {
    "long and short": (3 * N + 1) // 2,
    "short and long": (3 * N) // 2,
    "at random": np.cumsum(np.random.default_rng(0).integers(1, 4, 40)),
    "two missing": N + 2 * (N > 20),
    "one missing": N + (N > 20),
    "the second missing": N + (N > 0),
    "the rate halves": np.where(N < 20, N, 2 * N - 20),
    "one too early": 4 * N - 2 * (N == 20),
    # No interval alone is unusual, but the last frame comes five intervals late.
    "the rate drifts": np.where(N < 20, 4 * N, 5 * N - 20),
}


@pytest.mark.parametrize("name", VARYING)
@pytest.mark.parametrize("suffix", ["mp4", "mkv"])
def test_frame_rates_that_vary_are_refused(tmp_path, name, suffix):
    path = film(tmp_path / f"varies.{suffix}", VARYING[name])
    with pytest.raises(ParameterError, match="or its frame rate varies"):
        followed(path)


@pytest.mark.parametrize(
    ("stamps", "ticks"),
    [(N, 100), (3 * N, 100), (np.rint(N * 1000 / 240), 1000), (np.rint(N * 1000 / 29.97), 1000)],
    ids=["every tick", "every third", "240 Hz in ms", "29.97 Hz in ms"],
)
@pytest.mark.parametrize("suffix", ["mp4", "mkv"])
def test_constant_rates_are_read_whatever_the_clock(tmp_path, stamps, ticks, suffix):
    track = followed(film(tmp_path / f"constant.{suffix}", stamps, ticks=ticks))
    assert len(track) == len(N)
    assert track.quality == "40 good"


def test_frames_repeated_by_a_player_are_reported(tmp_path):
    fillers = [12, 20, 21]
    # With the noise of a camera, and computed without any.
    for noise, sight in ((2.0, Sight.REPEATED), (0.0, Sight.STILL)):
        rng, frames = np.random.default_rng(0), []
        for place in N.tolist():
            image = coloured(place) + noise * rng.standard_normal((120, 160, 3))
            new = np.clip(np.rint(image), 0.0, 255.0).astype(np.uint8)
            frames.append(frames[-1] if place in fillers else new)
        write_video(frames, tmp_path / "filled.mp4")
        track = followed(tmp_path / "filled.mp4")
        assert track.frames(sight).tolist() == fillers
        seen = track.status == 0
        assert seen.sum() == len(N) - len(fillers)
        assert np.abs(track.pixel[seen, 0] - 30.0 - 2.0 * N[seen]).max() < 0.5


def grey(low, kind, factor):
    """Return a dark disk in a bright image, with levels of 0 to 255 times a factor."""
    covered = np.clip(10.5 - np.hypot(COLUMNS - 60.0, ROWS - 60.0), 0.0, 1.0)
    return np.rint((200.0 - (200.0 - low) * covered) * factor).astype(kind)


def images(folder, pixels, suffix="png", **options):
    folder.mkdir()
    for number in range(8):
        Image.fromarray(pixels).save(folder / f"{number}.{suffix}", **options)
    return folder


@pytest.mark.parametrize("low", [0, 10])
@pytest.mark.parametrize("suffix", ["png", "tiff"])
def test_images_of_16_bits_are_scaled(tmp_path, low, suffix):
    found = {
        kind: track_mark(
            images(tmp_path / kind, grey(low, kind, factor), suffix),
            fps=1.0,
            scene=SCENE,
            mark=Mark("black"),
        )
        for kind, factor in (("u1", 1.0), ("u2", 257.0))
    }
    np.testing.assert_allclose(found["u2"].pixel, found["u1"].pixel, atol=1e-9)
    np.testing.assert_allclose(found["u2"].diameter, found["u1"].diameter, rtol=1e-9)
    assert found["u2"].diameter[0] == pytest.approx(0.020, rel=0.01)


def test_images_of_12_bits_within_16_are_refused(tmp_path):
    folder = images(tmp_path / "twelve", grey(0, "u2", 16.0))
    with pytest.raises(ParameterError, match=r"0\.png.*bright.*full range"):
        list(ImageFolder(folder))


@pytest.mark.parametrize("orientation", range(1, 9))
def test_images_are_turned_as_viewers_show_them(tmp_path, orientation):
    exif = Image.Exif()
    exif[0x0112] = orientation
    stored = coloured(10)[10:]
    folder = images(tmp_path / "turned", stored, "jpg", exif=exif, quality=95)
    # The transformation from the stored to the shown image, by the standard's definition.
    shown = {
        1: stored,
        2: stored[:, ::-1],
        3: stored[::-1, ::-1],
        4: stored[::-1],
        5: stored.swapaxes(0, 1),
        6: stored[::-1].swapaxes(0, 1),
        7: stored[::-1, ::-1].swapaxes(0, 1),
        8: stored[:, ::-1].swapaxes(0, 1),
    }[orientation]
    frame = next(iter(ImageFolder(folder)))
    assert frame.shape == shown.shape[:2]
    pixels = frame.crop(slice(None), slice(None)).astype(float)
    assert np.abs(pixels - shown).mean() < 5.0


def test_pages_of_an_image_are_a_film(tmp_path):
    pages = [Image.fromarray(coloured(place)) for place in range(12)]
    path = tmp_path / "film.tif"
    pages[0].save(path, save_all=True, append_images=pages[1:])
    folder = tmp_path / "folder"
    folder.mkdir()
    for number, page in enumerate(pages):
        page.save(folder / f"{number}.tif")
    track, expected = followed(path), followed(folder)
    np.testing.assert_array_equal(track.pixel, expected.pixel)
    assert len(track.pixel) == 12
    # No page is left out in silence.
    pages[3].save(folder / "3.tif", save_all=True, append_images=pages[:1])
    with pytest.raises(ParameterError, match=r"3\.tif.*holds 2 pages: give this file alone"):
        followed(folder)
    with pytest.raises(ParameterError, match=r"1\.tif.*one page: give the folder"):
        followed(folder / "1.tif")
    pages[1] = Image.fromarray(coloured(1)[10:])
    pages[0].save(path, save_all=True, append_images=pages[1:])
    with pytest.raises(ParameterError, match=r"page 1: has 160 x 110 pixels, .* 160 x 120"):
        followed(path)
