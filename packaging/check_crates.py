"""Package the crates as the registry will hold them, and use them from a crate outside.

    python packaging/check_crates.py --tests

It needs cargo. The packages are unpacked to a folder of their own; ``packaging/outside`` is copied
there and runs on them. With ``--tests``, the tests that the packages bring are run, too.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CRATES = ("asperity-set", "asperity")


def main(arguments: Sequence[str] | None = None) -> int:
    """Check both crates; return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--tests", action="store_true", help="run the tests of the packages, too")
    parser.add_argument("--allow-dirty", action="store_true", help="as of cargo package")
    options = parser.parse_args(arguments)
    manifest = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))
    version = manifest["workspace"]["package"]["version"]
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    words = [word for name in CRATES for word in ("--package", name)]
    # They are compiled below, once, by the crate that uses them.
    words += ["--allow-dirty"] * options.allow_dirty + ["--no-verify"]
    _run(["cargo", "package", "--locked", *words], ROOT)
    with tempfile.TemporaryDirectory() as scratch:
        place = Path(scratch)
        for name in CRATES:
            with tarfile.open(target / "package" / f"{name}-{version}.crate") as archive:
                archive.extractall(place, filter="data")
        outside = shutil.copytree(ROOT / "packaging" / "outside", place / "outside")
        own = ["--target-dir", str(target / "outside")]
        for name in CRATES:
            own += ["--config", f"patch.crates-io.{name}.path='{place / name}-{version}'"]
        _run(["cargo", "run", *own], outside)
        if options.tests:
            for name in CRATES:
                words = [word for word in own if name not in word or "--" in word]
                _run(["cargo", "test", "--features", "serde", *words], place / f"{name}-{version}")
    print(f"the crates of version {version} are good")
    return 0


def _run(command: Sequence[str], folder: Path) -> None:
    print("+", *command, flush=True)
    subprocess.run(command, cwd=folder, check=True)


if __name__ == "__main__":
    sys.exit(main())
