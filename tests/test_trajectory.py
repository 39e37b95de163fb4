"""Trajectories: files, slices, summaries."""

import asperity as asp
import numpy as np
import pytest
from asperity import trajectory as trajectory_module


@pytest.fixture(scope="module")
def motion():
    contacts = [
        asp.Contact(asp.FrictionLaw.isotropic(0.5), np.eye(2), normal_force=2.0),
        asp.Contact(asp.FrictionLaw.isotropic(0.1, dimension=1), [1.0, 0.0], normal_force=1.0),
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
        assert int(file["format"]) == trajectory_module.FORMAT


def test_foreign_files_are_refused(tmp_path):
    text = tmp_path / "text.npz"
    text.write_text("not a trajectory")
    other = tmp_path / "other.npz"
    np.savez(other, x=np.arange(3))
    future = tmp_path / "future.npz"
    np.savez(future, format=trajectory_module.FORMAT + 1)
    for path in (text, other, future):
        with pytest.raises(asp.ParameterError, match="path"):
            asp.Trajectory.load(path)
    with pytest.raises(FileNotFoundError):
        asp.Trajectory.load(tmp_path / "missing.npz")


def test_csv_has_names_units_and_all_digits(motion, tmp_path):
    path = tmp_path / "run.csv"
    motion.to_csv(path)
    header = path.read_text().splitlines()[0].split(",")
    assert header[:4] == ["t [s]", "q_0 [SI]", "q_1 [SI]", "u_0 [SI]"]
    assert "force_0_1 [N]" in header
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    assert table.shape == (201, len(header))
    np.testing.assert_array_equal(table[:, header.index("u_0 [SI]")], motion.u[:, 0])


def test_nothing_half_written(motion, tmp_path, monkeypatch):
    path = tmp_path / "run.csv"
    path.write_text("old")

    def fail(file, *args, **kwargs):
        file.write(b"half")
        raise OSError("disk full")

    monkeypatch.setattr(np, "savetxt", fail)
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
    for words in ("finished", "200 of 0.01 s", "contact 1", "ambiguous steps   0", "slip"):
        assert words in summary


def test_comparison(motion):
    assert motion == asp.Trajectory(**motion._parameters)
    assert motion != motion.slice(0.0, 1.0)
