"""Matrices of CalculiX and Matrix Market: right, or refused by name.

`calculix_pads.tar.xz` holds pads that CalculiX 2.20 has stored and, in NAME_freq.dat, its own
eigenvalues in seven digits. They were made for this project and may be used freely.
"""

import shutil
import subprocess
import tarfile
import warnings
from pathlib import Path

import asperity as asp
import numpy as np
import pytest
import scipy.io
import scipy.linalg
import scipy.sparse as sp
from pages import BLOCK

HEADER = "%%MatrixMarket matrix coordinate real "


@pytest.fixture(scope="module")
def pads(tmp_path_factory):
    folder = tmp_path_factory.mktemp("calculix")
    with tarfile.open(Path(__file__).parent / "calculix_pads.tar.xz") as archive:
        archive.extractall(folder, filter="data")
    return folder


def own_eigenvalues(path):
    """Return the eigenvalues ω² that CalculiX has found itself."""
    values = []
    for line in path.read_text().splitlines():
        words = line.split()
        if len(words) == 5 and words[0].isdigit():
            values.append(float(words[1]))
        elif values and words:
            break
    return np.array(values)


@pytest.mark.parametrize("name", ["pad_fixed", "pad_springs", "pad_c3d8i"])
def test_eigenfrequencies_are_those_of_calculix(pads, name):
    model = asp.read_calculix(pads / name)
    own = own_eigenvalues(pads / f"{name}_freq.dat")
    system = asp.LinearSystem(model.mass, stiffness=model.stiffness)
    for square in own[own > 1e3]:
        omega = np.sqrt(square)
        found = asp.stability(system, near=1.001 * omega, count=4).eigenvalues
        assert np.abs(found.imag - omega).min() <= 1e-6 * omega


@pytest.mark.long
def test_the_job_of_the_tutorial_run_anew(pads, tmp_path, monkeypatch):
    """The stored files of the page are those of its input, and its modes are CalculiX's own."""
    if shutil.which("ccx") is None:
        pytest.skip("ccx is not installed: apt-get install calculix-ccx")
    monkeypatch.chdir(tmp_path)
    page = Path(__file__).parents[1] / "docs" / "tutorials" / "squeal.md"
    exec(BLOCK.search(page.read_text(encoding="utf-8"))[1], {})
    subprocess.run(["ccx", "-i", "pad"], check=True, capture_output=True)
    for ending in (".sti", ".mas", ".dof"):
        ours, stored = np.loadtxt(f"pad{ending}"), np.loadtxt(pads / f"pad_springs{ending}")
        np.testing.assert_allclose(ours, stored, rtol=0.0, atol=1e-11 * np.abs(stored).max())
    deck = Path("pad.inp").read_text().replace(", SOLVER=MATRIXSTORAGE", "\n20")
    Path("own.inp").write_text(deck)
    subprocess.run(["ccx", "-i", "own"], check=True, capture_output=True)
    model = asp.read_calculix("pad")
    system = asp.LinearSystem(model.mass, stiffness=model.stiffness)
    found = asp.stability(system, near=0.0, count=40).eigenvalues
    own = own_eigenvalues(Path("own.dat"))
    assert len(own) == 20
    for omega in np.sqrt(own):
        assert np.abs(found.imag - omega).min() <= 1e-6 * omega


def test_findings_of_calculix(pads):
    fixed, springs, hidden = (
        asp.read_calculix(pads / name) for name in ("pad_fixed", "pad_springs.sti", "pad_c3d8i.mas")
    )
    assert len(fixed.nodes) == 168
    assert "28 nodes of the input have no coordinate" in fixed.summary()
    assert "is 0.08, 0.08, 0.08, without coordinates that are held" in fixed.summary()
    assert len(springs.nodes) == 252
    assert "The mass of its translations along x, y, z is 0.12, 0.12, 0.12." in springs.findings
    assert len(hidden.nodes) == 216
    assert "36 nodes of the files, from 37 on, are not in the input" in hidden.summary()
    # The sum of all entries of M is 27 masses here; translations of the input's nodes have one.
    assert "The mass of its translations along x, y, z is 0.12, 0.12, 0.12." in hidden.findings
    with pytest.raises(asp.ParameterError, match=r"mass.*singular"):
        asp.LinearSystem(hidden.mass, stiffness=hidden.stiffness).dense()


def test_contact_nodes_by_the_name_of_their_set(pads):
    model = asp.read_calculix(pads / "pad_springs")
    contact = model.coordinates("contact")
    assert contact.shape == (28, 3)
    assert (model.directions[contact] == np.arange(3)).all()
    np.testing.assert_array_equal(model.nodes[contact[:, 0]], model.node_sets["CONTACT"])
    assert (model.positions("CONTACT")[:, 2] == 0.0).all()
    np.testing.assert_array_equal(model.coordinates([1, 2]), contact[:2])
    mesh = asp.MeshContacts(
        asp.FrictionLaw.isotropic(0.5), coordinates=contact, velocity=[5.0, 0.0, 0.0]
    )
    force = np.zeros(252)
    force[model.coordinates("BACK")[:, 2]] = -50.0
    pad = asp.LinearSystem(model.mass, stiffness=model.stiffness, force=force, contacts=mesh)
    steady = asp.equilibrium(pad)
    assert steady.normal_force.sum() > 0.0
    with pytest.raises(asp.ParameterError, match=r"node .* lacks x"):
        asp.read_calculix(pads / "pad_fixed").coordinates("BACK")
    with pytest.raises(asp.ParameterError, match="CONTACT"):
        model.coordinates("FRONT")


def test_lost_friction_is_said(pads):
    with pytest.warns(UserWarning, match="friction is lost"):
        model = asp.read_calculix(pads / "slip")
    assert "friction is lost" in model.summary()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        asp.read_calculix(pads / "pad_fixed")


def test_files_of_different_jobs_are_refused(pads, tmp_path):
    for ending, name in ((".dof", "pad_fixed"), (".sti", "pad_springs"), (".mas", "pad_fixed")):
        (tmp_path / f"mixed{ending}").write_text((pads / f"{name}{ending}").read_text())
    with pytest.raises(asp.ParameterError, match=r"mixed\.sti must hold places from"):
        asp.read_calculix(tmp_path / "mixed")
    with pytest.raises(asp.ParameterError, match="cannot be read"):
        asp.read_calculix(tmp_path / "nothing")


def cut(text):
    return text[: text.rindex("\n", 0, -300) + 1]


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"sti": cut}, "same places"),
        ({"mas": cut}, "same places"),
        ({"sti": cut, "mas": cut}, "diagonal of coordinate"),
        ({"sti": lambda text: text[:-20] + "\n"}, "numbers"),
        # Within an exponent, which leaves a number.
        ({"sti": lambda text: text[:-5]}, r"job\.sti ends within a line"),
        ({"dof": lambda text: text[:-1]}, r"job\.dof ends within a line"),
        ({"sti": lambda text: text.replace("9.8211459322368e+06", "nan", 1)}, "finite"),
        ({"dof": lambda text: text.replace("1.2", "1.1", 1)}, "twice"),
        ({"dof": lambda text: text.replace("1.2", "1.-2", 1)}, "numbers of nodes"),
        ({"inp": lambda text: text + "*NODE\nx, 0, 0, 0\n"}, "deck"),
        ({"inp": lambda text: text + "*NSET, NSET=A, GENERATE\n1\n"}, "deck"),
        ({"inp": lambda text: text + "*NSET, NSET=A, GENERATE\n1, 5, 0\n"}, "deck"),
        ({"inp": lambda text: text + "*NSET, NSET=A\n1.5\n"}, "deck"),
        ({"inp": lambda text: text + "*NSET, NSET=A\nFRONT\n"}, "no set 'FRONT'"),
    ],
)
def test_files_of_calculix_that_are_cut_off_are_refused(pads, tmp_path, changes, match):
    for ending in ("sti", "mas", "dof", "inp"):
        text = (pads / f"pad_springs.{ending}").read_text()
        (tmp_path / f"job.{ending}").write_text(changes.get(ending, str)(text))
    with pytest.raises(asp.ParameterError, match=match):
        asp.read_calculix(tmp_path / "job")


def test_sets_name_a_node_once_and_positions_may_be_of_fortran(pads, tmp_path):
    deck = tmp_path / "other.inp"
    deck.write_text("*NODE\n1, 1.5D-2, 0, 0\n*NSET, NSET=A\n1, 1\n*NSET, NSET=B\nA, 2\n")
    model = asp.read_calculix(pads / "pad_springs", deck=deck)
    assert model.node_sets["A"] == (1,)
    assert model.node_sets["B"] == (1, 2)
    assert model.places[1] == (0.015, 0.0, 0.0)
    with pytest.raises(asp.ParameterError, match="whole numbers"):
        model.coordinates([1.5])


@pytest.mark.parametrize("symmetry", ["general", "symmetric", "skew-symmetric"])
def test_files_of_scipy_come_back(tmp_path, symmetry):
    A = sp.random_array((6, 6), density=0.4, rng=np.random.default_rng(3))
    A = {"general": A, "symmetric": A + A.T, "skew-symmetric": A - A.T}[symmetry]
    scipy.io.mmwrite(tmp_path / "A.mtx", sp.coo_array(A), symmetry=symmetry, precision=17)
    np.testing.assert_array_equal(asp.read_matrix_market(tmp_path / "A.mtx").toarray(), A.toarray())


def test_exponents_of_fortran_are_read(tmp_path):
    (tmp_path / "A.mtx").write_text(HEADER + "general\n% K\n2 2 2\n1 1 1.0D+03\n2 2 1.5d-02\n")
    np.testing.assert_array_equal(
        asp.read_matrix_market(tmp_path / "A.mtx").toarray(), np.diag([1e3, 1.5e-2])
    )


@pytest.mark.parametrize(
    ("text", "match"),
    [
        (HEADER + "symmetric\n2 2 4\n1 1 1\n1 2 3\n2 1 3\n2 2 1\n", "holds both"),
        (HEADER + "general\n2 2 2\n1 1 1\n", "2 entries, holds 1"),
        (HEADER + "general\n2 2 1\n0 1 1\n", "holds"),
        (HEADER + "general\n2 2 1\n3 1 1\n", "holds"),
        (HEADER + "general\n2 2 1\n1 1\n", "3 numbers"),
        (HEADER + "general\n2 2 1\n1 1 x\n", "numbers"),
        (HEADER + "hermitian\n2 2 1\n1 1 1\n", "hermitian"),
        (HEADER + "general\n", "size"),
        ("%%MatrixMarket matrix array real general\n1 1\n1\n", "array"),
        ("%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 1\n", "complex"),
        (HEADER + "general\n2.5 2 1\n1 1 1\n", "whole numbers"),
        (HEADER + "general\n-2 -2 0\n", "whole numbers"),
        (HEADER + "general\ninf 2 1\n1 1 1\n", "finite"),
        (HEADER + "general\n2 2 1\n1 1 nan\n", "finite"),
        (HEADER + "general\n1000000000000 1 1\n1 1 1\n", "whole numbers"),
        (HEADER + "skew-symmetric\n2 2 1\n1 1 5\n", "diagonal"),
        (HEADER + "general\n1 1 1\n1 1 4.2", "ends within a line"),
        ("1 1 1\n", "begin"),
        ("", "begin"),
    ],
)
def test_files_that_contradict_themselves_are_refused(tmp_path, text, match):
    (tmp_path / "A.mtx").write_text(text)
    with pytest.raises(asp.ParameterError, match=match):
        asp.read_matrix_market(tmp_path / "A.mtx")
