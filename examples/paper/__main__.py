"""Figures 1–8 and 10–27 with their data and checks.

Run in examples/: python -m paper --out ../out/figures 1 2 17
"""

import argparse
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

import asperity as asp
import matplotlib as mpl
import matplotlib.pyplot as plt
from paper.curves import write_curves
from paper.frame import Redrawn, report

HERE = Path(__file__).parent
FIGURES = {
    int(file.stem[3:]): f"paper.{file.parent.name}.{file.stem}"
    for file in sorted(HERE.glob("*/fig*.py"), key=lambda file: file.stem)
}
"""The module of a figure by its number in the paper; Fig. 9, a sketch of a spring, is left out."""


def redraw(number: int) -> Redrawn:
    """Draw a figure."""
    with asp.plot.style():
        drawn: Redrawn = import_module(FIGURES[number]).draw()
    return drawn


def main(arguments: Sequence[str] | None = None) -> int:
    """Write figNN.png and figNN.csv, print the checks; return 1 if a statement does not hold."""
    parser = argparse.ArgumentParser(prog="python -m paper", description=main.__doc__)
    parser.add_argument(
        "figures", metavar="N", nargs="*", type=int, help="such as 1 2 17; default all"
    )
    parser.add_argument("--out", metavar="DIR", type=Path, required=True)
    options = parser.parse_args(arguments)
    if unknown := set(options.figures) - set(FIGURES):
        parser.error(f"no such figures: {sorted(unknown)}; there are 1-8 and 10-27")
    mpl.use("Agg")
    options.out.mkdir(parents=True, exist_ok=True)
    checks = []
    for number in options.figures or FIGURES:
        drawn = redraw(number)
        asp.plot.save_figure(drawn.figure, options.out / f"fig{number:02d}.png")
        write_curves(options.out / f"fig{number:02d}.csv", drawn.curves)
        plt.close(drawn.figure)
        report(drawn.checks)
        checks += drawn.checks
    off = sum(not check.ok for check in checks)
    print(f"\n{len(checks)} checks, {off} off; figures and tables in {options.out}")
    return 1 if off else 0


if __name__ == "__main__":
    raise SystemExit(main())
