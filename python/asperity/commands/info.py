"""``asperity info``: versions and the build profile."""

from __future__ import annotations

import argparse
import platform
from importlib import metadata

import asperity._core as _core
from asperity._base.tables import aligned
from asperity.commands.options import SUCCESS, Commands

_PACKAGES = ("numpy", "scipy", "jinja2", "matplotlib", "h5py", "av", "pillow", "tqdm")


def add(commands: Commands) -> argparse.ArgumentParser:
    """Add the verb; return its parser."""
    return commands.add_parser("info", help="print versions and the build profile")


def run(_: argparse.Namespace) -> int:
    """Print; return the exit code."""
    python = f"{platform.python_version()} on {platform.system()} {platform.machine()}"
    rows = [("asperity", f"{_core.__version__} ({_core.build_profile} build)"), ("python", python)]
    print(aligned([*rows, *((package, _version(package)) for package in _PACKAGES)]))
    return SUCCESS


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"
