"""`read_matrices`: each format against a writer of its description; right, or refused by name."""

import sys
import types

import asperity as asp
import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp
from brake_pads import pad

N = 36
DOF = np.stack([np.repeat(np.arange(12) + 101, 3), np.tile([1, 2, 3], 12)], axis=1)


def matrices():
    M, C, K, *_ = pad((2, 1, 1))
    return {"mass": M.tocsc(), "stiffness": K.tocsc(), "damping": C.tocsc()}


def labelled(A, *, lower=True, separator=", "):
    """Text of Abaqus' MATRIX INPUT: row node and direction, column node and direction, value."""
    B = sp.coo_array(sp.tril(A) if lower else A)
    inner = "," if "," in separator else " "
    names = [inner.join(map(str, row)) for row in DOF.tolist()]
    entries = zip(B.row, B.col, B.data, strict=True)
    return "".join(separator.join([names[r], names[c], f"{x:.17e}\n"]) for r, c, x in entries)


def op4(matrices, *, big=False, dense=False, form=6):
    """Text of OUTPUT4 in double precision, three numbers of 23 characters per line."""
    lines = []
    for name, A in matrices.items():
        A = A.toarray()
        rows = -len(A) if big else len(A)
        lines.append(f"{A.shape[1]:8d}{rows:8d}{form:8d}{2:8d}{name:8s}1P,3E23.16")
        for j, column in enumerate(A.T, start=1):
            there = np.flatnonzero(column)
            if not len(there):
                continue
            parts = np.split(there, np.flatnonzero(np.diff(there) > 1) + 1)
            if dense:
                parts = [np.arange(there[0], there[-1] + 1)]
                lines.append(f"{j:8d}{there[0] + 1:8d}{2 * len(parts[0]):8d}")
            else:
                heads = (2 if big else 1) * len(parts)
                lines.append(f"{j:8d}{0:8d}{heads + 2 * len(there):8d}")
            for part in parts:
                length = 2 * len(part) + 1
                if big:
                    lines.append(f"{length:8d}{part[0] + 1:8d}")
                elif not dense:
                    lines.append(f"{65536 * length + part[0] + 1:12d}")
                values = [f"{value:23.16E}" for value in column[part]]
                lines += ["".join(values[k : k + 3]) for k in range(0, len(values), 3)]
        lines += [f"{A.shape[1] + 1:8d}{1:8d}{1:8d}", f"{1.0:23.16E}"]
    return "\n".join(lines) + "\n"


def same(model, dof=DOF):
    for role, expected in matrices().items():
        found = getattr(model, role).toarray()
        np.testing.assert_allclose(found, expected.toarray(), rtol=1e-15)
    if dof is not None:
        np.testing.assert_array_equal(np.stack([model.nodes, model.directions + 1], axis=1), dof)
        assert model.coordinates([103]).tolist() == [[6, 7, 8]]


@pytest.mark.parametrize("lower", [True, False])
@pytest.mark.parametrize("separator", [", ", " "])
def test_abaqus_names_nodes(tmp_path, lower, separator):
    paths = {}
    for role, A in matrices().items():
        paths[role] = tmp_path / f"job_{role}.mtx"
        text = "** matrix\n" + labelled(A, lower=lower, separator=separator)
        paths[role].write_text(text.replace("e+", "D+"))
    same(asp.read_matrices(**paths))
    deck = tmp_path / "job.inp"
    nodes = "".join(f"{node}, {node}.0, 0.0, 1.5\n" for node in range(101, 113))
    deck.write_text(f"*NODE, NSET=ALL\n{nodes}*NSET, NSET=Contact\n101, 104\n")
    model = asp.read_matrices(**paths, deck=deck)
    assert model.coordinates("contact").tolist() == [[0, 1, 2], [9, 10, 11]]
    assert model.positions("CONTACT")[1].tolist() == [104.0, 0.0, 1.5]
    assert "The mass of its translations along x, y, z is 0.12, 0.12, 0.12." in model.findings


def test_matrices_of_abaqus_share_their_coordinates(tmp_path):
    """Nodes without mass are in the file of the stiffness only."""
    M, K = tmp_path / "M.mtx", tmp_path / "K.mtx"
    K.write_text("1,1,1,1,5.0\n2,1,1,1,-1.0\n2,1,2,1,3.0\n-1,1,-1,1,7.0\n")
    M.write_text("2,1,2,1,0.5\n")
    model = asp.read_matrices(mass=M, stiffness=K)
    assert model.nodes.tolist() == [-1, 1, 2]
    assert model.mass.toarray().tolist() == np.diag([0.0, 0.0, 0.5]).tolist()
    assert model.stiffness.toarray().tolist() == [[7, 0, 0], [0, 5, -1], [0, -1, 3]]


def test_coordinates_of_abaqus_and_matrix_market(tmp_path):
    paths = {}
    for role, A in matrices().items():
        B, paths[role] = sp.coo_array(sp.tril(A)), tmp_path / f"{role}.mtx"
        np.savetxt(paths[role], np.stack([B.row + 1, B.col + 1, B.data], axis=1), "%d %d %.17e")
    scipy.io.mmwrite(paths["mass"], sp.coo_array(matrices()["mass"]), precision=17)
    model = asp.read_matrices(**paths)
    same(model, None)
    assert "The files name no nodes" in model.summary()
    same(asp.read_matrices(**paths, dof=DOF))
    with pytest.raises(asp.ParameterError, match="dof"):
        asp.read_matrices(**paths, dof=np.ones((N, 2)))
    with pytest.raises(asp.DimensionError, match="dof"):
        asp.read_matrices(**paths, dof=DOF[:-1])


@pytest.mark.parametrize("dense", [False, True])
def test_files_of_matlab(tmp_path, dense):
    found = matrices()
    names = {"M": "mass", "K": "stiffness", "D": "damping"}
    path = tmp_path / "pad.mat"
    held = {name: found[role].toarray() if dense else found[role] for name, role in names.items()}
    scipy.io.savemat(path, held)
    same(asp.read_matrices(mass=path, stiffness=path, damping=(path, "D"), dof=DOF))
    with pytest.raises(asp.ParameterError, match=r"damping: must be one of pad\.mat \(M, K, D\)"):
        asp.read_matrices(mass=path, stiffness=path, damping=path)


@pytest.mark.parametrize(
    "way", [{}, {"big": True}, {"dense": True}, {"form": 1}, {"dense": True, "form": 1}], ids=str
)
def test_output4_of_nastran(tmp_path, way):
    path = tmp_path / "pad.op4"
    found = matrices()
    path.write_text(
        op4({"K": found["stiffness"], "M": found["mass"], "C": found["damping"]}, **way)
    )
    same(asp.read_matrices(mass=path, stiffness=path, damping=path, dof=DOF))
    # A symmetric one of which one triangle is stored.
    path.write_text(op4({"KGG": sp.tril(found["stiffness"])}, big=way.get("big", False)))
    model = asp.read_matrices(mass=path, stiffness=(path, "KGG"))
    np.testing.assert_array_equal(model.stiffness.toarray(), found["stiffness"].toarray())


def test_a_file_as_nastran_writes_it(tmp_path):
    """Numbers without blanks between them, empty columns, and matrices that are not asked for."""
    path = tmp_path / "small.op4"
    path.write_text(
        "       3       2       2       2LOW     1P,3E23.16\n       1       0       5\n"
        "      327681\n 1.0000000000000000E+00-2.0000000000000000E+00\n"
        "       4       1       1\n 1.0000000000000000E+00\n"
        "       3       3       1       2KXX     1P,3E23.16\n       1       0       8\n"
        "      196609\n 4.0000000000000000D+02\n      196611\n-1.0000000000000000E+00\n"
        "       3       0       7\n      458753\n-1.0000000000000000E+00-5.0000000000000000E-01"
        " 3.0000000000000000E+00\n       4       1       1\n 1.0000000000000000E+00\n"
    )
    model = asp.read_matrices(mass=(path, "KXX"), stiffness=(path, "KXX"))
    expected = [[400.0, 0.0, -1.0], [0.0, 0.0, -0.5], [-1.0, 0.0, 3.0]]
    assert model.stiffness.toarray().tolist() == expected
    assert "K is not symmetric: entries differ by up to 0.5." in model.findings
    with pytest.raises(asp.ParameterError, match=r"real and square.*\(2, 3\)"):
        asp.read_matrices(mass=(path, "LOW"), stiffness=(path, "KXX"))
    text = path.read_text()
    for cut in (text[:-70], text.replace("-5.0000000000000000E-01", ""), "garbage", "\x00\x01"):
        path.write_text(cut)
        with pytest.raises(asp.ParameterError, match="mass"):
            asp.read_matrices(mass=(path, "KXX"), stiffness=(path, "KXX"))


def test_rows_without_entries_are_left_out_where_nodes_are_known(tmp_path, monkeypatch):
    """As in files of Ansys, which keep held coordinates, hold upper triangles and count from 0."""
    found = matrices()
    kept = np.ones(N)
    kept[[4, 5]] = 0.0
    rest = sp.diags_array(kept)
    held = {role: sp.triu(rest @ A @ rest) for role, A in found.items()}
    order = np.random.default_rng(2).permutation(N)

    class Full:
        def __init__(self, path):
            if "friction" in path:
                raise NotImplementedError("Unsymmetric")

        def load_km(self, *, sort):
            assert not sort
            return DOF[order] - [0, 1], *(
                sp.triu((held[role] + sp.triu(held[role], 1).T).tocsc()[order][:, order]).tocsc()
                for role in ("stiffness", "mass")
            )

    module = types.ModuleType("ansys.mapdl.reader")
    module.read_binary = Full
    for name in ("ansys", "ansys.mapdl", "ansys.mapdl.reader"):
        monkeypatch.setitem(sys.modules, name, module)
    path = tmp_path / "file.full"
    model = asp.read_matrices(mass=path, stiffness=path)
    assert (
        "2 rows without entries were left out as held, such as that of node 102." in model.findings
    )
    rest = order[np.isin(order, np.flatnonzero(kept))]
    np.testing.assert_array_equal(
        model.stiffness.toarray(), found["stiffness"].toarray()[np.ix_(rest, rest)]
    )
    np.testing.assert_array_equal(model.nodes, DOF[rest, 0])
    with pytest.raises(asp.ParameterError, match="node 102 lacks y"):
        model.coordinates([102])
    with pytest.raises(asp.ParameterError, match="Unsymmetric"):
        asp.read_matrices(mass=path, stiffness=tmp_path / "friction.full")
    monkeypatch.setitem(sys.modules, "ansys.mapdl.reader", None)
    with pytest.raises(ModuleNotFoundError, match="pip install ansys-mapdl-reader"):
        asp.read_matrices(mass=path, stiffness=path)


def test_instances_and_lost_triangles_are_said(tmp_path):
    K, deck = tmp_path / "K.mtx", tmp_path / "job.inp"
    K.write_text("1,1,1,1,5.0\n2,1,2,1,5.0\n2,1,1,1,-1.0\n")
    deck.write_text("*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 2, 0, 0\n*INSTANCE, NAME=PAD-1\n*INCLUDE\n")
    findings = asp.read_matrices(mass=K, stiffness=K, deck=deck).summary()
    assert "instances of parts" in findings
    assert "1 node of the input has no coordinate" in findings


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("1,1,1,1,5.0\n1,1,2,1,-1.0\n2,1,1,1,-1.0\n3,1,1,1,2.0\n", "both triangles of some"),
        ("1,1,1,1\n", "3 or 5 numbers"),
        ("", "3 or 5 numbers"),
        ("1,1,1,1,x\n", "numbers"),
        ("1,1,1,1,5.0\n1,1,1\n", "numbers"),
        ("1,1.5,1,1,5.0\n", "whole numbers"),
        ("1,0,1,1,5.0\n", "whole numbers"),
        ("1,1,1,1,nan\n", "finite"),
        ("0 1 5.0\n", "places"),
        ("-1 1 5.0\n1 1 1.0\n", "places"),
        ("1e12 1 5.0\n", "places"),
        ("1 1 5.0\n", "name nodes"),
    ],
)
def test_text_that_contradicts_itself_is_refused(tmp_path, text, match):
    K, M = tmp_path / "K.mtx", tmp_path / "M.mtx"
    K.write_text(text)
    M.write_text("1,1,1,1,5.0\n")
    with pytest.raises((asp.ParameterError, asp.DimensionError), match=match):
        asp.read_matrices(mass=M, stiffness=K)


def _with(data, place, byte):
    return data[:place] + bytes([byte]) + data[place + 1 :]


def test_wrong_files_are_named(tmp_path):
    small, large, text = tmp_path / "A.mat", tmp_path / "B.mat", tmp_path / "K.mtx"
    scipy.io.savemat(small, {"M": np.eye(2), "cell": np.array([1, "a"], dtype=object)})
    scipy.io.savemat(large, {"K": np.eye(3), "Z": 1j * np.eye(2)})
    text.write_text("1 1 5.0\n")
    (tmp_path / "C.mat").write_bytes(b"MATLAB 7.3 MAT-file" + bytes(600))
    (tmp_path / "empty.mat").write_bytes(b"")
    for mass, stiffness, match in (
        (small, large, r"must have shape \(3, 3\)"),
        (small, (large, "Z"), "real"),
        ((small, "cell"), (large, "K"), "mass"),
        (small, tmp_path / "C.mat", "MATLAB 7.3"),
        (small, tmp_path / "none.mat", "cannot be read"),
        (small, (text, "K"), "one matrix"),
        (small, tmp_path / "none.mtx", "^stiffness: cannot be read"),
        (tmp_path / "none.mtx", text, "^mass: cannot be read"),
        (tmp_path / "empty.mat", text, "^mass: cannot be read"),
        (None, text, "^mass: must be a file"),
        ((small,), text, "^mass: must be a file"),
    ):
        with pytest.raises((asp.ParameterError, asp.DimensionError), match=match):
            asp.read_matrices(mass=mass, stiffness=stiffness)
    text.write_text("1,1, 1,1, 5.0\n1,2, 1,2, 4.28")
    with pytest.raises(asp.ParameterError, match=r"^stiffness: K\.mtx ends within"):
        asp.read_matrices(mass=small, stiffness=text)
    text.write_text("1 1 5.0\n")
    # Damage that SciPy meets with errors of its own, or with a crash of Python.
    for compression in (False, True):
        K = matrices()["stiffness"]
        scipy.io.savemat(large, {"K": K}, do_compression=compression)
        data = large.read_bytes()
        # Indices in 32 bits, of which the highest byte is in place 3.
        indices = data.find(K.indices[:8].astype("<i4").tobytes())
        places = (160,) if compression else (indices + 3, indices + 7)
        for broken in (data[:45], data[:300], *(_with(data, place, 0x33) for place in places)):
            large.write_bytes(broken)
            with pytest.raises(
                asp.ParameterError, match=r"^stiffness: (cannot be read|is damaged)"
            ):
                asp.read_matrices(mass=text, stiffness=(large, "K"))
    for options, match in (
        ({"deck": tmp_path / "none.inp"}, "^deck: cannot be read"),
        ({"dof": [[1, 0]]}, "^dof: must name"),
    ):
        with pytest.raises(asp.ParameterError, match=match):
            asp.read_matrices(mass=text, stiffness=text, **options)
    text.write_text("\n  \n1,1, 1,1, 5.0\n")
    assert asp.read_matrices(mass=text, stiffness=text).nodes.tolist() == [1]
    with pytest.raises(asp.ParameterError, match=r"^dof: is for files that name no nodes"):
        asp.read_matrices(mass=text, stiffness=text, dof=[[1, 1]])


def test_coordinates_held_by_a_large_number_are_left_out(tmp_path):
    """As Abaqus holds those of boundary conditions, and a mass that lacks rows is said."""
    found, K, M = matrices(), tmp_path / "K.mtx", tmp_path / "M.mtx"
    stiff = found["stiffness"].tolil()
    stiff[30, 30] = stiff[32, 32] = 1e36
    K.write_text(labelled(stiff))
    M.write_text("".join(labelled(found["mass"]).splitlines(keepends=True)[:1]))
    model = asp.read_matrices(mass=M, stiffness=K)
    rest = np.delete(np.arange(N), [30, 32])
    np.testing.assert_array_equal(
        model.stiffness.toarray(), found["stiffness"].toarray()[np.ix_(rest, rest)]
    )
    assert (
        "2 coordinates with a stiffness of 1e+36 and more were left out as held, such as that of "
        "node 111." in model.findings
    )
    assert "33 rows of M vanish, such as that of node 101 in direction 2." in model.findings
