"""Publish those crates that the registry does not have yet in this version.

    python packaging/publish_crates.py --dry-run    says which
    python packaging/publish_crates.py              publishes them

The registry refuses a version that it has. So a release that is run once more, or whose crates were
published by hand, goes on with what is missing. It needs cargo, and its token in the environment.
Crates are not compiled here: packaging/check_crates.py has done that without a token.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tomllib
import urllib.error
import urllib.request
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CRATES = ("asperity-set", "asperity")
"""In the order of their dependence."""


def index_of(name: str) -> str:
    """Return the address of a crate in the index of crates.io; names have four letters or more.

    >>> index_of("asperity-set")
    'https://index.crates.io/as/pe/asperity-set'
    """
    return f"https://index.crates.io/{name[:2]}/{name[2:4]}/{name}"


def published(name: str, read: Callable[[str], str]) -> set[str]:
    """Return the versions of a crate that the index has: one JSON object in each line."""
    return {json.loads(line)["vers"] for line in read(index_of(name)).splitlines() if line}


def missing(version: str, read: Callable[[str], str]) -> list[str]:
    """Return the crates that the index does not have in this version."""
    return [name for name in CRATES if version not in published(name, read)]


def read_index(address: str) -> str:
    """Return what the index has; nothing of a crate that it does not know."""
    try:
        with urllib.request.urlopen(address, timeout=60) as answer:
            text: str = answer.read().decode("utf-8")
    except urllib.error.HTTPError as error:
        if error.code in (404, 410, 451):
            return ""
        raise
    return text


def main(arguments: Sequence[str] | None = None, read: Callable[[str], str] = read_index) -> int:
    """Publish what is missing; return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--dry-run", action="store_true", help="say what would be published")
    options = parser.parse_args(arguments)
    manifest = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))
    version = manifest["workspace"]["package"]["version"]
    wanted = missing(version, read)
    if not wanted:
        print(f"the registry has all crates of version {version}")
        return 0
    command = ["cargo", "publish", "--locked", "--no-verify"]
    command += [word for name in wanted for word in ("--package", name)]
    print("+", *command, flush=True)
    return 0 if options.dry_run else subprocess.run(command, cwd=ROOT, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
