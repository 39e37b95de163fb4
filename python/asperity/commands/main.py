"""The command ``asperity``."""

from __future__ import annotations

import argparse
import platform
import sys
import time
from collections.abc import Callable, Sequence
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity import __version__
from asperity._base import arrays
from asperity._base.files import write_csv
from asperity.errors import AsperityError
from asperity.solvers import NAMES, named

if TYPE_CHECKING:
    from asperity.paper.checks import Check

SUCCESS, CHECK_FAILED, USER_ERROR, INTERRUPTED = 0, 1, 2, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit code (0 good, 1 a check is off, 2 user error)."""
    options = _parser().parse_args(arguments)
    try:
        code: int = options.run(options)
    except KeyboardInterrupt:
        print("asperity: interrupted", file=sys.stderr)
        return INTERRUPTED
    except (AsperityError, OSError, ModuleNotFoundError) as error:
        print(f"asperity: {_explained(error)}", file=sys.stderr)
        return USER_ERROR
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="asperity", description="Set-valued anisotropic dry friction."
    )
    parser.add_argument("--version", action="version", version=f"asperity {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    demo = commands.add_parser(
        "demo",
        help="compute Fig. 17 and Fig. 27 of Walker & Leine (2019) and a round trip; check them",
        description="Compute Fig. 17 (limit cycle) and Fig. 27 (sliding paths) of Walker & Leine "
        "(2019) from the measured parameters, and a round trip: synthetic forces of a known law, "
        "the law identified from them, a path simulated with it. Write fig17, fig27 and roundtrip "
        "as .png and .csv and compare with converged values and the truth. Exit code 1 if one is "
        "off.",
        epilog="example: asperity demo --out out/demo",
    )
    demo.add_argument("--out", metavar="DIR", type=Path, required=True, help="folder to write into")
    demo.set_defaults(run=_demo)
    figures = commands.add_parser(
        "figures",
        help="redraw the figures of Walker & Leine (2019) and check what they state",
        description="Redraw Figs. 1-8 and 10-27 of Walker & Leine (2019): figNN.png, figNN.csv "
        "with its curves (points x, y) and arrows (from x, y by dx, dy), and a table of the "
        "statements that belong to it, Propositions 1-5 among them. Parameters the paper does not "
        "give are own ones, measurements are synthetic; each figure says so. Exit code 1 if a "
        "statement does not hold.",
        epilog="example: asperity figures --only 1-4,7 --out out/figures",
    )
    figures.add_argument(
        "--only", metavar="NUMBERS", default="1-27", help="such as 1-4,7; default all"
    )
    figures.add_argument(
        "--out", metavar="DIR", type=Path, required=True, help="folder to write into"
    )
    figures.set_defaults(run=_figures)
    solve = commands.add_parser(
        "solve",
        help="solve contact problems from files and grade the solutions",
        description="Solve the contact problems of .npz and HDF5 (FCLIB) files and print a row for "
        "each: the residual is the natural map ||P - proj(P - rho xi)||/max(||P||, rho ||b||), "
        "computed apart from the solvers; stages are method:iterations/factorizations. Exit code "
        "1 if a problem is not solved to the tolerance.",
        epilog="example: asperity solve problems/ --tolerance 1e-8 --time-limit 30 --csv out.csv",
    )
    solve.add_argument(
        "paths", metavar="FOLDER_OR_FILE", type=Path, nargs="+", help="files, folders of files"
    )
    solve.add_argument("--tolerance", type=float, default=1e-8, help="default 1e-8")
    solve.add_argument(
        "--time-limit", metavar="SECONDS", type=float, default=30.0, help="of a solve; default 30"
    )
    solve.add_argument("--solver", choices=list(NAMES), default="auto", help="default auto")
    solve.add_argument(
        "--repeat", metavar="N", type=int, default=1, help="best time of N short solves; default 1"
    )
    solve.add_argument("--csv", metavar="FILE", type=Path, help="write the table to a file too")
    solve.set_defaults(run=_solve)
    _add_identify(commands)
    _add_track(commands)
    info = commands.add_parser("info", help="print versions and the build profile")
    info.set_defaults(run=_info)
    return parser


def _add_track(commands: Any) -> None:
    track = commands.add_parser(
        "track",
        help="track a round mark in a video and measure its path",
        description="Track a round mark in a video or a folder of images; write path.csv, "
        "frames.csv, overlay.png, motion.png and report.html. The configuration states fps (of the "
        "recording, not of the playback), [mark] and [scene]. Exit code 1 if no position is known "
        "for more than a tenth of the frames, or the body does not come to rest in view.",
        epilog="example: asperity track frames/ --config track.toml --out out/track",
    )
    track.add_argument("video", metavar="VIDEO", type=Path, help="video file or folder of images")
    track.add_argument(
        "--config", metavar="FILE", type=Path, required=True, help="such as track.toml"
    )
    track.add_argument(
        "--out", metavar="DIR", type=Path, required=True, help="folder to write into"
    )
    track.set_defaults(run=_track)


def _add_identify(commands: Any) -> None:
    identify = commands.add_parser(
        "identify",
        help="identify a friction law from measured forces",
        description="Identify the force reservoir C and the direction set D from the forces of a "
        "pin-on-disk tribometer, with confidence bands, and compare models. The TOML file says how "
        "the files are read: sections file, columns, units, calibration, no_load, tribometer, "
        "processing, all optional. Writes sets.png, forces.png, residuals.png, parameters.csv, "
        "directions.csv, turns.csv, models.csv, report.html. Exit code 1 if they are to be read "
        "with warnings, which are printed: records without load or a calibration are missing, the "
        "model does not fit, or the data have another defect. Exit code 2 if something is wrong "
        "with the files; then nothing is written.",
        epilog="example: asperity identify run_1.csv --config tribometer.toml --out out/identify",
    )
    identify.add_argument("paths", metavar="DATA", type=Path, nargs="+", help="CSV files of runs")
    identify.add_argument("--config", metavar="FILE", type=Path, required=True, help="TOML file")
    identify.add_argument(
        "--out", metavar="DIR", type=Path, required=True, help="folder to write into"
    )
    for name, meaning in (("reservoir", "C"), ("direction", "D")):
        identify.add_argument(
            f"--{name}",
            choices=("circle", "ellipse", "superellipse", "fourier", "best"),
            default="superellipse",
            help=f"model of {meaning}, or the best one by BIC; default superellipse",
        )
    identify.add_argument(
        "--loss", choices=("linear", "huber", "cauchy"), default="linear", help="default linear"
    )
    identify.add_argument("--confidence", type=float, default=0.95, help="default 0.95")
    identify.set_defaults(run=_identify)


def _identify(options: argparse.Namespace) -> int:
    from asperity.commands import identify

    found = identify.identify(
        options.paths,
        options.config,
        options.out,
        reservoir=options.reservoir,
        direction=options.direction,
        loss=options.loss,
        confidence=options.confidence,
    )
    print(found.summary())
    print(f"\nfigures, tables and report.html in {options.out}")
    return CHECK_FAILED if found.fit.warnings else SUCCESS


def _demo(options: argparse.Namespace) -> int:
    from asperity.paper import demo

    return _report(lambda: demo.run(options.out), options.out)


def _figures(options: argparse.Namespace) -> int:
    from asperity.paper import redraw

    chosen = redraw.numbers(options.only)
    code = _report(lambda: redraw.run(options.out, chosen), options.out)
    for sentence in redraw.left_out(chosen):
        print(sentence)
    return code


def _solve(options: argparse.Namespace) -> int:
    from asperity.commands import solve

    files = solve.problem_files(options.paths)
    width = max(len(path.stem) for path in files)
    print(solve.line(solve.COLUMNS, width))
    rows = []
    unreadable: list[tuple[str, str]] = []
    for row in solve.solve(
        files,
        named(options.solver),
        tolerance=arrays.positive(options.tolerance, "--tolerance"),
        time_limit=arrays.positive(options.time_limit, "--time-limit"),
        repeat=arrays.count(options.repeat, "--repeat"),
        unreadable=unreadable,
    ):
        print(solve.line(row.cells(), width), flush=True)
        rows.append(row)
    solved, seconds = sum(row.solved for row in rows), sum(row.seconds for row in rows)
    for name, why in unreadable:
        print(f"{name}: unreadable: {why}")
    total = len(rows) + len(unreadable)
    print(f"solved {solved} of {total} to {options.tolerance:g}, {seconds:.3g} s in all")
    if options.csv is not None:
        write_csv(options.csv, solve.COLUMNS, (row.cells() for row in rows))
    return SUCCESS if solved == total else CHECK_FAILED


def _track(options: argparse.Namespace) -> int:
    from asperity.commands import track

    start = time.perf_counter()
    result = track.run(options.video, options.config, options.out)
    print(result.text())
    print(f"\nfigures and tables in {options.out}; {time.perf_counter() - start:.1f} s")
    return SUCCESS if result.complete else CHECK_FAILED


def _report(run: Callable[[], list[Check]], out: Path) -> int:
    """Run, print the table of checks, and return the exit code."""
    from asperity.paper.checks import table

    start = time.perf_counter()
    checks = run()
    seconds = time.perf_counter() - start
    print(table(checks))
    off = sum(not check.ok for check in checks)
    print(f"\n{len(checks)} checks, {off} off; figures and tables in {out}; {seconds:.1f} s")
    return CHECK_FAILED if off else SUCCESS


def _info(options: argparse.Namespace) -> int:
    from asperity import _core

    print(f"asperity    {__version__} ({_core.build_profile} build)")
    print(f"python      {platform.python_version()} on {platform.system()} {platform.machine()}")
    for package in ("numpy", "scipy", "matplotlib", "h5py", "av", "tqdm"):
        try:
            print(f"{package:<11} {metadata.version(package)}")
        except metadata.PackageNotFoundError:
            print(f"{package:<11} not installed")
    return SUCCESS


def _explained(error: Exception) -> str:
    if isinstance(error, ModuleNotFoundError):
        extra = {"h5py": "data", "av": "video", "PIL": "video"}.get(error.name or "", "plot")
        return f"{error.name} is missing: pip install 'asperity[{extra}]'"
    return str(error)
