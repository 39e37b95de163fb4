"""The table of the comparison: a line per problem, a summary, a file."""

import csv
from pathlib import Path

import numpy as np
from engines import Answer, solved

Row = tuple[str, int, dict[str, Answer]]
COLUMNS = ["problem", "contacts", "engine", "solver", "best_s", "median_s", "nat_scaled", "solved"]


def head(engines: list[str]) -> str:
    """Return the names of the columns; a residual above the tolerance is marked by "!"."""
    last = "  asperity/siconos" if {"asperity", "siconos"} <= set(engines) else ""
    return f"{'problem':40} {'contacts':>8} " + "".join(f"{name:>39}" for name in engines) + last


def line(row: Row, tolerance: float) -> str:
    """Return a line of the table: time, residual and solver per engine, and the ratio."""
    name, contacts, answers = row
    parts = []
    for one in answers.values():
        if np.isfinite(one.residual):
            mark = " " if solved(one, tolerance) else "!"
            parts.append(f"{duration(one.best):>11} {one.residual:8.1e}{mark}{one.label[:17]:>18}")
        else:
            parts.append(f"{one.label[:38]:>39}")
    ratio = quotient(answers, tolerance)
    last = f"{ratio:18.3f}" if np.isfinite(ratio) else ""
    return f"{name[:40]:40} {contacts:8d} " + "".join(parts) + last


def duration(seconds: float) -> str:
    """Return a time in readable units."""
    unit, size = next((u, s) for u, s in (("s ", 1.0), ("ms", 1e-3), ("us", 0.0)) if seconds >= s)
    return f"{seconds / (size or 1e-6):.4g} {unit}"


def quotient(answers: dict[str, Answer], tolerance: float) -> float:
    """Return the time of asperity over that of Siconos' best solver where both have solved."""
    pair = [answers.get(name, Answer("")) for name in ("asperity", "siconos")]
    return pair[0].best / pair[1].best if all(solved(one, tolerance) for one in pair) else np.nan


def summary(rows: list[Row], engines: list[str], tolerance: float) -> str:
    """Return the numbers of solved problems and the geometric mean of the ratios."""
    lines = []
    for name in engines:
        tried = [a[name] for *_, a in rows if a[name].label != "not for this problem"]
        done = [one for one in tried if solved(one, tolerance)]
        time = sum(one.best for one in done)
        lines.append(f"{name}: {len(done)} of {len(tried)} solved, {time:.4g} s for these")
    known = [a for *_, a in rows if "siconos" in a and solved(a["siconos"], tolerance)]
    ratios = np.array([quotient(answers, tolerance) for answers in known])
    both = ratios[np.isfinite(ratios)]
    if both.size:
        lines.append(
            f"asperity / best of Siconos: geometric mean {np.exp(np.log(both).mean()):.3g}, "
            f"largest {both.max():.3g}, below 1 on {(both < 1).sum()}, on {both.size} of the "
            f"{len(known)} problems that Siconos solves"
        )
    return "\n".join(lines)


def write(path: Path, rows: list[Row], tolerance: float) -> None:
    """Write one line per problem and engine."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8", newline="") as file:
        lines = csv.writer(file)
        lines.writerow(COLUMNS)
        for name, contacts, answers in rows:
            for engine, one in answers.items():
                numbers = [one.best, one.median, one.residual, int(solved(one, tolerance))]
                lines.writerow([name, contacts, engine, one.label, *numbers])
