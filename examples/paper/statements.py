"""Propositions 1–5 of [WL19], checked on given laws.

A statement is a check whose expected value is 1, for true, or 0, for a quantity that vanishes.
"""

import asperity as asp
import numpy as np
from asperity.demo import Check
from paper.drawing import Array, circle, unit_vectors

_PAIRS = 20_000


def truth(quantity: str, value: object) -> Check:
    """Return the check that a statement is true."""
    return Check(quantity, 1.0, float(bool(value)), 0.0, "1 = true")


def vanishes(quantity: str, values: Array | float, tolerance: float, unit: str = "") -> Check:
    """Return the check that no value exceeds the tolerance in magnitude."""
    return Check(quantity, 0.0, float(np.abs(values).max()), tolerance, unit)


def never_positive(quantity: str, values: Array | float, tolerance: float) -> Check:
    """Return the check that no value lies above the tolerance."""
    # Unlike Python's maximum, NumPy's keeps NaN, which no check passes.
    return Check(quantity, 0.0, float(np.maximum(np.max(values), 0.0)), tolerance)


def proposition_1(name: str, law: asp.FrictionLaw) -> list[Check]:
    """Check that an associated law dissipates Ψ*_C(γ) > 0."""
    slip = unit_vectors(circle(720))
    dissipation = law.dissipation(slip)
    return [
        vanishes(
            f"{name}, Prop. 1: dissipation − Ψ*_C(γ)",
            dissipation - law.reservoir.support(slip),
            1e-12,
        ),
        truth(f"{name}, Prop. 1: dissipation > 0", dissipation.min() > 0.0),
    ]


def proposition_2(
    name: str, associated: asp.FrictionLaw, others: list[asp.FrictionLaw]
) -> list[Check]:
    """Check that among laws with the same C the associated one dissipates most."""
    slip = unit_vectors(circle(720))
    excess = [law.dissipation(slip) - associated.dissipation(slip) for law in others]
    return [
        never_positive(f"{name}, Prop. 2: excess of other laws", np.max(excess), 1e-12),
        truth(
            f"{name}, Prop. 2: the comparison of laws agrees",
            all(
                associated.dissipates_at_least(law) and not law.dissipates_at_least(associated)
                for law in others
            ),
        ),
    ]


def propositions_3_and_4(
    name: str, associated: asp.FrictionLaw, others: list[asp.FrictionLaw]
) -> list[Check]:
    """Check that laws are maximal monotone if (4) and only if (3) they are associated."""
    return [
        never_positive(
            f"{name}, Prop. 4: (γ − γ*)·(λ − λ*) of the associated law",
            _products(associated),
            1e-12,
        ),
        truth(f"{name}, Prop. 4: found maximal monotone", associated.is_maximal_monotone),
        truth(
            f"{name}, Prop. 3: a pair breaks monotonicity of every other law",
            all(_broken(law) for law in others),
        ),
    ]


def proposition_5(name: str, law: asp.FrictionLaw) -> list[Check]:
    """Check that an extended law dissipates Ψ*_D(γ)/α > 0, with α at z = ∇Ψ*_D(γ)."""
    slip = unit_vectors(circle(720))
    z = law.direction.support_point(slip)
    # In slip k_D(z) = 1, so that (67) gives α = k_C(z).
    expected = law.direction.support(slip) / law.reservoir.gauge(z)
    dissipation = law.dissipation(slip)
    return [
        vanishes(f"{name}, Prop. 5: dissipation − Ψ*_D(γ)/α", dissipation - expected, 1e-9),
        truth(f"{name}, Prop. 5: dissipation > 0", dissipation.min() > 0.0),
    ]


def _products(law: asp.FrictionLaw) -> Array:
    slips = np.random.default_rng(1).normal(size=(2, _PAIRS, 2))
    (force, other), (slip, another) = law.force(slips), slips
    return np.sum((slip - another) * (force - other), axis=-1)


def _broken(law: asp.FrictionLaw) -> bool:
    """Return whether the witness of a law that is not monotone stands up to the law itself."""
    verdict = law.is_maximal_monotone
    if verdict or verdict.witness is None:
        return False
    slip, force, other_slip, other_force = verdict.witness
    pairs = ((slip, force), (other_slip, other_force))
    product = (slip - other_slip) @ (force - other_force)
    return all(_belongs(law, *pair) for pair in pairs) and bool(product > 0.0)


def _belongs(law: asp.FrictionLaw, slip: Array, force: Array) -> bool:
    if not slip.any():
        return bool(law.reservoir.contains(-force, tolerance=1e-9))
    return bool(np.allclose(law.force(slip), force, atol=1e-9))
