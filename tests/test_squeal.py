"""Squeal of finite-element models: equilibria with contacts that open, eigenvalues near a shift."""

import warnings

import asperity as asp
import numpy as np
import pytest
import scipy.sparse as sp
from asperity.steady_sliding.sparse.certificate import (
    Circle,
    _Measured,
    certified,
    unexplained_phases,
)
from asperity.steady_sliding.sparse.nearest import nearest
from asperity.system.sparse.dissection import nested_dissection
from asperity.system.sparse.factorisation import Factorisation
from brake_pads import dense_eigenvalues, eigenvalues_near, pad, pad_system

LAWS = {
    "isotropic": asp.FrictionLaw.isotropic(0.5),
    "elliptic": asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.3, angle=0.4)),
    "extended": asp.FrictionLaw(asp.Ellipse(0.6, 0.3, angle=0.9), asp.Ellipse(0.5, 0.3)),
}
WAYS = {"x": {}, "50°": {"phi": np.deg2rad(50.0)}, "disc": {"disc": True}}
# A force that lifts the end of the pad off the surface.
TILT = 1500.0


def complementary(system, steady):
    """Check K q = f + E λ_N, gaps and loads of every contact, without the code of the library."""
    mesh = system.contacts[0]
    force = system.force.copy()
    gap = np.zeros(mesh.count)
    for i in range(mesh.count):
        push = mesh.axes[i, 2] + mesh.law.force(mesh.slip[i]) @ mesh.axes[i, :2]
        force[mesh.coordinates[i]] += steady.normal_force[i] * push
        gap[i] = mesh.axes[i, 2] @ steady.q[mesh.coordinates[i]] + mesh.gap[i]
    size = np.abs(force).max()
    np.testing.assert_allclose(system.stiffness @ steady.q, force, atol=1e-9 * size)
    assert (steady.normal_force >= 0.0).all()
    assert (gap >= -1e-12 * np.abs(steady.q).max()).all()
    assert np.abs(gap[list(steady.closed)]).max() <= 1e-12 * np.abs(steady.q).max()
    opened = np.setdiff1d(np.arange(mesh.count), steady.closed)
    assert (steady.normal_force[opened] == 0.0).all()
    return len(opened)


@pytest.mark.parametrize("tilt", [0.0, TILT])
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("law", LAWS)
def test_eigenvalues_near_shifts_against_dense_ones(law, way, tilt):
    system = pad_system((3, 2, 2), LAWS[law], tilt=tilt, **WAYS[way])
    steady = asp.equilibrium(system)
    assert (complementary(system, steady) > 0) == (tilt > 0.0)
    every = dense_eigenvalues(system, steady)
    for hertz in (0.0, 3e3, 1e4, 2e4):
        found = asp.stability(system, equilibrium=steady, near=2.0 * np.pi * hertz, count=10)
        assert found.backward_errors.max() <= 1e-12
        distance = np.abs(every - 2j * np.pi * hertz)
        wanted = every[np.argsort(distance)[:10]]
        # At the edge of the circle one of a pair may be taken for the other.
        inside = np.abs(wanted - 2j * np.pi * hertz) < 0.999 * found.circles[0].radius
        for s in wanted[inside]:
            near = found.eigenvalues[np.abs(found.eigenvalues - s).argmin()]
            assert abs(near - s) <= 1e-8 * abs(s)


# Coordinates of five pads, contacts and the force that opens some of them.
PADS = [
    ((9, 6, 2), None, TILT),
    ((12, 8, 3), None, 0.0),
    ((16, 8, 5), 60, TILT),
    ((22, 11, 7), 100, TILT),
    ((33, 17, 10), 200, TILT),
]


@pytest.mark.parametrize(
    ("cells", "contacts", "tilt", "law", "way"),
    [
        pytest.param(*pad, law, way, marks=[] if k == 0 and law == "extended" else pytest.mark.long)
        for k, pad in enumerate(PADS)
        for law, way in zip(LAWS, ("x", "50°", "disc"), strict=True)
    ],
)
def test_eigenvalues_of_larger_pads_against_the_whole_saddle_matrix(
    cells, contacts, tilt, law, way
):
    system = pad_system(cells, LAWS[law], contacts=contacts, tilt=tilt, **WAYS[way])
    steady = asp.equilibrium(system)
    opened = complementary(system, steady)
    assert opened > 0 or tilt == 0.0
    growth = 0.0
    pairs = []
    for hertz in (1e3, 3e3, 8e3, 1.5e4):
        shift = 2j * np.pi * hertz
        found = asp.stability(system, equilibrium=steady, near=shift, count=20)
        assert found.backward_errors.max() <= 1e-12
        wanted = eigenvalues_near(system, steady, shift, 20)
        inside = wanted[np.abs(wanted - shift) < 0.999 * found.circles[0].radius]
        near = found.eigenvalues[np.abs(found.eigenvalues[:, None] - inside).argmin(axis=0)]
        pairs.append((near, inside))
        growth = max(growth, np.abs(inside.real).max())
    for near, inside in pairs:
        assert (np.abs(near - inside) <= 1e-8 * np.abs(inside)).all()
        assert (np.abs(near.real - inside.real) <= 1e-6 * growth).all()


@pytest.mark.parametrize("way", WAYS)
def test_contacts_open_where_a_closed_one_would_pull(way):
    system = pad_system((4, 3, 1), asp.FrictionLaw.isotropic(0.9), tilt=TILT, **WAYS[way])
    steady = asp.equilibrium(system)
    assert complementary(system, steady) > 0
    # The first guess does not matter.
    for closed in ([], [0, 7, 11]):
        other = asp.equilibrium(system, closed=closed)
        assert other.closed == steady.closed
        np.testing.assert_allclose(other.q, steady.q, rtol=1e-9, atol=1e-18)


def test_gaps_close_under_load():
    system = pad_system((4, 3, 1), LAWS["isotropic"], gap=np.linspace(0.0, 3e-4, 20))
    assert 0 < complementary(system, asp.equilibrium(system)) < 20


def test_a_pad_that_nothing_holds_has_no_equilibrium():
    M, C, _, f, _, nodes = pad((2, 2, 1))
    K = sp.csc_array(pad((2, 2, 1), spring=0.0)[2])
    mesh = asp.MeshContacts(
        LAWS["isotropic"], coordinates=3 * nodes[:, None] + np.arange(3), velocity=[1.0, 0.0, 0.0]
    )
    free = asp.LinearSystem(M, damping=C, stiffness=K, force=-f, contacts=mesh)
    with pytest.raises(asp.ParameterError, match="system"):
        asp.equilibrium(free)


def test_dense_and_sparse_stability_agree():
    system = pad_system((2, 2, 1), LAWS["extended"], phi=0.5)
    dense, near = asp.stability(system.dense()), asp.stability(system, near=1e5, count=12)
    for s, mode in zip(near.eigenvalues, near.modes.T, strict=True):
        i = np.abs(dense.eigenvalues - s).argmin()
        assert abs(dense.eigenvalues[i] - s) <= 1e-9 * abs(s)
        assert abs(np.vdot(dense.modes[:, i], mode)) == pytest.approx(1.0, rel=1e-6)
    # Without `near` the sparse system is made dense.
    assert asp.stability(system).growth_rate == dense.growth_rate
    from_dense = asp.stability(system.dense(), near=1e5, count=12)
    np.testing.assert_allclose(from_dense.eigenvalues, near.eigenvalues, rtol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_normals_may_share_coordinates(seed):
    """Contacts with dense directions, as of a reduced model, against the dense path."""
    rng = np.random.default_rng(seed)
    n = 7
    roots = rng.normal(size=(2, n, n))
    M, K = (root @ root.T + np.eye(n) for root in roots)
    contacts = [
        asp.Contact(
            LAWS["elliptic"],
            direction=0.3 * rng.normal(size=(n, 2)),
            normal=rng.normal(size=n),
            velocity=rng.normal(size=2),
        )
        for _ in range(3)
    ]
    pressed = -20.0 * np.sum([one.normal for one in contacts], axis=0)
    dense = asp.LinearSystem(M, stiffness=K, damping=0.02 * K, force=pressed, contacts=contacts)
    system = asp.LinearSystem(
        sp.csc_array(M), stiffness=K, damping=0.02 * K, force=pressed, contacts=contacts
    )
    steady = asp.equilibrium(system)
    assert len(steady.closed)
    known = asp.equilibrium(dense, closed=steady.closed)
    np.testing.assert_allclose(steady.q, known.q, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(steady.normal_force, known.normal_force, rtol=1e-8, atol=1e-10)
    every = asp.stability(dense, equilibrium=known).eigenvalues
    found = asp.stability(system, equilibrium=steady, near=1.0, count=6).eigenvalues
    for s in found:
        assert np.abs(every - s).min() <= 1e-9 * abs(s)


def test_determinants_have_the_sign_of_numpys():
    rng = np.random.default_rng(2)
    for n in (3, 8, 30):
        A = rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n))
        # The last has no pivots on the diagonal.
        for matrix in (A, A + A.T, np.roll(np.diag(np.diag(A)), 1, axis=0)):
            phase, size = np.linalg.slogdet(matrix)
            log = Factorisation(sp.csc_array(matrix)).log_determinant()
            assert log.real == pytest.approx(size, abs=1e-9)
            assert abs(np.exp(1j * log.imag) - phase) < 1e-9


def test_causes_are_those_of_the_dense_system():
    system = pad_system((2, 2, 1), LAWS["isotropic"])
    dense = asp.stability(system.dense())
    fastest = dense.eigenvalues[0]
    near = asp.stability(system, near=abs(fastest.imag), count=12)
    assert near.growth_rate == pytest.approx(dense.growth_rate, rel=1e-8)
    assert near.mechanisms["direction of friction"] == pytest.approx(
        dense.mechanisms["direction of friction"], rel=1e-6
    )
    assert near.mechanisms["mode coupling"] < 0.0
    assert "normal forces" in near.reason


def test_a_band_holds_all_of_its_eigenvalues():
    system = pad_system((4, 3, 2), LAWS["elliptic"], phi=0.3)
    steady = asp.equilibrium(system)
    every = dense_eigenvalues(system, steady)
    low, high, growth = 2.0 * np.pi * 2e3, 2.0 * np.pi * 3e4, 8e3
    inside = every[(np.abs(every.real) <= growth) & (every.imag >= low) & (every.imag <= high)]
    found = asp.stability(system, equilibrium=steady, band=(low, high), growth=growth, count=8)
    assert len(found.circles) > 1
    assert len(found.eigenvalues) == len(inside)
    for s in inside:
        assert np.abs(found.eigenvalues - s).min() <= 1e-8 * abs(s)
    frame = found.to_pandas()
    assert next(iter(frame.columns)) == "frequency [Hz]"
    np.testing.assert_array_equal(frame["frequency [Hz]"], found.frequencies)


def test_a_band_from_zero_holds_real_eigenvalues():
    # Springs that push away from rest: divergence, whose Im s = 0 has either sign by rounding.
    system = pad_system((3, 2, 1), asp.FrictionLaw.isotropic(1.0))
    away = np.zeros(system.dof)
    band = (0.0, 2.0 * np.pi * 1.5e4)
    for push in (3.2e6, 3.5e6, 4.0e6):
        away[0::3] = -push
        pushed = system.replace(stiffness=system.stiffness + sp.diags_array(away))
        chart = asp.squeal_map(pushed, parameters={"friction": [0.05, 0.1]}, band=band)
        for k, friction in enumerate((0.05, 0.1)):
            there = pushed.varied(friction=friction)
            wanted = asp.stability(there.dense()).eigenvalues.real.max()
            found = asp.stability(there, band=band, growth=2e4)
            np.testing.assert_allclose(found.growth_rate, wanted, rtol=1e-6)
            np.testing.assert_allclose(chart.growth_rate[k], wanted, rtol=1e-5)


def rates(*squares, damping=0.0):
    """Return masses on springs of their own, with ω² as given; many, so that few are found."""
    K = sp.diags_array(np.r_[squares, np.arange(1.0, 201.0) ** 2])
    return asp.LinearSystem(sp.identity(len(squares) + 200), stiffness=K, damping=damping)


def test_growth_beyond_what_was_asked_for_is_said():
    # Divergence with 3e4 1/s, far from the band.
    for low in (0.0, 20.0):
        found = asp.stability(rates(-9e8), band=(low, 60.0), growth=5.0, count=10)
        assert not found.unstable.any()
        np.testing.assert_allclose(found.beyond, [3e4], rtol=1e-12)
        assert "A motion without oscillation grows with 30000 1/s, beyond" in found.summary()
    # Within the bound it is one of the modes, and nothing is beyond.
    found = asp.stability(rates(-9.0), band=(0.0, 60.0), growth=5.0, count=10)
    assert found.unstable.sum() == 1
    assert found.growth_rate == pytest.approx(3.0, rel=1e-12)
    assert not len(found.beyond)
    # Flutter: s = 8 ± 30.5i of a negative damper.
    flutter = rates(64.0 + 30.5**2, damping=sp.diags_array(np.r_[-16.0, np.zeros(200)]))
    found = asp.stability(flutter, band=(0.0, 60.0), growth=5.0, count=20)
    assert not found.unstable.any()
    np.testing.assert_allclose(found.beyond, [8.0 + 30.5j], rtol=1e-12)
    assert f"{30.5 / (2.0 * np.pi):.6g} Hz grows with 8 1/s, beyond" in found.summary()
    assert not len(asp.stability(rates(9.0), band=(0.0, 60.0), growth=5.0).beyond)


def test_overdamped_motions_are_passed_by_or_named():
    """C = K/100: of 300 motions all eigenvalues but a few are about −100, or far away."""
    K = 1e6 * sp.diags_array([-1.0, 2.1, -1.0], offsets=[-1, 0, 1], shape=(300, 300))
    chain = asp.LinearSystem(sp.identity(300), stiffness=K, damping=1e-2 * K)
    # s² + ω² s/100 + ω² = 0 has real roots above ω = 200, and the lowest ω is 316.
    found = asp.stability(chain, band=(0.0, 3e3), growth=50.0, certify=True)
    assert not len(found.eigenvalues)
    assert found.certificate.is_complete
    for where in ({"near": 1e3}, {"band": (0.0, 3e3), "growth": 150.0}):
        with pytest.raises(asp.ConvergenceError, match=r"none of the .* critical damping") as error:
            asp.stability(chain, **where)
        assert "a smaller `growth`" in str(error.value)
    # As the message says.
    assert asp.stability(chain).growth_rate == pytest.approx(-100.245106, rel=1e-8)
    # A mode of its own that grows among them is found.
    loose = sp.block_diag([K, sp.csc_array([[1e6]])])
    C = sp.block_diag([1e-2 * K, sp.csc_array([[-20.0]])])
    both = asp.LinearSystem(sp.identity(301), stiffness=loose, damping=C)
    found = asp.stability(both, band=(0.0, 3e3), growth=50.0)
    np.testing.assert_allclose(found.eigenvalues, [10.0 + 1j * np.sqrt(1e6 - 100.0)], rtol=1e-12)
    # Of an undamped one no sign is certain.
    C = sp.block_diag([1e-2 * K, sp.csc_array((1, 1))])
    found = asp.stability(both.replace(damping=C), band=(0.0, 3e3), growth=50.0)
    np.testing.assert_allclose(found.eigenvalues, [1e3j], rtol=1e-12)
    assert not found.sign_is_certain.any()


def test_massless_coordinates_do_no_harm():
    """Elements with reduced integration have singular mass matrices; only dense ones need M⁻¹."""
    M = sp.csc_array(np.diag([1.0, 0.0, 2.0]))
    K = np.array([[3.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 4.0]])
    system = asp.LinearSystem(M, stiffness=sp.csc_array(K))
    condensed = K[::2][:, ::2] - np.outer(K[::2, 1], K[1, ::2]) / K[1, 1]
    omega = np.sqrt(np.linalg.eigvals(np.diag([1.0, 0.5]) @ condensed))
    found = asp.stability(system, near=1.5, count=2)
    np.testing.assert_allclose(np.sort(found.eigenvalues.imag), np.sort(omega), rtol=1e-12)
    # Undamped: no sign of a growth rate is certain, and none is claimed.
    assert not found.sign_is_certain.any()
    assert not found.unstable.any()
    with pytest.raises(asp.ParameterError, match=r"mass.*singular"):
        system.dense()


def test_a_shift_on_an_eigenvalue_and_systems_of_one_coordinate():
    belt = asp.MassOnBelt(
        1.0,
        stiffness=1.0,
        law=asp.FrictionLaw.isotropic(0.5),
        normal_force=1.0,
        belt_velocity=[1.0, 0.0],
    )
    on = asp.stability(belt, near=1.0, count=4)
    np.testing.assert_allclose(
        *(s[np.argsort(s.imag)] for s in (on.eigenvalues, asp.stability(belt).eigenvalues)),
        rtol=1e-9,
    )
    one = asp.LinearSystem(sp.csc_array([[2.0]]), stiffness=8.0, damping=0.4)
    exact = -0.1 + 1j * np.sqrt(4.0 - 0.01)
    found = asp.stability(one, near=1.0)
    np.testing.assert_allclose(found.eigenvalues[found.eigenvalues.imag > 0.0], [exact], rtol=1e-12)
    band = asp.stability(one, band=(0.0, 100.0))
    np.testing.assert_allclose(band.eigenvalues, [exact], rtol=1e-12)
    assert asp.stability(one, band=(10.0, 100.0)).summary() == "No mode is within the band."


CERTIFIED = [pytest.param(seed, marks=[] if seed < 4 else pytest.mark.long) for seed in range(25)]


@pytest.mark.parametrize("seed", CERTIFIED)
def test_certificates_find_what_is_missing_and_nothing_else(seed):
    rng = np.random.default_rng(seed)
    names = list(LAWS), list(WAYS)
    law, way = (str(rng.choice(one)) for one in names)
    system = pad_system((6, 4, 2), LAWS[law], tilt=float(rng.choice([0.0, TILT])), **WAYS[way])
    modes = asp.stability(system, near=1e5, count=2)
    pencil = modes.small_motions.pencil
    centre = 2j * np.pi * rng.uniform(1e3, 1.5e4)
    pairs, radius = nearest(pencil, centre, 30)
    values = pairs.values
    circle = Circle(centre, 0.65 * radius)
    whole = certified(pencil, values, circle)
    assert whole.is_complete
    inside = np.flatnonzero(circle.holds(values))
    gone = rng.choice(inside, min(len(inside), int(rng.integers(1, 3))), replace=False)
    less = certified(pencil, np.delete(values, gone), circle)
    assert less.is_conclusive
    np.testing.assert_allclose(
        np.sort_complex(less.missing), np.sort_complex(values[gone]), rtol=1e-8
    )
    # An edge within 10⁻⁵ |s| of an eigenvalue, which is inside and outside.
    i = int(np.abs(np.abs(values - centre) - 0.6 * radius).argmin())
    for side in (-1.0, 1.0):
        edge = Circle(centre, abs(values[i] - centre) + side * 1e-5 * abs(values[i]))
        if edge.radius < 0.75 * radius:
            assert certified(pencil, values, edge).is_complete
            missing = certified(pencil, np.delete(values, i), edge)
            assert missing.is_conclusive
            assert len(missing.missing) == (side > 0.0)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(10))
def test_certificates_of_pads_of_20_000_coordinates(seed, monkeypatch):
    """A complete list lacks nothing; of one or two that are taken away each is found."""
    rng = np.random.default_rng(seed)
    known = {}
    measured = _Measured._log

    def once(self, turn):
        # The same points for all lists.
        if turn not in known:
            known[turn] = measured(self, turn)
        return known[turn]

    monkeypatch.setattr(_Measured, "_log", once)
    law, way = (str(rng.choice(list(one))) for one in (LAWS, WAYS))
    tilt = float(rng.choice([0.0, TILT]))
    system = pad_system((33, 17, 10), LAWS[law], contacts=200, tilt=tilt, **WAYS[way])
    assert system.dof == 20196
    centre = 2j * np.pi * rng.uniform(1e3, 1.5e4)
    modes = asp.stability(system, near=centre, count=30)
    assert modes.backward_errors.max() <= 1e-12
    pencil, values = modes.small_motions.pencil, modes.eigenvalues
    distance = np.abs(values - centre)
    # In half of the cases an eigenvalue is beside the edge, inside or outside.
    i = int(np.abs(distance - 0.6 * modes.circles[0].radius).argmin())
    beside = rng.choice([-1e-5, 1e-5]) * abs(values[i]) if seed % 2 else 0.1 * distance[i]
    circle = Circle(centre, distance[i] + beside)
    assert certified(pencil, values, circle).is_complete
    inside = np.flatnonzero(circle.holds(values))
    for number in (1, 2):
        gone = rng.choice(inside, min(len(inside), number), replace=False)
        if number == 1 and i in inside:
            gone = np.array([i])
        less = certified(pencil, np.delete(values, gone), circle)
        assert less.is_conclusive
        np.testing.assert_allclose(
            np.sort_complex(less.missing), np.sort_complex(values[gone]), rtol=1e-8
        )


@pytest.mark.parametrize("number", [1, 2, 3, 5])
def test_a_zero_in_the_circle_leaves_phase_unexplained(number):
    rng = np.random.default_rng(number)
    angles = 2.0 * np.pi * np.arange(12) / 12
    radii = np.sqrt(rng.uniform(size=(3000, number)))
    zeros = radii * np.exp(2j * np.pi * rng.uniform(size=radii.shape))
    logs = np.log(np.exp(1j * angles) - zeros[:, :, None]).sum(axis=1)
    left = np.abs(unexplained_phases(angles, logs)).max(axis=1)
    assert left.min() > (0.72 if number == 1 else 0.25)
    # Those outside, at twice the radius, leave next to nothing.
    outside = np.log(np.exp(1j * angles) - 2.0 * np.exp(1j * zeros.real)[:, :, None]).sum(axis=1)
    assert np.abs(unexplained_phases(angles, outside)).max() < 0.01 * number


def test_stability_certifies():
    system = pad_system((4, 3, 2), LAWS["isotropic"])
    found = asp.stability(system, near=2e4, count=6, certify=True)
    assert found.certificate.is_complete
    assert found.certificate.factorisations >= 12
    assert "no eigenvalue missing" in found.summary()


def test_eigenvalues_of_close_pairs_are_missed_one_by_one():
    K = sp.diags_array(np.r_[4.0, 4.0 * (1.0 + 1e-6), np.arange(9.0, 29.0) ** 2])
    system = asp.LinearSystem(sp.identity(22), stiffness=K.tocsc(), damping=1e-3)
    pencil = asp.stability(system, near=2.0, count=4).small_motions.pencil
    known = nearest(pencil, 2j, 6)[0].values
    circle = Circle(2j, 1.0)
    assert certified(pencil, known, circle).is_complete
    first = np.abs(known - 2j).argmin()
    less = certified(pencil, np.delete(known, first), circle)
    np.testing.assert_allclose(less.missing, [known[first]], rtol=1e-8)


@pytest.mark.parametrize(
    "K",
    [
        pad((6, 3, 2))[2],
        sp.block_diag([pad((3, 2, 2))[2]] * 3, format="csc"),
        sp.identity(20000, format="csc"),
        sp.csc_array(np.ones((70, 70))),
        sp.diags_array([1.0, 1.0, 1.0], offsets=[-1, 0, 1], shape=(500, 500), format="csc"),
    ],
    ids=["pad", "three pads", "apart", "full", "chain"],
)
def test_dissection_orders_every_coordinate_once(K):
    np.testing.assert_array_equal(np.sort(nested_dissection(K)), np.arange(K.shape[0]))


def test_dissection_keeps_factors_small():
    from scipy.sparse.linalg import splu

    K = pad((14, 8, 5))[2]
    order = nested_dissection(K)
    ours = splu(
        K[order][:, order].tocsc(),
        permc_spec="NATURAL",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    assert ours.nnz < 0.7 * splu(K).nnz


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"near": 1e4, "band": (0.0, 1e5)}, "near"),
        ({"band": (2.0, 1.0)}, "band"),
        ({"near": np.nan}, "near"),
        ({"near": 1e4, "growth": 1.0}, "growth"),
        ({"near": 1e4, "count": 0}, "count"),
        ({"near": 1e4, "equilibrium": 3}, "equilibrium"),
    ],
)
def test_wrong_arguments_are_named(options, match):
    system = pad_system((2, 1, 1), LAWS["isotropic"])
    with pytest.raises((asp.ParameterError, asp.DimensionError), match=match):
        asp.stability(system, **options)
    other = asp.equilibrium(system.replace(force=2.0 * system.force))
    with pytest.raises(asp.ParameterError, match="do not balance"):
        asp.stability(system, near=1e4, equilibrium=other)
    with pytest.raises(asp.ParameterError, match="system"):
        asp.stability(asp.RigidBodies([asp.Body.ball(1.0, radius=0.1)]), near=1.0)


def free_chain(n=50, damping=0.0):
    """Return masses on a line that springs hold together and nothing else holds."""
    ends = np.r_[1.0, 2.0 * np.ones(n - 2), 1.0]
    K = 1e6 * sp.diags_array([-np.ones(n - 1), ends, -np.ones(n - 1)], offsets=[-1, 0, 1])
    return asp.LinearSystem(sp.identity(n), stiffness=K, damping=damping * K)


@pytest.mark.parametrize("damping", [0.0, 1e-5])
@pytest.mark.parametrize("near", [0.0, 10.0])
def test_rigid_body_modes_neither_grow_nor_are_missed(near, damping):
    """Rounding scatters the double eigenvalue 0 to both sides of the axis."""
    found = asp.stability(free_chain(damping=damping), near=near, count=6, certify=True)
    assert (np.abs(found.eigenvalues) < 1e-4).sum() == 2
    assert not found.unstable.any()
    assert found.certificate.is_complete


def test_no_sign_is_certain_of_equal_eigenvalues_on_the_axis():
    """Their left and right vectors are each any of the same space."""
    system = asp.LinearSystem(sp.identity(3), stiffness=4.0)
    found = asp.stability(system, near=2.0, count=6)
    np.testing.assert_allclose(np.sort(found.eigenvalues.imag), [-2, -2, -2, 2, 2, 2], rtol=1e-12)
    assert not found.sign_is_certain.any()


def test_equal_eigenvalues_beside_the_axis_have_certain_signs():
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    K = turn @ np.diag([4.0, 4.0, 9.0]) @ turn.T
    system = asp.LinearSystem(sp.identity(3), stiffness=0.5 * (K + K.T), damping=-1e-6)
    found = asp.stability(system, near=2.0, count=6)
    assert found.unstable.all()
    np.testing.assert_allclose(found.growth_rates, 5e-7, rtol=1e-6)


def held():
    """Return a contact that holds the only coordinate."""
    law = asp.FrictionLaw.isotropic(0.5, dimension=1)
    contact = asp.Contact(law, direction=[0.0], normal=[1.0], velocity=[1.0])
    return asp.LinearSystem(sp.identity(1), stiffness=1.0, force=[-1.0], contacts=contact)


def test_where_nothing_can_move_there_are_no_modes():
    massless = asp.LinearSystem(sp.csc_array((100, 100)), stiffness=2.0)
    for system in (held(), massless):
        for where in ({"near": 0.0}, {"band": (0.0, 1.0)}):
            found = asp.stability(system, **where, certify=True)
            assert not len(found.eigenvalues)
            assert found.certificate.is_complete
            assert "Nothing can move" in found.summary()
            assert dict(found.mechanisms) == {}


def test_more_eigenvalues_than_there_are_may_be_asked_of_massless_coordinates():
    n = 120
    K = 1e6 * sp.diags_array([-1.0, 2.1, -1.0], offsets=[-1, 0, 1], shape=(n, n))
    M = sp.diags_array(np.r_[np.ones(5), np.zeros(n - 5)])
    dense = K.toarray()
    rest = np.linalg.solve(dense[5:, 5:], dense[5:, :5])
    omega = np.sqrt(np.linalg.eigvalsh(dense[:5, :5] - dense[:5, 5:] @ rest))
    system = asp.LinearSystem(M, stiffness=K)
    found = asp.stability(system, near=1e3, count=20).eigenvalues.imag
    np.testing.assert_allclose(np.sort(found[found > 0.0]), omega, rtol=1e-9)
    band = asp.stability(system, band=(0.0, 3e3), certify=True)
    np.testing.assert_allclose(np.sort(band.eigenvalues.imag), omega, rtol=1e-9)
    assert band.certificate.is_complete


def test_an_equilibrium_must_name_the_contacts_that_it_loads():
    system = pad_system((2, 1, 1), LAWS["isotropic"])
    steady = asp.equilibrium(system)
    for closed, match in (([7], "names 7"), ([-1], "names -1"), ([], "loads contact")):
        with pytest.raises(asp.ParameterError, match=match):
            asp.stability(system, equilibrium=steady.replace(closed=closed), near=1e4)
    for options in ({"count": 3}, {"growth": 1.0}, {"certify": True}):
        with pytest.raises(asp.ParameterError, match="near"):
            asp.stability(system, **options)


def test_a_shift_on_an_eigenvalue_of_more_copies_than_asked_for_certifies_nothing():
    system = asp.LinearSystem(sp.identity(40), stiffness=4.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = asp.stability(system, near=2.0, count=12, certify=True)
    np.testing.assert_allclose(found.eigenvalues, np.full(12, 2j), rtol=1e-12)
    assert not found.certificate.is_conclusive
    assert found.certificate.factorisations == 0


def test_shifts_at_which_numbers_overflow_are_refused():
    system = asp.LinearSystem(sp.identity(80), stiffness=sp.diags_array(np.arange(1.0, 81.0)))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for where in ({"near": 1e100}, {"near": 1e200}, {"band": (0.0, 1e200)}):
            with pytest.raises(asp.ParameterError, match="too large numbers"):
                asp.stability(system, **where)


def test_all_rigid_motions_of_a_free_pad_are_found():
    """Twelve eigenvalues at one point hide the others, which the count has to know."""
    M, _, K, *_ = pad((3, 2, 2), spring=1e-300)
    free = asp.LinearSystem(M, stiffness=K)
    for system, certify in ((free, True), (free.replace(damping=1e-8 * K), False)):
        found = asp.stability(system, near=0.0, count=14, certify=certify)
        assert (np.abs(found.eigenvalues) < 1.0).sum() == 12
        assert not found.unstable.any()
        assert not certify or found.certificate.is_complete


@pytest.mark.parametrize("length", [2, 3, 4, 5, 6])
def test_no_sign_is_certain_of_chains_that_rounding_scatters(length):
    """Without damping, Jordan chains grow like powers of t, not exponentially."""
    turn = np.linalg.qr(np.random.default_rng(length).normal(size=(length, length)))[0]
    K = turn @ (4.0 * np.eye(length) + np.eye(length, k=1)) @ turn.T
    system = asp.LinearSystem(np.eye(length), stiffness=K)
    found = asp.stability(system, near=2.0, count=2 * length)
    assert not found.sign_is_certain.any()
    assert asp.stability(system).kind == "neutral"
    # Damping that is more than the scatter decides.
    damped = asp.stability(system.replace(damping=0.1), near=2.0, count=2 * length)
    assert damped.sign_is_certain.all() or length > 4
    assert (damped.growth_rates < 0.0).all()


def test_forces_that_are_wrong_by_little_do_not_balance():
    system = pad_system((3, 2, 1), LAWS["extended"], phi=0.4)
    steady = asp.equilibrium(system)
    assert steady.residual < 1e-13
    asp.stability(system, near=1e4, count=2, equilibrium=steady)
    loads = {"normal_force": (1.0 + 1e-4) * steady.normal_force}
    for change, match in (
        (loads, "friction of its loads"),
        ({**loads, "force": (1.0 + 1e-4) * steady.force}, "do not balance"),
        ({"q": (1.0 + 1e-4) * steady.q}, "do not balance"),
        ({"force": 1.01 * steady.force}, "friction of its loads"),
        ({"force": steady.force[:, :1]}, "friction of its loads"),
    ):
        with pytest.raises(asp.ParameterError, match=match):
            asp.stability(system, near=1e4, count=2, equilibrium=steady.replace(**change))


def test_steps_have_no_effect_on_sparse_systems():
    system = pad_system((2, 1, 1), LAWS["extended"], phi=0.4)
    for call in (
        lambda: asp.equilibrium(system, step=1e-4),
        lambda: asp.stability(system, near=1e4, step=1e-4),
    ):
        with pytest.raises(asp.ParameterError, match="step: has no effect"):
            call()
