"""A virtual pin-on-disk tribometer: raw data of a known law."""

from __future__ import annotations

import math
import os
from dataclasses import KW_ONLY
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import (
    Count,
    Fraction,
    Given,
    Index,
    NonNegative,
    Number,
    Positive,
    Record,
    field,
)
from asperity.errors import ParameterError
from asperity.identify.records.calibration import Calibration
from asperity.identify.records.record import RawData, Recording
from asperity.identify.records.writing import write_raw
from asperity.law import FrictionLaw

_CHUNK = 1 << 18
_DIRECTIONS = 720


def _planar(law: Any, name: str) -> FrictionLaw:
    if not isinstance(law, FrictionLaw) or law.dimension != 2:
        raise ParameterError(name, f"must be a FrictionLaw of the plane, got {law!r}")
    return law


def _moving(rate: Any, name: str) -> float:
    number = arrays.number(rate, name)
    if number == 0.0:
        raise ParameterError(name, "must not vanish")
    return number


def _mixed(crosstalk: Any, name: str) -> float | Array:
    mixed = arrays.array(crosstalk, name)
    if mixed.ndim == 0:
        return arrays.non_negative(float(mixed), name)
    return arrays.array(mixed, name, (3, 3))


class VirtualTribometer(Record):
    """A pin on a rotating disk whose contact obeys a friction law, and a sensor that does not.

    The sensor reads F = Xλ + zero + drift + noise, rounded to its resolution. Amplitudes of noise
    and drift are relative to the level of the channel: the mean friction force of the two
    horizontal ones, the normal force of the third. Everything random follows from the seed.

    Args:
        law: planar law in the frame of the disk.
        normal_force: mean λ_N in N.
        turns: length of the run in turns.
        turn_rate: in turns/s; negative turns backwards. 0.16 turns/s at 0.05 m are 50 mm/s.
        sample_rate: in Hz.
        start_angle: rotation at the start in rad, which is the sliding direction then.
        radius: distance of the pin from the axis in m.
        noise: standard deviation, relative.
        noise_bandwidth: corner frequency of first-order noise in Hz; white noise by default.
        crosstalk: X itself, shape ``(3, 3)``, or the bound of the entries of X − I.
        calibration_loads: how many loads per axis are weighed, 1/m, 2/m, …, 1 of the normal
            force; 0 leaves the sensor uncalibrated.
        reading_error: standard error of a reading in calibration, relative to the normal force.
        no_load_time: length of the records before and after without load in s.
        zero: bound of the channels' readings without load, relative to the normal force.
        load_ripple: amplitude of λ_N over a turn, relative.
        drift: bound of the zeros' linear change from start to end, relative.
        bits: resolution of readings over ± four normal forces; None does not round.
        seed: of everything random.

    Raises:
        ParameterError: if the law is not planar.

    >>> from asperity import FrictionLaw
    >>> from asperity.identify import VirtualTribometer, process
    >>> virtual = VirtualTribometer(FrictionLaw.isotropic(0.2), normal_force=10.0, turns=2, seed=1)
    >>> bool(abs(process(virtual.record()).averaged(36).force[0, 0] / 10.0 - 0.2) < 0.01)
    True
    """

    law: Annotated[FrictionLaw, _planar]
    _: KW_ONLY
    normal_force: Positive
    turns: Positive = 10.0
    turn_rate: Annotated[float, _moving] = 0.16
    sample_rate: Positive = 10_000.0
    start_angle: Number = 0.0
    radius: Positive = 0.05
    noise: NonNegative = 0.01
    noise_bandwidth: Positive | None = None
    crosstalk: Annotated[Given[ArrayLike, float | Array], _mixed] = field(default=0.05)
    calibration_loads: Index = 6
    reading_error: NonNegative = 1e-3
    no_load_time: NonNegative = 10.0
    zero: NonNegative = 0.02
    load_ripple: Fraction = 0.03
    drift: NonNegative = 0.01
    bits: Count | None = 16
    seed: Index = 0

    @classmethod
    def perfect(cls, law: FrictionLaw, *, normal_force: float, **options: Any) -> VirtualTribometer:
        """Make one without noise, drift, rounding and errors of calibration; crosstalk stays.

        >>> from asperity import FrictionLaw
        >>> from asperity.identify import VirtualTribometer
        >>> VirtualTribometer.perfect(FrictionLaw.isotropic(0.2), normal_force=9.0, turns=3).noise
        0.0
        """
        exact: dict[str, Any] = {
            "noise": 0.0,
            "reading_error": 0.0,
            "no_load_time": 0.0,
            "zero": 0.0,
            "drift": 0.0,
            "bits": None,
        }
        return cls(law, normal_force=normal_force, **{**exact, **options})

    def record(self) -> RawData:
        """Return the readings of one run, of the weighings and of the records without load."""
        random = np.random.default_rng(self.seed)
        mixing = self._mixing(random)
        calibration = self._calibration(random, mixing)
        levels = self._levels()
        zero = self.normal_force * self.zero * random.uniform(-1.0, 1.0, 3)
        drift = self.drift * levels * random.uniform(-1.0, 1.0, 3)
        phase = float(random.uniform(0.0, 2.0 * math.pi))

        idle = round(self.no_load_time * self.sample_rate)
        running = round(self.turns / abs(self.turn_rate) * self.sample_rate)
        if running < 2:
            raise ParameterError("turns", "must give two samples or more")
        total = running + 2 * idle

        def part(first: int, count: int, source: str) -> Recording:
            sample = np.arange(first - idle, first - idle + count)
            time = sample / self.sample_rate
            loaded = source == "virtual"
            turned = 2.0 * math.pi * self.turn_rate * time if loaded else np.zeros(count)
            angle = self.start_angle + turned
            readings = np.zeros((count, 3))
            if loaded:
                readings = self._forces(angle, phase) @ mixing.T
            share = (first + np.arange(count)) / total - 0.5
            for channel in range(3):
                readings[:, channel] += zero[channel] + drift[channel] * share
                readings[:, channel] += levels[channel] * self._noise(random, count)
            return _recording(time, angle, self._rounded(readings), source)

        before = [part(0, idle, "virtual, before")] if idle > 1 else []
        run = part(idle, running, "virtual")
        after = [part(idle + running, idle, "virtual, after")] if idle > 1 else []
        return RawData([run], calibration=calibration, no_load=before + after, radius=self.radius)

    def write(self, folder: str | os.PathLike[str]) -> list[str]:
        """Write what `record` returns as CSV files with a configuration, for `read_raw`.

        Args:
            folder: made if it is not there.

        Returns:
            Names of the files, the run first, ``tribometer.toml`` last.
        """
        return write_raw(self.record(), folder)

    def _levels(self) -> Array:
        phi = 2.0 * math.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
        friction = np.linalg.norm(self.law.force(arrays.unit_vectors(phi)), axis=1).mean()
        return self.normal_force * np.array([friction, friction, 1.0])

    def _mixing(self, random: np.random.Generator) -> Array:
        drawn = random.uniform(-1.0, 1.0, (3, 3))
        if isinstance(self.crosstalk, np.ndarray):
            return self.crosstalk
        return np.eye(3) + self.crosstalk * drawn

    def _calibration(self, random: np.random.Generator, mixing: Array) -> Calibration | None:
        m = self.calibration_loads
        if m == 0:
            return None
        steps = self.normal_force * np.arange(1, m + 1) / m
        loads = np.concatenate([np.outer(steps, axis) for axis in np.eye(3)])
        error = self.normal_force * self.reading_error
        readings = loads @ mixing.T + error * random.normal(size=loads.shape)
        return Calibration(loads, readings, reading_error=error)

    def _forces(self, angle: Array, phase: float) -> Array:
        """Return tangential, radial and normal force by (119), shape ``(n, 3)``."""
        speed = 2.0 * math.pi * self.turn_rate * self.radius
        forces = np.empty((len(angle), 3))
        for start in range(0, len(angle), _CHUNK):
            rows = slice(start, start + _CHUNK)
            e = arrays.unit_vectors(angle[rows])
            normal = self.normal_force * (1.0 + self.load_ripple * np.sin(angle[rows] + phase))
            x, y = -self.law.force(speed * e, normal_force=normal).T
            forces[rows, 0] = e[:, 0] * x + e[:, 1] * y
            forces[rows, 1] = e[:, 0] * y - e[:, 1] * x
            forces[rows, 2] = normal
        return forces

    def _noise(self, random: np.random.Generator, count: int) -> Array:
        if self.noise == 0.0:
            return np.zeros(count)
        white = random.normal(size=count)
        if self.noise_bandwidth is None:
            return self.noise * white
        from scipy.signal import lfilter

        memory = math.exp(-2.0 * math.pi * self.noise_bandwidth / self.sample_rate)
        # The first sample has the stationary distribution already.
        white[1:] *= math.sqrt(1.0 - memory**2)
        return np.asarray(self.noise * lfilter([1.0], [1.0, -memory], white), dtype=np.float64)

    def _rounded(self, readings: Array) -> Array:
        if self.bits is None:
            return readings
        step = 8.0 * self.normal_force / 2.0**self.bits
        return step * np.round(readings / step)


def _recording(time: Array, angle: Array, readings: Array, source: str) -> Recording:
    for series in (time, angle, readings):
        series.flags.writeable = False
    return Recording(time, angle=angle, readings=readings, source=source)
