"""Files of contact problems that are refused, with the key that is wrong."""

import json

import asperity as asp
import numpy as np
import pytest
from asperity import DimensionError, ParameterError
from test_problem_files import DISK, PROBLEMS, every_format, of_bodies, plain


def changed(path, **changes):
    """Rewrite a file with some keys changed, without those that are None."""
    with np.load(path) as data:
        arrays = {**data, **changes}
    np.savez(path, **{key: value for key, value in arrays.items() if value is not None})


@pytest.mark.parametrize(
    ("key", "kind", "value"),
    [
        *((key, ParameterError, None) for key in ("W_data", "W_indptr", "W_shape", "q", "mu")),
        ("q", ParameterError, np.full(12, np.nan)),
        ("q", ParameterError, np.array(["a"] * 12)),
        ("mu", DimensionError, np.ones(5)),
        ("mu", ParameterError, np.array([0.5, 0.5, -0.1, 0.5])),
        ("mu", ParameterError, np.array([0.5, 0.5, np.inf, 0.5])),
        ("W_shape", ParameterError, np.array([12])),
        ("W_indices", ParameterError, np.ones(144)),
    ],
)
def test_missing_and_wrong_keys_are_named(tmp_path, key, kind, value):
    path = tmp_path / "problem.npz"
    plain().save(path)
    changed(path, **{key: value})
    with pytest.raises(kind) as caught:
        asp.ContactProblem.load(path)
    assert caught.value.argument == key


@pytest.mark.parametrize(
    ("argument", "key", "value"),
    [
        ("W", "W_shape", np.array([12, 11])),
        ("W", "W_indices", np.full(144, 99)),
        ("W", "W_indptr", np.arange(12)),
        ("W", "W_data", np.full(144, np.nan)),
        ("W", "W_data", -np.ones(144)),
    ],
)
def test_a_broken_matrix_is_named(tmp_path, argument, key, value):
    path = tmp_path / "problem.npz"
    plain().save(path)
    changed(path, **{key: value})
    with pytest.raises(ParameterError) as caught:
        asp.ContactProblem.load(path)
    assert caught.value.argument.startswith(argument)


# Starts of compressed rows that end at zero entries, but point far outside on the way, which SciPy
# does not notice: summing duplicates then writes there.
OUTSIDE = np.array([0, *[10**6] * 11, 0])


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("W_indptr", OUTSIDE),
        ("W_indptr", np.array([0, *[-(10**6)] * 11, 0])),
        ("W_indptr", np.array([0, *range(12, 132, 12), 144, 10**6])),
        ("W_indptr", np.array([0, *[2**62, -(2**62)] * 5, 0, -1])),
        ("W_indices", np.full(144, -(10**9))),
        ("W_indices", np.zeros(7, dtype=int)),
        ("W_shape", np.array([12, 2**62])),
        ("W_shape", np.array([2**62, 12])),
        ("W_shape", np.array([-12, 12])),
        ("M_shape", np.array([12, 2**62])),
        ("M_indptr", OUTSIDE),
        ("H_indptr", OUTSIDE),
        ("H_shape", np.array([12, 2**62])),
    ],
)
def test_no_part_of_a_matrix_points_outside(tmp_path, key, value):
    path = tmp_path / "problem.npz"
    (plain() if key.startswith("W") else of_bodies()).save(path)
    changed(path, **{key: value})
    with pytest.raises(ParameterError) as caught:
        asp.ContactProblem.load(path)
    assert caught.value.argument == key.partition("_")[0]


def test_bodies_that_do_not_belong_to_the_operator_are_refused(tmp_path):
    path = tmp_path / "problem.npz"
    of_bodies().save(path)
    with np.load(path) as data:
        scaled = 1.1 * data["M_data"]
    changed(path, M_data=scaled)
    with pytest.raises(ParameterError, match="must be WᵀM⁻¹W") as caught:
        asp.ContactProblem.load(path)
    assert caught.value.argument == "W"


LAW_TREE = {"type": "FrictionLaw", "parameters": {}}


@pytest.mark.parametrize(
    "text",
    [
        "not json",
        "{}",
        "3",
        '["word"]',
        "[" * 100_000,
        json.dumps([LAW_TREE]),
        json.dumps([{"type": "Path", "parameters": {}}]),
        json.dumps([{"type": "Disk", "parameters": {"radius": 1.0}}]),
        json.dumps([{"type": "eval", "parameters": {"source": "1"}}]),
        json.dumps([{"type": ["Disk"], "parameters": {}}]),
    ],
)
def test_only_laws_are_built_from_a_file(tmp_path, text):
    path = tmp_path / "problem.npz"
    PROBLEMS["extended"].save(path)
    changed(path, laws=np.array(text))
    with pytest.raises(ParameterError):
        asp.ContactProblem.load(path)


@pytest.mark.parametrize(
    "key", ["fclib_local/W/p", "fclib_local/vectors/q", "fclib_local/spacedim"]
)
def test_missing_groups_are_named(tmp_path, key):
    import h5py

    path = tmp_path / "problem.h5"
    plain().save(path)
    with h5py.File(path, "a") as file:
        del file[key]
    with pytest.raises(ParameterError, match="is missing") as caught:
        asp.ContactProblem.load(path)
    assert caught.value.argument == key


@pytest.mark.parametrize("group", ["fclib_local_rolling", "fclib_global_rolling"])
def test_rolling_friction_is_refused_by_name(tmp_path, group):
    import h5py

    path = tmp_path / "problem.h5"
    with h5py.File(path, "w") as file:
        file.create_group(group)
    with pytest.raises(ParameterError, match="rolling friction") as caught:
        asp.ContactProblem.load(path)
    assert caught.value.argument == group


def test_a_mass_matrix_that_is_not_symmetric_is_refused(tmp_path):
    import h5py

    path = tmp_path / "problem.h5"
    of_bodies().save(path)
    with h5py.File(path, "a") as file:
        del file["fclib_local"]
        file["fclib_global/M/x"][1] += 1.0
    with pytest.raises(ParameterError, match="symmetric") as caught:
        asp.ContactProblem.load(path)
    assert caught.value.argument == "fclib_global/M"


@every_format
def test_an_unknown_form_of_the_operator_is_refused(tmp_path, suffix):
    path = tmp_path / f"problem{suffix}"
    problem = plain().replace(delassus=plain().delassus.toarray())
    problem.save(path)
    if suffix == ".npz":
        changed(path, W_form=np.array("round"))
    else:
        import h5py

        with h5py.File(path, "a") as file:
            del file["data/form"]
            file["data/form"] = "round"
    with pytest.raises(ParameterError, match="form"):
        asp.ContactProblem.load(path)


def test_pickled_arrays_are_not_read(tmp_path):
    path = tmp_path / "problem.npz"
    plain().save(path)
    changed(path, q=np.array([DISK] * 12, dtype=object))
    with pytest.raises(ParameterError) as caught:
        asp.ContactProblem.load(path)
    assert caught.value.argument == "q"


@every_format
@pytest.mark.parametrize("content", [b"", b"neither of them", b"PK\x03\x04broken"])
def test_other_files_are_refused(tmp_path, suffix, content):
    path = tmp_path / f"problem{suffix}"
    path.write_bytes(content)
    with pytest.raises(ParameterError) as caught:
        asp.ContactProblem.load(path)
    assert caught.value.argument == "path"


def test_unknown_endings_and_absent_files(tmp_path):
    for use in (plain().save, asp.ContactProblem.load):
        with pytest.raises(ParameterError, match=r"\.npz, \.h5, \.hdf5"):
            use(tmp_path / "problem.mat")
    with pytest.raises(FileNotFoundError):
        asp.ContactProblem.load(tmp_path / "absent.npz")
