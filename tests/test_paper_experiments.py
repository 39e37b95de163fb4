"""The synthetic measurements behind Figs. 18–27: the laws have what the paper reports."""

import asperity as asp
import matplotlib as mpl
import numpy as np
import pytest

mpl.use("Agg")

from asperity.demo import film, round_trip, table1
from asperity.identify import VirtualTribometer, fit_law, process
from paper.measurements import pairings


def exact_forces(law, turns=2, count=7200):
    phi = 2.0 * np.pi * turns * np.arange(count) / count
    return phi, -law.force(np.stack([np.cos(phi), np.sin(phi)], axis=-1))


def test_pvc_has_the_published_friction_coefficients():
    across, along = pairings.PVC.law.reservoir.radius([0.0, 0.5 * np.pi])
    assert 9.3 * across == pytest.approx(5.00, abs=1e-3)
    assert 9.3 * along == pytest.approx(4.49, abs=1e-3)
    assert across == pytest.approx(0.54, abs=5e-3)
    assert along == pytest.approx(0.48, abs=5e-3)


def test_the_least_squares_superellipses_of_pvc_are_those_of_table_1():
    fit = fit_law(exact_forces(pairings.PVC.law), confidence=None)
    found = {name: one.value for name, one in fit.parameters.items()}
    assert 9.3 * found["reservoir.a"] == pytest.approx(4.99, abs=2e-3)
    assert 9.3 * found["reservoir.b"] == pytest.approx(4.25, abs=2e-3)
    assert found["reservoir.exponent"] == pytest.approx(2.94, abs=5e-3)
    assert found["direction.ratio"] == pytest.approx(1.84 / 1.19, abs=2e-3)
    assert found["direction.exponent"] == pytest.approx(2.51, abs=5e-3)


@pytest.mark.parametrize("pair", [pairings.SANDBLASTED, pairings.PVC, pairings.STEEL])
def test_laws_that_are_measured_are_admissible(pair):
    assert pair.law.is_dissipative
    assert pair.law.direction.is_convex
    assert asp.critical_directions(pair.law) == []


def test_steel_is_neither_associated_nor_collinear():
    assert not pairings.STEEL.law.is_associated
    assert not pairings.STEEL.law.is_collinear


def test_the_disk_starts_at_the_angle_to_the_grooves():
    disk, _ = film.slide(table1.LAWS["associated, ellipse C"], 1.52, 58.0)
    v = disk.velocity
    assert np.rad2deg(np.arctan2(v[1], v[0])) == pytest.approx(32.0)
    assert np.hypot(*v) == pytest.approx(1.52)


def test_a_wrong_law_fails_the_checks_of_the_round_trip():
    """The checks can fail: a fit to a circle is far off."""
    virtual = VirtualTribometer(
        table1.LAWS["associated, ellipse C"], normal_force=9.3, turns=3, sample_rate=500.0
    )
    trip = round_trip.run()
    assert all(check.ok for check in round_trip.checks(trip))
    other = round_trip.RoundTrip(fit_law(process(virtual.record())), trip.film, trip.run)
    assert not all(check.ok for check in round_trip.checks(other))
    assert len(trip.comparison) == len(trip.film.camera) == 80
