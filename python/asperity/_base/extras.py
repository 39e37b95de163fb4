"""Libraries that are installed with an extra of the package, imported where they are needed."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType


def library(name: str, *, extra: str = "") -> ModuleType:
    """Import a library.

    Args:
        name: of the library.
        extra: that installs it; by default of the same name.

    Raises:
        ModuleNotFoundError: without it, saying what installs it.
    """
    try:
        return import_module(name)
    except ImportError:
        raise ModuleNotFoundError(
            f'needs {name}: pip install "asperity[{extra or name}]"', name=name
        ) from None
