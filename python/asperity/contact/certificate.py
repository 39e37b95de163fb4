"""What is left of the contact laws at given percussions, in physical units."""

from __future__ import annotations

from asperity._value import Value


class Certificate(Value):
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
        cone_violation: max P_N (k_C(−P/P_N) − 1)⁺, friction beyond the reservoir, in N s.
        direction_violation: largest distance of a friction percussion from the one that the law
            assigns to the slip, in N s.
        stick: number of contacts that stick.
        slip: number of contacts that slip.
        open: number of open contacts.

    Reference: [WL19] (19), (55); [AcaryBremondHuber2018].

    >>> import numpy as np
    >>> from asperity import ContactProblem, FrictionLaw
    >>> problem = ContactProblem(np.eye(3), [-1.0, 0.2, 0.0], FrictionLaw.isotropic(0.5))
    >>> problem.certificate([0.9, -0.2, 0.0]).penetration_velocity
    0.09999999999999998
    """

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

    def __init__(
        self,
        *,
        worst_contact: int,
        natural_map: float,
        penetration_velocity: float,
        complementarity: float,
        tension: float,
        cone_violation: float,
        direction_violation: float,
        stick: int,
        slip: int,
        open: int,
    ) -> None:
        self._set(
            worst_contact=int(worst_contact),
            natural_map=float(natural_map),
            penetration_velocity=float(penetration_velocity),
            complementarity=float(complementarity),
            tension=float(tension),
            cone_violation=float(cone_violation),
            direction_violation=float(direction_violation),
            stick=int(stick),
            slip=int(slip),
            open=int(open),
        )

    def __str__(self) -> str:
        defects = [
            ("natural map", self.natural_map, ""),
            ("penetration velocity", self.penetration_velocity, "m/s"),
            ("complementarity", self.complementarity, "J"),
            ("tension", self.tension, "N s"),
            ("friction beyond C", self.cone_violation, "N s"),
            ("friction off direction", self.direction_violation, "N s"),
        ]
        lines = [f"{name:<22} {value:9.2e} {unit}".rstrip() for name, value, unit in defects]
        counts = f"{self.stick} stick, {self.slip} slip, {self.open} open"
        return "\n".join([*lines, f"{'contacts':<22} {counts}; worst {self.worst_contact}"])
