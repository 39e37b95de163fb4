"""What is left of the contact laws at given percussions, in physical units."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import Annotated, Any, Literal

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.tables import aligned
from asperity._base.value import Index, NonNegative, Record, Vector

InfeasibilityKind = Literal["closing", "one_contact", "cases"]


def _cases(value: Any, name: str) -> tuple[int | Array, ...]:
    def entry(case: Any) -> int | Array:
        if np.ndim(case) == 0:
            return arrays.count(case, name, least=0)
        return arrays.array(case, name, (None,))

    return tuple(map(entry, value))


class Certificate(Record):
    """Largest defects of the contact laws over all contacts, each in its own unit.

    ``str()`` prints them as a table. A solution to rounding has all defects at zero; an approximate
    one shows here what is wrong with it: bodies that sink in, adhesion, friction beyond C, or
    friction in a direction that does not belong to the slip.

    Attributes:
        worst_contact: contact with the largest relative residual.
        natural_map: defect of the whole problem, see `ContactProblem.natural_map`.
        penetration_velocity: max(0, −ξ_N) over the unilateral contacts, in m/s.
        complementarity: max |P_N ξ_N| over the unilateral contacts, in J.
        tension: max(0, −P_N), in N s.
        cone_violation: max |P| (1 − 1/k_C(−P/P_N))⁺ of the friction percussions P, in N s: by so
            much they are longer than the reservoir is in their direction.
        direction_violation: largest distance of a friction percussion, and of ρ times its slip,
            from a pair that obeys the law, in N s, see `ContactProblem.residual`.
        stick: number of contacts that stick.
        slip: number of contacts that slip.
        open: number of open contacts.

    Reference: [WL19] (19), (55); [AcaryBremondHuber2018].

    >>> import numpy as np
    >>> from asperity import ContactProblem, FrictionLaw
    >>> problem = ContactProblem(
    ...     np.eye(3), free_velocity=[-1.0, 0.2, 0.0], laws=FrictionLaw.isotropic(0.5)
    ... )
    >>> problem.certificate([0.9, -0.2, 0.0]).penetration_velocity
    0.09999999999999998
    """

    _: KW_ONLY
    worst_contact: int
    natural_map: float
    penetration_velocity: float
    complementarity: float
    tension: float
    cone_violation: float
    direction_violation: float
    stick: int
    slip: int
    open: int

    def __str__(self) -> str:
        defects = [
            ("natural map", self.natural_map, ""),
            ("penetration velocity", self.penetration_velocity, "m/s"),
            ("complementarity", self.complementarity, "J"),
            ("tension", self.tension, "N s"),
            ("friction beyond C", self.cone_violation, "N s"),
            ("friction off direction", self.direction_violation, "N s"),
        ]
        lines = [(name, f"{value:.2e} {unit}") for name, value, unit in defects]
        counts = f"{self.stick} stick, {self.slip} slip, {self.open} open"
        return aligned([*lines, ("contacts", f"{counts}; worst {self.worst_contact}")])


class Infeasibility(Record):
    """The proof that a contact problem has no solution, see `ContactSolution.infeasibility`.

    Kind ``"closing"``: weights d ≥ 0 of the normal rows of unilateral contacts with Gᵀd = 0.
    Whatever the percussions P, Σ dᵢξᵢ = (Gᵀd)·P + d·(b + e∘γ_B) = d·(b + e∘γ_B) < 0, but a
    solution has ξᵢ ≥ 0: the contacts with dᵢ > 0 close on each other, and no percussion changes
    how fast. For normal rows alone this is Farkas' lemma.

    Kind ``"one_contact"``: a contact that no other one influences has neither an open, nor a
    sticking, nor a slipping state (Painlevé's paradox).

    Kind ``"cases"``: all that a few contacts can do together is divided into cases, which are
    listed depth first. A number is the contact whose state divides a case: any into open and
    closed, closed into stick and slip, on a line in directions 1 and −1, in a plane in the
    quadrants of γ_T, and sectors of directions into halves. An array is a vector z of the rows
    with z·ξ ≤ 0 for all velocities of a case, (Gᵀz)·P ≥ 0 for all its percussions and
    z·(b + e∘γ_B) > 0: as z·ξ = (Gᵀz)·P + z·(b + e∘γ_B), the case is empty (Farkas' lemma). A
    contact with a given normal force begins as closed.

    `asperity.contact.grading.proves_no_solution` checks all of them without a solver.

    Attributes:
        kind: ``"closing"``, ``"one_contact"`` or ``"cases"``.
        contact: the contact without a solution, or the one with the largest part in d; of cases the
            one that approaches fastest without percussions.
        direction: d, with sum one, shape ``(rows,)``; of the other kinds the contact's normal row.
        closing_velocity: −d·(b + e∘γ_B) in m/s; of the other kinds the speed at which the contact
            approaches without percussions.
        residual: max |(Gᵀd)ⱼ|/sⱼ over max sᵢdᵢ, s = √diag G: zero to rounding; of bodies
            max |(W d)ₖ|/maxⱼ |W_kj| over max dᵢ; of cases the most by which rounding violates an
            inequality, in scaled rows relative to Σ sᵢ|zᵢ|.
        cases: of a proof by cases, else empty.

    >>> import numpy as np
    >>> from asperity import ContactProblem, FrictionLaw
    >>> line = FrictionLaw.isotropic(0.3, dimension=1)
    >>> normals = np.array([[1.0, -1.0], [-1.0, 1.0]])
    >>> jaws = np.kron(normals, np.diag([1.0, 0.0])) + np.diag([0.0, 1.0, 0.0, 1.0])
    >>> squeezed = ContactProblem(jaws, free_velocity=[-0.2, 0.0, -0.4, 0.0], laws=line)
    >>> proof = squeezed.solve(on_failure="record").infeasibility
    >>> proof.direction.round(12).tolist(), round(proof.closing_velocity, 12)
    ([0.5, 0.0, 0.5, 0.0], 0.3)
    """

    _: KW_ONLY
    kind: InfeasibilityKind
    contact: Index
    direction: Vector
    closing_velocity: NonNegative
    residual: NonNegative
    cases: Annotated[tuple[int | Array, ...], _cases] = ()
