"""Mass and stiffness of a model of CalculiX, as it stores them itself."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from asperity.errors import ParameterError
from asperity.system.sparse.files.entries import TO_PYTHON, symmetric, table, text_of, whole_lines
from asperity.system.sparse.files.model import FiniteElementModel, beside, of_matrices

if TYPE_CHECKING:
    from asperity.system.sparse.matrices import SparseMatrix

# Above every number of a node.
_LARGEST = 2**53


def read_calculix(
    path: str | os.PathLike[str], *, deck: str | os.PathLike[str] | None = None
) -> FiniteElementModel:
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
    numbers = table(whole_lines(f"{job}.dof").replace(".", " ").splitlines(), name, 2)
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
    places, sets, cards = read_deck("" if deck is None else text_of(deck))
    findings = [
        *_lost(cards),
        *beside(dof[:, 0], places),
        *of_matrices(M, K, dof, places),
    ]
    return FiniteElementModel(M, K, dof[:, 0], dof[:, 1] - 1, places, sets, tuple(findings))


def _matrices(job: Path, n: int) -> tuple[SparseMatrix, SparseMatrix]:
    """Return K and M, of which CalculiX writes the same places, with the whole diagonal."""
    files = Path(f"{job}.sti"), Path(f"{job}.mas")
    K, M = (table(whole_lines(file).splitlines(), file.name, 3) for file in files)
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


def read_deck(
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
