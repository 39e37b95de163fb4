"""Nested dissection: an elimination order that keeps sparse factors small."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import csr_array

# Groups of coordinates below which dissection no longer pays.
_LEAF = 40


def nested_dissection(matrix: Any) -> NDArray[np.intp]:
    """Return an order of the rows and columns of a matrix of symmetric pattern.

    Coordinates with the same neighbours, such as those of one node of a mesh, stay together. A
    part is cut at a level of the breadth-first search that starts from its far end: on meshes that
    is a plane across the longest direction. The levels of the cut come last (George 1973).
    """
    groups, graph = _grouped(matrix)
    sizes = np.bincount(groups)
    order = np.zeros(len(sizes), dtype=np.intp)
    end = len(order)
    parts = [np.arange(len(order))]
    # Numbers are given from the end, so that what is cut out first comes last.
    while parts:
        part = parts.pop()
        cut, rest = _cut(graph, part, sizes)
        order[end - len(cut) : end] = cut
        end -= len(cut)
        parts += rest
    rank = np.empty(len(order), dtype=np.intp)
    rank[order] = np.arange(len(order))
    return np.argsort(rank[groups], kind="stable")


def _grouped(matrix: Any) -> tuple[NDArray[np.intp], csr_array[Any]]:
    """Return the group of each coordinate and the graph of the groups."""
    from scipy.sparse import csr_array

    n = matrix.shape[0]
    pattern = csr_array((np.ones(matrix.nnz), matrix.indices, matrix.indptr), shape=(n, n))
    pattern = csr_array(pattern + pattern.T)
    pattern.data[:] = 1.0
    pattern.setdiag(1.0)
    # Equal sums of numbers without pattern mean equal neighbours.
    marks = np.floor(2.0**20 * np.modf(np.arange(1.0, n + 1.0) * np.sqrt(2.0))[0] + 1.0)
    keys = np.stack([pattern @ marks, pattern @ (marks * marks), np.diff(pattern.indptr)])
    _, groups = np.unique(keys, axis=1, return_inverse=True)
    groups = groups.ravel()
    # The pattern of one member is that of all.
    member = np.zeros(groups.max() + 1, dtype=np.intp)
    member[groups] = np.arange(n)
    gather = csr_array((np.ones(n), (np.arange(n), groups)), shape=(n, len(member)))
    graph = csr_array(pattern[member] @ gather)
    return groups, graph


def _cut(
    graph: csr_array[Any], part: NDArray[np.intp], sizes: NDArray[np.intp]
) -> tuple[NDArray[np.intp], list[NDArray[np.intp]]]:
    """Return the separator of a part and what it leaves; of small parts all."""
    if len(part) <= _LEAF:
        return part, []
    inside = graph[part][:, part]
    level = _levels(inside, np.array([0]))
    if (level < 0).any():
        return _components(inside, part)
    for _ in range(2):
        level = _levels(inside, np.flatnonzero(level == level.max()))
    weight = np.bincount(level, weights=sizes[part])
    if len(weight) < 3:
        return part, []
    below = np.cumsum(weight) - weight
    above = weight.sum() - below - weight
    # A small separator in the middle: halves may differ where the separator gains by it.
    cost = weight[1:-1] / np.minimum(np.minimum(below, above)[1:-1], 0.35 * weight.sum())
    middle = 1 + int(np.argmin(cost))
    return part[level == middle], [part[level < middle], part[level > middle]]


def _components(
    inside: csr_array[Any], part: NDArray[np.intp]
) -> tuple[NDArray[np.intp], list[NDArray[np.intp]]]:
    """Return the small components of a part one after another, and each of the large ones."""
    from scipy.sparse.csgraph import connected_components

    _, label = connected_components(inside, directed=False)
    order = np.argsort(label, kind="stable")
    members = np.bincount(label)
    is_small = (members <= _LEAF)[label[order]]
    large = np.split(part[order], np.cumsum(members)[:-1])
    return part[order[is_small]], [one for one in large if len(one) > _LEAF]


def _levels(graph: csr_array[Any], start: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the distance of each vertex from a set, −1 where there is no path."""
    level = np.full(graph.shape[0], -1, dtype=np.intp)
    level[start], front, depth = 0, start, 0
    while len(front):
        depth += 1
        reached = np.zeros(graph.shape[0])
        reached[front] = 1.0
        near = np.flatnonzero((graph @ reached > 0.0) & (level < 0))
        level[near], front = depth, near
    return level
