"""Linear systems with sparse matrices and contacts of meshes."""

import pickle

import asperity as asp
import numpy as np
import pytest
import scipy.sparse as sp
from asperity.system import SparseLinearSystem
from brake_pads import pad, pad_system

LAW = asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.3))
KINDS = [sp.csc_array, sp.csr_matrix, sp.coo_array, sp.lil_array]


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_sparse_matrix_is_taken(kind):
    M, C, K, *_ = pad((2, 1, 1))
    system = asp.LinearSystem(kind(M), damping=kind(C), stiffness=kind(K))
    assert isinstance(system, SparseLinearSystem)
    assert isinstance(system.mass, sp.csc_array)
    assert system.dof == M.shape[0]
    np.testing.assert_array_equal(system.stiffness.toarray(), K.toarray())
    # Scalars and diagonals beside sparse matrices are as beside dense ones.
    np.testing.assert_array_equal(
        asp.LinearSystem(2.0, stiffness=kind(K)).mass.toarray(), 2.0 * np.eye(system.dof)
    )


def test_values_are_frozen_compared_replaced_and_sent():
    system = pad_system((2, 1, 1), LAW)
    assert pickle.loads(pickle.dumps(system)) == system == system.replace()
    assert system.replace(force=2.0 * system.force) != system
    with pytest.raises(ValueError, match="read-only"):
        system.mass.data[0] = 0.0
    weak = system.with_law(asp.FrictionLaw.isotropic(0.1))
    assert weak.columns.laws[0] == asp.FrictionLaw.isotropic(0.1)
    assert repr(system) == "<SparseLinearSystem: 36 coordinates, 6 contacts>"
    assert system.labels.contacts[:2] == ("contact 0", "contact 1")


def test_the_dense_twin_is_the_same_system():
    system = pad_system((2, 1, 1), LAW, disc=True)
    dense = system.dense()
    mesh = system.contacts[0]
    np.testing.assert_array_equal(dense.mass, system.mass.toarray())
    for i, contact in enumerate(dense.contacts):
        place = mesh.coordinates[i]
        np.testing.assert_allclose(contact.direction[place], mesh.axes[i, :2].T)
        np.testing.assert_allclose(contact.normal[place], mesh.axes[i, 2])
        np.testing.assert_allclose(
            contact.velocity, -mesh.axes[i, :2] @ mesh.velocity[i], atol=1e-14
        )


def test_single_contacts_stand_beside_those_of_a_mesh():
    M, C, K, f, _, nodes = pad((2, 1, 1))
    unit = np.eye(len(f))
    side = asp.Contact(
        asp.FrictionLaw.isotropic(0.2, dimension=1),
        direction=unit[-2],
        normal_force=30.0,
        velocity=[-1.0],
    )
    mesh = asp.MeshContacts(
        LAW, coordinates=3 * nodes[:, None] + np.arange(3), velocity=[2.0, 1.0, 0.0]
    )
    system = asp.LinearSystem(M, damping=C, stiffness=K, force=f, contacts=[side, mesh])
    found, dense = asp.equilibrium(system), asp.equilibrium(system.dense())
    np.testing.assert_allclose(found.q, dense.q, rtol=1e-9, atol=1e-16)
    np.testing.assert_allclose(found.normal_force, dense.normal_force, rtol=1e-9)
    np.testing.assert_allclose(found.force, dense.force, rtol=1e-9, atol=1e-9)
    assert found.closed == dense.closed


def test_oblique_normals_turn_with_the_surface():
    """A pad and its surface that are turned together have the same loads."""
    angle = 0.7
    turn = np.array(
        [
            [np.cos(angle), 0.0, np.sin(angle)],
            [0.0, 1.0, 0.0],
            [-np.sin(angle), 0.0, np.cos(angle)],
        ]
    )
    M, C, K, f, _, nodes = pad((2, 2, 1))
    turned = sp.kron(sp.identity(len(f) // 3), turn, format="csc")
    where = {"coordinates": 3 * nodes[:, None] + np.arange(3)}
    velocity = np.array([3.0, 2.0, 0.0])
    flat = asp.MeshContacts(LAW, **where, velocity=velocity)
    oblique = asp.MeshContacts(
        LAW,
        **where,
        velocity=turn @ velocity,
        normals=turn @ [0.0, 0.0, 2.0],
        tangents=turn @ [1.0, 0.0, 0.5],
    )
    first = asp.LinearSystem(M, damping=C, stiffness=K, force=f, contacts=flat)
    M, C, K = (turned @ part @ turned.T for part in (M, C, K))
    second = asp.LinearSystem(M, damping=C, stiffness=K, force=turned @ f, contacts=oblique)
    one, two = asp.equilibrium(first), asp.equilibrium(second)
    np.testing.assert_allclose(two.normal_force, one.normal_force, rtol=1e-9)
    np.testing.assert_allclose(two.q, turned @ one.q, rtol=1e-9, atol=1e-15)
    s, t = (asp.stability(each, near=5e4, count=6).eigenvalues for each in (first, second))
    np.testing.assert_allclose(np.sort_complex(t), np.sort_complex(s), rtol=1e-9)


def test_what_needs_dense_matrices_refuses_by_name():
    system = pad_system((2, 1, 1), LAW)
    for call in (
        lambda: asp.simulate(system, dt=1e-6, t_end=1e-5),
        lambda: asp.integrate(system, t_end=1e-5),
    ):
        with pytest.raises(asp.ParameterError, match=r"system\.dense\(\)"):
            call()
    large = asp.LinearSystem(sp.identity(2001, format="csc"))
    with pytest.raises(asp.ParameterError, match="2001 coordinates"):
        large.dense()


def wrong_systems():
    M, C, K, f, *_ = pad((2, 1, 1))
    hole = K.copy()
    hole.data[3] = np.nan
    return {
        "mass.*one of its triangles": lambda: asp.LinearSystem(sp.triu(M), stiffness=K),
        "mass.*symmetric": lambda: asp.LinearSystem(
            M + sp.diags_array([1.0], offsets=[1], shape=M.shape)
        ),
        "stiffness.*one triangle": lambda: asp.LinearSystem(M, stiffness=sp.tril(K)),
        "mass.*square": lambda: asp.LinearSystem(M[:3]),
        "damping.*shape": lambda: asp.LinearSystem(M, damping=C[:3, :3]),
        "stiffness.*finite": lambda: asp.LinearSystem(M, stiffness=hole),
        "stiffness.*real": lambda: asp.LinearSystem(M, stiffness=1j * K),
        "force": lambda: asp.LinearSystem(M, force=f[:4]),
        "contacts": lambda: asp.LinearSystem(M, contacts=[LAW]),
        "contacts.*below": lambda: asp.LinearSystem(
            M, contacts=asp.MeshContacts(LAW, coordinates=[[0, 1, 99]], velocity=[1.0, 0.0, 0.0])
        ),
    }


@pytest.mark.parametrize("match", wrong_systems())
def test_wrong_matrices_are_named(match):
    with pytest.raises((asp.ParameterError, asp.DimensionError), match=match):
        wrong_systems()[match]()


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"law": asp.FrictionLaw.isotropic(0.3, dimension=1)}, "law"),
        ({"coordinates": [[0, 1, 1]]}, "coordinates"),
        ({"coordinates": [[0, 1, 2.5]]}, "coordinates"),
        ({"coordinates": [[0, 1]]}, "coordinates"),
        ({"coordinates": [[0, 1, 1e30]]}, "coordinates"),
        ({"velocity": [1.0, 2.0]}, "velocity"),
        ({"normals": [0.0, 0.0, 0.0]}, "normals"),
        ({"tangents": [0.0, 0.0, 1.0]}, "tangents"),
        ({"gap": [0.0, 0.0]}, "gap"),
    ],
)
def test_wrong_contacts_of_a_mesh_are_named(changes, match):
    given = {"law": LAW, "coordinates": [[0, 1, 2]], "velocity": [1.0, 0.0, 0.0], **changes}
    with pytest.raises((asp.ParameterError, asp.DimensionError), match=match):
        asp.MeshContacts(given.pop("law"), **given)


def test_a_node_that_stands_still_would_stick():
    mesh = asp.MeshContacts.on_disc(
        LAW, coordinates=[[0, 1, 2]], positions=[[0.0, 0.0, 0.0]], rate=[0.0, 0.0, 5.0]
    )
    system = asp.LinearSystem(sp.identity(3), stiffness=sp.identity(3), contacts=mesh)
    with pytest.raises(asp.ParameterError, match="stick"):
        asp.equilibrium(system)


def test_small_integers_are_added_as_numbers():
    places = np.zeros(2, dtype=np.intp)
    twice = sp.coo_array((np.array([100, 100], dtype=np.int8), (places, places)), shape=(1, 1))
    assert asp.LinearSystem(twice).mass.toarray() == 200.0


@pytest.mark.parametrize("M", [[[-1.0, 0.0], [0.0, 1.0]], [[1.0, 3.0], [3.0, 1.0]]])
def test_masses_are_not_negative(M):
    with pytest.raises(asp.ParameterError, match=r"mass.*semidefinite"):
        asp.LinearSystem(sp.csc_array(M))


def test_tangents_of_a_disc_are_given_or_circles():
    with pytest.raises(asp.ParameterError, match="tangents"):
        asp.MeshContacts.on_disc(
            LAW,
            coordinates=[[0, 1, 2]],
            positions=[[0.1, 0.0, 0.0]],
            rate=[0.0, 0.0, 5.0],
            circumferential=True,
            tangents=[1.0, 0.0, 0.0],
        )


def test_a_start_is_refused_and_velocities_along_normals_are_left_out():
    law = asp.FrictionLaw.isotropic(0.4)
    system = pad_system((3, 3, 2), law)
    with pytest.raises(asp.ParameterError, match="q0: has no effect") as refused:
        asp.equilibrium(system, q0=np.zeros(system.dof))
    assert refused.value.argument == "q0"
    across, within = (
        asp.MeshContacts(law, coordinates=[[0, 1, 2]], velocity=[5.0, 0.0, along])
        for along in (2.0, 0.0)
    )
    assert (across.slip == within.slip).all()


@pytest.mark.parametrize("kind", KINDS)
def test_contacts_take_sparse_directions(kind):
    dense = asp.Contact(LAW, direction=np.eye(5)[:, :2], normal=np.eye(5)[3])
    for shape in ((5, 1), (1, 5)):
        normal = kind(np.eye(5)[3].reshape(shape))
        assert asp.Contact(LAW, direction=kind(np.eye(5)[:, :2]), normal=normal) == dense
    with pytest.raises(asp.DimensionError, match="normal"):
        dense.replace(normal=kind(np.eye(4)[:, :1]))
