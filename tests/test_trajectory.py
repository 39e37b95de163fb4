"""Trajectories: files, slices, summaries."""

import csv
import io
import pickle
import zipfile

import asperity as asp
import numpy as np
import pytest
from asperity._base.storage.result_file import FORMAT


@pytest.fixture(scope="module")
def motion():
    contacts = [
        asp.Contact(asp.FrictionLaw.isotropic(0.5), direction=np.eye(2), normal_force=2.0),
        asp.Contact(
            asp.FrictionLaw.isotropic(0.1, dimension=1), direction=[1.0, 0.0], normal_force=1.0
        ),
    ]
    system = asp.LinearSystem(1.0, contacts=contacts)
    return asp.simulate(system, dt=1e-2, t_end=2.0, u0=[1.0, 0.5])


def test_missing_components_are_nan(motion):
    assert motion.slip.shape == (201, 2, 2)
    assert np.isnan(motion.slip[1:, 1, 1]).all()
    assert np.isfinite(motion.slip[1:, 1, 0]).all()


def test_arrays_are_read_only(motion):
    for name in ("t", "q", "u", "slip", "force", "normal_force", "phase", "phase_counts"):
        array = getattr(motion, name)
        assert array.flags.c_contiguous
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


@pytest.mark.parametrize("name", ["run.npz", "run", "run.dat", "läuft.npz"])
def test_save_and_load_keep_the_name_and_everything_else(motion, tmp_path, name):
    path = tmp_path / name
    motion.save(path)
    assert [file.name for file in tmp_path.iterdir()] == [name]
    assert asp.Trajectory.load(path) == motion
    with np.load(path, allow_pickle=False) as file:
        assert str(file["version"]) == asp.__version__
        assert int(file["format"]) == FORMAT


def test_foreign_files_are_refused(motion, tmp_path):
    text = tmp_path / "text.npz"
    text.write_text("not a trajectory")
    one = tmp_path / "one.npy"
    np.save(one, np.arange(3))
    table = tmp_path / "table.csv"
    motion.to_csv(table)
    for path in (text, one, table, tmp_path):
        with pytest.raises(asp.ParameterError) as caught:
            asp.Trajectory.load(path)
        assert caught.value.argument == "path"
        assert "allow_pickle" not in str(caught.value)
    other = tmp_path / "other.npz"
    np.savez(other, x=np.arange(3))
    future = tmp_path / "future.npz"
    np.savez(future, format=FORMAT + 1, version="9.9")
    for path in (other, future):
        with pytest.raises(asp.ParameterError, match="format"):
            asp.Trajectory.load(path)
    with pytest.raises(FileNotFoundError):
        asp.Trajectory.load(tmp_path / "missing.npz")


ARRAYS = ("t", "q", "u", "slip", "force", "normal_force", "phase", "iterations", "residual")
DAMAGE = {
    "removed": lambda array: None,
    "cut": lambda array: array[:-1],
    "extended": lambda array: np.concatenate([array, array[-1:]]),
    "an axis more": lambda array: array[..., None],
    "an axis less": lambda array: array.reshape(-1) if array.ndim > 1 else array[0],
    "text": lambda array: array.astype(str),
    "objects": lambda array: array.astype(object),
}


def kinds_of_damage():
    for name in ARRAYS:
        for kind in DAMAGE:
            yield name, DAMAGE[kind], f"{name}-{kind}"
    yield "phase_counts", DAMAGE["removed"], "phase_counts-removed"


@pytest.mark.parametrize(
    ("name", "change"), [pytest.param(*case[:2], id=case[2]) for case in kinds_of_damage()]
)
def test_every_kind_of_damage_is_refused_by_name(motion, tmp_path, name, change):
    path = tmp_path / "run.npz"
    motion.save(path)
    with np.load(path) as file:
        fields = dict(file)
    fields[name] = change(fields[name])
    np.savez(path, **{key: value for key, value in fields.items() if value is not None})
    with pytest.raises(asp.ParameterError) as caught:
        asp.Trajectory.load(path)
    assert str(path) in str(caught.value)
    # Of two fields that do not fit each other either may be the wrong one.
    assert caught.value.argument in (*ARRAYS, "phase_counts")
    if change is DAMAGE["removed"]:
        assert caught.value.argument == name


def test_unknown_arrays_are_refused(motion, tmp_path):
    path = tmp_path / "run.npz"
    motion.save(path)
    with np.load(path) as file:
        np.savez(path, **{**file, "note": "unknown"})
    with pytest.raises(asp.ParameterError, match="note: does not belong to it"):
        asp.Trajectory.load(path)


def test_bytes_behind_an_array_are_refused(motion, tmp_path):
    path = tmp_path / "run.npz"
    motion.save(path)
    with zipfile.ZipFile(path) as file:
        entries = {name: file.read(name) for name in file.namelist()}
    with zipfile.ZipFile(path, "w") as file:
        for name, whole in entries.items():
            file.writestr(name, whole + b"more" * (name == "content.npy"))
    with pytest.raises(asp.ParameterError, match=r"content: .* more than it states"):
        asp.Trajectory.load(path)


def outcome(path, expected):
    """Load; what is not refused must be what was saved."""
    try:
        assert asp.Trajectory.load(path) == expected
    except asp.AsperityError:
        return False
    return True


@pytest.mark.parametrize("cases", [200, pytest.param(10_000, marks=pytest.mark.long)])
def test_damaged_bytes_are_refused_or_do_not_matter(motion, tmp_path, cases):
    path = tmp_path / "run.npz"
    short = motion.slice(0.0, 0.1)
    short.save(path)
    whole = path.read_bytes()
    rng = np.random.default_rng(1)
    read = 0
    for _ in range(cases):
        damaged = bytearray(whole)
        for place in rng.integers(len(whole), size=rng.integers(1, 4)):
            damaged[place] ^= rng.integers(1, 256)
        if rng.random() < 0.2:
            del damaged[rng.integers(len(whole)) :]
        path.write_bytes(damaged)
        read += outcome(path, short)
    # Dates and names of the archive do not matter, its numbers do.
    assert read < 0.3 * cases


@pytest.mark.parametrize(
    "system",
    [
        asp.SlidingPoint(1.0, law=asp.FrictionLaw.isotropic(0.3)),
        asp.LinearSystem(np.eye(2), stiffness=np.eye(2)),
        asp.SlidingDisk(asp.FrictionLaw.isotropic(0.3), velocity=[1.0, 0.0]),
    ],
    ids=["point", "no contact", "bodies in space"],
)
@pytest.mark.parametrize("options", [{}, {"sample_every": 0.007}, {"until_rest": True}])
def test_runs_of_all_kinds_come_back(tmp_path, system, options):
    run = asp.simulate(system, dt=1e-3, t_end=0.05, **options)
    path = tmp_path / "run.npz"
    run.save(path)
    assert asp.Trajectory.load(path) == run
    part = run.slice(run.t[-2], run.t[-1])
    part.save(path)
    assert asp.Trajectory.load(path) == part
    start = run.slice(0.0, 0.0)
    start.save(path)
    assert asp.Trajectory.load(path) == start


def test_csv_has_names_units_and_all_digits(motion, tmp_path):
    path = tmp_path / "run.csv"
    motion.to_csv(path)
    header = path.read_text().splitlines()[0].split(",")
    assert header[:4] == ["t [s]", "q0 [SI]", "q1 [SI]", "u0 [SI]"]
    assert "contact 0 force 2 [N]" in header
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    assert table.shape == (201, len(header))
    np.testing.assert_array_equal(table[:, header.index("u0 [SI]")], motion.u[:, 0])


def test_nothing_half_written(motion, tmp_path, monkeypatch):
    path = tmp_path / "run.csv"
    path.write_text("old")

    def fail(file, *args, **kwargs):
        file.write("half" if isinstance(file, io.TextIOBase) else b"half")
        raise OSError("disk full")

    monkeypatch.setattr(csv, "writer", fail)
    monkeypatch.setattr(np, "savez_compressed", fail)
    for write in (motion.to_csv, motion.save):
        with pytest.raises(OSError, match="disk full"):
            write(path)
    assert [file.name for file in tmp_path.iterdir()] == ["run.csv"]
    assert path.read_text() == "old"


def test_slice(motion):
    part = motion.slice(0.1, 0.2)
    assert len(part) == 11
    assert part.t[0] == pytest.approx(0.1)
    np.testing.assert_array_equal(part.q, motion.q[10:21])
    with pytest.raises(asp.ParameterError, match="t0"):
        motion.slice(5.0, 6.0)


def test_shares_and_summary(motion):
    phases = motion.phase[1:]
    expected = (phases == asp.Phase.STICK).mean(axis=0)
    np.testing.assert_allclose(motion.stick_fraction, expected)
    summary = motion.summary()
    for words in (
        "went on to its end. ",
        "of 200 steps, up to t = 2 s",
        "contact 1 stuck",
        "slipped",
    ):
        assert words in summary


def test_comparison(motion):
    assert motion == asp.Trajectory(**motion._parameters)
    assert motion != motion.slice(0.0, 1.0)


def test_parts_of_results_are_taken_by_others_and_change_nothing():
    from scipy.spatial.transform import Rotation

    ball = asp.Body.ball(
        1.0, radius=0.1, velocity=(1.0, 0.5, 0.0), angular_velocity=(0.0, 0.0, 1.0)
    )
    run = asp.integrate(asp.RigidBodies([ball]), t_end=1.0, sample_every=0.1)
    many = asp.simulate_many(asp.RigidBodies([ball]), dt=0.1, t_end=0.2, u0=run.u[:2])
    quarter = Rotation.from_euler("z", 90.0, degrees=True)
    turned = quarter.apply(run.q[:, :3])
    np.testing.assert_allclose(turned[-1], [-0.5, 1.0, run.q[-1, 2]], atol=1e-12)
    for part in (run.q[-1, :3], run.end.q[:3], run.u[0][:3], run.slice(0.1, 0.5).q[0, :3]):
        quarter.apply(part)
        Rotation.from_rotvec(part)
    quarter.apply(many.q[0, :3])
    before = run.q.tolist()
    run.q[0][:] = 7.0
    with pytest.raises(ValueError, match="read-only"):
        run.q[0] = 7.0
    assert run.q.tolist() == before
    # Otherwise they are arrays as all others, as are those that follow from them.
    assert repr(run.q) == repr(np.array(run.q))
    assert {type(one) for one in (run.q[0], 2.0 * run.q, run.q @ run.q.T, run.q.sum(axis=0))} == {
        np.ndarray
    }
    assert type(pickle.loads(pickle.dumps(run.q))) is np.ndarray
    assert isinstance(run.t[-1], float)
