"""Solvers of the one-step contact problem."""

from __future__ import annotations

from typing import Literal

from asperity import _arrays, _core
from asperity._value import Value
from asperity.errors import ParameterError


class Solver(Value):
    """Base of the contact solvers; any solver solves any `ContactProblem`."""

    _core: _core.Solver


class Exact(Solver):
    """Block Gauss–Seidel whose one-contact solve is exact: it finds all solutions and selects one.

    The rule of selection continues the previous state: a contact that stuck keeps sticking while
    that is admissible; a slipping one takes the slip solution whose direction is nearest to its
    last. A single contact is solved in one sweep.

    Args:
        max_sweeps: limit of sweeps over the contacts.

    >>> from asperity import Exact
    >>> Exact()
    Exact()
    """

    max_sweeps: int

    def __init__(self, *, max_sweeps: int = 10_000) -> None:
        max_sweeps = _arrays.count(max_sweeps, "max_sweeps")
        self._set(max_sweeps=max_sweeps)
        self._keep(_core=_core.Solver.exact(max_sweeps))


class ProxJacobi(Solver):
    """The paper's fixed-point iteration: P^{k+1} = −(1/α_k) prox_D(−α_k P^k + r γ^k).

    All contacts are updated at once from the last iterate.

    Args:
        r: prox parameter, a number > 0 used as it stands in all rows, or ``"adaptive"``: r̃ is the
            reciprocal of the largest row sum of abs(G) over the contact's rows, and is halved when
            the residual stops falling; the friction rows take r = α_k r̃. In stick a number
            converges for certain only while r λ_max(G) < 2 α_min.
        max_iterations: limit of iterations.

    Reference: [WL19] (20)–(22), (69)(70).

    >>> from asperity import ProxJacobi
    >>> ProxJacobi(r=0.5)
    ProxJacobi(r=0.5)
    """

    r: float | Literal["adaptive"]
    max_iterations: int

    def __init__(
        self, *, r: float | Literal["adaptive"] = "adaptive", max_iterations: int = 100_000
    ) -> None:
        number = _step_length(r)
        max_iterations = _arrays.count(max_iterations, "max_iterations")
        self._set(r="adaptive" if number is None else number, max_iterations=max_iterations)
        self._keep(_core=_core.Solver.prox_jacobi(number, max_iterations))


class ProxGaussSeidel(Solver):
    """The iteration of `ProxJacobi`, contact after contact with the newest percussions.

    Args:
        r: as in `ProxJacobi`, with row sums over the contact's own columns.
        max_iterations: limit of sweeps over the contacts.

    >>> from asperity import ProxGaussSeidel
    >>> ProxGaussSeidel(max_iterations=500)
    ProxGaussSeidel(max_iterations=500)
    """

    r: float | Literal["adaptive"]
    max_iterations: int

    def __init__(
        self, *, r: float | Literal["adaptive"] = "adaptive", max_iterations: int = 100_000
    ) -> None:
        number = _step_length(r)
        max_iterations = _arrays.count(max_iterations, "max_iterations")
        self._set(r="adaptive" if number is None else number, max_iterations=max_iterations)
        self._keep(_core=_core.Solver.prox_gauss_seidel(number, max_iterations))


def chosen(solver: Solver | None) -> Solver:
    """Return the solver, `Exact` if none was given."""
    if solver is None:
        return Exact()
    if not isinstance(solver, Solver):
        raise ParameterError("solver", f"must be a solver such as Exact(), got {solver!r}")
    return solver


def _step_length(r: float | str) -> float | None:
    """Return the number, ``None`` for the adaptive choice."""
    if isinstance(r, str):
        _arrays.choice(r, "r", ["adaptive"])
        return None
    return _arrays.positive(r, "r")
