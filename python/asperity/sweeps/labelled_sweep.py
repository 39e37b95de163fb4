"""A function at all points of a grid."""

from __future__ import annotations

import inspect
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any, Literal

from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.progress import Progress, reporter
from asperity._base.result import counted
from asperity._core import __version__
from asperity.errors import ParameterError, SweepInterrupted
from asperity.sweeps.execution import Execution
from asperity.sweeps.executors import Workers
from asperity.sweeps.folder import Folder, fingerprint, folder_of
from asperity.sweeps.grid import Grid, automatic_points, chunk_shape, grid_of
from asperity.sweeps.identity import identity_of
from asperity.sweeps.store import FAILED, MISSING, Store
from asperity.sweeps.task import Call

if TYPE_CHECKING:
    import xarray


def sweep(
    function: Callable[..., Any],
    grid: Mapping[str, ArrayLike | Sequence[str]],
    *,
    store: str | os.PathLike[str] | None = None,
    executor: Executor | Callable[[], Executor] | Any = None,
    chunk: int | Literal["auto"] = "auto",
    on_failure: Literal["record", "raise"] = "record",
    seed: int | None = None,
    resume: bool | Literal["failed"] = True,
    progress: Progress = None,
    constants: Mapping[str, Any] | None = None,
    units: Mapping[str, str] | None = None,
    vector: str | Sequence[str] = (),
) -> xarray.Dataset:
    """Call a function at all points of a grid, on any executor; return labelled arrays.

    Points are computed in chunks. Each chunk is a task for a worker and a file of every array of
    the store, into which this process alone writes: first the results, last the status of the
    points. A sweep that was killed goes on where it was; nothing is computed twice but what was in
    flight. A store can be opened with ``xarray.open_zarr`` while it grows.

    Processes of its own import the script that calls it once more each: there the call belongs
    below ``if __name__ == "__main__":``.

    Args:
        function: takes the names of the grid as keywords, and returns a number, a truth value, an
            enumerator, an array of fixed shape, or several of them by name in a mapping. The first
            good result, in the order of the points, says which names and shapes there are; where
            others differ is a failure. Results of a single value are called ``value``.
        grid: values by name, numbers or texts of shape ``(n,)``. Coordinates of xarray keep their
            unit.
        store: folder of the store, which is made or gone on with; by default the results stay in
            memory.
        executor: of `concurrent.futures`, of loky or mpi4py, a client of dask, or a function that
            returns one and is called again if its processes die; by default processes of its own,
            one for each core, with one thread each.
        chunk: points per chunk; ``"auto"`` makes about 200 chunks of up to 500 points. A store that
            exists keeps its own.
        on_failure: ``"record"`` keeps the message of a point at which the function raises an error,
            ``"raise"`` ends the sweep.
        seed: of random numbers; the function must take ``rng``, a `numpy.random.Generator`, which
            depends on the seed and the values of the point, not on its place in the grid.
        resume: whether a store that exists is gone on with, or refused; ``"failed"`` computes again
            the points that failed, too.
        progress: ``True`` for a bar of tqdm, or a function of (done, all) points.
        constants: further arguments by name, the same at all points.
        units: of axes and results by name, for their attributes; other names are refused.
        vector: names of axes whose values are handed over whole, as arrays; results then begin with
            their lengths.

    Returns:
        The arrays over the names of the grid; those of a store are read when they are used. Real
        results are NaN where there are none, flags -128. ``status`` is 0 where a point is missing,
        1 where it is done, 2 where it failed, and ``message`` says why. Failures at all points are
        warned of.

    Raises:
        ParameterError: if an argument cannot be used, or if the store holds something else, which
            is named: another grid, function, source of the file of the function, minor version,
            seed, or another value of a constant, of a default or of a variable that the function
            encloses.
        SweepError: if a point fails with ``on_failure="raise"``, or if the processes of an executor
            die that cannot be made again.
        SweepInterrupted: on Ctrl-C, with what was done.
        OSError: naming the store, if it cannot be written; it can be gone on with.
        ModuleNotFoundError: without xarray and zarr, which ``pip install "asperity[sweep]"``
            installs.

    >>> from concurrent.futures import ThreadPoolExecutor
    >>> import numpy as np
    >>> from asperity import Ellipse, FrictionLaw, MassOnBelt, stability, sweep
    >>> def point(phi, zeta):
    ...     law = FrictionLaw(Ellipse(3.0, 1.0, angle=zeta), Ellipse(3.0, 1.0))
    ...     belt = [np.cos(phi), np.sin(phi)]
    ...     mass = MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=belt)
    ...     return {"growth": stability(mass).growth_rate}
    >>> grid = {"phi": np.radians([40.0, 50.0]), "zeta": np.radians([0.0, 30.0])}
    >>> with ThreadPoolExecutor() as threads:
    ...     chart = sweep(point, grid, executor=threads, units={"growth": "1/s", "phi": "rad"})
    >>> dict(chart.growth.sizes), (chart.growth > 0.0).values.tolist()
    ({'phi': 2, 'zeta': 2}, [[False, False], [False, True]])
    """
    if not callable(function):
        raise ParameterError("function", f"must be callable, got {function!r}")
    words = _words(units)
    points = grid_of(grid, vector, words)
    fixed = _constants(constants)
    number = None if seed is None else arrays.count(seed, "seed", least=0)
    _check_parameters(function, points, fixed, number)
    arrays.choice(on_failure, "on_failure", ("record", "raise"))
    if not isinstance(resume, bool) and resume != "failed":
        raise ParameterError("resume", f"must be True, False or 'failed', got {resume!r}")
    size = None if chunk == "auto" else arrays.count(chunk, "chunk")
    whole = {name: points.axes[name] for name in points.vector}
    call = Call(
        function,
        points.names,
        {**fixed, **whole},
        tuple(points.axes),
        points.vector_shape,
        number,
    )
    facts = {
        "asperity": __version__,
        **identity_of(function, fixed, stored=store is not None),
        "seed": "none" if number is None else number,
        "vector": " ".join(points.vector),
    }
    facts["fingerprint"] = fingerprint(points, facts)
    shape = chunk_shape(points.shape, size or automatic_points(points.points))
    options: dict[str, Any] = {"size": shape, "facts": facts, "units": words}
    kept = Store(points, **options)
    if store is not None:
        path = folder_of(store)
        if resume is False and path.exists():
            raise ParameterError("store", f"must be new with resume=False, {path} exists")
        kept = Folder(path, points, **options)
    strict = on_failure == "raise"
    wanted = (MISSING, FAILED) if strict or resume == "failed" else (MISSING,)
    try:
        with reporter(progress, "point") as report:
            if kept.begin(wanted):
                workers = Workers(executor)
                Execution(kept, points, call, workers, strict=strict, report=report).run(
                    kept.missing(wanted)
                )
    except KeyboardInterrupt:
        kept.settle()
        raise SweepInterrupted(kept.dataset(), kept.known, points.points) from None
    found = kept.dataset()
    if (kept.status == FAILED).all():
        warnings.warn(
            f"the function failed at all {counted(points.points, 'point')}, the first time with "
            f"{found.message.values.flat[0]}",
            RuntimeWarning,
            stacklevel=2,
        )
    return found


def _words(units: Mapping[str, str] | None) -> dict[str, str]:
    if not isinstance(units, Mapping | None):
        raise ParameterError("units", f"must hold units by names, got {units!r}")
    found = dict(units or {})
    for name, unit in found.items():
        arrays.of_kind(name, "units", str, "given by names")
        arrays.of_kind(unit, "units", str, f"a text for {name}")
    return found


def _constants(constants: Mapping[str, Any] | None) -> dict[str, Any]:
    if not isinstance(constants, Mapping | None):
        raise ParameterError("constants", f"must hold arguments by names, got {constants!r}")
    return dict(constants or {})


def _check_parameters(
    function: Callable[..., Any], grid: Grid, constants: Mapping[str, Any], seed: int | None
) -> None:
    """Refuse names that the function does not take, before anything is computed."""
    both = sorted(grid.axes.keys() & constants.keys())
    if both:
        raise ParameterError("constants", f"must not hold axes of the grid, got {', '.join(both)}")
    try:
        parameters = inspect.signature(function).parameters
    except (TypeError, ValueError):
        # Some functions in C do not say.
        return
    kinds = {name: one.kind for name, one in parameters.items()}
    others = inspect.Parameter.VAR_KEYWORD in kinds.values()
    by_name = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    takes = [name for name, kind in kinds.items() if kind in by_name]
    for argument, names in (("grid", grid.axes), ("constants", constants)):
        for name in names:
            if name not in takes and not others:
                raise ParameterError(
                    argument,
                    f"must have names of parameters: {', '.join(takes) or 'there are none'}; "
                    f"got {name!r}",
                )
    if seed is not None and "rng" not in takes and not others:
        raise ParameterError("seed", "has no effect: the function has no parameter rng")
    given = {*grid.axes, *constants, *(() if seed is None else ("rng",))}
    for name, one in parameters.items():
        needed = one.default is inspect.Parameter.empty and one.kind in by_name
        if needed and name not in given:
            advice = "seed" if name == "rng" else "grid"
            raise ParameterError(advice, f"must be given: the function needs {name}")
