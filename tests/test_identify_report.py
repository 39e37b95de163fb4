"""The report of a fit."""

import base64
import re

import matplotlib as mpl
import numpy as np
import pytest
from asperity import FrictionLaw, ParameterError, Superellipse
from asperity.identify import FourierDirection, fit_law
from asperity.plot import plot_fitted_forces, plot_fitted_sets, plot_residuals
from matplotlib.axes import Axes

mpl.use("Agg")


def data(noise=0.005, turns=4):
    law = FrictionLaw(Superellipse(0.54, 0.46, 2.94), Superellipse(1.84, 1.19, 2.51))
    phi = np.linspace(0.0, turns * 2.0 * np.pi, 3000, endpoint=False)
    force = -law.force(np.stack([np.cos(phi), np.sin(phi)], axis=-1))
    return phi, force + noise * np.random.default_rng(0).normal(size=force.shape)


def test_report_is_one_file_that_needs_no_other(tmp_path):
    path = fit_law(data()).report(tmp_path / "report.html", title="Steel <ground>")
    assert path.parent == tmp_path
    assert [item.name for item in tmp_path.iterdir()] == ["report.html"]
    text = path.read_text(encoding="utf-8")
    assert "Steel &lt;ground&gt;" in text
    pictures = re.findall(r'src="data:image/png;base64,([^"]+)"', text)
    assert len(pictures) == 3
    assert all(base64.b64decode(picture).startswith(b"\x89PNG") for picture in pictures)
    assert not re.search(r"(src|href)=\"(?!data:)|@import|url\(", text)
    for word in (
        "closure",
        "reservoir.exponent",
        "direction.ratio",
        "not identifiable",
        "ΔBIC",
        "FrictionLaw(",
    ):
        assert word in text


def test_reports_of_fits_that_lack_something(tmp_path):
    phi, force = data(turns=1)
    text = fit_law((phi, force), confidence=None).report(tmp_path / "one.html").read_text()
    assert "without confidence intervals" in text
    assert "ΔBIC" not in text
    fit = fit_law(data(noise=0.0), reservoir="fourier", direction=FourierDirection(30))
    text = fit.report(tmp_path / "two.html").read_text()
    assert "curve through many points" in text or "not convex" in text


def test_a_report_that_cannot_be_written_leaves_nothing(tmp_path):
    fit = fit_law(data())
    with pytest.raises(OSError, match="missing"):
        fit.report(tmp_path / "missing" / "report.html")
    assert not list(tmp_path.iterdir())


def test_names_of_facts_may_be_broken_into_lines(tmp_path):
    text = fit_law(data()).report(tmp_path / "report.html").read_text()
    assert "nowrap" not in text
    assert "max-width: 22rem" in text


def test_other_formats_than_html_are_refused(tmp_path):
    fit = fit_law(data())
    with pytest.raises(ParameterError, match="must end in") as refused:
        fit.report(tmp_path / "report.pdf")
    assert refused.value.argument == "path"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("plot", [plot_fitted_sets, plot_fitted_forces, plot_residuals])
@pytest.mark.parametrize("other", [FrictionLaw.isotropic(0.3), None, "fit"])
def test_only_fits_are_drawn(plot, other):
    with pytest.raises(ParameterError) as caught:
        plot(other)
    assert caught.value.argument == "fit"


@pytest.mark.parametrize("plot", [plot_fitted_sets, plot_fitted_forces, plot_residuals])
def test_figures_take_axes_and_return_them(plot):
    from matplotlib.figure import Figure

    ax = Figure().add_subplot()
    assert plot(fit_law(data(), confidence=None), ax=ax) is ax
    assert ax.has_data()
    assert isinstance(plot(fit_law(data())), Axes)
