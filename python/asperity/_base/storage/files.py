"""Results on disk: a file, or the files of a folder, are complete or not there."""

from __future__ import annotations

import os
import secrets
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from asperity.errors import ParameterError


@contextmanager
def atomic(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a temporary file beside `path` that replaces it when the block succeeds.

    Its name is that of `path` between a dot and eight digits with ``.tmp``: what a process that was
    killed leaves behind can be recognised and removed.

    Raises:
        ParameterError: if `path` names no file.
        OSError: naming `path`, if it cannot be written.
    """
    with replaced(path) as temporary, temporary.open("xb") as file:
        yield file
        file.flush()
        os.fsync(file.fileno())


@contextmanager
def replaced(path: str | os.PathLike[str], ending: str = ".tmp") -> Iterator[Path]:
    """Yield the name of the temporary file of `atomic`, to writers that open files themselves."""
    target = Path(path)
    if not target.name or "\0" in target.name:
        raise ParameterError("path", f"must name a file, got {os.fspath(path)!r}")
    temporary = target.with_name(f".{target.name}.{secrets.token_hex(4)}{ending}")
    try:
        yield temporary
        os.replace(temporary, target)
    except OSError as error:
        if error.errno is None:
            raise
        # The temporary name, or none, would not identify the file.
        raise OSError(error.errno, error.strerror, os.fspath(target)) from None
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def unreadable(path: Path, error: OSError) -> str:
    """Return why a file cannot be read, in the same words on every system.

    A folder that is opened as a file is a folder on Linux, and is not permitted on Windows.
    """
    if path.is_dir():
        return "is a folder: name the file in it"
    return f"cannot be read: {error.strerror}"


def refuse_input(target: Path, read: Iterable[object], argument: str) -> None:
    """Refuse to write a file, or into a folder, that is read, however its path is spelt.

    Args:
        target: what is to be written.
        read: paths of what is read; tables in memory and None are none.
        argument: that names the target.
    """
    for one in read:
        if not isinstance(one, str | os.PathLike):
            continue
        # What is not there is not read, and cannot be overwritten.
        with suppress(FileNotFoundError):
            if os.path.samefile(target, one):
                raise ParameterError(argument, f"would replace {os.fspath(one)}, which is read")


class ResultFolder:
    """A folder for files that belong together: they are of one result, or nothing has changed.

    Args:
        out: the folder, made when it is filled.
        names: of all files that any result may have: one that a result does not have is removed.
            Every result has the first one, and those of other commands do not.
        read: paths from which the result is made.

    Raises:
        ParameterError: before anything is worked out, if the folder, or one above it, is a file or
            cannot be written into, or holds a folder of one of the names, or a file that is not of
            an earlier result, or is read.
    """

    def __init__(self, out: Path, names: Sequence[str], read: Iterable[object] = ()) -> None:
        place = next(one for one in (out, *out.absolute().parents) if one.exists())
        if not place.is_dir():
            raise ParameterError("out", f"must name a folder, {place} is a file")
        if not os.access(place, os.W_OK | os.X_OK):
            raise ParameterError(
                "out", f"must be a folder to write into, {place} does not allow it"
            )
        for name in names:
            if (out / name).is_dir():
                raise ParameterError("out", f"must hold no folder of the name {name}: remove it")
        used = list(read)
        for target in (out, *(out / name for name in names)):
            refuse_input(target, used, "out")
        there = [name for name in names if (out / name).exists()]
        if there and names[0] not in there:
            raise ParameterError(
                "out", f"holds {there[0]}, of another command or yours: name another folder"
            )
        self._out = out
        self._names = names

    @contextmanager
    def filled(self) -> Iterator[Path]:
        """Yield a temporary folder, whose files replace those in the folder once all are complete.

        Old files are moved away before new ones are moved in, so that a crash never leaves a
        mixture. The temporary folder, ``.asperity-…``, is then left behind and can be removed.
        """
        out = self._out
        made = [place for place in (out, *out.parents) if not place.exists()]
        out.mkdir(parents=True, exist_ok=True)
        try:
            # Inside `out`: renaming works on one file system only.
            with tempfile.TemporaryDirectory(dir=out, prefix=".asperity-") as folder:
                fresh, old = Path(folder, "new"), Path(folder, "old")
                fresh.mkdir()
                old.mkdir()
                yield fresh
                _exchange(fresh, old, out, self._names)
        except BaseException:
            for place in made:
                with suppress(OSError):
                    place.rmdir()
            raise


def _exchange(fresh: Path, old: Path, out: Path, names: Sequence[str]) -> None:
    """Put the fresh files in the place of the old ones, or leave those where they are."""
    written = [name for name in names if (fresh / name).exists()]
    try:
        # The first goes last and comes first: what a kill leaves is known by it.
        for name in reversed(names):
            if (out / name).exists():
                (out / name).replace(old / name)
        for name in written:
            (fresh / name).replace(out / name)
    except BaseException:
        for name in written:
            if not (fresh / name).exists():
                (out / name).unlink(missing_ok=True)
        for one in old.iterdir():
            one.replace(out / one.name)
        raise
