"""In which line of a TOML text each key stands, which Python's reader does not tell."""

from __future__ import annotations

import re
import tomllib
from contextlib import suppress
from typing import NamedTuple

_TOKEN = re.compile(
    r'''(?P<space>[ \t\r]+|\#[^\n]*)|(?P<newline>\n)
    |(?P<text>"""(?:\\.|[^\\])*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\')
    |(?P<word>[^\s\#"\'=.,\[\]{}]+)|(?P<mark>.)''',
    re.VERBOSE | re.DOTALL,
)
_END = ""


class _Token(NamedTuple):
    kind: str
    text: str
    line: int


class KeyLines:
    r"""Lines of keys and of entries of lists, such as ``law.reservoir.sets[1].radius``, from 1.

    A text that is not TOML is read as far as possible.

    Attributes:
        count: number of lines.

    >>> from asperity._base.storage.key_lines import KeyLines
    >>> lines = KeyLines('x = [1,\n2]\n[[law.sets]]\nset = {radius = 1.0}\n')
    >>> lines.of("x[1]"), lines.of("law.sets[0].set.radius"), lines.of("law.direction")
    (2, 4, 3)
    """

    def __init__(self, text: str) -> None:
        self.count = text.count("\n") + 1
        self._tokens = _tokens(text)
        self._next = 0
        self._first: dict[str, int] = {}
        self._begun: list[tuple[int, str]] = []
        # How many tables ``[[key]]`` there have been.
        self._tables: dict[str, int] = {}
        # Lists that are nested so deeply are not TOML that Python reads.
        with suppress(RecursionError):
            self._read()

    def of(self, key: str) -> int | None:
        """Return the line of a key, else that of what it is in, else None."""
        while key:
            if key in self._first:
                return self._first[key]
            key = key[: max(key.rfind("."), key.rfind("["), 0)]
        return None

    def begun(self, line: int | None) -> str:
        """Return the last key that begins in this line or above it, or an empty text.

        Bytes that cannot be printed are not a key, but those of a file of another kind.
        """
        known = [
            key for at, key in self._begun if line is not None and at <= line and key.isprintable()
        ]
        return known[-1] if known else ""

    def _read(self) -> None:
        section = ""
        while (token := self._skip("newline")).kind:
            if token.text == "[":
                section = self._header()
            else:
                self._pair(section)
            # The rest of a line that is not TOML.
            while self._peek().kind not in (_END, "newline"):
                self._next += 1

    def _header(self) -> str:
        """Read ``[key]`` or ``[[key]]``; return the key with the number of the table."""
        line = self._peek().line
        self._next += 1
        several = self._peek().text == "["
        if several:
            self._next += 1
        path, names = "", self._names("]")
        for i, name in enumerate(names):
            path = f"{path}.{name}" if path else name
            if several and i == len(names) - 1:
                self._tables[path] = self._tables.get(path, 0) + 1
            self._note(path, line)
            if path in self._tables:
                path = f"{path}[{self._tables[path] - 1}]"
                self._note(path, line)
        if path:
            self._begun.append((line, path))
        return path

    def _pair(self, section: str) -> None:
        """Read ``key = value``."""
        line, path = self._peek().line, section
        for name in self._names("="):
            path = f"{path}.{name}" if path else name
            self._note(path, line)
        self._begun.append((line, path))
        self._value(path)

    def _names(self, end: str) -> list[str]:
        """Read the parts of a dotted key and the mark behind it."""
        names = []
        while (token := self._peek()).kind not in (_END, "newline"):
            self._next += 1
            if token.text == end:
                break
            if token.kind in ("word", "text"):
                names.append(_unquoted(token))
        return names

    def _value(self, path: str) -> None:
        token = self._peek()
        if token.text == "[":
            self._next += 1
            i = 0
            while (token := self._skip("newline")).kind and token.text != "]":
                self._note(f"{path}[{i}]", token.line)
                before = self._next
                self._value(f"{path}[{i}]")
                if self._skip("newline").text == ",":
                    self._next += 1
                    i += 1
                elif self._next == before:
                    return
            self._next += 1
        elif token.text == "{":
            self._next += 1
            while (token := self._skip("newline")).kind and token.text != "}":
                before = self._next
                self._pair(path)
                if self._skip("newline").text == ",":
                    self._next += 1
                if self._next == before:
                    return
            self._next += 1
        else:
            # A date may have a blank in it, a number a dot.
            while (token := self._peek()).kind not in (_END, "newline") and token.text not in ",]}":
                self._next += 1

    def _note(self, path: str, line: int) -> None:
        self._first.setdefault(path, line)

    def _peek(self) -> _Token:
        return self._tokens[self._next] if self._next < len(self._tokens) else _Token(_END, "", 0)

    def _skip(self, kind: str) -> _Token:
        while self._peek().kind == kind:
            self._next += 1
        return self._peek()


def _tokens(text: str) -> list[_Token]:
    tokens, line = [], 1
    for match in _TOKEN.finditer(text):
        kind = match.lastgroup or ""
        if kind != "space":
            tokens.append(_Token(kind, match[0], line))
        line += match[0].count("\n")
    return tokens


def _unquoted(token: _Token) -> str:
    if token.kind == "text":
        with suppress(ValueError):
            return str(tomllib.loads(f"key = {token.text}")["key"])
    return token.text
