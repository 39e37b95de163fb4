"""What workers do: call the function at the points of a chunk."""

from __future__ import annotations

import hashlib
import pickle
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity._base.pool import one_of_many
from asperity.errors import ParameterError
from asperity.sweeps.outputs import Results, Schema, are_real, misfit, named, packed, sample_of


@dataclass(frozen=True)
class Call:
    """What is the same for all points.

    Attributes:
        function: that is called.
        names: of the axes that are gone through point by point.
        fixed: other arguments: constants, and axes that are handed over whole.
        axes: names of all axes.
        vector_shape: lengths of those that are handed over whole.
        seed: of the random numbers that the function is given as ``rng``, if it is.
    """

    function: Callable[..., Any]
    names: tuple[str, ...]
    fixed: Mapping[str, Any]
    axes: tuple[str, ...]
    vector_shape: tuple[int, ...]
    seed: int | None

    def arguments(self, values: Sequence[Any]) -> dict[str, Any]:
        """Return what the function is given at a point."""
        point = dict(zip(self.names, values, strict=True))
        if self.seed is None:
            return {**self.fixed, **point}
        return {**self.fixed, **point, "rng": generator(self.seed, point)}


@dataclass(frozen=True)
class Failure:
    """Why there is no result at a point.

    Attributes:
        error: class of the exception.
        message: what it says.
        traceback: where it was raised.
    """

    error: str
    message: str
    traceback: str = ""

    def __str__(self) -> str:
        return f"{self.error}: {self.message}" if self.message else self.error

    @classmethod
    def of(cls, error: BaseException) -> Failure:
        """Return what an exception says, as far as it can say it."""
        message = lines = ""
        with suppress(Exception):
            message = str(error)
        with suppress(Exception):
            lines = "".join(traceback.format_exception(error))
        return cls(type(error).__name__, message, lines)


@dataclass
class Answer:
    """What a worker found at the points of a chunk, which are numbered in their order.

    Attributes:
        count: of the points of the chunk.
        places: of those that were computed.
        failures: where there is no result.
        schema: what the first good result is; None if there was none.
        arrays: all results that are alike.
        samples: instead of arrays, every result and what it is, if it is not known yet which of
            them count.
    """

    count: int
    places: Sequence[int]
    failures: dict[int, Failure]
    schema: Schema | None = None
    arrays: dict[str, NDArray[Any]] = field(default_factory=dict)
    samples: dict[int, tuple[Schema, Results]] = field(default_factory=dict)

    @classmethod
    def lost(cls, count: int, places: Sequence[int], why: Failure) -> Answer:
        """Return the answer of a worker that gave none."""
        return cls(count, places, dict.fromkeys(places, why))

    @classmethod
    def of(
        cls,
        call: Call,
        places: Sequence[int],
        results: list[Results | None],
        failures: dict[int, Failure],
        wanted: Schema | None,
    ) -> Answer:
        """Return the answer with what the function has returned at the points of a chunk."""
        answer = cls(len(results), places, failures)
        if wanted is not None and are_real(results, wanted):
            return replace(answer, schema=wanted, arrays=packed(results, wanted))
        samples = {}
        for i, one in enumerate(results):
            if one is not None:
                try:
                    samples[i] = sample_of(one, call.axes, call.vector_shape)
                except Exception as error:
                    # Results may be of any class, and raise whatever it likes.
                    failures[i] = Failure.of(error)
        found = wanted or next((schema for schema, _ in samples.values()), None)
        answer = replace(answer, failures=failures, schema=found, samples=samples)
        alike = all(schema == found for schema, _ in samples.values())
        if found is not None and (wanted is not None or alike):
            return answer.fitted(found)
        # Another chunk may hold the first result of all, with which these are compared.
        return answer

    def fitted(self, wanted: Schema) -> Answer:
        """Return the answer with arrays of what is wanted; other results become failures."""
        if self.schema == wanted and not self.samples:
            return self
        failed, fitting = dict(self.failures), dict[int, Results]()
        for i, (schema, one) in self.samples.items():
            why = misfit(schema, wanted)
            if why:
                failed[i] = Failure("TypeError", why)
            else:
                fitting[i] = one
        if self.arrays and self.schema is not None:
            why = misfit(self.schema, wanted)
            failed = {i: failed.get(i, Failure("TypeError", why)) for i in self.places}
        arrays = packed([fitting.get(i) for i in range(self.count)], wanted)
        return replace(self, failures=failed, schema=wanted, arrays=arrays, samples={})


def portable(call: Call) -> bytes:
    """Return a call as bytes for other processes.

    Functions that these cannot import, such as those of a notebook, travel with their code, for
    which cloudpickle is needed.

    Raises:
        ParameterError: naming `function`, without cloudpickle, or if nothing can carry it.
    """
    typed = getattr(call.function, "__module__", "") == "__main__" and not hasattr(
        sys.modules["__main__"], "__file__"
    )
    try:
        if not typed:
            return pickle.dumps(call)
        why = "other processes cannot import it"
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        why = str(error)
    try:
        import cloudpickle
    except ImportError:
        raise ParameterError(
            "function",
            f"cannot be sent to other processes: {why}. Define it in a file, install cloudpickle, "
            "or use threads (executor=concurrent.futures.ThreadPoolExecutor())",
        ) from None
    try:
        whole: bytes = cloudpickle.dumps(call)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise ParameterError("function", f"cannot be sent to other processes: {error}") from None
    return whole


def compute(
    call: Call | bytes,
    values: Sequence[NDArray[Any]],
    places: Sequence[int],
    wanted: Schema | None,
    strict: bool,
) -> Answer:
    """Call the function at the points of a chunk.

    Args:
        call: the function and its other arguments.
        values: along the axes of the chunk.
        places: of the points to compute.
        wanted: what the function must return, if that is known.
        strict: whether to end at the first failure.
    """
    if isinstance(call, bytes):
        call = _loaded(call)
    points = list(product(*(part.tolist() for part in values)))
    results: list[Results | None] = [None] * len(points)
    failures: dict[int, Failure] = {}
    function, arguments = call.function, call.arguments
    with one_of_many():
        for i in places:
            try:
                results[i] = named(function(**arguments(points[i])))
            except (Exception, SystemExit) as error:
                failures[i] = Failure.of(error)
                if strict:
                    break
    return Answer.of(call, places, results, failures, wanted)


def _loaded(call: bytes) -> Call:
    try:
        loaded: Call = pickle.loads(call)
    except Exception as error:
        raise ParameterError(
            "function",
            f"cannot be found by a worker process ({type(error).__name__}: {error}): define it at "
            "the top of a file that workers can import",
        ) from None
    return loaded


def generator(seed: int, point: Mapping[str, float | str]) -> np.random.Generator:
    """Return the random numbers of a point, which depend on its values only.

    The point of a larger grid, or of one in another order, has the same.

    >>> from asperity.sweeps.task import generator
    >>> one, other = (generator(7, point) for point in ({"a": 1, "b": 0.5}, {"b": 0.5, "a": 1.0}))
    >>> one.normal() == other.normal()
    True
    """
    known = repr(sorted((name, _plain(value)) for name, value in point.items()))
    digest = hashlib.sha256(known.encode()).digest()
    key = np.frombuffer(digest, "<u4", 4).tolist()
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))


def _plain(value: float | str) -> float | str:
    """Return equal numbers as one: 1 as 1.0, -0.0 as 0.0."""
    return value if isinstance(value, str) or value != float(value) else float(value) + 0.0
