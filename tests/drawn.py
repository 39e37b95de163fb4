"""What a function of `asperity.plot` adds to axes."""

from matplotlib.collections import Collection
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.spines import Spine


def drawn(plot, what, **options):
    """Return the artists that show data, in the order in which they were drawn."""
    given = options.get("ax")
    before = set() if given is None else set(given.get_children())
    ax = plot(what, **options)
    assert given is None or ax is given
    shown = [one for one in ax.get_children() if one not in before and one is not ax.patch]
    return [
        one
        for one in shown
        if isinstance(one, Line2D | Collection | Patch | AxesImage) and not isinstance(one, Spine)
    ]
