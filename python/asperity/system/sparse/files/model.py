"""Matrices of a finite-element model, and what is found in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import Result, counted
from asperity._base.value import keep_views
from asperity.errors import ParameterError

if TYPE_CHECKING:
    from asperity.system.sparse.matrices import SparseMatrix


@dataclass(frozen=True, eq=False, repr=False)
class FiniteElementModel(Result):
    """M, K and perhaps C of a model, with the node and the direction of each coordinate.

    Attributes:
        mass: M, shape ``(n, n)``.
        stiffness: K, shape ``(n, n)``.
        nodes: number of the node of each coordinate, shape ``(n,)``; 0 where it is not known.
        directions: 0, 1, 2 for x, y, z, shape ``(n,)``; more for nodes of other kinds.
        places: positions of the nodes of the input by number, in its unit of length.
        node_sets: numbers of nodes by name, in capitals.
        findings: what the files lack, or hold beside the nodes of the input.
        damping: C, shape ``(n, n)``; None without its file.
    """

    mass: SparseMatrix
    stiffness: SparseMatrix
    nodes: NDArray[np.intp]
    directions: NDArray[np.intp]
    places: Mapping[int, tuple[float, float, float]]
    node_sets: Mapping[str, tuple[int, ...]]
    findings: tuple[str, ...]
    damping: SparseMatrix | None = None

    def __post_init__(self) -> None:
        keep_views(self)

    def coordinates(self, nodes: str | ArrayLike) -> NDArray[np.intp]:
        """Return numbers of coordinates x, y, z of nodes, shape ``(m, 3)``, for `MeshContacts`.

        Args:
            nodes: name of a set, or numbers of nodes.

        Raises:
            ParameterError: if a node has no three coordinates, as one that is held.
        """
        numbers = self._numbers(nodes)
        known = {
            (int(node), int(direction)): i
            for i, (node, direction) in enumerate(zip(self.nodes, self.directions, strict=True))
        }
        found = np.array(
            [[known.get((int(i), k), -1) for k in range(3)] for i in numbers], dtype=np.intp
        ).reshape(-1, 3)
        if (found < 0).any():
            node, k = (int(part) for part in np.argwhere(found < 0)[0])
            raise ParameterError(
                "nodes",
                f"must have three coordinates: node {numbers[node]} lacks {'xyz'[k]}, which is "
                "held, dependent, or not of this model",
            )
        return found

    def positions(self, nodes: str | ArrayLike) -> Array:
        """Return where nodes are, shape ``(m, 3)``.

        Args:
            nodes: name of a set, or numbers of nodes.
        """
        numbers = self._numbers(nodes)
        lost = [int(i) for i in numbers if int(i) not in self.places]
        if lost:
            raise ParameterError("nodes", f"must be nodes of the input, {lost[0]} is none")
        return np.array([self.places[int(i)] for i in numbers]).reshape(-1, 3)

    def _numbers(self, nodes: str | ArrayLike) -> NDArray[np.intp]:
        if isinstance(nodes, str):
            name = nodes.upper()
            if name not in self.node_sets:
                known = ", ".join(self.node_sets) or "there are none"
                raise ParameterError("nodes", f"must be a set of the input ({known}), got {nodes}")
            return np.array(self.node_sets[name], dtype=np.intp)
        numbers = arrays.array(nodes, "nodes", (None,))
        if (numbers != np.floor(numbers)).any():
            raise ParameterError("nodes", "must be whole numbers")
        return numbers.astype(np.intp)

    def __repr__(self) -> str:
        n = counted(len(self.nodes), "coordinate")
        return f"<FiniteElementModel: {n}, {counted(len(self.places), 'node')}>"

    def summary(self) -> str:
        """Return the size of the model and the findings."""
        n = counted(len(self.nodes), "coordinate")
        first = f"The model has {n}; the input has {counted(len(self.places), 'node')}."
        return "\n".join([first, *self.findings])


def beside(nodes: NDArray[np.intp], places: Mapping[int, object]) -> list[str]:
    """Return coordinates without nodes of the input, and nodes without coordinates."""
    if not places:
        return []
    inside = np.array(list(places), dtype=np.intp)
    hidden = np.setdiff1d(nodes, inside)
    held = np.setdiff1d(inside, nodes)
    findings = []
    if len(hidden):
        findings.append(
            f"{counted(len(hidden), 'node')} of the files, from {hidden[0]} on, "
            f"{'is' if len(hidden) == 1 else 'are'} not in the input: those of incompatible modes "
            "(C3D8I), expanded shells or rigid bodies."
        )
    if len(held):
        findings.append(
            f"{counted(len(held), 'node')} of the input {'has' if len(held) == 1 else 'have'} no "
            "coordinate in the files: held, tied or dependent."
        )
    return findings


def of_matrices(
    M: SparseMatrix, K: SparseMatrix, dof: NDArray[np.intp], places: Mapping[int, object]
) -> list[str]:
    """Return coordinates without stiffness and the mass of rigid translations."""
    findings = []
    for name, one in (("K", K), ("M", M)):
        rows: Array = np.asarray(abs(one).sum(axis=1)).ravel()
        empty = np.flatnonzero(rows == 0.0)
        if len(empty):
            verb = "vanishes" if len(empty) == 1 else "vanish"
            findings.append(
                f"{counted(len(empty), 'row')} of {name} {verb}, such as that of node "
                f"{dof[empty[0], 0]} in direction {dof[empty[0], 1]}."
            )
    own = np.isin(dof[:, 0], np.array(list(places), dtype=np.intp)) if places else rows >= 0.0
    moved = [(own & (dof[:, 1] == k)).astype(float) for k in (1, 2, 3)]
    masses = np.array([r @ (M @ r) for r in moved])
    listed = ", ".join(f"{mass:.6g}" for mass in masses)
    findings.append(f"The mass of its translations along x, y, z is {listed}.")
    if places and own.sum() < 3 * len(places):
        findings[-1] = findings[-1][:-1] + ", without coordinates that are held or dependent."
    return findings
