"""Solvers of the one-step contact problem."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import KW_ONLY
from functools import cached_property
from typing import Annotated, ClassVar, Literal, TypeAlias

import asperity._core as _core
from asperity._base import arrays
from asperity._base.value import Count, Record

__all__ = [
    "ADMM",
    "Auto",
    "Exact",
    "InteriorPoint",
    "ProxGaussSeidel",
    "ProxJacobi",
    "ProximalPoint",
    "SemismoothNewton",
]


class Solver(Record):
    """Base of the contact solvers; all take any law but `InteriorPoint` and `ADMM`."""

    _method: ClassVar[str]

    @cached_property
    def _core(self) -> _core.Solver:
        # The core says None for "adaptive".
        options = {name: None if v == "adaptive" else v for name, v in self._parameters.items()}
        return _core.Solver(self._method, **options)


def _without(value: str | Iterable[str], argument: str) -> tuple[str, ...]:
    names = [value] if isinstance(value, str) else value
    return tuple(arrays.choice(name, argument, _core.Solver.steps()) for name in names)


Without: TypeAlias = Annotated[str | Iterable[str], _without]


class Auto(Solver):
    """The default: one method after the other, each where it is the fastest that is known to work.

    Contacts that do not influence each other get one sweep of `Exact`. Others are swept while that
    promises an end sooner than a few factorisations, each contact taking the first solution that
    continues its state. Steps follow from the best percussions so far, until one ends the work:
    ``"rest"`` (one factorisation for bodies that rest on each other, and `InteriorPoint` from
    there), ``"acceleration"`` (sweeps with Anderson's acceleration, where factorisations are
    expensive), ``"newton"`` (`SemismoothNewton`), ``"admm"`` (where factorisations are expensive)
    and ``"interior_point"`` for laws that they take, and ``"proximal_point"``, which takes all laws
    and singular Delassus operators. ``ContactSolution.stages`` names what was done.

    Args:
        without: names of steps to leave out.
        threads: for work that is done contact by contact, from 513 contacts on, and for islands
            side by side; the result does not depend on it.

    >>> from asperity import Auto
    >>> Auto(without=["admm", "interior_point"])
    Auto(without=('admm', 'interior_point'))
    """

    _method = "auto"
    STEPS: ClassVar[tuple[str, ...]] = tuple(_core.Solver.steps())

    _: KW_ONLY
    without: Without = ()
    threads: Count = 1


class Exact(Solver):
    """Block Gauss–Seidel whose one-contact solve is exact: it finds all solutions and selects one.

    With p = 3 it finds one solution of a contact only.

    The rule of selection continues the previous state: a contact that stuck keeps sticking while
    that is admissible; a slipping one takes the slip solution whose direction is nearest to its
    last. A single contact is solved in one sweep.

    The right one for a few contacts, for contacts that hardly feel each other, and wherever the
    rule of selection matters. Contacts that share one load (a table with four legs, a stack) make
    it slow.

    Args:
        max_sweeps: limit of sweeps over the contacts.

    >>> from asperity import Exact
    >>> Exact()
    Exact()
    """

    _method = "exact"

    _: KW_ONLY
    max_sweeps: Count = 10_000


def _step_length(value: float | str, argument: str) -> float | str:
    if isinstance(value, str):
        return arrays.choice(value, argument, ["adaptive"])
    return arrays.positive(value, argument)


StepLength: TypeAlias = Annotated[float | Literal["adaptive"], _step_length]


class ProxJacobi(Solver):
    """The paper's fixed-point iteration: P^{k+1} = −(1/α_k) prox_D(−α_k P^k + r γ^k).

    All contacts are updated at once from the last iterate. For comparison with the paper, and as
    an independent check.

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

    _method = "prox_jacobi"

    _: KW_ONLY
    r: StepLength = "adaptive"
    max_iterations: Count = 100_000


class ProxGaussSeidel(Solver):
    """The iteration of `ProxJacobi`, contact after contact with the newest percussions.

    Faster than `ProxJacobi`, otherwise like it; `Exact` needs fewer sweeps still.

    Args:
        r: as in `ProxJacobi`, with row sums over the contact's own columns.
        max_iterations: limit of sweeps over the contacts.

    >>> from asperity import ProxGaussSeidel
    >>> ProxGaussSeidel(max_iterations=500)
    ProxGaussSeidel(max_iterations=500)
    """

    _method = "prox_gauss_seidel"

    _: KW_ONLY
    r: StepLength = "adaptive"
    max_iterations: Count = 100_000


class SemismoothNewton(Solver):
    """Newton's method on the natural map of all contacts at once, each step one factorisation.

    The right one from a good start, such as the last step's solution, and for problems with a
    regular Delassus operator: it then takes a handful of steps. From a poor start it may cycle. Its
    matrices are regularised by 1e-8 of the blocks of G, which changes the steps and not where they
    lead: elimination among bodies needs it.

    Args:
        max_iterations: limit of Newton steps.

    Reference: [AlartCurnier1991], [AcaryBremondHuber2018].

    >>> from asperity import SemismoothNewton
    >>> SemismoothNewton(max_iterations=20)
    SemismoothNewton(max_iterations=20)
    """

    _method = "newton"

    _: KW_ONLY
    max_iterations: Count = 200


class ProximalPoint(Solver):
    """A sequence of problems G + εI about the last iterate, each solved by `SemismoothNewton`.

    The right one for singular Delassus operators (more contacts than the bodies distinguish)
    and for laws of all kinds. It needs no barrier of the reservoir, only its gauge and projections
    onto D.

    Args:
        max_iterations: limit of outer iterations.

    Reference: [AcaryBremondHuber2018].

    >>> from asperity import ProximalPoint
    >>> ProximalPoint()
    ProximalPoint()
    """

    _method = "proximal_point"

    _: KW_ONLY
    max_iterations: Count = 1000


class InteriorPoint(Solver):
    """A primal-dual path-following method over the friction cones.

    The right one for many contacts, above all hyperstatic ones; an iteration is a factorisation,
    and their number grows slowly with the size. It starts from a point of its own, and rounding
    ends it before the other methods: a few steps of `SemismoothNewton`, a stage of their own, add
    the last digits. It takes contacts whose C and D are disks, balls or ellipses
    (p = 1: symmetric intervals), not necessarily the same; others raise `ParameterError`.

    Args:
        max_iterations: limit of iterations.

    Reference: [NesterovTodd1998], [Mehrotra1992], [DeSaxceFeng1998].

    >>> from asperity import InteriorPoint
    >>> InteriorPoint()
    InteriorPoint()
    """

    _method = "interior_point"

    _: KW_ONLY
    max_iterations: Count = 100


class ADMM(Solver):
    """The alternating direction method of multipliers: many iterations for one factorisation.

    The right one where a factorisation is too expensive to repeat; it is repeated when the penalty
    changes. Where its residual does not fall, it begins again without percussions and extrapolates
    its iterates, and after that goes on as before from the best of them. It takes the contacts that
    `InteriorPoint` takes.

    Args:
        max_iterations: limit of iterations.

    >>> from asperity import ADMM
    >>> ADMM()
    ADMM()
    """

    _method = "admm"

    _: KW_ONLY
    max_iterations: Count = 2000


_DEFAULT = Auto()


def chosen(solver: Solver | None) -> Solver:
    """Return the solver, `Auto` if none was given."""
    if solver is None:
        return _DEFAULT
    return arrays.of_kind(solver, "solver", Solver, "a solver such as Auto()")


def named(name: str) -> Solver:
    """Return the solver of a name such as ``"auto"`` or ``"proximal-point"``, with its defaults."""
    return NAMES[arrays.choice(name, "solver", tuple(NAMES))]()


NAMES: dict[str, type[Solver]] = {
    "auto": Auto,
    "exact": Exact,
    "prox-jacobi": ProxJacobi,
    "prox-gauss-seidel": ProxGaussSeidel,
    "newton": SemismoothNewton,
    "proximal-point": ProximalPoint,
    "interior-point": InteriorPoint,
    "admm": ADMM,
}
