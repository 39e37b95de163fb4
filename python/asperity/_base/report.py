"""Reports: one HTML file with everything in it, from one template."""

from __future__ import annotations

import base64
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, TypeAlias

from asperity._base.storage.files import atomic
from asperity.errors import ParameterError


@dataclass(frozen=True)
class Text:
    """A ``"paragraph"``; a ``"warning"``, to be kept in mind with all of the report; ``"code"``."""

    text: str
    kind: str = "paragraph"


@dataclass(frozen=True)
class Facts:
    """Names and what there is to say of them."""

    kind: ClassVar[str] = "facts"
    rows: Sequence[tuple[str, str]]


@dataclass(frozen=True)
class Grid:
    """A table of texts; a short row's last cell goes on to the end, one row may be marked."""

    kind: ClassVar[str] = "grid"
    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    marked: int | None = None


@dataclass(frozen=True)
class Picture:
    """A picture as the bytes of a PNG file."""

    kind: ClassVar[str] = "picture"
    name: str
    png: bytes

    @property
    def base64(self) -> str:
        """The bytes as text."""
        return base64.b64encode(self.png).decode()


Block: TypeAlias = Text | Facts | Grid | Picture


class Section:
    """Blocks under a heading; an empty heading is left out."""

    def __init__(self, heading: str, *blocks: Block) -> None:
        self.heading = heading
        self.blocks = blocks


def write_report(path: str | os.PathLike[str], title: str, sections: Sequence[Section]) -> Path:
    """Write a report, which needs no other file and no network; it is complete or not there.

    Raises:
        ParameterError: if the path has the ending of another format.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    if Path(path).suffix.lower() not in (".html", ".htm"):
        raise ParameterError("path", f"must end in .html or .htm, got {os.fspath(path)!r}")
    environment = Environment(
        loader=PackageLoader("asperity._base"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    text = environment.get_template("report.html").render(title=title, sections=sections)
    with atomic(path) as file:
        file.write(text.encode())
    return Path(path)
