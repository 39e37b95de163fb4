"""The two simulations of the paper at the tolerances of the demo."""

import numpy as np
import pytest
from asperity.paper import fig17, fig27, table1
from asperity.paper.checks import Check, table


@pytest.fixture(scope="module")
def cycle():
    return fig17.run()


@pytest.fixture(scope="module")
def paths():
    return [fig27.run(dt) for dt in fig27.TIME_STEPS]


def assert_all_ok(checks):
    assert checks
    assert all(check.ok for check in checks), table(checks)


def test_fig17(cycle):
    assert_all_ok(fig17.checks(cycle, fig17.system()))


def test_fig17_is_periodic(cycle):
    motion = cycle.trajectory
    assert motion.t[-1] - motion.t[0] == pytest.approx(cycle.period, abs=2 * motion.dt)
    np.testing.assert_allclose(motion.q[-1], motion.q[0], atol=2e-3)


def test_higher_belt_speed_means_less_sticking(cycle):
    import asperity as asp

    fast = fig17.system(3.0)
    motion = asp.simulate(fast, dt=2e-3, t_end=300.0).slice(150.0, 300.0)
    assert fig17.measure(motion, float(fast.equilibrium[0])).stick_share < cycle.stick_share


def test_fig27_end_points_times_and_deflections(paths):
    checks = fig27.checks(paths[-1])
    assert len(checks) == 32
    assert_all_ok(checks)


def test_fig27_converges_with_first_order(paths):
    checks = fig27.convergence(paths)
    assert len(checks) == 6
    assert_all_ok(checks)


def test_expected_deflections_follow_from_the_expected_end_points():
    for (_, angle), (x, y, _, deflection) in fig27.EXPECTED.items():
        direction = np.deg2rad(angle)
        lateral = abs(y * np.cos(direction) - x * np.sin(direction))
        assert lateral == pytest.approx(deflection, abs=2e-4)


def test_table1_is_per_unit_normal_force():
    radius = table1.SUPERELLIPSE_C.radius(0.0) * table1.NORMAL_FORCE
    assert radius == pytest.approx(4.99)
    assert len(table1.laws()) == 4


def test_a_wrong_number_is_off():
    assert not Check("period", 28.703, 28.6, 0.02).ok
    assert not Check("period", 28.703, float("nan"), 0.02).ok
    assert "OFF" in table([Check("period", 28.703, 28.6, 0.02)])
