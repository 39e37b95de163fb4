"""Messages of points that failed, as lines of JSON beside the arrays."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

Line = dict[str, Any]
"""Of one point: its ``index``, its ``point`` by name, ``error``, ``message``, ``traceback``."""


class Failures:
    """The file, or a list where there is none; lines are added before the chunk is committed.

    Args:
        path: of the file, if there is one.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path = path
        self._lines: list[Line] = []

    def add(self, lines: Iterable[Line]) -> None:
        """Add lines at the end."""
        if self._path is None:
            self._lines.extend(lines)
            return
        text = "".join(f"{json.dumps(line)}\n" for line in lines)
        if text:
            with self._path.open("ab") as file:
                # What a process that was killed has not finished is a line of its own.
                file.write(f"\n{text}".encode())

    def __iter__(self) -> Iterator[Line]:
        if self._path is None:
            yield from self._lines
        elif self._path.exists():
            with self._path.open(encoding="utf-8", errors="replace") as file:
                for text in file:
                    line = _parsed(text)
                    if line is not None:
                        yield line


def _parsed(text: str) -> Line | None:
    try:
        line = json.loads(text)
    except ValueError:
        return None
    return line if isinstance(line, dict) and {"index", "message", "error"} <= line.keys() else None
