"""Reduced systems and maps of squeal against the sparse systems that they stand for."""

import asperity as asp
import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp
from brake_pads import pad, pad_system
from matplotlib.figure import Figure

LAWS = {
    "isotropic": asp.FrictionLaw.isotropic(1.0),
    "extended": asp.FrictionLaw(asp.Ellipse(1.0, 0.6, angle=0.9), asp.Ellipse(0.5, 0.3)),
    "falling": asp.FrictionLaw.associated(asp.Ellipse(0.9, 0.7)).replace(
        rate=asp.Stribeck(8.0, ratio=0.5)
    ),
}
BAND = (2.0 * np.pi * 300.0, 2.0 * np.pi * 1.5e4)
GRID = {"friction": np.linspace(0.2, 0.9, 5), "phi": np.deg2rad(np.linspace(0.0, 90.0, 7))}


def in_band(system, band=BAND):
    """Return eigenvalues of the whole system by solutions of its own."""
    return asp.stability(system, band=band).eigenvalues


@pytest.mark.parametrize("disc", [False, True])
@pytest.mark.parametrize("law", LAWS)
def test_loads_and_open_contacts_are_those_of_the_whole_system(law, disc):
    system = pad_system((4, 3, 2), LAWS[law], tilt=1500.0, disc=disc)
    # Whatever the modes are, the static ones give loads and gaps.
    reduced = asp.reduce(system, band=(0.0, 2.0 * np.pi * 3e3))
    opened = set()
    for friction, phi, speed in [
        (1.0, 0.0, 1.0),
        (0.3, 1.0, 2.0),
        (0.9, 2.5, 0.5),
        (0.6, 4.0, 1.0),
    ]:
        there = {"friction": friction, "phi": phi, "speed": speed}
        whole = asp.equilibrium(system.varied(**there))
        size = whole.normal_force.max()
        small = asp.equilibrium(reduced.varied(**there), closed=whole.closed)
        np.testing.assert_allclose(small.normal_force, whole.normal_force, atol=1e-10 * size)
        state = reduced.states.at(**there)
        np.testing.assert_allclose(state.load, whole.normal_force, atol=1e-10 * size)
        assert np.flatnonzero(state.closed).tolist() == list(whole.closed)
        opened.add(len(whole.closed) < len(state.closed))
        gaps = system.columns.normals.T @ reduced.expand(small.q)
        np.testing.assert_allclose(gaps, small.q[: len(gaps)], atol=1e-12 * np.abs(gaps).max())
    assert True in opened


@pytest.mark.parametrize("law", LAWS)
def test_growth_rates_of_a_reduced_system(law):
    system = pad_system((5, 3, 2), LAWS[law], phi=0.4)
    reduced = asp.reduce(system, band=BAND)
    assert reduced.dof < system.dof / 3
    found = asp.stability(reduced).eigenvalues
    near = asp.stability(reduced, band=BAND).eigenvalues
    for s in in_band(system):
        for values in (found, near):
            nearest = values[np.abs(values - s).argmin()]
            assert abs(nearest.real - s.real) <= 1e-2 * abs(s.real)
            assert abs(nearest - s) <= 1e-5 * abs(s)


def test_a_reduced_pad_moves_like_the_whole_one():
    system = pad_system((4, 3, 1), asp.FrictionLaw.isotropic(0.4), contacts=4)
    whole = system.dense()
    reduced = asp.reduce(system, band=(0.0, 2.0 * np.pi * 2e4), sticking=True)
    assert reduced.dof < 0.5 * whole.dof
    start = asp.equilibrium(reduced)
    whole_start = asp.equilibrium(system)
    np.testing.assert_allclose(
        reduced.expand(start.q), whole_start.q, atol=1e-9 * np.abs(whole_start.q).max()
    )
    mode = asp.stability(system, near=2.0 * np.pi * 3e3, count=2).modes[:, 0].real
    kick = 0.3 * np.linalg.lstsq(reduced.basis, mode / np.abs(mode).max(), rcond=None)[0]
    run = {"dt": 2e-7, "t_end": 4e-4}
    one = asp.simulate(reduced, q0=start.q, u0=kick, **run)
    other = asp.simulate(whole, q0=reduced.expand(start.q), u0=reduced.expand(kick), **run)
    moved = other.q - other.q[0]
    error = np.abs(reduced.expand(one.q) - other.q).max()
    assert error <= 0.01 * np.abs(moved).max()


def test_a_map_against_solutions_of_the_whole_system():
    system = pad_system((5, 3, 2), LAWS["isotropic"])
    chart = asp.squeal_map(system, parameters=GRID, band=BAND)
    assert max(chart.estimates.values()) <= 1.0
    assert chart.open_contacts.max() > 0
    frame = chart.to_pandas()
    data = chart.to_xarray()
    points = [(0, 0), (2, 3), (4, 1), (4, 4), (3, 6)]
    for i, j in points:
        there = {
            name: float(values[k]) for (name, values), k in zip(GRID.items(), (i, j), strict=True)
        }
        wanted = in_band(system.varied(**there))
        values = chart.eigenvalues[:, i, j]
        values = values[~np.isnan(values)]
        assert len(values) == len(wanted)
        for s in wanted:
            nearest = values[np.abs(values - s).argmin()]
            assert abs(nearest.real - s.real) <= max(1e-2 * abs(s.real), 1e-5 * abs(s))
        here = frame[
            (frame["friction [-]"] == there["friction"]) & (frame["phi [rad]"] == there["phi"])
        ]
        np.testing.assert_array_equal(np.sort(here["growth rate [1/s]"]), np.sort(values.real))
        there_too = data["frequency"].sel(there).to_numpy()
        np.testing.assert_array_equal(
            np.sort(there_too)[: len(values)], np.sort(values.imag) / 2 / np.pi
        )
    assert "full solves" in chart.summary()
    assert len(chart._repr_html_()) > 1000


def test_the_border_of_instability_is_that_of_the_whole_system_within_a_degree():
    system = pad_system((10, 5, 3), LAWS["isotropic"], contacts=20)
    # Damped so much that the sliding direction decides.
    system = system.replace(damping=system.damping + 2e-6 * system.stiffness)
    phi = np.deg2rad(np.linspace(0.0, 180.0, 31))
    parameters = {"friction": [0.6], "phi": phi}
    growth = asp.squeal_map(system, parameters=parameters, band=BAND).growth_rate[0]
    borders = np.flatnonzero((growth[1:] > 0.0) != (growth[:-1] > 0.0))
    assert len(borders) >= 3
    for k in borders[:2]:
        # The map between its points: on the basis of a reduced system.
        between = np.linspace(phi[k], phi[k + 1], 4)
        finer = {"friction": [0.6], "phi": between}
        own = asp.squeal_map(system, parameters=finer, band=BAND).growth_rate[0]
        j = np.flatnonzero((own[1:] > 0.0) != (own[:-1] > 0.0))[0]
        at = between[j] + (between[j + 1] - between[j]) * own[j] / (own[j] - own[j + 1])
        for step, inside in ((-1.0, own[j] > 0.0), (1.0, own[j + 1] > 0.0)):
            there = system.varied(friction=0.6, phi=at + np.deg2rad(step))
            assert (in_band(there).real.max() > 0.0) == inside


def test_a_band_without_modes_has_an_empty_map():
    system = pad_system((3, 2, 1), LAWS["isotropic"])
    for band in ((1.0, 2.0), (1e9, 2e9)):
        chart = asp.squeal_map(system, parameters={"friction": [0.1, 0.5]}, band=band)
        assert chart.eigenvalues.shape == (0, 2)
        assert "0 modes" in chart.summary()
    assert asp.reduce(system, band=(1.0, 2.0)).dof < system.dof


def test_rounding_is_no_growth():
    system = pad_system((3, 2, 1), LAWS["isotropic"], gap=1.0)
    free = system.replace(damping=0.0 * system.damping)
    chart = asp.squeal_map(free, parameters={"friction": [0.1, 0.3, 0.5]}, band=BAND)
    assert np.abs(chart.growth_rates).max() < 1e-6
    assert not chart.unstable.any()
    assert "unstable at 0.0%" in chart.summary()
    ax = asp.plot.plot_squeal_map(chart, ax=Figure().add_subplot(), quantity="frequencies")
    assert not any(len(line.get_xdata()) for line in ax.lines if line.get_marker() == "o")


def test_modes_keep_their_names_over_friction():
    system = pad_system((5, 3, 2), LAWS["isotropic"])
    chart = asp.squeal_map(system, parameters={"friction": np.linspace(0.05, 0.3, 26)}, band=BAND)
    # Without contacts that open modes change continuously.
    assert (chart.open_contacts == 0).all()
    inner = chart.frequencies[
        ((chart.frequencies > 400.0) & (chart.frequencies < 1.48e4)).all(axis=1)
    ]
    assert len(inner) >= 4
    assert np.abs(np.diff(inner, axis=1)).max() <= 0.02 * inner.max()
    for quantity in ("growth_rates", "frequencies", "damping_ratios"):
        ax = asp.plot.plot_squeal_map(chart, ax=Figure().add_subplot(), quantity=quantity)
        circles = [line for line in ax.lines if line.get_marker() == "o"]
        begins = sum(len(line.get_xdata()) for line in circles)
        growth = chart.growth_rates
        assert begins == (growth[:, 1:] * growth[:, :-1] < 0.0).sum()
    ax = asp.plot.plot_damping_ratios(chart, ax=Figure().add_subplot())
    assert len(ax.lines[1].get_xdata()) == (chart.growth_rates > 0.0).sum()


@pytest.mark.parametrize("friction", [[0.0], [0.0, 0.2, 0.4]])
def test_a_map_may_begin_without_friction(friction):
    """There the modes are those of the pad whose contact nodes slide freely on the surface."""
    system = pad_system((4, 3, 2), LAWS["isotropic"], phi=0.3)
    chart = asp.squeal_map(system, parameters={"friction": friction}, band=BAND)
    free = np.setdiff1d(np.arange(system.dof), system.contacts[0].coordinates[:, 2])
    M, C, K = (
        part.toarray()[np.ix_(free, free)]
        for part in (system.mass, system.damping, system.stiffness)
    )
    squares, modes = scipy.linalg.eigh(K, M)
    rates = 0.5 * np.sum(modes * (C @ modes), axis=0)
    wanted = -rates + 1j * np.sqrt(squares - rates**2)
    wanted = wanted[(wanted.imag >= BAND[0]) & (wanted.imag <= BAND[1])]
    found = chart.eigenvalues[:, 0]
    found = found[~np.isnan(found)]
    np.testing.assert_allclose(*(s[np.argsort(s.imag)] for s in (found, wanted)), rtol=1e-5)
    # As long as the damping is proportional to M and K, its share of |s| is exact, too.
    np.testing.assert_allclose(np.sort(found.real), np.sort(wanted.real), rtol=1e-3)


def test_speed_and_friction_are_relative_to_the_system():
    system = pad_system((3, 2, 1), LAWS["falling"], phi=0.3)
    same = system.varied()
    assert same == system
    twice = system.varied(friction=2.0, phi=0.5, speed=3.0).contacts[0]
    mesh = system.contacts[0]
    np.testing.assert_allclose(twice.law.force([1.0, 2.0]), 2.0 * mesh.law.force([1.0, 2.0]))
    v = 15.0 * np.array([np.cos(0.8), np.sin(0.8), 0.0])
    np.testing.assert_allclose(twice.velocity, np.broadcast_to(v, (mesh.count, 3)), atol=1e-14)
    dense = system.dense().varied(friction=2.0, phi=0.5, speed=3.0)
    for i, contact in enumerate(dense.contacts):
        np.testing.assert_allclose(contact.velocity, twice.slip[i], atol=1e-14)
    line = asp.mechanisms.mode_coupling(0.5)
    with pytest.raises(asp.DimensionError, match="phi"):
        line.varied(phi=0.1)


@pytest.mark.parametrize(
    ("parameters", "band", "name"),
    [
        ({"mu": [0.1]}, BAND, "parameters"),
        ({}, BAND, "parameters"),
        ({"friction": [-0.1, 1.0]}, BAND, "friction: must not be negative"),
        ({"speed": [0.0, 1.0]}, BAND, "speed: must be positive"),
        ({"friction": [0.9, 0.1]}, BAND, "friction: must rise"),
        ({"phi": [0.0, 0.0, 1.0]}, BAND, "phi: must rise"),
        ({"phi": []}, BAND, "phi"),
        ({"phi": [0.0]}, (5.0, 1.0), "band"),
    ],
)
def test_wrong_parameters_are_named(parameters, band, name):
    system = pad_system((2, 2, 1), LAWS["isotropic"])
    with pytest.raises(asp.AsperityError, match=name):
        asp.squeal_map(system, parameters=parameters, band=band)


def test_what_cannot_be_reduced_is_refused():
    system = pad_system((2, 2, 1), LAWS["isotropic"])
    with pytest.raises(asp.AsperityError, match="sparse"):
        asp.reduce(system.dense(), band=BAND)
    skew = sp.csc_array(system.stiffness + sp.diags_array([1e6] * (system.dof - 1), offsets=1))
    with pytest.raises(asp.ParameterError, match="stiffness"):
        asp.reduce(system.replace(stiffness=skew), band=BAND)
    loose = sp.csc_array(pad((2, 2, 1), spring=0.0)[2])
    with pytest.raises(asp.ParameterError, match=r"nothing holds|singular"):
        asp.reduce(system.replace(stiffness=loose), band=BAND)


def test_mode_shapes_on_the_mesh(tmp_path):
    cells = np.array((3, 2, 1))
    system = pad_system(cells, LAWS["isotropic"], phi=0.4)
    positions = pad(cells)[4]
    modes = asp.stability(system, near=2.0 * np.pi * 3e3, count=2)
    number = np.arange(len(positions)).reshape(cells + 1)
    corners = [
        (0, 0, 0),
        (1, 0, 0),
        (1, 1, 0),
        (0, 1, 0),
        (0, 0, 1),
        (1, 0, 1),
        (1, 1, 1),
        (0, 1, 1),
    ]
    bricks = np.stack(
        [number[a : a + 3, b : b + 2, c : c + 1].ravel() for a, b, c in corners], axis=1
    )
    coordinates = np.arange(system.dof).reshape(-1, 3)
    coordinates[3, 1] = -1
    file = tmp_path / "modes.vtk"
    modes.save_vtk(file, coordinates=coordinates, positions=positions, cells=bricks)
    words = file.read_text().split()
    at = words.index("POINTS") + 3
    read = np.array(words[at : at + positions.size], dtype=float).reshape(-1, 3)
    np.testing.assert_array_equal(read, positions)
    starts = [k for k, word in enumerate(words) if word == "VECTORS"]
    assert len(starts) == 4
    parts = [np.array(words[k + 3 : k + 3 + positions.size], dtype=float) for k in starts]
    wanted = modes.modes[:, 1].copy()
    wanted[10] = 0.0
    np.testing.assert_array_equal(parts[2] + 1j * parts[3], wanted)
    kinds = [bricks[1:], np.array([[0, 1, 2, 3], [1, 2, 3, 4]])]
    modes.save_vtk(file, coordinates=coordinates, positions=positions, cells=kinds)
    lines = file.read_text().splitlines()
    at = lines.index("CELLS 7 55")
    read = [list(map(int, line.split()[1:])) for line in lines[at + 1 : at + 8]]
    assert read == [row for nodes in kinds for row in nodes.tolist()]
    assert lines[at + 8 : at + 16] == ["CELL_TYPES 7", *["12"] * 5, "10", "10"]
    for name, wrong in (
        ("cells", [bricks, bricks[:, :7]]),
        ("coordinates", coordinates + 5),
        ("coordinates", coordinates + 0.5),
        ("cells", bricks[:, :7]),
        ("cells", bricks + 0.5),
    ):
        given = {"coordinates": coordinates, "positions": positions, "cells": bricks, name: wrong}
        with pytest.raises(asp.AsperityError, match=name):
            modes.save_vtk(tmp_path / "wrong.vtk", **given)
    assert not (tmp_path / "wrong.vtk").exists()


@pytest.mark.long
def test_limit_cycle_of_a_reduced_pad_against_time_steps():
    system = pad_system(
        (6, 4, 2), asp.FrictionLaw.isotropic(0.9), contacts=4, phi=np.deg2rad(135.0), speed=0.02
    )
    system = system.replace(damping=3e-6 * system.stiffness)
    reduced = asp.reduce(system, band=(2.0 * np.pi * 2e3, 2.0 * np.pi * 3.2e3))
    cycle = asp.limit_cycle(reduced)
    assert cycle.is_stable
    start = asp.equilibrium(reduced)
    errors = []
    for dt in (1e-6, 5e-7, 2.5e-7):
        run = asp.simulate(reduced, dt=dt, t_end=0.06, q0=start.q, u0=np.full(reduced.dof, 1e-5))
        # The first amplitude, behind the gaps, over the last third.
        last = run.q[-int(0.02 / dt) :, 4]
        y = last - last.mean()
        up = np.flatnonzero((y[:-1] < 0.0) & (y[1:] >= 0.0))
        times = up - y[up] / (y[up + 1] - y[up])
        period = (times[-1] - times[0]) / (len(times) - 1) * dt
        swing = np.ptp(last) / np.ptp(cycle.motion.q[:, 4])
        errors.append((abs(period / cycle.period - 1.0), abs(swing - 1.0)))
    # Of first order in the step.
    first, second, third = np.array(errors)
    assert (second <= 0.6 * first).all()
    assert (third <= 0.6 * second).all()
    assert (third <= 5e-4).all()


@pytest.mark.long
def test_a_large_map_against_solutions_of_the_whole_system():
    system = pad_system((33, 17, 10), LAWS["isotropic"], contacts=200)
    friction, phi = np.linspace(0.1, 0.9, 21), np.deg2rad(np.linspace(0.0, 180.0, 91))
    chart = asp.squeal_map(system, parameters={"friction": friction, "phi": phi}, band=BAND)
    assert max(chart.estimates.values()) <= 1.0
    random = np.random.default_rng(0)
    for i, j in zip(random.integers(21, size=30), random.integers(91, size=30), strict=True):
        there = system.varied(friction=friction[i], phi=phi[j])
        whole = asp.stability(there, near=2.0 * np.pi * 7.65e3, count=26).eigenvalues
        found = chart.eigenvalues[:, i, j]
        found = found[~np.isnan(found)]
        # Those at the edge of the band may be on either side of it.
        inner = (whole.imag > 1.001 * BAND[0]) & (whole.imag < 0.999 * BAND[1])
        for s in whole[inner]:
            error = np.abs(found[np.abs(found - s).argmin()].real - s.real)
            assert error <= max(1.0, 1e-2 * abs(s.real))
