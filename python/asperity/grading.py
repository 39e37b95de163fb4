"""The natural map of a contact problem in NumPy, a second opinion on what the core reports."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from asperity._arrays import Array
from asperity.contact import ContactProblem
from asperity.contact.arguments import sizes
from asperity.law import FrictionLaw
from asperity.sets import Ball, Disk


def natural_map(problem: ContactProblem, percussion: Array) -> float:
    """Return ‖P − proj(P − ρξ)‖/max(‖P‖, ρ‖b + e∘γ_B‖), ρ = rows/tr G.

    Unilateral contacts with disks or balls are projected onto their cones, with μ‖ξ_T‖ added to
    ξ_N. Others have the defects P_N − max(0, P_N − ρξ_N) and z − prox_{P_N D}(z + ρξ_T), z = −αP.

    Args:
        problem: with any laws.
        percussion: in N s, shape ``(rows,)``.

    Reference: [AcaryBremondHuber2018]; [WL19] (12), (69).

    >>> from asperity import ContactProblem, FrictionLaw
    >>> problem = ContactProblem(np.eye(3), [-1.0, 3.0, 4.0], FrictionLaw.isotropic(0.5))
    >>> natural_map(problem, np.array([1.0, -0.3, -0.4])) < 1e-12
    True
    """
    free = problem.free_velocity + _restitution(problem)
    rho = free.size / problem.delassus.diagonal().sum()
    # A solver may have ended anywhere.
    if not np.isfinite(percussion).all():
        return math.inf
    xi = problem.delassus @ percussion + free
    squares = 0.0
    for law, unilateral, rows, normal in _groups(problem):
        p, v = percussion[rows], rho * xi[rows]
        if not unilateral:
            squares += _tangential(law, normal, p, v)
            continue
        if isinstance(law.reservoir, Ball | Disk) and law.reservoir == law.direction:
            squares += _cone(float(law.reservoir.support(np.eye(law.dimension)[0])), p, v)
            continue
        squares += float(((p[:, 0] - np.maximum(0.0, p[:, 0] - v[:, 0])) ** 2).sum())
        squares += _tangential(law, p[:, 0], p[:, 1:], v[:, 1:])
    scale = max(_norm(percussion), float(rho) * _norm(free), float(np.finfo(float).tiny))
    return math.sqrt(squares) / scale


def _restitution(problem: ContactProblem) -> Array:
    """Return e∘γ_B."""
    each = sizes(problem.laws, problem.normal_force)
    factor = np.repeat(problem.tangential_restitution, each)
    first = np.cumsum(each) - each
    closed = np.array([force is None for force in problem.normal_force])
    factor[first[closed]] = problem.normal_restitution[closed]
    restitution: Array = factor * problem.initial_velocity
    return restitution


def _groups(
    problem: ContactProblem,
) -> list[tuple[FrictionLaw, bool, NDArray[np.int64], Array]]:
    """Return contacts of one law and kind together: law, kind, their rows, prescribed forces."""
    each = np.array(sizes(problem.laws, problem.normal_force))
    first = np.cumsum(each) - each
    members: dict[tuple[int, bool], list[int]] = {}
    for i, (law, force) in enumerate(zip(problem.laws, problem.normal_force, strict=True)):
        members.setdefault((id(law), force is None), []).append(i)
    groups = []
    for (_, unilateral), contacts in members.items():
        rows = first[contacts][:, None] + np.arange(each[contacts[0]])
        forces = [problem.normal_force[i] or 0.0 for i in contacts]
        groups.append((problem.laws[contacts[0]], unilateral, rows, np.array(forces)))
    return groups


def _cone(mu: float, p: Array, v: Array) -> float:
    """Return the squared defect of P = proj_K(P − ρξ̃), ξ̃_N = ξ_N + μ‖ξ_T‖, K the friction cone."""
    moved = p - v
    moved[:, 0] -= mu * np.sqrt((v[:, 1:] ** 2).sum(axis=1))
    normal, tangent = moved[:, 0], moved[:, 1:]
    length = np.sqrt((tangent**2).sum(axis=1))
    on_edge = np.maximum((normal + mu * length) / (1.0 + mu**2), 0.0)
    scale = mu * on_edge / np.where(length > 0.0, length, 1.0)
    edge = np.column_stack([on_edge, scale[:, None] * tangent])
    nearest = np.where((length <= mu * normal)[:, None], moved, edge)
    return float(((p - nearest) ** 2).sum())


def _tangential(law: FrictionLaw, normal: Array, p: Array, v: Array) -> float:
    """Return the squared defect of z = prox_{P_N D}(z + ρξ_T); all of P where P_N ≤ 0."""
    closed = normal > 0.0
    open_defect = float((p[~closed] ** 2).sum())
    force = normal[closed][:, None]
    x = -p[closed] / force
    alpha = 1.0 / (law.direction.gauge(x) - law.reservoir.gauge(x) + 1.0)
    z = alpha[:, None] * x
    off = (z - law.direction.project(z + v[closed] / force)) * force
    return open_defect + float((off**2).sum())


def _norm(values: Array) -> float:
    return float(np.sqrt((values**2).sum()))
