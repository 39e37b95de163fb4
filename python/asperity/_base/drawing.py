"""Pictures of values for notebooks: drawn when they are asked for, without a display."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING

from asperity.errors import ParameterError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Size in inches; on a screen 110 points per inch give a picture as wide as a page's column.
_SIZE, _DPI = (6.0, 4.0), 110


def png(function: str, value: object, **options: object) -> str | None:
    """Return what a function of `asperity.plot` draws as the address of an image.

    None where there is nothing to draw, such as two coordinates of a system that has one, or no
    matplotlib to draw with.
    """
    figure = _figure(function, value, options)
    if figure is None:
        return None
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=_DPI)
    return f"data:image/png;base64,{base64.b64encode(file.getvalue()).decode()}"


def svg(function: str, value: object) -> str | None:
    """Return what a function of `asperity.plot` draws as SVG; None as of `png`."""
    figure = _figure(function, value, {})
    if figure is None:
        return None
    file = io.StringIO()
    figure.savefig(file, format="svg", metadata={"Date": None})
    text = file.getvalue()
    # Notebooks want the element alone.
    return text[text.index("<svg") :]


def _figure(function: str, value: object, options: Mapping[str, object]) -> Figure | None:
    try:
        # Subpackages below `plot` import it at first use only.
        plot = import_module("asperity.plot")
        from matplotlib.figure import Figure
    except ImportError:
        return None
    with plot.style():
        figure = Figure(figsize=_SIZE, layout="constrained")
        try:
            getattr(plot, function)(value, **options, ax=figure.add_subplot())
        except ParameterError:
            return None
    return figure
