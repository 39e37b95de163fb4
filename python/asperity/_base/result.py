"""What results of computations have in common: a summary, a picture for notebooks, tables."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from asperity._base.drawing import png
from asperity._base.extras import library
from asperity._base.tables import write_columns
from asperity._base.value import keep_views

if TYPE_CHECKING:
    import pandas
    import xarray

NO_UNIT = "-"
"""The unit of numbers without one."""


class Result:
    """Base of what computations return.

    Whatever a result holds, ``print(result.summary())`` says in sentences what it means, its
    ``repr`` is one line, and in a notebook it shows as a picture, if there is one, and the summary.
    """

    _picture: ClassVar[str | None] = None
    """Name of the function of `asperity.plot` that draws the result."""

    def summary(self) -> str:
        """Return what the result says, in sentences with units."""
        raise NotImplementedError

    def _repr_html_(self) -> str:
        """Return the picture and the summary for a notebook; it is drawn when it is asked for."""
        lines = "<br>".join(escape(line) for line in self.summary().splitlines())
        return f"<div>{self._image()}<p>{lines}</p></div>"

    def _drawing(self) -> dict[str, object]:
        """Return the options of the drawing."""
        return {}

    def _image(self) -> str:
        """Return the picture as an element of HTML; empty where there is none to draw."""
        source = None if self._picture is None else png(self._picture, self, **self._drawing())
        if source is None:
            return ""
        return f'<img alt="{escape(type(self).__name__)}" src="{source}" style="max-width: 100%">'


def counted(number: int, noun: str, plural: str = "") -> str:
    """Return a number with its noun.

    >>> from asperity._base.result import counted
    >>> counted(1, "step"), counted(2, "axis", "axes")
    ('1 step', '2 axes')
    """
    return f"{number} {noun if number == 1 else plural or noun + 's'}"


@dataclass(frozen=True)
class Axis:
    """A direction of arrays.

    Attributes:
        values: numbers or names along it.
        unit: of numbers.
        description: what it counts, in a few words.
        units: of what stands at each place, where these differ.
    """

    values: NDArray[Any] | Sequence[str]
    unit: str = ""
    description: str = ""
    units: Sequence[str] | None = None


@dataclass(frozen=True)
class Series:
    """An array with names for its axes.

    Attributes:
        values: the array.
        axes: names of its axes; the first is that of the rows of the table.
        unit: of the values; empty where an axis holds their units.
        description: what they are, in a few words.
        names: words for the numbers of an array that stand for these.
        bare: whether the names along its axes say what it is, so that columns need no other word
            unless two had the same title.
    """

    values: NDArray[Any]
    axes: tuple[str, ...]
    unit: str = ""
    description: str = ""
    names: Mapping[int, str] = field(default_factory=dict)
    bare: bool = False


@dataclass(frozen=True)
class Table:
    """Series along common axes, of which the first is that of the rows.

    Attributes:
        axes: by name.
        series: by name.
        facts: what else is to be known, as numbers and texts.
    """

    axes: Mapping[str, Axis]
    series: Mapping[str, Series]
    facts: Mapping[str, str | int | float]

    def __post_init__(self) -> None:
        keep_views(self)

    @property
    def rows(self) -> str:
        """Name of the axis of the rows."""
        return next(iter(self.axes))

    def columns(self) -> dict[str, NDArray[Any]]:
        """Return one-dimensional columns by titles that hold their units, the rows' axis first."""
        columns = list(self._titled(bare=True))
        if len(dict(columns)) < len(columns):
            # A name of the user, such as x_dot, is what another column is called.
            columns = list(self._titled(bare=False))
        return dict(columns)

    def _titled(self, *, bare: bool) -> Iterator[tuple[str, NDArray[Any]]]:
        first = self.axes[self.rows]
        yield title(self.rows, first.unit), np.asarray(first.values)
        for name, series in self.series.items():
            if series.axes[0] == self.rows:
                yield from self._columns_of(name, series, bare=bare and series.bare)

    def _columns_of(
        self, name: str, series: Series, *, bare: bool
    ) -> Iterator[tuple[str, NDArray[Any]]]:
        names = series.axes[1:]
        others = [self.axes[axis] for axis in names]
        for index in np.ndindex(series.values.shape[1:]):
            places = [(axis, axis.values[i]) for axis, i in zip(others, index, strict=True)]
            labels = [str(value) for _, value in places if isinstance(value, str)]
            numbers = [
                f"at {name} = {value} {axis.unit}".strip()
                for name, (axis, value) in zip(names, places, strict=True)
                if not isinstance(value, str)
            ]
            units = [a.units[i] for a, i in zip(others, index, strict=True) if a.units is not None]
            own = [] if bare else [name.replace("_", " ")]
            # Of parts of a motion its letter stands in front: q x_dot, the coordinate.
            front = [*own, *labels[:1]] if series.bare else [*labels[:1], *own]
            words = [*front, *labels[1:], *numbers]
            yield (
                title(" ".join(words), units[0] if units else series.unit),
                series.values[:, *index],
            )


def title(words: str, unit: str) -> str:
    """Return the title of a column."""
    return f"{words} [{unit}]" if unit else words


class TableResult(Result):
    """Base of results that hold series or a table."""

    _digits: ClassVar[int | None] = None
    """Digits of numbers in text; by default as many as it takes to read the same number again."""

    def _table(self) -> Table:
        raise NotImplementedError

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write a table as text, with a column per number; titles hold names and units.

        Args:
            path: of the file, which is complete or not there.
        """
        write_columns(path, self._table().columns(), digits=self._digits)

    def to_pandas(self) -> pandas.DataFrame:
        """Return the table of `to_csv` as a data frame, whose index is the first column.

        Raises:
            ImportError: without pandas, which ``pip install "asperity[pandas]"`` installs.
        """
        pandas = library("pandas")
        index, *columns = self._table().columns().items()
        return pandas.DataFrame(dict(columns), index=pandas.Index(index[1], name=index[0]))

    def to_xarray(self) -> xarray.Dataset:
        """Return the arrays with names for their axes, and units and meanings as attributes.

        Raises:
            ImportError: without xarray, which ``pip install "asperity[xarray]"`` installs.
        """
        xarray = library("xarray")
        table = self._table()
        coordinates: dict[str, Any] = {}
        for name, axis in table.axes.items():
            # Files cannot hold axes without places.
            if not len(axis.values):
                continue
            coordinates[name] = name, np.asarray(axis.values), _attributes(axis.unit, axis)
            if axis.units is not None:
                words = {"long_name": f"unit along {name}"}
                coordinates[f"{name}_unit"] = name, np.asarray(axis.units), words
        variables = {
            name: (series.axes, series.values, self._attributes_of(table, series))
            for name, series in table.series.items()
            if all(series.values.shape[1:])
        }
        return xarray.Dataset(variables, coordinates, dict(table.facts))

    def _attributes_of(self, table: Table, series: Series) -> dict[str, Any]:
        units = {unit for name in series.axes for unit in (table.axes[name].units or ())} or {
            series.unit
        }
        attributes = _attributes(units.pop() if len(units) == 1 else "", series)
        if series.names:
            # The convention of climate and forecast metadata for numbers that stand for words.
            attributes["flag_values"] = np.array(list(series.names), dtype=series.values.dtype)
            attributes["flag_meanings"] = " ".join(series.names.values())
        return attributes


def _attributes(unit: str, of: Axis | Series) -> dict[str, Any]:
    words = {"units": "1" if unit == NO_UNIT else unit, "long_name": of.description}
    return {name: word for name, word in words.items() if word}
