"""The command ``asperity track``: folders, videos, configurations, results."""

import re
import shutil

import numpy as np
import pytest
from asperity.commands.main import main
from asperity.track import VideoFile, VirtualCamera, track_mark, write_video
from filmed import RUN, SMALL

CONFIG = """
fps = 500.0
bandwidth = 0.03
[mark]
colour = "red"
diameter = 0.01
[scene]
metres_per_pixel = 2e-4
origin = [10, 20]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A film of the run as images, with its configuration."""
    out = tmp_path_factory.mktemp("film") / "new" / "frames"
    VirtualCamera(RUN, tilt=0.2, **SMALL).write(out)
    return out


def test_the_command_writes_tables_figures_and_report(folder, tmp_path, capsys):
    out = tmp_path / "new" / "out"
    code = main(["track", str(folder), "--config", str(folder / "track.toml"), "--out", str(out)])
    assert code == 0
    assert sorted(file.name for file in out.iterdir()) == [
        "frames.csv",
        "motion.png",
        "overlay.png",
        "path.csv",
        "report.html",
    ]
    told = capsys.readouterr().out
    end = [float(x) for x in re.search(r"end point +(\S+), (\S+) mm", told).groups()]
    assert end == pytest.approx(1e3 * RUN.q[-1], abs=0.2)
    table = np.loadtxt(out / "path.csv", delimiter=",", skiprows=1)
    assert 1e3 * table[-1, 1:3] == pytest.approx(1e3 * RUN.q[-1], abs=0.2)
    report = (out / "report.html").read_text()
    assert report.count("data:image/png;base64,") == 2
    assert "end point" in report
    assert "http" not in report.replace("<!doctype html>", "")


def test_a_film_that_loses_the_mark_exits_with_1(folder, tmp_path, capsys):
    images = sorted(folder.glob("*.png"))
    film = tmp_path / "film"
    film.mkdir()
    for number in range(20):
        shutil.copy(images[min(number, 11)], film / f"{number}.png")
    from PIL import Image

    for number in range(12, 20):
        Image.new("RGB", (640, 540), (120, 120, 120)).save(film / f"{number}.png")
    arguments = ["track", str(film), "--config", str(folder / "track.toml")]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 1
    told = capsys.readouterr().out
    assert "12 good, 8 lost" in told
    assert "frames 12-19" in told


POINTS = "pixels = [[0, 0], [1, 0], [0, 1]]\nplane = [[0, 0], [1, 0], [0, 1]]\n"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("fps = 500.0", "", r"track.toml: fps: is missing"),
        ("500.0", "-1", r"track.toml, line 2: fps: must be positive"),
        ("500.0", '"fast"', r"track.toml, line 2: fps: must be a number, got 'fast'"),
        ("bandwidth", "bandwith", r"line 3: bandwith: is not known, did you mean 'bandwidth'"),
        ("diameter", "radius", r"line 6: \[mark\] radius: is not known; known are colour"),
        ("diameter", "start", r"line 6: \[mark\] start: .* it belongs above all sections"),
        ('"red"', '"pink"', r"track.toml, line 5: \[mark\] colour: must be"),
        ("metres", "miles", r"\[scene\] miles_per_pixel: .* did you mean 'metres_per_pixel'"),
        (CONFIG[CONFIG.index("[scene]") :], "", r"track.toml: \[scene\]: is missing"),
        ("[10, 20]", "[10]", r"line 9: \[scene\] origin: must have shape"),
        ("[mark]", "[mark", r"track.toml, line 4: \[mark\]: is not TOML"),
        ("fps", "\ufefffps", "is not TOML"),
        ("metres_per_pixel = 2e-4\norigin = [10, 20]\n", POINTS, "pixels: must hold at least 4"),
        ("origin", POINTS + "origin", r"line 7: \[scene\]: gives points and a scale"),
    ],
)
def test_bad_configurations_are_one_line(old, new, message, tmp_path, capsys, folder):
    config, out = tmp_path / "track.toml", tmp_path / "out"
    config.write_text(CONFIG.replace(old, new), encoding="utf-8")
    assert main(["track", str(folder), "--config", str(config), "--out", str(out)]) == 2
    told = capsys.readouterr().err.strip()
    assert re.search(message, told)
    assert "\n" not in told
    assert not out.exists()


def damaged(folder, kind):
    """Return a folder of frames that cannot be tracked."""
    images = sorted(folder.parent.glob("frames/*.png"))[:4]
    film = folder.parent / kind
    film.mkdir()
    for number, image in enumerate(images):
        shutil.copy(image, film / f"f{number}.png")
    if kind == "empty":
        for image in film.iterdir():
            image.unlink()
    elif kind == "text":
        (film / "f2.png").write_text("no image")
    elif kind == "half":
        (film / "f2.png").write_bytes(images[2].read_bytes()[:5000])
    elif kind == "gap":
        (film / "f2.png").unlink()
    elif kind == "twice":
        shutil.copy(images[0], film / "g2.png")
    elif kind == "unnumbered":
        shutil.copy(images[0], film / "last.png")
    elif kind == "size":
        from PIL import Image

        Image.new("RGB", (64, 54)).save(film / "f3.png")
    return film


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("empty", "must hold images"),
        ("text", "f2.png: is no image"),
        ("half", "f2.png: is no image"),
        ("gap", "image 2 is missing after f1.png"),
        ("twice", "2.png: has the number of .2.png"),
        ("unnumbered", "last.png: has no number"),
        ("size", "f3.png: has 64 x 54 pixels"),
        ("short", "too short"),
    ],
)
def test_bad_folders_are_one_line(kind, message, folder, tmp_path, capsys):
    film, out = damaged(folder, kind), tmp_path / "out"
    code = main(["track", str(film), "--config", str(folder / "track.toml"), "--out", str(out)])
    told = capsys.readouterr().err.strip().splitlines()[-1]
    assert code == 2
    assert re.search(message, told)
    assert not out.exists()


def test_videos(tmp_path, folder, capsys):
    camera = VirtualCamera(RUN, noise=1.0, **{**SMALL, "fps": 100.0})
    write_video(camera.frames(), tmp_path / "slow.mp4", quality=10)
    video = VideoFile(tmp_path / "slow.mp4")
    assert len(video) == len(camera)
    track = track_mark(video, fps=100.0, scene=camera.view, mark=camera.mark)
    # Colours are stored for 2 x 2 pixels together.
    assert np.abs(track.pixel - camera.pixel).max() < 0.2
    for frame in video:
        whole = frame.crop(slice(None), slice(None))
        for rows, columns in (
            ((101, 223), (33, 170)),
            ((0, 57), (0, 101)),
            ((501, 540), (600, 640)),
        ):
            part = slice(*rows), slice(*columns)
            assert np.array_equal(frame.crop(*part), whole[part])
        break
    (tmp_path / "text.mp4").write_text("no video")
    (tmp_path / "cut.mp4").write_bytes((tmp_path / "slow.mp4").read_bytes()[:3000])
    for name in ("text.mp4", "cut.mp4"):
        arguments = ["track", str(tmp_path / name), "--config", str(folder / "track.toml")]
        assert main([*arguments, "--out", str(tmp_path / "out")]) == 2
        assert f"{name}: is no video" in capsys.readouterr().err


def test_videos_without_pyav_say_what_to_install(tmp_path, folder, capsys, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "av", None)
    (tmp_path / "slow.mp4").write_bytes(b"\0\0\0\x18ftypmp42")
    arguments = ["track", str(tmp_path / "slow.mp4"), "--config", str(folder / "track.toml")]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 2
    assert 'pip install "asperity[video]"' in capsys.readouterr().err
