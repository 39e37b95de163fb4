"""Example scenarios, as ``asperity init`` writes them."""

from __future__ import annotations

import os
from pathlib import Path

from asperity._base.storage.files import ResultFolder
from asperity._base.storage.toml import advice_on
from asperity.errors import ParameterError
from asperity.law import FrictionLaw, LawFile, Provenance
from asperity.predict.kinds import KINDS
from asperity.sets import Superellipse

FILES = ("scenario.toml", "law.toml")
"""What `write_example` writes."""


def write_example(kind: str, folder: str | os.PathLike[str]) -> tuple[Path, ...]:
    """Write an example of a scenario with a law beside it; files that are there are kept.

    Args:
        kind: name of the kind, such as ``"sliding point"``.
        folder: made if it is not there.

    Returns:
        The files.

    Raises:
        ParameterError: if the kind is not known, or one of the files is there already.
    """
    if kind not in KINDS:
        raise ParameterError("kind", f"{kind!r} is not known{advice_on(kind, KINDS)}")
    place = Path(folder)
    for name in FILES:
        if (place / name).exists():
            raise ParameterError("out", f"holds a file {name} already: name another folder")
    law = FrictionLaw(Superellipse(4.99 / 9.3, 4.25 / 9.3, 2.94), Superellipse(1.84, 1.19, 2.51))
    note = "PVC on ground steel, Table 1 of Walker and Leine (2019)"
    with ResultFolder(place, FILES).filled() as fresh:
        (fresh / "scenario.toml").write_text(KINDS[kind].example, encoding="utf-8", newline="\n")
        LawFile(law, provenance=Provenance(made_by="asperity init", note=note)).save(
            fresh / "law.toml"
        )
    return tuple(place / name for name in FILES)
