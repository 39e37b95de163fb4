"""Plots: what is drawn, not how it looks."""

import asperity as asp
import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")

from asperity.plot import (
    look,
    plot_forces_in_reservoir,
    plot_law,
    plot_path,
    plot_phase,
    plot_set,
    save_figure,
)

LAW = asp.FrictionLaw(asp.Ellipse(0.6, 0.2, angle=0.3), asp.Ellipse(3.0, 1.0))


@pytest.fixture(scope="module")
def motion():
    belt = asp.MassOnBelt(1.0, 1.0, LAW, 1.0, [0.1, 0.05])
    return asp.simulate(belt, dt=1e-2, t_end=20.0)


@pytest.fixture(autouse=True)
def _close():
    import matplotlib.pyplot as plt

    yield
    plt.close("all")


def test_set_outline_lies_on_the_boundary():
    star = asp.Superellipse(2.0, 1.0, 0.5)
    ax = plot_set(star, label="C")
    x, y = ax.lines[0].get_data()
    np.testing.assert_allclose(star.gauge(np.stack([x, y], -1)), 1.0, rtol=1e-12)
    assert (x[0], y[0]) == (x[-1], y[-1])
    assert ax.get_aspect() == 1.0


def test_law_draws_forces_on_the_reservoir():
    ax = plot_law(LAW, arrows=12)
    dots = next(line for line in ax.lines if line.get_marker() == "o")
    force = np.stack(dots.get_data(), -1)
    assert len(force) == 12
    np.testing.assert_allclose(LAW.reservoir.gauge(force), 1.0, rtol=1e-9)
    assert ax.get_legend() is not None


def test_path_and_phase_show_every_sample(motion):
    ax = plot_path(motion, label="mass")
    np.testing.assert_array_equal(ax.lines[0].get_xydata(), motion.q)
    coloured = plot_phase(motion)
    drawn = np.vstack([s for lines in coloured.collections for s in lines.get_segments()])
    assert {tuple(point) for point in drawn} == {tuple(point) for point in motion.q}
    labels = {lines.get_label() for lines in coloured.collections}
    assert labels == {"stick", "slip"}


def test_forces_lie_within_the_reservoir(motion):
    ax = plot_forces_in_reservoir(motion, LAW)
    dots = np.vstack([line.get_xydata() for line in ax.lines if line.get_marker() == "."])
    assert len(dots) == motion.steps
    assert LAW.reservoir.contains(dots, tolerance=1e-9).all()


def test_existing_axes_are_used_and_nothing_is_set_globally():
    import matplotlib.pyplot as plt

    before = dict(mpl.rcParams)
    with look.style():
        _, ax = plt.subplots()
    assert plot_set(asp.Disk(1.0), ax) is ax
    assert dict(mpl.rcParams) == before


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_figures_are_written_whole(tmp_path, suffix):
    path = tmp_path / f"set.{suffix}"
    save_figure(plot_set(asp.Disk(1.0)).figure, path)
    assert path.stat().st_size > 1000
    assert [file.name for file in tmp_path.iterdir()] == [path.name]
