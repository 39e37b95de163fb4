"""The command ``asperity``."""

from __future__ import annotations

import argparse
import codecs
import io
import os
import re
import sys
from collections.abc import Sequence

from asperity._core import __version__
from asperity.commands import (
    compare,
    demo,
    export,
    identify,
    identify_paths,
    info,
    init,
    law,
    parameter_sweep,
    scenario,
    sliding_stability,
    solve,
    squeal,
    track,
)
from asperity.commands.options import INTERRUPTED, PIPE_CLOSED, USER_ERROR
from asperity.errors import AsperityError, ParameterError

_VERBS = (
    identify,
    identify_paths,
    law,
    compare,
    export,
    init,
    scenario,
    sliding_stability,
    squeal,
    parameter_sweep,
    track,
    solve,
    demo,
    info,
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit code (0 good, 1 doubtful, 2 user error)."""
    _take_every_character()
    options = _parser().parse_args(arguments)
    try:
        code: int = options.run(options)
        sys.stdout.flush()
    except KeyboardInterrupt:
        print("asperity: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # Who reads the output, such as head, has seen enough. What is left of it goes nowhere.
        with open(os.devnull, "wb") as nowhere:
            os.dup2(nowhere.fileno(), sys.stdout.fileno())
        return PIPE_CLOSED
    except (AsperityError, OSError, ModuleNotFoundError) as error:
        print(f"asperity: {_explained(error, options)}", file=sys.stderr)
        return USER_ERROR
    return code


def _take_every_character() -> None:
    """Let what is printed hold Greek letters and signs, wherever it goes.

    Files and pipes of Windows have an encoding that lacks them, unless Python 3.15 or newer writes
    there: they are written as UTF-8 then, as all files of asperity are. A terminal keeps its
    encoding, and so does what ``PYTHONIOENCODING`` asks for: what these lack becomes "?".
    """
    for stream in (sys.stdout, sys.stderr):
        if (
            not isinstance(stream, io.TextIOWrapper)
            or codecs.lookup(stream.encoding).name == "utf-8"
        ):
            continue
        if stream.isatty() or "PYTHONIOENCODING" in os.environ:
            stream.reconfigure(errors="replace")
        else:
            stream.reconfigure(encoding="utf-8")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="asperity",
        description="Dry friction that depends on the direction of sliding: measure its law, "
        "predict motions with it, find where it makes machines squeal.",
    )
    parser.add_argument("--version", action="version", version=f"asperity {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for verb in _VERBS:
        added = verb.add(commands)
        added.set_defaults(run=verb.run, usage=added.format_usage())
    return parser


def _explained(error: Exception, options: argparse.Namespace) -> str:
    if isinstance(error, ModuleNotFoundError):
        extras = {"h5py": "data", "av": "video", "PIL": "video", "xarray": "sweep", "zarr": "sweep"}
        extras |= {"pandas": "tables", "openpyxl": "tables"}
        if error.name == "distributed":
            return "distributed is missing: pip install distributed"
        extra = extras.get(error.name or "", "plot")
        return f'{error.name} is missing: pip install "asperity[{extra}]"'
    if isinstance(error, ParameterError):
        # In the words of the command line, if it is an option of it.
        option = f"--{error.argument.replace('_', '-')}"
        if re.search(rf"\[?{re.escape(option)}[\s\]]", options.usage):
            return f"{option}: {error.message}"
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    return str(error)
