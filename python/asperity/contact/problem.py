"""The one-step contact problem: Delassus operator, free velocities and laws in, percussions out."""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

import asperity._core as _core
from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.value import Value
from asperity.contact import bilateral as joints
from asperity.contact import operator
from asperity.contact.arguments import dimension, fractions, listed_laws, normal_forces, sizes
from asperity.contact.certificate import Certificate
from asperity.contact.compressed import compressed
from asperity.contact.solution import ContactSolution, LocalSolution, starting
from asperity.errors import ConvergenceError, NoSolutionError, ParameterError
from asperity.law import FrictionLaw
from asperity.solvers import Solver, chosen
from asperity.status import Status

if TYPE_CHECKING:
    from scipy.sparse import csr_array, sparray, spmatrix

Measure = Literal["contact", "global"]
_OPERATOR = ("delassus", "mass", "directions")
_FEW = 4
"""Contacts of problems that are shown with all their numbers."""


class ContactProblem(Value):
    """Find percussions P with ξ = G P + b + e∘γ_B, ξ_N ∈ N_{R₀⁻}(−P_N), ξ_T ∈ N_D(−αP_T).

    Rows come contact by contact: the normal row first where the contact is unilateral, then the p
    tangential rows, none without friction. The problem is independent of the mechanical system.

    Args:
        delassus: G = [W_N W]ᵀ M⁻¹ [W_N W] in 1/kg, shape ``(rows, rows)``; need not be symmetric.
            Any sparse array or matrix of SciPy is kept as a ``csr_array`` with sorted columns.
            ``None`` if it follows from `mass` and `directions`.
        free_velocity: b, the velocities without percussions in m/s, shape ``(rows,)``; as an
            attribute, what bilateral rows leave of it.
        laws: one law per contact, or one law for all, of dimension p = 1, 2 or 3; ``None`` of a
            contact without friction, p = 0, of which 0 ≤ P_N ⊥ ξ_N ≥ 0 is all.
        normal_force: prescribed normal percussions P_N ≥ 0 in N s: a number for all contacts, or
            one entry per contact, ``None`` meaning unilateral. Default: all unilateral.
        normal_restitution: e_N in [0, 1], a number or shape ``(contacts,)``.
        tangential_restitution: e_T in [0, 1], a number or shape ``(contacts,)``.
        initial_velocity: γ_B before the step in m/s, shape ``(rows,)``, for restitution.
        mass: M of the bodies, see `from_bodies`.
        directions: [W_N W] of the bodies, see `from_bodies`.
        bilateral: W_E of rows that hold the bodies, see `from_bodies`.
        bilateral_velocity: b_E of these rows, see `from_bodies`.

    Raises:
        DimensionError, ParameterError: naming the argument.

    Reference: [WL19] (19), (55).

    >>> import numpy as np
    >>> from asperity import ContactProblem, FrictionLaw
    >>> problem = ContactProblem(
    ...     [[1.0, 0.0], [0.0, 1.0]],
    ...     free_velocity=[3.0, 4.0],
    ...     laws=FrictionLaw.isotropic(0.5),
    ...     normal_force=1.0,
    ... )
    >>> solution = problem.solve()
    >>> solution.status, solution.percussion.round(12).tolist()
    (Status.CONVERGED, [-0.3, -0.4])

    Contacts with one tangential row, and with none:

    >>> feet = ContactProblem(
    ...     np.eye(3),
    ...     free_velocity=[-1.0, 2.0, -3.0],
    ...     laws=[FrictionLaw.isotropic(0.5, dimension=1), None],
    ... )
    >>> feet.solve().percussion.round(12).tolist()
    [1.0, -0.5, 3.0]
    """

    free_velocity: Array
    laws: tuple[FrictionLaw | None, ...]
    normal_force: tuple[float | None, ...]
    normal_restitution: Array
    tangential_restitution: Array
    initial_velocity: Array
    bilateral_velocity: Array | None
    _core: _core.Problem

    def __init__(
        self,
        delassus: ArrayLike | sparray | spmatrix | None,
        *,
        free_velocity: ArrayLike,
        laws: FrictionLaw | Sequence[FrictionLaw | None] | None,
        normal_force: float | Sequence[float | None] | None = None,
        normal_restitution: ArrayLike = 0.0,
        tangential_restitution: ArrayLike = 0.0,
        initial_velocity: ArrayLike | None = None,
        mass: ArrayLike | sparray | spmatrix | None = None,
        directions: ArrayLike | sparray | spmatrix | None = None,
        bilateral: ArrayLike | sparray | spmatrix | None = None,
        bilateral_velocity: ArrayLike | None = None,
    ) -> None:
        free = arrays.array(free_velocity, "free_velocity", (None,))
        chosen_laws = listed_laws(laws, free.size, normal_force)
        contacts = len(chosen_laws)
        normal = normal_forces(normal_force, chosen_laws)
        rows = sum(sizes(chosen_laws, normal))
        arrays.check_shape(free, "free_velocity", (rows,))
        initial = np.zeros(rows)
        if initial_velocity is not None:
            initial = arrays.array(initial_velocity, "initial_velocity", (rows,))
        bodies = operator.parameters(delassus, mass, directions, rows)
        self._set(
            **bodies,
            **joints.parameters(bilateral, bilateral_velocity, bodies),
            free_velocity=free,
            laws=chosen_laws,
            normal_force=normal,
            normal_restitution=fractions(normal_restitution, "normal_restitution", contacts),
            tangential_restitution=fractions(
                tangential_restitution, "tangential_restitution", contacts
            ),
            initial_velocity=initial,
        )
        if self._joints is not None:
            self._keep(free_velocity=self._joints.free_velocity)
            given: Any = compressed(self._joints.delassus, "directions", (rows, rows)).triple
        else:
            given = operator.for_core(*(self._parameters[name] for name in _OPERATOR))
        try:
            core = _core.Problem(
                given,
                self.free_velocity,
                [None if law is None else law._core for law in chosen_laws],
                list(normal),
                self.normal_restitution,
                self.tangential_restitution,
                self.initial_velocity,
            )
        except ParameterError as error:
            if error.argument == "mass":
                # Which of its properties it lacks takes longer to find than to refuse it.
                operator.check_mass(self._parameters["mass"])
            if error.argument == "delassus" and self._parameters["directions"] is not None:
                operator.check_directions(self._parameters["directions"])
            raise
        self._keep(_core=core)

    def __repr__(self) -> str:
        contacts = len(self.laws)
        if contacts <= _FEW:
            return super().__repr__()
        rows = self.free_velocity.size
        bodies = "" if self._parameters["mass"] is None else ", of bodies"
        return f"<ContactProblem: {contacts} contacts, {rows} rows{bodies}>"

    @classmethod
    def from_bodies(
        cls,
        mass: ArrayLike | sparray | spmatrix,
        *,
        directions: ArrayLike | sparray | spmatrix,
        free_velocity: ArrayLike,
        laws: FrictionLaw | Sequence[FrictionLaw | None] | None,
        delassus: ArrayLike | sparray | spmatrix | None = None,
        bilateral: ArrayLike | sparray | spmatrix | None = None,
        bilateral_velocity: ArrayLike | None = None,
        **options: Any,
    ) -> Self:
        """Make the problem with G = WᵀM⁻¹W of the bodies, W = [W_N W].

        Solvers that factor matrices then choose between a matrix over the bodies and one over the
        contacts: many contacts of few bodies are solved several times faster.

        Bilateral rows W_E hold the bodies, W_EᵀM⁻¹(W P + W_E P_E) + b_E = 0 with P_E of any sign,
        as joints do: they are eliminated. `delassus` and `free_velocity` are those of the motion
        that they let pass, for which solvers, measures, proofs and files take them. Rows may repeat
        each other, as in loops: P_E has the least Σ G_ii P_i² then. `bilateral_percussion` returns
        it. They may hold tangential rows of a contact, as in planar models: at rest friction is
        undetermined there, sliding brings about what belongs to it.

        Args:
            mass: M in kg and kg m², sparse, symmetric, positive definite, block-diagonal with
                small blocks; shape ``(n, n)``.
            directions: W, sparse, shape ``(n, rows)``: the equation of motion's, not Wᵀ.
            free_velocity: b in m/s, shape ``(rows,)``, best within the range of Wᵀ: contacts of
                which one alone would do are hard to solve where it is not.
            laws: as for the class.
            delassus: G if it is known and nothing is bilateral; default: assembled.
            bilateral: W_E, sparse, shape ``(n, m)``. Default none.
            bilateral_velocity: b_E, the velocities of these rows without percussions, in m/s, shape
                ``(m,)``; they may not contradict each other by more than 1e-6 of themselves.
                Default 0.
            options: ``normal_force`` and what follows, as for the class.

        Raises:
            DimensionError, ParameterError: naming the argument.

        >>> import numpy as np
        >>> from asperity import ContactProblem, FrictionLaw
        >>> free, law = [-1.0, 0.1, 0.1], FrictionLaw.isotropic(0.3)
        >>> block = ContactProblem.from_bodies(
        ...     2.0 * np.eye(3), directions=np.eye(3), free_velocity=free, laws=law
        ... )
        >>> block.solve().percussion.round(12).tolist(), block.delassus.diagonal().tolist()
        ([2.0, -0.2, -0.2], [0.5, 0.5, 0.5])

        Between rails that stop its motion along the third axis:

        >>> rail = np.array([[0.0], [0.0], [1.0]])
        >>> held = ContactProblem.from_bodies(
        ...     2.0 * np.eye(3),
        ...     directions=np.eye(3)[:, :2],
        ...     free_velocity=[-1.0, 0.5],
        ...     laws=FrictionLaw.isotropic(0.3, dimension=1),
        ...     bilateral=rail,
        ...     bilateral_velocity=[0.5],
        ... )
        >>> found = held.solve().percussion
        >>> found.round(12).tolist(), held.bilateral_percussion(found).round(12).tolist()
        ([2.0, -0.6], [-1.0])
        """
        return cls(
            delassus,
            bilateral=bilateral,
            bilateral_velocity=bilateral_velocity,
            free_velocity=free_velocity,
            laws=laws,
            mass=mass,
            directions=directions,
            **options,
        )

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some parameters changed.

        A new `delassus` forgets the bodies and what holds them, and new bodies forget the old
        `delassus`; new `bilateral` rows, or ``None``, forget the velocities of the old ones. A new
        `free_velocity` is that of bodies which no bilateral row holds, as `from_bodies` takes it.
        """
        if "bilateral" in changes:
            changes = {"bilateral_velocity": None, **changes}
        if "delassus" in changes:
            bodies = {"mass": None, "directions": None}
            rows = {"bilateral": None, "bilateral_velocity": None}
            changes = {"free_velocity": self.free_velocity, **bodies, **rows, **changes}
        elif "mass" in changes or "directions" in changes:
            changes = {"delassus": None, **changes}
        return super().replace(**changes)

    @cached_property
    def delassus(self) -> Array | csr_array:
        """The Delassus operator G in 1/kg, shape ``(rows, rows)``; of bodies, assembled."""
        if self._joints is not None:
            return self._joints.delassus
        given = self._parameters["delassus"]
        if given is None:
            mass, directions = self._parameters["mass"], self._parameters["directions"]
            return operator.assembled(mass.tocsr(), directions.tocsr())
        return given.tocsr() if hasattr(given, "tocsr") else given

    @cached_property
    def mass(self) -> csr_array | None:
        """M of the bodies in kg and kg m², shape ``(n, n)``."""
        mass = self._parameters["mass"]
        return None if mass is None else mass.tocsr()

    @cached_property
    def directions(self) -> csr_array | None:
        """[W_N W] of the bodies, shape ``(n, rows)``."""
        directions = self._parameters["directions"]
        return None if directions is None else directions.tocsr()

    @cached_property
    def bilateral(self) -> csr_array | None:
        """W_E of the rows that hold the bodies, shape ``(n, m)``."""
        bilateral = self._parameters["bilateral"]
        return None if bilateral is None else bilateral.tocsr()

    def bilateral_percussion(self, percussion: ArrayLike) -> Array:
        """Return P_E of the bilateral rows in N s for percussions of the contacts, shape ``(m,)``.

        Args:
            percussion: in N s, shape ``(rows,)``.
        """
        given = self._percussion(percussion)
        return np.zeros(0) if self._joints is None else self._joints.percussion(given)

    @cached_property
    def _joints(self) -> joints.Joints | None:
        given = self._parameters
        if given["bilateral"] is None:
            return None
        names = ("mass", "directions", "free_velocity", "bilateral", "bilateral_velocity")
        contacts = zip(self.row_slices, self.normal_force, strict=True)
        return joints.eliminated(*(given[name] for name in names), contacts=contacts)

    @property
    def row_slices(self) -> tuple[slice, ...]:
        """The rows of each contact."""
        rows = sizes(self.laws, self.normal_force)
        ends = np.cumsum(rows).tolist()
        return tuple(slice(end - size, end) for size, end in zip(rows, ends, strict=True))

    def solve(
        self,
        solver: Solver | None = None,
        *,
        tolerance: float = 1e-10,
        time_limit: float | None = None,
        on_failure: str = "raise",
        start: ContactSolution | ArrayLike | None = None,
        measure: Measure = "contact",
    ) -> ContactSolution:
        """Solve the problem.

        Args:
            solver: default `Auto`.
            tolerance: largest admissible value of the measure.
            time_limit: in s; default none.
            on_failure: ``"raise"`` or ``"record"``: return the best iterate with its status.
            start: previous solution, the start of the iteration and of the rule of selection; or
                percussions in N s to start the iteration from, shape ``(rows,)``.
            measure: what has to meet the tolerance: ``"contact"``, the largest relative defect of
                a contact (`residual`), or ``"global"``, that of the whole problem (`natural_map`).

        Returns:
            The solution; its measures are computed independently of the solver.

        Raises:
            NoSolutionError: if there is no solution: bodies are squeezed, or a contact has none by
                itself (Painlevé). The proof is its ``infeasibility``.
            ConvergenceError: if the tolerance is not reached.
            ParameterError: if the solver does not take such laws.
        """
        arrays.choice(on_failure, "on_failure", ("raise", "record"))
        found = self._core.solve(
            chosen(solver)._core,
            arrays.positive(tolerance, "tolerance"),
            None if time_limit is None else arrays.positive(time_limit, "time_limit"),
            None if start is None else starting(start, self),
            arrays.choice(measure, "measure", ("contact", "global")),
        )
        solution = ContactSolution._of(found)
        if not found.converged and on_failure == "raise":
            raise _failure(self, solution, measure)
        return solution

    def residual(self, percussion: ArrayLike) -> float:
        """Return the natural residual of percussions, the largest over the contacts.

        The defect of a normal row is P_N − max(0, P_N − ρξ_N), ρ = rows/tr G of the contact's own
        block. That of friction is the distance from (P, ρξ) to a pair near by that obeys the law,
        of percussion and velocity the larger part. With z = −αP and z′ = prox_{P_N D}(z + αρξ)
        one such pair is max(‖P + z′/α(z′)‖, ‖z − z′‖/α) away, another one, at rest,
        ‖P‖ max(0, 1 − 1/k_C(−P/P_N)) + ρ‖ξ‖; the nearer one counts. For D = C it is ‖z − z′‖.
        So a percussion of friction is beyond its reservoir by no more than its defect, however thin
        D is beside C.

        Both are taken relative to the percussion of the contact and ρ times its loads:
        independent of units and of the other contacts' sizes ([WL19] (12), (69)).

        Args:
            percussion: in N s, shape ``(rows,)``.

        >>> from asperity import ContactProblem, FrictionLaw
        >>> law = FrictionLaw.isotropic(0.3, dimension=1)
        >>> problem = ContactProblem([[1.0]], free_velocity=[0.5], laws=law, normal_force=1.0)
        >>> problem.residual([-0.3]) < 1e-12 < problem.residual([-0.2])
        True
        """
        return self._core.residual(self._percussion(percussion))[0]

    def natural_map(self, percussion: ArrayLike) -> float:
        """Return the natural map of the whole problem, ‖P − proj(P − ρξ)‖/max(‖P‖, ρ‖b‖).

        ρ = rows/tr G of the whole operator. Isotropic unilateral contacts are projected onto their
        cones, with μ‖ξ_T‖ added to ξ_N; others have the defects of `residual`. It is
        the measure in which engines are compared, and it lets a contact of small percussions be
        far off next to one of large ones.

        Args:
            percussion: in N s, shape ``(rows,)``.

        Reference: [DeSaxceFeng1998], [AcaryBremondHuber2018].

        >>> import numpy as np
        >>> from asperity import ContactProblem, FrictionLaw
        >>> problem = ContactProblem(
        ...     np.eye(3), free_velocity=[-1.0, 3.0, 4.0], laws=FrictionLaw.isotropic(0.5)
        ... )
        >>> problem.natural_map([1.0, -0.3, -0.4]) < 1e-12
        True
        """
        return self._core.natural_map(self._percussion(percussion))

    def certificate(self, percussion: ArrayLike) -> Certificate:
        """Return what is left of the contact laws at given percussions, in physical units.

        Args:
            percussion: in N s, shape ``(rows,)``.
        """
        return Certificate(**self._core.certificate(self._percussion(percussion)))

    def spectrum(self) -> tuple[float, float]:
        """Return estimates of the smallest and largest eigenvalue of ½(G + Gᵀ) in 1/kg."""
        return self._core.spectrum()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the problem to a file, which `load` reads.

        Args:
            path: ending in ``.npz``, or in ``.hdf5`` or ``.h5`` for the layout of FCLIB, which
                needs ``pip install "asperity[data]"``. What both formats hold:
                `asperity.contact.files`.
        """
        from asperity.contact.files import save

        save(self, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> ContactProblem:
        """Read a problem from a file.

        Args:
            path: ending in ``.npz``, ``.hdf5`` or ``.h5``.

        Raises:
            ParameterError: naming the key that is missing or wrong.
        """
        from asperity.contact.files import load

        return load(path)

    def solutions(
        self, contact: int, *, percussion: ArrayLike | None = None
    ) -> list[LocalSolution]:
        """Return all solutions of one contact, the percussions of the others held.

        Args:
            contact: its number, from 0; p = 2, 1 or 0.
            percussion: held percussions in N s, shape ``(rows,)``; default zeros. The rows of
                `contact` itself do not matter.

        Returns:
            Open, stick, then slip solutions by increasing direction of slip.

        >>> from asperity import ContactProblem, FrictionLaw
        >>> problem = ContactProblem(
        ...     [[1.0, 0.0], [0.0, 1.0]],
        ...     free_velocity=[0.2, 0.0],
        ...     laws=FrictionLaw.isotropic(0.3),
        ...     normal_force=1.0,
        ... )
        >>> [solution.phase for solution in problem.solutions(0)]
        [Phase.STICK]
        """
        number = arrays.count(contact, "contact", 0)
        if number >= len(self.laws):
            raise ParameterError("contact", f"must be below {len(self.laws)}, got {number}")
        if dimension(self.laws[number]) > 2:
            raise ParameterError("contact", "must have p ≤ 2: solutions with p = 3 are not listed")
        held = np.zeros(self.free_velocity.size) if percussion is None else percussion
        found = self._core.solutions(number, self._percussion(held))
        return [LocalSolution(**solution) for solution in found]

    def _percussion(self, percussion: ArrayLike) -> Array:
        return arrays.array(percussion, "percussion", (self.free_velocity.size,))


def _failure(
    problem: ContactProblem, solution: ContactSolution, measure: Measure
) -> ConvergenceError | ParameterError:
    status = solution.status
    if status is Status.NOT_APPLICABLE:
        return ParameterError("solver", f"{status.message}. {status.advice}")
    residual = solution.residual if measure == "contact" else solution.natural_map
    details: dict[str, Any] = {
        "contact": solution.worst_contact, "residual": residual, "advice": status.advice
    }  # fmt: skip
    if status is Status.NO_SOLUTION:
        proof = solution.infeasibility
        return NoSolutionError(status.message, **details, infeasibility=proof, problem=problem)
    return ConvergenceError(status.message, **details)
