"""Writers of files, and what may go wrong while they write.

Run as a program of its own, ``python faults.py WRITER COUNT``: it forks children that write and
come to grief, so many of each kind, and checks what they leave behind. It has a single thread, so
that forking is safe.
"""

from __future__ import annotations

import contextlib
import errno
import io
import os
import re
import resource
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import asperity as asp
import numpy as np

LAW = asp.FrictionLaw.isotropic(0.3)
# Leftovers of processes that were killed: of a file, of a folder.
TEMPORARY = re.compile(r"\..+\.[0-9a-f]{8}\.tmp(\..+)?|\.asperity-.+")
Write = Callable[[Path], object]


def _run(speed):
    system = asp.SlidingPoint(1.0, law=LAW)
    return asp.simulate(system, dt=1e-4, t_end=0.3, u0=[speed, 0.0])


def _problem(size):
    rng = np.random.default_rng(size)
    root = rng.normal(size=(3 * size, 3 * size))
    return asp.ContactProblem(root @ root.T, free_velocity=rng.normal(size=3 * size), laws=LAW)


def trajectory():
    first, second = _run(1.0), _run(2.0)
    return lambda out: first.save(out / "run.npz"), lambda out: second.save(out / "run.npz")


def table():
    first, second = _run(1.0).slice(0.0, 0.1), _run(2.0)
    return lambda out: first.to_csv(out / "run.csv"), lambda out: second.to_csv(out / "run.csv")


def problem_npz():
    first, second = _problem(20), _problem(60)
    return (
        lambda out: first.save(out / "problem.npz"),
        lambda out: second.save(out / "problem.npz"),
    )


def problem_hdf5():
    first, second = _problem(20), _problem(60)
    return lambda out: first.save(out / "problem.h5"), lambda out: second.save(out / "problem.h5")


def law():
    first, second = (
        asp.FrictionLaw.isotropic(0.3),
        asp.FrictionLaw.tensor([[0.3, 0.1], [0.1, 0.2]], fourth_order=np.zeros((2, 2, 2, 2))),
    )
    return lambda out: first.save(out / "law.toml"), lambda out: second.save(out / "law.toml")


def figure():
    from matplotlib.figure import Figure

    def drawn(values):
        drawing = Figure(figsize=(3.0, 2.0))
        drawing.add_subplot().plot(values)
        return lambda out: asp.plot.save_figure(drawing, out / "figure.png")

    return drawn([1.0, 2.0]), drawn(np.random.default_rng(0).normal(size=500))


def figure_data():
    from asperity._base.tables import write_columns

    def curves(n):
        x, y = np.random.default_rng(n).normal(size=(2, n))
        columns = {"curve": ["a"] * n, "x": x, "y": y}
        return lambda out: write_columns(out / "data.csv", columns)

    return curves(300), curves(5000)


def _film(speed):
    from asperity.track import Mark, PlaneView, track_mark

    row, column = np.mgrid[:60, :160]
    frames = np.full((40, 60, 160, 3), 120, np.uint8)
    for k, frame in enumerate(frames):
        frame[np.hypot(column - 20.0 - speed * min(k, 30), row - 30.0) < 9.0] = 220, 30, 30
    return frames, lambda: track_mark(
        frames, fps=100.0, scene=PlaneView.from_scale(1e-3), mark=Mark("red")
    )


def frames():
    first, second = (_film(speed)[1]() for speed in (2.0, 3.0))
    return lambda out: first.to_csv(out / "frames.csv"), lambda out: second.to_csv(
        out / "frames.csv"
    )


def path():
    first, second = (_film(speed)[1]().path() for speed in (2.0, 3.0))
    return lambda out: first.to_csv(out / "path.csv"), lambda out: second.to_csv(out / "path.csv")


def video():
    from asperity.track import write_video

    first, second = (_film(speed)[0] for speed in (2.0, 3.0))
    return (
        lambda out: write_video(first, out / "film.mp4"),
        lambda out: write_video(second, out / "film.mp4"),
    )


def _campaign(folder, mu):
    from asperity import identify
    from asperity.identify import write_raw

    machine = identify.VirtualTribometer(
        asp.FrictionLaw.isotropic(mu),
        normal_force=10.0,
        turns=3.2,
        sample_rate=60.0,
        no_load_time=1.0,
    )
    raw = machine.record()
    return raw, [folder / name for name in write_raw(raw, folder)]


def raw_data():
    from asperity.identify import write_raw

    with tempfile.TemporaryDirectory() as folder:
        first, second = (_campaign(Path(folder), mu)[0] for mu in (0.3, 0.5))
    return lambda out: write_raw(first, out), lambda out: write_raw(second, out)


def _two_fits(samples):
    from asperity.identify import fit_law

    phi = np.linspace(0.0, 4.0 * np.pi, samples, endpoint=False)
    ray = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    return (fit_law((phi, mu * ray), reservoir="circle", direction="circle") for mu in (0.3, 0.5))


def fit():
    first, second = _two_fits(5000)
    return lambda out: first.save(out / "fit.npz"), lambda out: second.save(out / "fit.npz")


def report():
    first, second = _two_fits(500)
    return lambda out: first.report(out / "fit.html"), lambda out: second.report(out / "fit.html")


def _quiet(*arguments):
    from asperity.commands.main import main

    told = io.StringIO()
    with contextlib.redirect_stdout(told), contextlib.redirect_stderr(told):
        code = main(list(map(str, arguments)))
    if code == 2:
        raise OSError(errno.EIO, told.getvalue().strip().splitlines()[-1])


def command_identify():
    places = [Path(tempfile.mkdtemp()) for _ in range(2)]
    files = [_campaign(place, mu)[1] for place, mu in zip(places, (0.3, 0.5), strict=True)]

    def writer(names):
        options = ("--reservoir", "circle", "--direction", "circle")
        return lambda out: _quiet(
            "identify", names[0], "--config", names[-1], "--out", out, *options
        )

    return writer(files[0]), writer(files[1])


def command_identify_paths():
    def writer(mu):
        place = Path(tempfile.mkdtemp())
        system = asp.SlidingPoint(1.0, law=asp.FrictionLaw.isotropic(mu))
        for k, speed in enumerate((1.0, 1.2)):
            run = asp.simulate(system, dt=0.02, t_end=0.4, u0=[speed, 0.1])
            rows = [f"{t},{x},{y}" for t, (x, y) in zip(run.t, run.q, strict=True)]
            (place / f"{k}.csv").write_text("\n".join(["t,x1,x2", *rows]))
        config = Path(tempfile.mkdtemp(), "paths.toml")
        config.write_text("[paths]\nposition_error = 1e-4\n")
        options = ("--reservoir", "circle", "--direction", "circle", "--config", config)
        files = sorted(place.glob("*.csv"))
        return lambda out: _quiet("identify-paths", *files, *options, "--out", out)

    return writer(0.3), writer(0.5)


def command_track():
    from PIL import Image

    def writer(speed):
        place = Path(tempfile.mkdtemp())
        for k, pixels in enumerate(_film(speed)[0]):
            Image.fromarray(pixels).save(place / f"{k}.png")
        config = Path(tempfile.mkdtemp(), "track.toml")
        config.write_text(
            "fps = 100.0\n[mark]\ncolour = 'red'\n[scene]\nmetres_per_pixel = 0.001\n"
        )
        return lambda out: _quiet("track", place, "--config", config, "--out", out)

    return writer(2.0), writer(3.0)


def command_solve():
    place = Path(tempfile.mkdtemp())
    for name, size in (("small", 2), ("large", 4)):
        _problem(size).save(place / f"{name}.npz")
    return tuple(
        lambda out, name=name: _quiet("solve", place / f"{name}.npz", "--csv", out / "solved.csv")
        for name in ("small", "large")
    )


def folder():
    """Files of megabytes that belong together, as commands write them."""
    from asperity._base.storage.files import ResultFolder

    names = [f"{k}.bin" for k in range(5)]

    def writer(letter, names_here):
        def write(out):
            with ResultFolder(out, names).filled() as place:
                for name in names_here:
                    (place / name).write_bytes(letter * 200_000)

        return write

    # Each lacks a file that the other one has; every result has the first.
    return writer(b"a", [names[0], *names[2:]]), writer(b"b", names[:-1])


WRITERS = {
    one.__name__: one
    for one in (
        trajectory, table, problem_npz, problem_hdf5, law, figure, figure_data, frames, path, video,
        raw_data, fit, report, command_identify, command_identify_paths, command_track,
        command_solve, folder,
    )
}  # fmt: skip
# Writers of files that belong together, all of one result or none.
TOGETHER = {"command_identify", "command_identify_paths", "command_track", "folder"}
# Writers that read, fit and draw for seconds before they write.
LATE = {"command_identify", "command_identify_paths", "command_track", "report"}
# Times of solves are never the same twice.
DIFFERENT = {"command_solve"}


def contents(out: Path, name: str) -> dict[str, object]:
    """Return what the files hold, without those that are named as temporary."""
    found: dict[str, object] = {}
    for one in sorted(out.iterdir()):
        if TEMPORARY.fullmatch(one.name):
            continue
        if one.suffix == ".npz":
            # Archives hold the time at which they were written.
            with np.load(one) as file:
                found[one.name] = {key: file[key].tobytes() for key in file}
        elif one.suffix == ".toml":
            # Laws hold the day on which they were written.
            found[one.name] = re.sub(rb"date = .*", b"", one.read_bytes())
        elif name in DIFFERENT:
            found[one.name] = re.sub(r"[-+.e\d]+", "0", one.read_text())
        else:
            found[one.name] = one.read_bytes()
    return found


class Case:
    """A writer of two results, what they are when nothing goes wrong, and how long both take."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.writers: tuple[Write, Write] = WRITERS[name]()
        begin = time.perf_counter()
        self.results = [self._written(write) for write in self.writers]
        self.seconds = time.perf_counter() - begin
        assert self.results[0] != self.results[1], "the two results must differ"

    def _written(self, write: Write) -> dict[str, object]:
        with tempfile.TemporaryDirectory() as out:
            write(Path(out))
            return contents(Path(out), self.name)

    def check(self, found: dict[str, object]) -> None:
        """Every file is one of the complete ones."""
        for key, value in found.items():
            assert any(one.get(key) == value for one in self.results), f"{key} is half-written"
        if self.name in TOGETHER:
            of_one = [
                all(one.get(key) == value for key, value in found.items()) for one in self.results
            ]
            assert any(of_one), "files of two results are mixed"


def child(action: Callable[[], object], ready: int | None = None) -> int:
    """Fork a process that does something and ends; return its number."""
    number = os.fork()
    if number:
        return number
    try:
        if ready is not None:
            os.write(ready, b"x")
        action()
        os._exit(0)
    except BaseException as error:
        os.write(2, f"{type(error).__name__}: {error}\n".encode())
        os._exit(1)


def killed(case: Case, count: int) -> None:
    """Kill processes that replace a result by another one."""
    out = Path(tempfile.mkdtemp())
    case.writers[0](out)
    kill = kill_those_that_begin_to_write if case.name in LATE else kill_those_that_write_for_ever
    leftovers = kill(case, out, count)
    # What a process left behind does not hinder the next one.
    case.writers[1](out)
    assert contents(out, case.name) == case.results[1]
    print(f"{count} killed, {leftovers} left a temporary file")


def kill_those_that_write_for_ever(case: Case, out: Path, count: int) -> int:
    """Kill processes that write both results again and again; return how many leave something."""

    def again_and_again():
        while True:
            for write in case.writers:
                write(out)

    leftovers = 0
    for _ in range(count):
        heard, ready = os.pipe()
        number = child(again_and_again, ready)
        os.read(heard, 1)
        kill_after(number, 1.5 * case.seconds)
        os.close(heard)
        os.close(ready)
        leftovers += after_a_kill(case, out)
    return leftovers


def kill_those_that_begin_to_write(case: Case, out: Path, count: int) -> int:
    """Kill processes that go on from where a file is about to be written; return what they leave.

    What comes before that is done once per result: the process that has done it forks.
    """
    heard, told = os.pipe()
    first, second = case.writers
    for write, other, kills in ((first, second, count // 2), (second, first, count - count // 2)):
        before = Path(tempfile.mkdtemp())
        other(before)

        def fork_and_kill(kills=kills, before=before):
            begin = time.perf_counter()
            number = os.fork()
            if not number:
                return
            assert os.waitpid(number, 0)[1] == 0
            seconds = time.perf_counter() - begin
            for _ in range(kills):
                # What each of them replaces is the other result.
                shutil.copytree(before, out, dirs_exist_ok=True)
                number = os.fork()
                if not number:
                    return
                kill_after(number, 1.5 * seconds)
                os.write(told, bytes([after_a_kill(case, out)]))
            os._exit(0)

        def begin_to_write(write=write, fork_and_kill=fork_and_kill):
            before_writing(out, fork_and_kill)
            write(out)

        number = child(begin_to_write)
        assert os.waitpid(number, 0)[1] == 0
    os.close(told)
    with os.fdopen(heard, "rb") as counts:
        leftovers = counts.read()
    assert len(leftovers) == count, "nothing was written below the folder"
    return sum(leftovers)


def before_writing(out: Path, action: Callable[[], None]) -> None:
    """Let this process do something before it makes its first file or folder below a folder."""
    waiting = True

    def hook(event: str, arguments: tuple) -> None:
        nonlocal waiting
        if not waiting or event not in ("open", "os.mkdir"):
            return
        path, mode, *_ = arguments
        writes = event == "os.mkdir" or (isinstance(mode, str) and not set(mode).isdisjoint("wxa+"))
        if writes and str(path).startswith(f"{out}/"):
            waiting = False
            action()

    sys.addaudithook(hook)


def kill_after(number: int, most: float) -> None:
    """Kill a process after a random time of at most so many seconds."""
    # A fork has the generator of the process it comes from.
    time.sleep(float(np.random.default_rng().uniform(0.0, most)))
    os.kill(number, signal.SIGKILL)
    os.waitpid(number, 0)


def after_a_kill(case: Case, out: Path) -> int:
    """Check what is there, remove what is temporary and return how much that was."""
    found = contents(out, case.name)
    if case.name not in TOGETHER:
        assert found.keys() == set().union(*case.results), "a file has gone"
    case.check(found)
    temporary = [one for one in out.iterdir() if TEMPORARY.fullmatch(one.name)]
    for one in temporary:
        shutil.rmtree(one) if one.is_dir() else one.unlink()
    return len(temporary)


def refused(name: str, write: Write, out: Path, prepare: Callable[[], object]) -> str | None:
    """Return what a writer says that cannot write, None if it could."""
    heard, told = os.pipe()

    def attempt():
        prepare()
        try:
            write(out)
        except (OSError, asp.AsperityError) as error:
            os.write(told, f"{type(error).__name__}: {error}".encode())

    number = child(attempt)
    os.close(told)
    message = b""
    while part := os.read(heard, 4096):
        message += part
    os.close(heard)
    _, status = os.waitpid(number, 0)
    assert status == 0, f"{name} let another error through"
    return message.decode() or None


def full(case: Case, count: int) -> None:
    """Let a writer run out of space after so and so many bytes of a file."""
    first, second = case.writers
    with tempfile.TemporaryDirectory() as place:
        out = Path(place)
        first(out)
        largest = max(one.stat().st_size for one in out.iterdir())
        refusals = 0
        for size in np.unique(np.geomspace(1, max(largest, 2), count).astype(int) - 1).tolist():

            def limited(size=size):
                # As on a full disk, but for the number of the error.
                resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

            message = refused(case.name, second, out, limited)
            found = contents(out, case.name)
            case.check(found)
            assert not [one for one in out.iterdir() if TEMPORARY.fullmatch(one.name)]
            if message is None:
                assert found == case.results[1]
                first(out)
                continue
            refusals += 1
            if case.name in TOGETHER:
                assert found == case.results[0], "the older result has gone"
            assert "File too large" in message, message
            assert ".tmp" not in message, f"{message} names a temporary file"
        assert refusals
        print(f"{refusals} refused")


def forbidden(case: Case) -> None:
    """Let a writer write where it must not, and where no folder can be."""
    # It has written before: whoever may write nowhere may perhaps not read modules, either.
    write, _ = case.writers
    place = Path(tempfile.mkdtemp())
    place.chmod(0o755)
    locked = place / "locked"
    locked.mkdir(mode=0o555)

    def as_nobody():
        if os.getuid() == 0:
            # The administrator may write anywhere.
            os.setgid(65534)
            os.setuid(65534)

    message = refused(case.name, write, locked, as_nobody)
    assert message is not None, "wrote into a folder without permission"
    assert re.search("Permission denied|does not allow", message), message
    assert ".tmp" not in message, f"{message} names a temporary file"
    assert not list(locked.iterdir())
    (place / "file").write_text("mine")
    message = refused(case.name, write, place / "file" / "below", lambda: None)
    assert message is not None
    assert re.search("Not a directory|is a file|must name a folder", message), message
    assert (place / "file").read_text() == "mine"
    locked.chmod(0o755)
    shutil.rmtree(place)
    print("refused")


if __name__ == "__main__":
    given, times = Case(sys.argv[1]), int(sys.argv[2])
    killed(given, times)
    # Each of these does what comes before the writing once more.
    full(given, min(times, 10) if given.name in LATE else times)
    forbidden(given)
