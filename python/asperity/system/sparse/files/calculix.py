"""Mass and stiffness of a model of CalculiX, as it stores them itself."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.result import Result, counted
from asperity._base.value import keep_views
from asperity.errors import ParameterError
from asperity.system.sparse.files.entries import TO_PYTHON, symmetric, table, text_of

if TYPE_CHECKING:
    from asperity.system.sparse.matrices import SparseMatrix

# Above every number of a node.
_LARGEST = 2**53


@dataclass(frozen=True, eq=False, repr=False)
class CalculixModel(Result):
    """M and K of a model, with the node and the direction of each coordinate.

    Attributes:
        mass: M, shape ``(n, n)``.
        stiffness: K, shape ``(n, n)``.
        nodes: number of the node of each coordinate, shape ``(n,)``.
        directions: 0, 1, 2 for x, y, z, shape ``(n,)``; more for nodes of other kinds.
        places: positions of the nodes of the input by number, in its unit of length.
        node_sets: numbers of nodes by name, in capitals.
        findings: what these files cannot hold, or hold beside the nodes of the input.
    """

    mass: SparseMatrix
    stiffness: SparseMatrix
    nodes: NDArray[np.intp]
    directions: NDArray[np.intp]
    places: Mapping[int, tuple[float, float, float]]
    node_sets: Mapping[str, tuple[int, ...]]
    findings: tuple[str, ...]

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
        return f"<CalculixModel: {n}, {counted(len(self.places), 'node')}>"

    def summary(self) -> str:
        """Return the size of the model and the findings."""
        n = counted(len(self.nodes), "coordinate")
        first = f"The model has {n}; the input has {counted(len(self.places), 'node')}."
        return "\n".join([first, *self.findings])


def read_calculix(
    path: str | os.PathLike[str], *, deck: str | os.PathLike[str] | None = None
) -> CalculixModel:
    """Read what ``*FREQUENCY, SOLVER=MATRIXSTORAGE`` of CalculiX has written.

    The files hold one triangle of symmetric matrices, whatever the model: friction of a contact
    pair is lost in them, and so are dashpots and damping. Keep contact pairs out of the model and
    give the contact nodes to `MeshContacts`.

    Args:
        path: of the job, JOB or JOB.sti, beside which JOB.mas and JOB.dof are.
        deck: the input; default JOB.inp, if there is one. Files that it includes are not read.

    Returns:
        M, K, names of the coordinates and findings.

    Raises:
        ParameterError: if a file is missing, no such file, or the files are of different jobs.

    Warns:
        UserWarning: if the input has friction in a contact pair, which the files have lost.
    """
    job = Path(os.fspath(path))
    job = job.with_suffix("") if job.suffix in (".sti", ".mas", ".dof") else job
    name = f"{job.name}.dof"
    numbers = table(text_of(f"{job}.dof").replace(".", " ").splitlines(), name, 2)
    if not ((numbers >= 0) & (numbers == np.floor(numbers)) & (numbers < _LARGEST)).all():
        raise ParameterError("path", f"{name} must hold numbers of nodes and directions")
    dof = numbers.astype(np.intp)
    n = len(dof)
    if not n:
        raise ParameterError("path", f"{job.name}.dof holds no coordinates")
    if len(np.unique(dof, axis=0)) < n:
        raise ParameterError("path", f"{job.name}.dof names a coordinate twice")
    K, M = _matrices(job, n)
    if deck is None and Path(f"{job}.inp").exists():
        deck = f"{job}.inp"
    places, sets, cards = _deck("" if deck is None else text_of(deck))
    findings = [
        *_lost(cards),
        *_beside(dof[:, 0], places),
        *_of_matrices(M, K, dof, places),
    ]
    return CalculixModel(M, K, dof[:, 0], dof[:, 1] - 1, places, sets, tuple(findings))


def _matrices(job: Path, n: int) -> tuple[SparseMatrix, SparseMatrix]:
    """Return K and M, of which CalculiX writes the same places, with the whole diagonal."""
    files = Path(f"{job}.sti"), Path(f"{job}.mas")
    K, M = (table(text_of(file).splitlines(), file.name, 3) for file in files)
    made = symmetric(K, n, files[0].name), symmetric(M, n, files[1].name)
    if not np.array_equal(K[:, :2], M[:, :2]):
        raise ParameterError(
            "path",
            f"{files[0].name} and {files[1].name} must hold the same places: one is cut off, or "
            "they are of different jobs",
        )
    lacking = np.setdiff1d(np.arange(1, n + 1), K[K[:, 0] == K[:, 1], 0])
    if len(lacking):
        raise ParameterError(
            "path",
            f"{files[0].name} lacks the diagonal of coordinate {lacking[0]} and is cut off, or of "
            "another job",
        )
    return made


def _deck(
    text: str,
) -> tuple[dict[int, tuple[float, float, float]], dict[str, tuple[int, ...]], list[str]]:
    """Return nodes, sets of nodes and the names of all cards of an input."""
    places: dict[int, tuple[float, float, float]] = {}
    sets: dict[str, tuple[int, ...]] = {}
    cards: list[str] = []
    options: dict[str, str] = {}
    for line in text.splitlines():
        if line.startswith("**") or not line.strip():
            continue
        if line.startswith("*"):
            card, *rest = (part.strip().upper() for part in line[1:].split(","))
            cards.append(re.sub(r"\s+", " ", card))
            pairs = (part.partition("=") for part in rest)
            options = {key.strip(): value.strip() for key, _, value in pairs}
            continue
        words = [word.strip() for word in line.split(",") if word.strip()]
        members: Sequence[int] = ()
        try:
            if cards[-1:] == ["NODE"]:
                members = [int(words[0])]
                x, y, z = ([float(word.translate(TO_PYTHON)) for word in words[1:4]] + [0.0] * 3)[
                    :3
                ]
                places[members[0]] = x, y, z
            elif cards[-1:] == ["NSET"]:
                members = _members(words, sets, generate="GENERATE" in options)
        except (ValueError, IndexError):
            raise ParameterError(
                "deck", f"has a line after *{cards[-1]} that is none of it: {line.strip()}"
            ) from None
        except KeyError as name:
            # An included file may define it.
            if "INCLUDE" not in cards:
                raise ParameterError("deck", f"has no set {name}, which a set names") from None
        if members and "NSET" in options:
            # As of CalculiX, whose sets name a node once.
            known = dict.fromkeys(sets.get(options["NSET"], ()))
            sets[options["NSET"]] = tuple({**known, **dict.fromkeys(members)})
    return places, sets, cards


def _members(
    words: Sequence[str], sets: Mapping[str, tuple[int, ...]], *, generate: bool
) -> list[int]:
    if generate:
        first, last, step = [int(word) for word in (*words, "1")[:3]]
        return list(range(first, last + 1, step))
    found: list[int] = []
    for word in words:
        found += [int(word)] if word.lstrip("+-")[:1].isdigit() else sets[word.upper()]
    return found


def _lost(cards: Sequence[str]) -> list[str]:
    """Return what the input has and the files cannot hold."""
    findings = []
    if "FRICTION" in cards and "CONTACT PAIR" in cards:
        findings.append(
            "The input has friction in a contact pair: K of a slipping contact is not symmetric, "
            "and the files hold one triangle, so that its friction is lost."
        )
        warnings.warn(findings[0], stacklevel=3)
    if {"DASHPOT", "DAMPING", "MODAL DAMPING"} & set(cards):
        findings.append("The input has dampers or damping, which the files do not hold.")
    if "INCLUDE" in cards:
        findings.append("The input includes other files, which were not read.")
    return findings


def _beside(nodes: NDArray[np.intp], places: Mapping[int, object]) -> list[str]:
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


def _of_matrices(
    M: SparseMatrix, K: SparseMatrix, dof: NDArray[np.intp], places: Mapping[int, object]
) -> list[str]:
    """Return coordinates without stiffness and the mass of rigid translations."""
    findings = []
    rows: Array = np.asarray(abs(K).sum(axis=1)).ravel()
    empty = np.flatnonzero(rows == 0.0)
    if len(empty):
        findings.append(f"{counted(len(empty), 'row')} of K vanish, such as {empty[0]}.")
    own = np.isin(dof[:, 0], np.array(list(places), dtype=np.intp)) if places else rows >= 0.0
    moved = [(own & (dof[:, 1] == k)).astype(float) for k in (1, 2, 3)]
    masses = np.array([r @ (M @ r) for r in moved])
    listed = ", ".join(f"{mass:.6g}" for mass in masses)
    findings.append(f"The mass of its translations along x, y, z is {listed}.")
    if places and own.sum() < 3 * len(places):
        findings[-1] = findings[-1][:-1] + ", without coordinates that are held or dependent."
    return findings
