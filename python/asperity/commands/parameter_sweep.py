"""``asperity sweep``: a function of a file at all points of a grid."""

from __future__ import annotations

import argparse
import importlib
import math
import os
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.extras import library
from asperity._base.progress import bar_if_there
from asperity.commands.options import DOUBTFUL, SUCCESS, Commands
from asperity.errors import ParameterError
from asperity.sweeps import sweep, sweep_status

if TYPE_CHECKING:
    from xarray import Dataset

_DEGREE = math.pi / 180.0
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
# A letter O is a zero that was meant.
_UNIT = r"((?![Oo]\b)[^\W\d_][^:]*|%|°)?"
_RANGE = re.compile(rf"({_NUMBER}):({_NUMBER}):(\d+){_UNIT}")
_VALUE = re.compile(rf"({_NUMBER}){_UNIT}")
# Texts that are numbers with a slip of the hand, such as O.2 and 1/3, or that no point can have.
_MISTYPED = re.compile(r"(?i)[-+.\d].*|nan|inf(inity)?|(?=.*\d)[oil\d]*\.[oil\d]*")


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    parser = commands.add_parser(
        "sweep",
        help="compute a function of a Python file at all points of a grid, resumed after a kill",
        description="Call a function of a Python file at all combinations of values, on all cores "
        "or on a dask cluster, and keep the results as labelled arrays in a zarr store, which "
        "xarray.open_zarr reads, also while it grows. Started again, the command goes on where it "
        "was. An axis is FIRST:LAST:COUNT, with both ends, or a list V,V,...; numbers in deg are "
        "converted to rad, any other unit is kept as a label. Exit code 1 if the function failed "
        "at some points; STORE/failures.jsonl says why.",
        epilog="examples: asperity sweep chart.py:point --grid phi=0:180:721deg mu=0.2,0.3 "
        "--store chart.zarr; asperity sweep --status --store chart.zarr",
    )
    parser.add_argument(
        "function",
        metavar="FILE.py:FUNCTION",
        nargs="?",
        help="takes the names of the grid, returns a number, or several by name in a dictionary",
    )
    parser.add_argument(
        "--grid", metavar="NAME=VALUES", nargs="+", default=[], help="the axes of the grid"
    )
    parser.add_argument("--store", metavar="DIR", type=Path, required=True, help="folder of zarr")
    parser.add_argument(
        "--status", action="store_true", help="say how far the sweep of the store is, and end"
    )
    parser.add_argument(
        "--units", metavar="NAME=UNIT", nargs="+", default=[], help="of results, for their labels"
    )
    parser.add_argument(
        "--chunk", metavar="N", type=int, help="points that are computed and written together"
    )
    parser.add_argument(
        "--seed", metavar="N", type=int, help="of the random numbers rng that the function takes"
    )
    parser.add_argument(
        "--again", action="store_true", help="compute again the points that failed, too"
    )
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="of a dask cluster, such as tcp://10.0.0.1:8786"
    )
    return parser


def run(options: argparse.Namespace) -> int:
    """Compute or look, and print; return the exit code."""
    if not options.status:
        _compute(options)
    status = sweep_status(options.store)
    print(status.summary())
    return DOUBTFUL if status.failed else SUCCESS


def _compute(options: argparse.Namespace) -> Dataset:
    if options.function is None:
        raise ParameterError("function", "must be given as FILE.py:FUNCTION, or --status")
    axes = [_axis(text) for text in options.grid]
    units = {name: unit for name, _, unit in axes if unit}
    units.update(_pair(text, "units") for text in options.units)
    file, function = _function(options.function)
    with bar_if_there("point") as move, _Scheduler(options.scheduler, file) as executor:
        return sweep(
            function,
            {name: values for name, values, _ in axes},
            store=options.store,
            executor=executor,
            chunk="auto" if options.chunk is None else options.chunk,
            seed=options.seed,
            resume="failed" if options.again else True,
            progress=move,
            units=units,
        )


class _Scheduler:
    """A client of dask, which has sent the file to the workers; None without an address."""

    def __init__(self, address: str | None, file: Path) -> None:
        self._address, self._file = address, file
        self._client: Any = None

    def __enter__(self) -> Any:
        if self._address is not None:
            try:
                self._client = library("distributed", extra="sweep").Client(self._address)
            except (OSError, ValueError) as error:
                raise ParameterError("scheduler", f"cannot be reached: {error}") from None
            self._client.upload_file(os.fspath(self._file))
        return self._client

    def __exit__(self, *_: object) -> None:
        if self._client is not None:
            self._client.close()


def _function(text: str) -> tuple[Path, Callable[..., Any]]:
    """Return a function and its file, which workers import by the name of its module."""
    name, colon, word = text.rpartition(":")
    file = Path(name)
    if not colon or file.suffix != ".py" or not word.isidentifier():
        raise ParameterError("function", f"must be given as FILE.py:FUNCTION, got {text!r}")
    if not file.is_file():
        raise ParameterError("function", f"must be in a file, {file} is none")
    sys.path.insert(0, str(file.parent.resolve()))
    module = importlib.import_module(file.stem)
    found = getattr(module, "__file__", None)
    if found is None or not Path(found).samefile(file):
        raise ParameterError("function", f"must be in a file of another name: there is a {found}")
    if not callable(getattr(module, word, None)):
        raise ParameterError("function", f"must be one of {file}, which has no {word!r}")
    return file, getattr(module, word)


def _axis(text: str) -> tuple[str, NDArray[Any] | Sequence[str], str]:
    """Return name, values and unit of an axis.

    >>> from asperity.commands.parameter_sweep import _axis
    >>> _axis("mu=0.2,0.3")
    ('mu', array([0.2, 0.3]), '')
    >>> _axis("law=wood,steel")
    ('law', ['wood', 'steel'], '')
    >>> name, values, unit = _axis("phi=0:180:3deg")
    >>> name, values.round(4).tolist(), unit
    ('phi', [0.0, 1.5708, 3.1416], 'rad')
    """
    name, values = _pair(text, "grid")
    whole = _RANGE.fullmatch(values)
    if whole is not None:
        first, last, count, unit = whole.groups()
        if int(count) < 1:
            raise ParameterError("grid", f"must have values, got {text!r}")
        return name, *_in_si(np.linspace(float(first), float(last), int(count)), unit)
    parts = [_VALUE.fullmatch(one) for one in values.split(",")]
    numbers = [one for one in parts if one is not None]
    if not numbers and ":" not in values and not any(map(_MISTYPED.fullmatch, values.split(","))):
        return name, values.split(","), ""
    units = {one[2] for one in numbers if one[2] is not None}
    if len(numbers) < len(parts) or len(units) > 1:
        raise ParameterError(
            "grid", f"must be FIRST:LAST:COUNT or V,V,... with a unit, or names, got {text!r}"
        )
    return name, *_in_si(np.array([float(one[1]) for one in numbers]), next(iter(units), None))


def _in_si(values: NDArray[Any], unit: str | None) -> tuple[NDArray[Any], str]:
    return (values * _DEGREE, "rad") if unit == "deg" else (values, unit or "")


def _pair(text: str, argument: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals or not name or not value:
        raise ParameterError(argument, f"must be given as NAME=..., got {text!r}")
    return name, value
