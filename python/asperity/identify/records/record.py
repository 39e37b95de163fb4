"""What the tribometer recorded: time, rotation of the disk, three force channels."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import KW_ONLY
from itertools import combinations, pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import (
    AnyArray,
    Count,
    Given,
    Number,
    OptionalArray,
    Positive,
    Record,
    Text,
    Truth,
    field,
)
from asperity.errors import DimensionError, ParameterError, RecordError
from asperity.identify.records.calibration import ByChannel, Calibration
from asperity.identify.records.tables.headings import CHANNELS as CHANNELS
from asperity.identify.records.tables.headings import COEFFICIENT, READINGS

if TYPE_CHECKING:
    from typing import Self

# A step longer than this many usual ones is a gap.
GAP = 1.5
# Between a file and the lines of one of its pieces.
PIECE = ", lines "
# The disk may shake by this angle against its sense of rotation.
BACKLASH = 0.1
_LISTED = 5
# Crosstalk, relative to the gains, that is rounding.
_ROUNDING = 1e-9


class Recording(Record):
    """One run of the tribometer: evenly sampled readings of its channels.

    Args:
        time: t in s, rising, without gaps; shape ``(n,)``.
        angle: rotation of the disk in rad, not wrapped; shape ``(n,)``.
        readings: tangential, radial and normal channel as read, in the unit of the calibration's
            readings or in N without one; shape ``(n, 3)``.
        source: where it comes from, for messages.

    Raises:
        RecordError: with row numbers from 1, if a value is not finite or samples are missing.
        DimensionError: if the lengths differ.

    Reference: [WL19] §5.2.

    >>> from asperity.identify import Recording
    >>> run = Recording([0.0, 0.1, 0.2], angle=[0.0, 0.5, 1.0], readings=[[1.0, 0.0, 5.0]] * 3)
    >>> round(run.sample_rate, 9), round(run.turn_rate, 3)
    (10.0, 0.796)
    """

    time: AnyArray
    _: KW_ONLY
    angle: AnyArray
    readings: AnyArray
    source: Text = ""
    velocity: OptionalArray = field(default=None)
    # Those of the channels in the file it was read from.
    _units: ClassVar[tuple[str, ...]] = ()
    # Of a stage in m as it was read: slopes leave reversals out.
    _position: ClassVar[Array | None] = None

    def _complete(self, given: dict[str, Any]) -> None:
        source = given["source"]
        t = given["time"] = _series(given["time"], "time", source, (None,))
        if len(t) < 2:
            raise DimensionError("time", f"must hold two samples or more, got {len(t)}")
        for what, rows in (("rise", standstill_rows(t)), ("go on without gap", gap_rows(t))):
            if rows.size:
                raise RecordError(source, f"time: does not {what} after {rows_text(rows + 1)}")
        for name, columns in (("angle", ()), ("readings", (3,)), ("velocity", (2,))):
            if given[name] is not None:
                given[name] = _series(given[name], name, source, (len(t), *columns))

    def __len__(self) -> int:
        return len(self.time)

    def __reduce__(self) -> tuple[Any, ...]:
        return *super().__reduce__(), {"_units": self._units, "_position": self._position}

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some parameters changed."""
        found = super().replace(**changes)
        if "readings" not in changes:
            found._keep(_units=self._units, _position=self._position)
        return found

    def __repr__(self) -> str:
        motion = f"{abs(self.turns):.6g} turns" if self.velocity is None else "strokes"
        return (
            f"<Recording: {len(self)} samples, {self.duration:.6g} s, "
            f"{motion}{f', {self.source}' if self.source else ''}>"
        )

    @property
    def file(self) -> str:
        """The source without the lines, for one of the pieces a file was cut into."""
        return self.source.partition(PIECE)[0]

    @property
    def duration(self) -> float:
        """Time from the first to the last sample in s."""
        return float(self.time[-1] - self.time[0])

    @property
    def sample_rate(self) -> float:
        """Samples per second."""
        return (len(self) - 1) / self.duration

    @property
    def turns(self) -> float:
        """Turns from the first to the last sample, negative if the disk turns backwards."""
        return float(self.angle[-1] - self.angle[0]) / (2.0 * math.pi)

    @property
    def turn_rate(self) -> float:
        """Turns per second, not negative."""
        return abs(self.turns) / self.duration

    @property
    def turns_back(self) -> bool:
        """Whether the disk turns both ways, by more than it may shake."""
        return turn_back(self.angle) is not None


class Processing(Record):
    """How raw data become forces over the sliding direction: what `process` does if not told.

    Args:
        cut_off: cut-off frequency of one pass of the normal force's low-pass filter, in turn rates;
            None leaves it unfiltered.
        order: of one pass.
        grid_angle: angle of the sliding direction from e₁ in rad where the rotation reads 0.

    >>> from asperity.identify import Processing
    >>> Processing(grid_angle=0.5)
    Processing(grid_angle=0.5)
    """

    _: KW_ONLY
    cut_off: Positive | None = 20.0
    order: Count = 4
    grid_angle: Number = 0.0


_USUAL = Processing()


def _several(values: Any, argument: str) -> tuple[Recording, ...]:
    found = (values,) if isinstance(values, Recording) else arrays.several(values, argument)
    for value in found:
        if not isinstance(value, Recording):
            raise ParameterError(argument, f"must hold Recordings, got {value!r}")
    return found


_Recordings: TypeAlias = Annotated[Given[Iterable[Recording], tuple[Recording, ...]], _several]


class RawData(Record):
    """All that was recorded of one pairing: runs, calibration and records without load.

    Args:
        recordings: the runs; one or several, none twice.
        calibration: of the force sensor; None if the readings are forces in N already.
        no_load: records without contact, on the clock of the runs. The zero of a run is
            interpolated linearly in time between the nearest before and after it; with records on
            one side only the nearest is taken, and its drift until the run counts as uncertainty.
        normal_load: constant λ_N in N that replaces what the normal channel says of λ_N; its
            crosstalk to the others is removed all the same.
        radius: distance of the pin from the axis in m, for the sliding speed.
        zero_error: standard error of the zeros of the three forces in N, a number or one for each
            channel: what is known of it beyond the records without load, or in their place. Of an
            error that is only known to be below l, the standard error is l/√3.
        gain_error: standard error of the three gains, relative to them, likewise: beyond the
            calibration, or in its place. With a `normal_load`, the third is the error of that.
        one_channel: whether the radial channel was not recorded. Its readings are zeros then, and
            nothing is known of the deflection of the force.
        processing: what `process` does with it; of `read_raw` the section of the configuration.

    >>> from asperity import FrictionLaw
    >>> from asperity.identify import VirtualTribometer
    >>> raw = VirtualTribometer(FrictionLaw.isotropic(0.2), normal_force=10.0, turns=2).record()
    >>> len(raw.recordings), len(raw.no_load)
    (1, 2)
    """

    recordings: _Recordings
    _: KW_ONLY
    calibration: Calibration | None = None
    no_load: _Recordings = field(default=())
    normal_load: Positive | None = None
    radius: Positive | None = None
    zero_error: ByChannel = field(default=None)
    gain_error: ByChannel = field(default=None)
    one_channel: Truth = False
    processing: Processing = _USUAL

    def _complete(self, given: dict[str, Any]) -> None:
        if not given["recordings"]:
            raise ParameterError("recordings", "must hold at least one recording")
        _refuse_copies(given["recordings"])
        known = given["calibration"]
        if known is None:
            _refuse_voltages(given["recordings"])
        elif COEFFICIENT in {unit.removeprefix("-") for one in given["recordings"]
                             for unit in one._units}:  # fmt: skip
            raise RecordError(
                given["recordings"][0].source,
                "tangential: is a coefficient of friction, to which no calibration belongs: leave "
                "the calibration out",
                ("calibration", "units"),
            )
        elif given["one_channel"] and (
            abs(known.matrix[[0, 2], 1]).max() > _ROUNDING * abs(known.matrix[1, 1])
        ):
            raise ParameterError(
                "one_channel",
                "needs a calibration without crosstalk of the radial channel, which is not there",
            )


def _refuse_voltages(runs: tuple[Recording, ...]) -> None:
    """Refuse readings that are no forces."""
    for run in runs:
        for channel, unit in zip(CHANNELS, run._units, strict=False):
            if unit.removeprefix("-") in READINGS:
                raise RecordError(
                    run.source,
                    f"{channel}: is in {unit}, which only a calibration turns into N: known loads "
                    f"and their readings in {unit.removeprefix('-')}, of all three channels",
                    ("calibration", "units"),
                )


def _refuse_copies(runs: tuple[Recording, ...]) -> None:
    """Refuse a run given twice: bands would be too narrow."""
    for one, other in combinations(runs, 2):
        if (
            len(one) == len(other)
            and (one.readings[0] == other.readings[0]).all()
            and np.array_equal(one.readings, other.readings)
            and np.array_equal(one.angle, other.angle)
        ):
            raise RecordError(other.source, f"is the same as {one.source or 'another run'}")


def _series(values: ArrayLike, name: str, source: str, shape: tuple[int | None, ...]) -> Array:
    """Return finite numbers that refuse writing; arrays that refuse it already are not copied."""
    arrays.refuse_masked(values, name)
    given = np.asarray(values)
    if given.dtype.kind not in "iufb":
        raise ParameterError(name, f"must hold real numbers, got {values!r}")
    arrays.check_shape(given, name, shape)
    # The sum of finite numbers is finite: no array of flags in the usual case.
    with np.errstate(all="ignore"):
        is_finite = math.isfinite(float(given.sum()))
    if not is_finite and not np.isfinite(given).all():
        bad = np.flatnonzero(~np.isfinite(given).reshape(len(given), -1).all(axis=1))
        raise RecordError(source, f"{name}: NaN or infinity in {rows_text(bad + 1)}")
    kept = given.dtype == np.float64 and given.flags.c_contiguous and not given.flags.writeable
    return given if kept else arrays.read_only(given.astype(np.float64, copy=False))


def turn_back(angle: Array) -> int | None:
    """Return the row up to which the disk has turned back most; None if it turns one way."""
    forwards = angle[-1] >= angle[0]
    farthest = np.maximum.accumulate(angle) if forwards else np.minimum.accumulate(angle)
    np.subtract(farthest, angle, out=farthest)
    row = int(farthest.argmax() if forwards else farthest.argmin())
    return row if abs(farthest[row]) > BACKLASH else None


def goes_back(pieces: Sequence[Recording]) -> bool:
    """Return whether a disk turns both ways in the pieces of a record."""
    if any(after.time[0] <= before.time[-1] for before, after in pairwise(pieces)):
        return any(piece.turns_back for piece in pieces)
    return turn_back(np.concatenate([piece.angle for piece in pieces])) is not None


def gap_rows(time: Array) -> NDArray[np.intp]:
    """Return the indices of samples that the next one follows too late; NaN says nothing."""
    steps = np.diff(time)
    usual = float(np.median(steps))
    if math.isnan(usual):
        known = steps[np.isfinite(steps)]
        usual = float(np.median(known)) if known.size else 0.0
    return np.flatnonzero(steps > GAP * usual)


def standstill_rows(time: Array) -> NDArray[np.intp]:
    """Return the indices of samples that the next one does not follow in time."""
    return np.flatnonzero(np.diff(time) <= 0.0)


def rows_text(rows: NDArray[np.intp]) -> str:
    """Return the first of some row numbers and how many there are."""
    first = ", ".join(str(row) for row in rows[:_LISTED])
    more = f", … ({len(rows)} rows)" if len(rows) > _LISTED else ""
    return f"row{'s' * (len(rows) > 1)} {first}{more}"
