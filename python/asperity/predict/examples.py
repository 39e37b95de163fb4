"""Example scenarios, as ``asperity init`` writes them."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from asperity._base.storage.files import ResultFolder
from asperity._base.storage.toml import advice_on
from asperity.errors import ParameterError
from asperity.law import FrictionLaw, LawFile, Provenance
from asperity.predict.kinds import KINDS
from asperity.sets import Disk, Ellipse, Superellipse

FILES = ("scenario.toml", "law.toml")
"""What `write_example` writes."""
SQUEAL_FILES = ("squeal.toml", "law.toml", "bar_STIF1.mtx", "bar_MASS1.mtx", "bar.inp")
"""What it writes of a finite-element model that squeals."""

_SQUEAL = """\
# A finite-element model that slides steadily on a moving surface: asperity squeal squeal.toml
title = "a bar on a belt"
# File of the friction law. Its axes e1, e2 lie in the surface, e1 along [contacts] tangent.
law = "law.toml"

[model]
# Matrices of Abaqus (*MATRIX OUTPUT), Nastran (.op4), Ansys (.full), MATLAB (.mat) or Matrix
# Market (.mtx), in units that go together, such as m, kg, s, N. Of a file that holds several:
# mass_name = "MGG". Of CalculiX (*FREQUENCY, SOLVER=MATRIXSTORAGE) instead: calculix = "JOB".
# Contact pairs and friction stay out of the model.
stiffness = "bar_STIF1.mtx"
mass = "bar_MASS1.mtx"
# Input with nodes and sets of nodes. Where the files name no nodes, and rows are x, y, z of one
# node after the other, first_node = 1 numbers them.
deck = "bar.inp"

[damping]
# C = mass * M + stiffness * K, in 1/s and s, beside that of [model] damping, if there is one.
stiffness = 1e-8

[contacts]
# Name of a set, or numbers of nodes; normal from the surface into the body.
nodes = "CONTACT"
normal = [0.0, 0.0, 1.0]
tangent = [1.0, 0.0, 0.0]

[surface]
# Velocity in m/s; of a disc that turns instead: rate = [0.0, 0.0, 60.0] in rad/s, centre, and
# circles = true if the marks of grinding are circles.
velocity = [5.0, 0.0, 0.0]

# Forces in N, spread evenly over the nodes of a set.
[[loads]]
nodes = "ALL"
force = [0.0, 0.0, -3000.0]

[squeal]
# In Hz. certify counts whether a mode is missing and takes several times as long.
band = [0.0, 15000.0]
certify = true

[parameters]
# Factors of the friction force, and angles by which the motion of the surface is turned.
friction = [0.5, 1.0]
direction_deg = [0.0]
"""


def write_example(kind: str, folder: str | os.PathLike[str]) -> tuple[Path, ...]:
    """Write an example of a scenario with a law beside it; files that are there are kept.

    Args:
        kind: name of the kind, such as ``"sliding point"``, or ``"squeal"``.
        folder: made if it is not there.

    Returns:
        The files.

    Raises:
        ParameterError: if the kind is not known, or one of the files is there already.
    """
    known = (*KINDS, "squeal")
    if kind not in known:
        raise ParameterError("kind", f"{kind!r} is not known{advice_on(kind, known)}")
    place, names = Path(folder), SQUEAL_FILES if kind == "squeal" else FILES
    for name in names:
        if (place / name).exists():
            raise ParameterError("out", f"holds a file {name} already: name another folder")
    law = FrictionLaw(Superellipse(4.99 / 9.3, 4.25 / 9.3, 2.94), Superellipse(1.84, 1.19, 2.51))
    note = "PVC on ground steel, Table 1 of Walker and Leine (2019)"
    if kind == "squeal":
        law, note = FrictionLaw(Ellipse(0.6, 0.4, angle=0.5), Disk(1.0)), "made up"
    texts = _bar() if kind == "squeal" else {"scenario.toml": KINDS[kind].example}
    with ResultFolder(place, names).filled() as fresh:
        for name, text in texts.items():
            (fresh / name).write_text(text, encoding="utf-8", newline="\n")
        LawFile(law, provenance=Provenance(made_by="asperity init", note=note)).save(
            fresh / "law.toml"
        )
    return tuple(place / name for name in names)


def _bar() -> dict[str, str]:
    """Return a bar of 60 nodes on oblique springs as texts of Abaqus."""
    n, oblique = 60, np.array([1.0, 0.0, 0.7])
    foot = 2e6 * np.outer(oblique, oblique) + 1e5 * np.eye(3)
    own, next_one = foot + 2.0 * np.diag([4e7, 4e7, 9e7]), [-4e7, -4e7, -9e7]
    K, M, nodes = [], [], []
    for node in range(1, n + 1):
        nodes.append(f"{node}, {0.002 * (node - 1):.6g}, 0.0, 0.0")
        for i in range(3):
            M.append(f"{node},{i + 1}, {node},{i + 1}, 2.0e-3")
            K += [f"{node},{i + 1}, {node},{j + 1}, {own[i, j]:.16e}" for j in range(i + 1)]
            if node < n:
                K.append(f"{node + 1},{i + 1}, {node},{i + 1}, {next_one[i]:.16e}")
    sets = "*NSET, NSET=CONTACT, GENERATE\n11, 50\n"
    return {
        "squeal.toml": _SQUEAL,
        "bar_STIF1.mtx": "\n".join(K) + "\n",
        "bar_MASS1.mtx": "\n".join(M) + "\n",
        "bar.inp": "*NODE, NSET=ALL\n" + "\n".join(nodes) + f"\n{sets}",
    }
