"""Runs that cannot be used: no complete turn, no contact."""

from __future__ import annotations

from collections.abc import Sequence

from asperity._base.arrays import Array
from asperity.errors import RecordError
from asperity.identify.records.record import RawData


def refuse_incomplete(raw: RawData, found: Sequence[int]) -> None:
    """Refuse files without a complete turn; `found` are the complete turns of each recording.

    Pieces of a file that was cut at its defects count together.
    """
    turns = dict(zip(map(id, raw.recordings), found, strict=True))
    for run in raw.recordings:
        # A recording without a name is a file of its own.
        pieces = [one for one in raw.recordings if run.source and one.file == run.file] or [run]
        if not any(turns[id(piece)] for piece in pieces):
            covered = max(abs(piece.turns) for piece in pieces)
            raise RecordError(
                run.file,
                f"angle: covers {covered:.3g} turns, at least one complete turn is needed",
            )


def refuse_lost_contact(raw: RawData, starts: tuple[int, ...], normal: Array) -> None:
    """Refuse runs with a normal force that is not positive."""
    for run, start, stop in zip(raw.recordings, starts, starts[1:], strict=False):
        lowest = int(normal[start:stop].argmin())
        if normal[start + lowest] <= 0.0:
            raise RecordError(
                run.source,
                f"normal channel: no pressure at row {lowest + 1} "
                f"({normal[start + lowest]:.4g} N); compression must be positive",
            )
