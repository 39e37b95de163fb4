"""A law with the uncertainty of the parameters it was identified by: in a file, and at random."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage import data
from asperity._base.storage.provenance import Provenance
from asperity._base.storage.toml import advice_on
from asperity._base.tables import aligned
from asperity.errors import AsperityError, DimensionError, FitError, ParameterError
from asperity.identify.estimator.covariance import Covariance
from asperity.identify.models.names import (
    DIRECTION_KINDS,
    DIRECTIONS,
    RESERVOIR_KINDS,
    RESERVOIRS,
    DirectionName,
    ReservoirName,
    direction_model,
    reservoir_model,
    short,
)
from asperity.identify.models.patches import PATCH_KINDS, PatchModel
from asperity.identify.models.structure import PatchStructure, PlanarStructure, Structure
from asperity.law import FrictionLaw, LawFile
from asperity.law.file import checked

_PARTS = ("turns", "calibration", "zeros")
# Radii of a law and of the law of its parameters differ by rounding only.
_SAME, _DIRECTIONS_COMPARED = 1e-9, 72
# How far eigenvalues of a covariance may be below zero, relative to the largest one.
_ROUNDING = 1e-9
# So many draws for every law are made at most: most of them must be laws.
_DRAWS, _FEWEST_DRAWS = 20, 200
_BY_ONE = " by one run"


def recorded_under(loads: Sequence[float], *, runs: int) -> str:
    """Return the note of a law on the normal forces in N under which its runs were recorded.

    Args:
        loads: of the runs, or of the pieces that they were cut into.
        runs: how many there are.
    """
    by = _BY_ONE * (runs == 1)
    return f"recorded under {', '.join(dict.fromkeys(f'{load:.4g}' for load in loads))} N{by}"


class IdentifiedLaw(LawFile):
    """A law with the models, the values and the covariance of its parameters: a file of both.

    `fit_law` gives it as `Fit.identified_law`, ``asperity identify`` writes it as ``law.toml``. Its
    `sample` draws laws that are as uncertain as the measurement leaves them; motions of these are a
    band of the motion.

    Args:
        law: the law of the parameters; it may have a rate factor beside.
        reservoir_model: model of C, as for `fit_law`; of a law of a patch, the model of both sets.
        direction_model: model of D, likewise; None of a patch.
        values: the parameters, in the order of `names`.
        turns: covariance of the `coordinates` from what differs between turns, ``(k, k)``; None if
            there are no bands, and then nothing can be drawn.
        calibration: covariance from the calibration; None if its error is not known.
        zeros: covariance from the records without load; likewise.
        degrees_of_freedom: of these three; infinite where errors are known.
        provenance: where the law comes from.

    Raises:
        ParameterError: if the law is not that of the parameters, or a covariance is none.

    >>> import numpy as np
    >>> from asperity import Ellipse, FrictionLaw
    >>> from asperity.identify import IdentifiedLaw
    >>> law = FrictionLaw.collinear(Ellipse(0.5, 0.4))
    >>> spread = np.diag([0.01, 0.01, 0.02]) ** 2
    >>> found = IdentifiedLaw(
    ...     law,
    ...     reservoir_model="ellipse",
    ...     direction_model="circle",
    ...     values=[0.5, 0.4, 0.0],
    ...     turns=spread,
    ... )
    >>> found.names
    ('reservoir.a', 'reservoir.b', 'reservoir.angle')
    >>> found.standard_errors.round(9).tolist()
    [0.005, 0.004, 0.02]
    >>> len(found.sample(10, seed=1))
    10
    """

    reservoir_model: ReservoirName | PatchModel
    direction_model: DirectionName | None
    values: Array
    turns: Array | None
    calibration: Array | None
    zeros: Array | None
    degrees_of_freedom: tuple[float, float, float]
    _structure: Structure
    _at: Array

    def __init__(
        self,
        law: FrictionLaw,
        *,
        reservoir_model: ReservoirName | PatchModel,
        direction_model: DirectionName | None = None,
        values: ArrayLike,
        turns: ArrayLike | None = None,
        calibration: ArrayLike | None = None,
        zeros: ArrayLike | None = None,
        degrees_of_freedom: tuple[float, float, float] = (math.inf, math.inf, math.inf),
        provenance: Provenance | None = None,
    ) -> None:
        structure = _structure(reservoir_model, direction_model)
        count = len(structure.names)
        numbers = arrays.array(values, "values", (count,))
        parts = {
            name: None if part is None else _covariance(part, name, count)
            for name, part in zip(_PARTS, (turns, calibration, zeros), strict=True)
        }
        models: tuple[Any, Any] = reservoir_model, None
        if isinstance(structure, PlanarStructure):
            models = short(structure.reservoir), short(structure.direction)
        self._set(
            **checked(law, provenance),
            reservoir_model=models[0],
            direction_model=models[1],
            values=arrays.read_only(numbers),
            **parts,
            degrees_of_freedom=_degrees(degrees_of_freedom),
        )
        self._keep(_structure=structure, _at=arrays.read_only(structure.of_values(numbers)))
        _check_same(self.law, structure.law(self._at))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, such as ``"reservoir.a"``."""
        return self._structure.names

    @property
    def _loads(self) -> tuple[float, ...]:
        """The normal forces in N that the note of `recorded_under` says."""
        note = self.provenance.note.removesuffix(_BY_ONE)
        found = re.fullmatch(r"recorded under (.+) N", note)
        return () if found is None else tuple(map(float, found[1].split(", ")))

    @property
    def _is_of_one_run(self) -> bool:
        """Whether that note says so: the scatter between mountings is not in the covariance."""
        return self.provenance.note.endswith(_BY_ONE)

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the parameters, ``"rad"`` of angles and ``"-"`` of all others."""
        return self._structure.units

    @property
    def coordinates(self) -> tuple[str, ...]:
        """What the covariances are of, such as ``"ln(reservoir.a)"``: semi-axes are positive."""
        return self._structure.labels

    @property
    def covariance(self) -> Array:
        """Covariance of the `coordinates` from all causes that are known, ``(k, k)``.

        Raises:
            ParameterError: if none is known.
        """
        return self.covariances.total

    @property
    def standard_errors(self) -> Array:
        """Standard errors of the parameters, ``(k,)``.

        Raises:
            ParameterError: if no covariance is known.
        """
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0)) * self.slopes

    @property
    def slopes(self) -> Array:
        """Derivatives of the parameters by their `coordinates`, ``(k,)``."""
        pairs = zip(self._at, self._structure.coordinates, strict=True)
        return np.array([float(one.scale.slope(x)) for x, (_, one) in pairs])

    def moved(self, steps: ArrayLike) -> FrictionLaw:
        """Return the law whose `coordinates` are further by these steps, ``(k,)``."""
        at = self._at + arrays.array(steps, "steps", (len(self.names),))
        return self.law_of(self._structure.values(at))

    def law_of(self, values: ArrayLike) -> FrictionLaw:
        """Return the law of other values of the parameters, with the rate factor of this one.

        Args:
            values: in the order of `names`, shape ``(k,)``.

        Raises:
            ParameterError: if these are the parameters of no law.
            FitError: if a curve of D is not convex.
        """
        numbers = arrays.array(values, "values", (len(self.names),))
        found = self._structure.law(self._structure.of_values(numbers))
        return found if self.law.rate is None else found.replace(rate=self.law.rate)

    def sample_values(self, n: int, *, seed: int) -> Array:
        """Draw parameters that are as uncertain as the measurement leaves them.

        Their coordinates are the estimate and, for every cause of errors, a draw of Student's t
        with its covariance and degrees of freedom, as in the bands of the fit. Draws that are no
        law, or beyond the bounds of a model, are repeated.

        Args:
            n: number of draws.
            seed: of the random numbers; the same seed gives the same draws.

        Returns:
            Values in the order of `names`, ``(n, k)``.

        Raises:
            ParameterError: if no covariance is known.
            FitError: if hardly any draws are laws.
        """
        return self._draw(n, seed)[0]

    def sample(self, n: int, *, seed: int) -> tuple[FrictionLaw, ...]:
        """Draw laws that are as uncertain as the measurement leaves them, see `sample_values`.

        Args:
            n: number of laws.
            seed: of the random numbers; the same seed gives the same laws.

        Raises:
            ParameterError: if no covariance is known.
            FitError: if hardly any draws are laws.
        """
        return self._draw(n, seed)[1]

    def _draw(self, n: int, seed: int) -> tuple[Array, tuple[FrictionLaw, ...]]:
        count = arrays.count(n, "n")
        random = np.random.default_rng(arrays.count(seed, "seed", least=0))
        known = self.covariances
        factors = [
            (root_of(part), degrees)
            for part, degrees in zip(known.parts, known.degrees, strict=True)
            if part is not None
        ]
        values: list[Array] = []
        laws: list[FrictionLaw] = []
        for _ in range(_DRAWS * count + _FEWEST_DRAWS):
            at = self._at.copy()
            for root, degrees in factors:
                step = root @ random.normal(size=at.size)
                if math.isfinite(degrees):
                    step *= math.sqrt(degrees / random.chisquare(degrees))
                at += step
            if not self._structure.within_bounds(at):
                continue
            drawn = self._structure.values(at)
            try:
                laws.append(self.law_of(drawn))
            except AsperityError:
                continue
            values.append(drawn)
            if len(laws) == count:
                return np.array(values), tuple(laws)
        raise FitError(
            f"only {len(laws)} of {_DRAWS * count + _FEWEST_DRAWS} draws are laws: the measurement "
            "does not tell the parameters, choose models with fewer of them or record more turns"
        )

    @property
    def covariances(self) -> Covariance:
        """The covariances by their causes.

        Raises:
            ParameterError: if none is known.
        """
        if self.turns is None:
            raise ParameterError(
                "covariance", "is not known: fit with bands, which take two turns or more"
            )
        return Covariance(self.turns, self.calibration, self.zeros, self.degrees_of_freedom)

    def _parameters_table(self) -> tuple[dict[str, Any] | None, str]:
        covariance = {}
        for name, degrees in zip(_PARTS, self.degrees_of_freedom, strict=True):
            part = self._parameters[name]
            if part is not None:
                known = {"degrees_of_freedom": degrees} if math.isfinite(degrees) else {}
                covariance[name] = {**known, "matrix": part}
        parts: tuple[tuple[str, Any, data.Kinds], ...] = (
            ("reservoir_model", self.reservoir_model, RESERVOIR_KINDS),
            ("direction_model", self.direction_model, DIRECTION_KINDS),
        )
        if self.direction_model is None:
            parts = (("model", self.reservoir_model, PATCH_KINDS),)
        models = {
            key: model if isinstance(model, str) else data.typed(model, f"parameters.{key}", kinds)
            for key, model, kinds in parts
        }
        table = {
            **{key: model for key, model in models.items() if isinstance(model, str)},
            "names": self.names,
            "values": self.values,
            "units": self.units,
            "coordinates": self.coordinates,
            **{key: model for key, model in models.items() if not isinstance(model, str)},
            "covariance": covariance or None,
        }
        return table, f"what [law] was made of: change both, or leave this out\n{self._estimates()}"

    def _estimates(self) -> str:
        """Return the parameters as a table to read."""
        errors = np.full(self.values.shape, np.nan) if self.turns is None else self.standard_errors
        rows = [("name", "estimate", "standard error", "unit")]
        rows += [
            (name, f"{value:.6g}", f"{error:.2g}" if math.isfinite(error) else "not known", unit)
            for name, value, error, unit in zip(
                self.names, self.values, errors, self.units, strict=True
            )
        ]
        lines = aligned(rows, right=(1, 2)).split("\n")
        return "\n".join(f"  {line}" for line in lines)

    @classmethod
    def _of_parts(
        cls, law: FrictionLaw, provenance: Provenance, parameters: Mapping[str, Any] | None
    ) -> Self:
        key = "parameters"
        if parameters is None:
            raise ParameterError(
                key,
                "is missing: this is a law without the parameters that it was identified by, which "
                "FrictionLaw.load reads. Fit.save_law and `asperity identify` write them, "
                "FrictionLaw.save does not",
            )
        parts_of_models: dict[str, tuple[Mapping[str, Any], data.Kinds]] = {
            "reservoir_model": (RESERVOIRS, RESERVOIR_KINDS),
            "direction_model": (DIRECTIONS, DIRECTION_KINDS),
        }
        if "model" in parameters:
            parts_of_models = {"model": ({}, PATCH_KINDS)}
        for name in (*parts_of_models, "names", "values", "coordinates"):
            if name not in parameters:
                raise ParameterError(f"{key}.{name}", "is missing")
        models = [
            _model(parameters[name], f"{key}.{name}", *known)
            for name, known in parts_of_models.items()
        ]
        structure = _structure(*models)
        for name, known in (
            ("names", structure.names),
            ("coordinates", structure.labels),
            ("units", structure.units),
        ):
            given = parameters.get(name, known)
            if tuple(given) != known:
                raise ParameterError(f"{key}.{name}", f"must be {list(known)} for these models")
        covariance = parameters.get("covariance", {})
        degrees, parts = [], []
        for name in _PARTS:
            part = covariance.get(name, {})
            if name in covariance and "matrix" not in part:
                raise ParameterError(f"{key}.covariance.{name}.matrix", "is missing")
            parts.append(part.get("matrix"))
            within = f"{key}.covariance.{name}.degrees_of_freedom"
            count = part.get("degrees_of_freedom")
            degrees.append(math.inf if count is None else arrays.positive(count, within))
        try:
            return cls(
                law,
                reservoir_model=models[0],
                direction_model=models[1] if len(models) > 1 else None,
                values=parameters["values"],
                **dict(zip(_PARTS, parts, strict=True)),
                degrees_of_freedom=(degrees[0], degrees[1], degrees[2]),
                provenance=provenance,
            )
        except ParameterError as error:
            name = error.argument
            if name in _PARTS:
                name = f"covariance.{name}.matrix"
            at = name if name.startswith("law.") else f"{key}.{name}"
            raise type(error)(at, error.message) from None


def identified(
    law: FrictionLaw, structure: Structure, p: Array, covariance: Covariance | None
) -> IdentifiedLaw:
    """Return the law of coordinates with their covariance, None if it is not known."""
    known: dict[str, Any] = {}
    if covariance is not None:
        whole = covariance.merged()
        known = dict(zip(_PARTS, whole.parts, strict=True))
        known["degrees_of_freedom"] = (max(whole.degrees[0], 1.0), *whole.degrees[1:])
    return IdentifiedLaw(law, **structure.named(), values=structure.values(p), **known)


def _structure(reservoir: Any, direction: Any = None) -> PlanarStructure | PatchStructure:
    if isinstance(reservoir, PatchModel):
        if direction is not None:
            raise ParameterError("direction_model", "must be None: a patch has one model")
        return PatchStructure(reservoir)
    models: list[Any] = []
    for name, model, made in (
        ("reservoir_model", reservoir, reservoir_model),
        ("direction_model", direction, direction_model),
    ):
        try:
            models.append(made(model))
        except ParameterError as error:
            raise ParameterError(name, error.message) from None
    return PlanarStructure(*models)


def _model(given: Any, key: str, names: Mapping[str, Any], kinds: data.Kinds) -> Any:
    if not isinstance(given, str):
        return data.built_as_typed(given, key, kinds)
    if given not in names:
        raise ParameterError(key, f"{given!r} is not known{advice_on(given, names)}")
    return given


def _covariance(given: ArrayLike, name: str, count: int) -> Array:
    part = arrays.array(given, name, (count, count))
    largest = float(np.abs(part).max(initial=0.0))
    if not np.allclose(part, part.T, rtol=0.0, atol=_ROUNDING * largest):
        raise ParameterError(name, "must be a covariance, it is not symmetric")
    least = float(np.linalg.eigvalsh(0.5 * (part + part.T)).min(initial=0.0))
    if least < -_ROUNDING * largest:
        raise ParameterError(name, f"must be a covariance, it has the eigenvalue {least:.3g}")
    return arrays.read_only(part)


def root_of(covariance: Array) -> Array:
    """Return L with L Lᵀ the covariance, which may be singular."""
    sizes, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T))
    return vectors * np.sqrt(np.maximum(sizes, 0.0))


def _degrees(given: Any) -> tuple[float, float, float]:
    name = "degrees_of_freedom"
    listed = arrays.several(given, name)
    if len(listed) != len(_PARTS):
        raise DimensionError(name, f"must hold {len(_PARTS)} numbers, got {given!r}")
    # Errors that are known have infinitely many.
    found = [math.inf if one == math.inf else arrays.positive(one, name) for one in listed]
    return found[0], found[1], found[2]


def _check_same(law: FrictionLaw, own: FrictionLaw) -> None:
    """Refuse a law that is not the one of the parameters."""
    if law.dimension != own.dimension:
        raise ParameterError("law", f"must have p = {own.dimension}, has p = {law.dimension}")
    theta = 2.0 * math.pi * np.arange(_DIRECTIONS_COMPARED) / _DIRECTIONS_COMPARED
    for name, one, other in (
        ("reservoir", law.reservoir, own.reservoir),
        ("direction", law.direction, own.direction),
    ):
        if law.dimension == 2:
            sizes = one.radius(theta), other.radius(theta)
        else:
            normals = np.random.default_rng(0).normal(size=(_DIRECTIONS_COMPARED, law.dimension))
            sizes = one.support(normals), other.support(normals)
        off = float(np.abs(sizes[0] / sizes[1] - 1.0).max())
        if not off <= _SAME:
            raise ParameterError(
                f"law.{name}",
                f"must be that of the parameters, its radii differ by {off:.2g} of theirs: change "
                "both, or leave out [parameters]",
            )
