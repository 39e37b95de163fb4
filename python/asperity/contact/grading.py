"""Second opinions in NumPy on what the core reports: natural map, proofs that nothing solves."""

from __future__ import annotations

import functools
import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.contact import ContactProblem, Infeasibility
from asperity.contact.arguments import dimension
from asperity.law import FrictionLaw
from asperity.sets import Ball, Disk

if TYPE_CHECKING:
    from scipy.sparse import csr_array

__all__ = ["natural_map", "proves_no_solution"]

State: TypeAlias = str | tuple[float, float]
"""What a contact does: any, open, closed, stick, or slip between two angles."""

_EPSILON = float(np.finfo(float).eps)
# Percussions, and velocities that they bring to contacts, over those of the loads, beyond which
# a problem counts as unsolved.
_HUGE, _FASTEST = 5e9, 5e7


def natural_map(problem: ContactProblem, percussion: ArrayLike) -> float:
    """Return ‖P − proj(P − ρξ)‖/max(‖P‖, ρ‖b + e∘γ_B‖), ρ = rows/tr G.

    Unilateral contacts with disks or balls are projected onto their cones, with μ‖ξ_T‖ added to
    ξ_N. Others have the defect P_N − max(0, P_N − ρξ_N), and that of friction which
    `ContactProblem.residual` has: the distance to a pair near by that obeys the law.

    Args:
        problem: with any laws.
        percussion: in N s, shape ``(rows,)``; infinity where they are not finite, as those of a
            solver may be.

    Reference: [AcaryBremondHuber2018]; [WL19] (12), (69).

    >>> from asperity import ContactProblem, FrictionLaw
    >>> problem = ContactProblem(
    ...     np.eye(3), free_velocity=[-1.0, 3.0, 4.0], laws=FrictionLaw.isotropic(0.5)
    ... )
    >>> natural_map(problem, np.array([1.0, -0.3, -0.4])) < 1e-12
    True
    """
    free = _free_velocity(problem)
    rho = free.size / problem.delassus.diagonal().sum()
    given = arrays.with_gaps(percussion, "percussion", free.shape)
    # A solver may have ended anywhere.
    if not np.isfinite(given).all():
        return math.inf
    xi = rho * (problem.delassus @ given + free)
    alike = defaultdict(list)
    for law, (rows, force) in zip(problem.laws, _contacts(problem), strict=True):
        alike[id(law), force is None].append((law, rows.start, force))
    squares = 0.0
    for contacts in alike.values():
        (law, *_), first, forces = zip(*contacts, strict=True)
        at = np.array(first)[:, None] + np.arange(dimension(law) + (forces[0] is None))
        squares += float((_defects(law, forces, given[at], xi[at]) ** 2).sum())
    scale = float(max(_norm(given), rho * _norm(free), np.finfo(float).tiny))
    return math.sqrt(squares) / scale


def proves_no_solution(problem: ContactProblem, proof: Infeasibility) -> bool:
    """Check the proof that a problem has no solution, from the problem alone.

    A proof of the kind ``"closing"`` has weights d ≥ 0 on normal rows of unilateral contacts with
    d·(b + e∘γ_B) < 0 and Gᵀd = 0 up to the rounding of the entries of G, |(Gᵀd)ⱼ| ≤ 8 ε sⱼ Σᵢ sᵢdᵢ
    with s = √diag G. A remainder |(Gᵀd)ⱼ| ≤ η sⱼ bounds the percussions of any solution from
    below: Σ sⱼ|Pⱼ| ≥ −d·(b + e∘γ_B)/η, which must be 5e9 times the largest |b_N|/s_N of these
    contacts; in a problem of bodies W d must vanish, too, up to 2e-10 of the largest weight. Or
    W d is rounding, |(W d)ₖ| ≤ 16 ε maxⱼ |W_kj| Σ dⱼ over the contacts of the body, and bounds the
    velocities u that percussions bring to the bodies. As Σ dᵢξᵢ = (W d)·u + d·(b + e∘γ_B), a
    solution has Σₖ |(W d)ₖ||uₖ| ≥ −d·(b + e∘γ_B), which must take velocities at contacts,
    uₖ maxⱼ |W_kj|, of 5e7 times the largest load, whatever the masses.

    A proof of the kind ``"one_contact"`` has a contact without entries of G to others, which
    neither opens nor sticks, and whose slip velocity is in none of 20,000 intervals of directions
    parallel to the direction that the friction belongs to. It is checked for p = 1 and p = 2 and a
    regular block.

    A proof of the kind ``"cases"`` divides all that the contacts can do, see `Infeasibility`, until
    each case has its z. Up to rounding of 8 ε Σ sᵢ|zᵢ| in scaled rows, z·ξ ≤ 0 holds at the ends
    of sectors and (Gᵀz)·P ≥ 0 for the friction where tangents of C, 32 in half a turn, meet; a
    remainder η bounds percussions and velocities of any solution from below, which must be 5e9
    times the largest |b|/s. It is checked for p ≤ 1 and, with convex C, p = 2.

    Args:
        problem: with any laws.
        proof: the `infeasibility` of a solution.

    >>> from asperity import ContactProblem, FrictionLaw
    >>> line = FrictionLaw.isotropic(1.0, dimension=1)
    >>> paradox = ContactProblem([[1.0, 2.0], [2.0, 3.0]], free_velocity=[-1.0, 5.0], laws=line)
    >>> proves_no_solution(paradox, paradox.solve(on_failure="record").infeasibility)
    True
    """
    free = _free_velocity(problem)
    arrays.of_kind(proof, "proof", Infeasibility, "an Infeasibility")
    if proof.direction.shape != free.shape or not 0 <= proof.contact < len(problem.laws):
        return False
    if proof.kind == "one_contact":
        return _has_none(problem, proof.contact, free)
    if proof.kind == "cases":
        return _covers(problem, proof.cases, free)
    weights = proof.direction
    normal = np.zeros(free.size, dtype=bool)
    normal[[rows.start for rows, force in _contacts(problem) if force is None]] = True
    if not weights.max() > 0.0 or (weights < 0.0).any() or (weights[~normal] != 0.0).any():
        return False
    # Products with the smallest numbers would vanish.
    weights = weights / weights.max()
    return bool(
        -weights @ free > 1e-13 * (weights @ np.abs(free))
        and (_keeps_bodies(problem, weights, free) or _vanishes(problem, weights, free))
    )


def _directions(problem: ContactProblem) -> csr_array | None:
    """Return W of bodies that nothing holds but contacts."""
    return problem.directions if problem.bilateral is None else None


def _keeps_bodies(problem: ContactProblem, weights: Array, free: Array) -> bool:
    """Return whether contacts that open ask for velocities of bodies far beyond the loads."""
    directions = _directions(problem)
    if directions is None:
        return False
    # Rows of forces, without those of drilling torques.
    ends = [
        (rows.start, min(rows.stop, rows.start + 2 + (f is None))) for rows, f in _contacts(problem)
    ]
    load = max(np.abs(free[start:stop]).max() for start, stop in ends)
    levers = abs(directions)
    lever = levers.max(axis=1).toarray().ravel()
    touched = lever > 0.0
    moved = np.abs(directions @ weights)[touched] / lever[touched]
    explained = 16.0 * _EPSILON * (levers.sign() @ weights)[touched]
    return bool((moved <= explained).all() and -weights @ free >= _FASTEST * moved.sum() * load)


def _vanishes(problem: ContactProblem, weights: Array, free: Array) -> bool:
    """Return whether Gᵀd is rounding, so that percussions would be far beyond the loads."""
    scale = np.sqrt(problem.delassus.diagonal())
    changed = (np.abs(problem.delassus.T @ weights) / scale).max()
    called_for = (np.abs(free) / scale)[weights > 0.0].max()
    if not (
        changed <= 8.0 * _EPSILON * (scale * weights).sum()
        and -weights @ free >= _HUGE * changed * called_for
    ):
        return False
    directions = _directions(problem)
    if directions is None:
        return True
    # Weights as percussions move no body, up to rounding.
    explained = abs(directions) @ np.where(weights == 0.0, 0.0, 1.0 / scale)
    momentum = np.abs(directions @ weights)
    return bool((momentum <= 2e-10 * (scale * weights).max() * explained).all())


def _has_none(problem: ContactProblem, contact: int, free: Array) -> bool:
    """Return whether a contact that no other one influences has no solution."""
    rows, law = problem.row_slices[contact], problem.laws[contact]
    row = problem.delassus[rows]
    dense = row if isinstance(row, np.ndarray) else row.toarray()
    block, b = dense[:, rows], free[rows]
    alone = np.delete(dense, np.r_[rows], axis=1)
    unilateral = problem.normal_force[contact] is None
    if law is None or alone.any() or not unilateral or law.dimension > 2 or b[0] >= 0.0:
        return False
    if np.linalg.cond(block) > 1e8:
        return False
    stick = np.linalg.solve(block, -b)
    if stick[0] > 0.0 and law.reservoir.gauge(-stick[1:] / stick[0]) <= 1.0 + 1e-9:
        return False
    directions, friction = _frictions(law)
    # P_N = −b_N/resistance; the slip is multiplied by it, so that it has no pole.
    resistance = block[0, 0] + friction @ block[0, 1:]
    bare = block[1:, 0] + friction @ block[1:, 1:].T
    slip = resistance[:, None] * b[1:] - b[0] * bare
    along = (slip * directions).sum(axis=1)
    if law.dimension == 1:
        return not bool(((resistance > 0.0) & (along > 0.0)).any())
    # Resistance and slip are affine in the friction.
    across = directions[:, 0] * slip[:, 1] - directions[:, 1] * slip[:, 0]
    roots = np.flatnonzero(np.sign(across[1:]) != np.sign(across[:-1]))
    part = across[roots] / (across[roots] - across[roots + 1])
    ahead = [
        value[roots] + part * (value[roots + 1] - value[roots]) > -1e-6 * np.abs(value).max()
        for value in (resistance, along)
    ]
    return not bool((ahead[0] & ahead[1]).any())


def _covers(problem: ContactProblem, cases: Sequence[int | Array], free: Array) -> bool:
    """Return whether cases, listed depth first, cover all states and have no solution."""
    begun: tuple[State, ...]
    begun = tuple("any" if force is None else "closed" for force in problem.normal_force)
    left = [begun]
    for case in cases:
        if not left:
            return False
        states = left.pop()
        if not isinstance(case, int):
            if not _is_empty(problem, states, case, free):
                return False
        elif case < len(states) and (parts := _parts(states[case], dimension(problem.laws[case]))):
            left += [(*states[:case], part, *states[case + 1 :]) for part in reversed(parts)]
        else:
            return False
    return not left


def _parts(state: State, p: int) -> list[State]:
    """Return the states that a state is divided into; none if it is not."""
    if isinstance(state, tuple):
        middle = 0.5 * (state[0] + state[1])
        return [(state[0], middle), (middle, state[1])] if state[0] < state[1] else []
    if state == "any":
        return ["open", "closed"]
    if state != "closed" or p not in (1, 2):
        return []
    if p == 1:
        return ["stick", (0.0, 0.0), (math.pi, math.pi)]
    return ["stick", *((0.5 * math.pi * k, 0.5 * math.pi * (k + 1)) for k in range(4))]


def _is_empty(problem: ContactProblem, states: tuple[State, ...], z: Array, free: Array) -> bool:
    """Return whether z separates a case from its loads, so far that no rounding matters."""
    scale = np.sqrt(problem.delassus.diagonal())
    # G may have lost heavy bodies beside light ones.
    if z.shape != free.shape or not z.any() or scale.min() == 0.0:
        return False
    if _directions(problem) is not None:
        return False
    # Products with the smallest numbers would vanish.
    z = z / np.abs(z).max()
    y, gap, left, size = problem.delassus.T @ z, z @ free, 0.0, scale @ np.abs(z)
    # Of entries of G far beyond its diagonal, sums lose more than that.
    entries: Any = abs(problem.delassus)
    summed = max(size, (entries.T @ np.abs(z) / scale).max())
    loads = (np.abs(free) / scale).max()
    contacts = zip(_contacts(problem), problem.laws, states, strict=True)
    for (rows, force), law, state in contacts:
        tangent = slice(rows.start + (force is None), rows.stop)
        if state in ("any", "open"):
            left = max(left, z[rows.start] * scale[rows.start])
        if isinstance(state, tuple):
            ends = arrays.unit_vectors(np.array(state))[:, : dimension(law)]
            left = max(left, (ends @ z[tangent] / (np.abs(ends) @ (1.0 / scale[tangent]))).max())
        elif state != "stick" and z[tangent].any():
            return False
        if state == "open":
            continue
        if law is not None and (law.dimension > 2 or not law.reservoir.is_convex):
            return False
        friction = np.zeros((1, 0)) if law is None else _friction_of(law, state)
        if friction is None:
            return False
        pulled, pulling = friction @ y[tangent], np.abs(friction) @ scale[tangent]
        if force is None:
            left = max(left, (-(y[rows.start] + pulled) / (scale[rows.start] + pulling)).max())
        else:
            gap += force * pulled.min()
            loads = max(loads, force * pulling.max())
    beyond = _HUGE * (left + 0.5 * _EPSILON * summed) * loads
    return bool(left <= 8.0 * _EPSILON * size and gap > 0.0 and gap >= beyond)


def _friction_of(law: FrictionLaw, state: State) -> Array | None:
    """Return points around the friction per unit normal force of a state: where tangents of C meet.

    None where they do not meet. Points of the boundary alone would leave out corners between them.
    """
    if law.dimension == 1:
        ends = np.cos(state)[:1, None] if isinstance(state, tuple) else np.array([[1.0], [-1.0]])
        return law.force(ends, normal_force=1.0)
    first, turn = 0.0, 2.0 * math.pi
    if isinstance(state, tuple):
        # Flat sides of D may end the sector.
        beside = arrays.unit_vectors(np.add(state, [-1e-6, 1e-6]))
        z = law.direction.support_point(beside)
        first, last = np.add(np.arctan2(z[:, 1], z[:, 0]), [-1e-6, 1e-6])
        turn = (last - first) % (2.0 * math.pi)
    # More tangents hold less around C, others than those of the proof hold what it need not.
    pieces = max(math.ceil(32.0 * turn / math.pi), 1)
    rays = arrays.unit_vectors(first + turn * np.linspace(0.0, 1.0, pieces + 1))
    x = rays / law.reservoir.gauge(rays)[:, None]
    normal = law.reservoir.gauge_gradient(x)
    # 1 − nᵀx of each point and the tangent at its neighbour; along a flat side both are zero.
    ahead = np.maximum(1.0 - (normal[:-1] * x[1:]).sum(axis=1), _EPSILON)[:, None]
    behind = np.maximum(1.0 - (normal[1:] * x[:-1]).sum(axis=1), _EPSILON)[:, None]
    shared = ahead + behind - ahead * behind
    # Tangents of sides that lean away from each other meet behind them.
    if not (shared > 0.0).all():
        return None
    return -np.vstack([x[[0, -1]], (ahead * x[:-1] + behind * x[1:]) / shared])


@functools.lru_cache(maxsize=16)
def _frictions(law: FrictionLaw) -> tuple[Array, Array]:
    """Return slip directions and friction per unit normal force, all around and along flats."""
    if law.dimension == 1:
        both = np.array([[1.0], [-1.0]])
        return both, law.force(both, normal_force=1.0)
    directions = arrays.unit_vectors(np.arange(20_002) * 2.0 * np.pi / 20_000)
    ends = law.direction.support_point(directions)
    steps = np.linalg.norm(np.diff(ends, axis=0), axis=1)
    pieces = np.where(steps > 20.0 * steps.mean(), 1000, 1)
    k = np.repeat(np.arange(len(steps)), pieces)
    part = (np.arange(len(k)) - np.repeat(np.cumsum(pieces) - pieces, pieces)) / pieces[k]
    along = ends[k] + part[:, None] * (ends[k + 1] - ends[k])
    return directions[k], -along / law.reservoir.gauge(along)[:, None]


def _contacts(problem: ContactProblem) -> Iterator[tuple[slice, float | None]]:
    return zip(problem.row_slices, problem.normal_force, strict=True)


def _free_velocity(problem: ContactProblem) -> Array:
    """Return b + e∘γ_B."""
    arrays.of_kind(problem, "problem", ContactProblem, "a ContactProblem")
    contacts = list(_contacts(problem))
    widths = [rows.stop - rows.start for rows, _ in contacts]
    factor = np.repeat(problem.tangential_restitution, widths)
    closing = [i for i, (_, force) in enumerate(contacts) if force is None]
    factor[[contacts[i][0].start for i in closing]] = problem.normal_restitution[closing]
    free: Array = problem.free_velocity + factor * problem.initial_velocity
    return free


def _defects(law: FrictionLaw | None, forces: Sequence[float | None], p: Array, v: Array) -> Array:
    """Return the defects of contacts with v = ρξ and the normal forces that are given, if any."""
    if law is None:
        return p[:, 0] - np.maximum(0.0, p[:, 0] - v[:, 0])
    if forces[0] is not None:
        return _friction(law, np.array(forces), p, v)
    if isinstance(law.reservoir, Ball | Disk) and law.reservoir == law.direction:
        return _cone(float(law.reservoir.support(np.eye(law.dimension)[0])), p, v)
    normal = p[:, 0]
    tangential = _friction(law, normal, p[:, 1:], v[:, 1:])
    return np.hypot(normal - np.maximum(0.0, normal - v[:, 0]), tangential)


def _cone(mu: float, p: Array, v: Array) -> Array:
    """Return the defects of P = proj_K(P − ρξ̃), ξ̃_N = ξ_N + μ‖ξ_T‖, K the friction cone."""
    moved = p - v
    moved[:, 0] -= mu * _norm(v[:, 1:])
    length = _norm(moved[:, 1:])
    outside = length > mu * moved[:, 0]
    normal = np.maximum((moved[:, 0] + mu * length) / (1.0 + mu**2), 0.0)[outside]
    moved[outside, 0] = normal
    moved[outside, 1:] *= (mu * normal / np.where(length > 0.0, length, 1.0)[outside])[:, None]
    return _norm(p - moved)


def _friction(law: FrictionLaw, normal: Array, p: Array, v: Array) -> Array:
    """Return the distances of P_T, v = ρξ_T from the law; ‖P_T‖ where P_N ≤ 0.

    Per unit of P_N two pairs obey the law near (x, v): the end of a prox step, x′ = z′/α(z′) with
    the rest of the step as velocity, whose larger part is counted, and x in C at rest. Beside cusps
    of C there may be a nearer one.
    """
    defects, closed = _norm(p), normal > 0.0
    force = normal[closed][:, None]
    x, v = -p[closed] / force, v[closed] / force
    gauge = law.reservoir.gauge(x)[:, None]
    inverse = 1.0 + law.direction.gauge(x)[:, None] - gauge  # 1/α
    end = law.direction.project((x + v) / inverse)
    # 1/α(z′) is k_C(z′) − k_D(z′) + 1, and k_C(z′) where the step ends on the boundary of D.
    depth = np.minimum(law.direction.gauge(end), 1.0)
    there = end / (law.reservoir.gauge(end) - depth + 1.0)[:, None]
    slip = np.maximum(_norm(x - there), _norm(end * inverse - x))
    if not law.reservoir.is_convex:
        slip = np.minimum(slip, _beside(law, x, v))
    rest = _norm(x - x / np.maximum(gauge, 1.0)) + _norm(v)
    defects[closed] = np.minimum(slip, rest) * normal[closed]
    return defects


def _beside(law: FrictionLaw, x: Array, v: Array) -> Array:
    """Return distances to slip where a step along the gradient of k_C crosses the boundary of C.

    They are infinite where it crosses none, or begins or ends at the origin, which has no gradient.
    """
    distances, rows = np.full(len(x), np.inf), np.flatnonzero(x.any(axis=1))
    excess, slope = law.reservoir.gauge(x[rows]) - 1.0, law.reservoir.gauge_gradient(x[rows])
    step = slope * (2.0 * excess / (slope**2).sum(axis=1))[:, None]
    near = x[rows] - step
    crosses = near.any(axis=1) & ((law.reservoir.gauge(near) - 1.0) * excess <= 0.0)
    rows, aside = rows[crosses], []
    for at in (x[rows], near[crosses]):
        normal = law.direction.gauge_gradient(at)
        normal /= _norm(normal)[:, None]
        along = np.maximum((v[rows] * normal).sum(axis=1), 0.0)[:, None]
        aside.append(_norm(v[rows] - along * normal))
    found = _norm(step[crosses]) + np.maximum(*aside)
    distances[rows] = np.where(np.isfinite(found), found, np.inf)
    return distances


def _norm(vectors: Array) -> Any:
    return np.linalg.norm(vectors, axis=-1)
