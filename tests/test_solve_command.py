"""The command `asperity solve`: table, grading, exit codes."""

import csv

import asperity as asp
import numpy as np
import pytest
from asperity.commands.main import main
from asperity.contact import batch
from asperity.contact.batch import COLUMNS
from asperity.contact.grading import natural_map
from samples import LAWS, random_problem
from scipy.sparse import csr_array

LAW = asp.FrictionLaw.isotropic(0.5)


def problem(contacts, seed=0):
    rng = np.random.default_rng(seed)
    jacobian = rng.normal(size=(3 * contacts, 3 * contacts + 2))
    return asp.ContactProblem(
        csr_array(jacobian @ jacobian.T / contacts),
        free_velocity=rng.normal(size=3 * contacts),
        laws=LAW,
    )


@pytest.fixture
def folder(tmp_path):
    for contacts in (5, 1, 3):
        problem(contacts).save(tmp_path / f"{contacts}_contacts.npz")
    (tmp_path / "notes.txt").write_text("not a problem")
    return tmp_path


def run(capsys, *arguments):
    code = main(["solve", *map(str, arguments)])
    captured = capsys.readouterr()
    return code, captured.out.splitlines(), captured.err


def test_the_table_has_a_row_per_problem_small_ones_first(capsys, folder):
    code, lines, _ = run(capsys, folder)
    assert code == 0
    assert lines[0].split() == " ".join(COLUMNS).split()
    assert [line.split()[0] for line in lines[1:-1]] == [f"{n}_contacts" for n in (1, 3, 5)]
    for line, contacts in zip(lines[1:-1], (1, 3, 5), strict=True):
        cells = line.split()
        assert cells[1:3] == [str(contacts), "converged"]
        assert float(cells[5]) <= 1e-8
        assert float(cells[6]) > 0.0
    assert lines[-1].startswith("solved 3 of 3 to 1e-08, ")


@pytest.mark.parametrize("solver", ["exact", "prox-gauss-seidel", "newton", "proximal-point"])
def test_every_solver_can_be_chosen(capsys, folder, solver):
    code, lines, _ = run(capsys, folder, "--solver", solver, "--tolerance", 1e-6)
    assert code == 0, lines


def test_the_table_as_csv(capsys, folder):
    out = folder / "out.csv"
    assert run(capsys, folder, "--csv", out)[0] == 0
    with out.open(newline="") as file:
        rows = list(csv.reader(file))
    assert tuple(rows[0]) == COLUMNS
    assert [row[1] for row in rows[1:]] == ["1", "3", "5"]


def test_an_unsolved_problem_exits_with_1(capsys, folder):
    code, lines, _ = run(capsys, folder, "--tolerance", 1e-300, "--time-limit", 0.1)
    assert code == 1
    assert not lines[-1].startswith("solved 3")


def test_the_grader_does_not_believe_the_solver(capsys, folder, monkeypatch):
    monkeypatch.setattr(batch, "natural_map", lambda problem, percussion: 1e-3)
    code, lines, _ = run(capsys, folder)
    assert code == 1
    assert all(line.split()[2] == "off" for line in lines[1:-1])


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("absent.npz", "absent.npz"),
        ("notes.txt", "must end in .npz"),
        ("nofolder", "is not there"),
    ],
)
def test_user_errors_exit_with_2(capsys, folder, name, words):
    (folder / "notes.txt").touch()
    code, _, error = run(capsys, folder / name)
    assert code == 2
    assert words in error


def test_grader_by_hand():
    """Slip against the wrong direction: the projection of (1, -0.5, 0) - ρξ̃ onto the cone."""
    sliding = asp.ContactProblem(np.eye(3), free_velocity=[-1.0, 0.5, 3.0], laws=LAW)
    percussion = np.array([1.0, -0.5, 0.0])
    # ξ = (0, 0, 3), ξ̃_N = 1.5; moved = (-0.5, -0.5, -3): ‖T‖ = 3.041381, on the edge at
    # (−0.5 + 0.5·3.041381)/1.25 = 0.816553.
    length = np.hypot(0.5, 3.0)
    normal = (-0.5 + 0.5 * length) / 1.25
    edge = np.array([normal, *(0.5 * normal / length * np.array([-0.5, -3.0]))])
    scale = np.linalg.norm([-1.0, 0.5, 3.0])
    expected = np.linalg.norm(percussion - edge) / scale
    assert natural_map(sliding, percussion) == pytest.approx(expected, rel=1e-12)
    assert natural_map(sliding, np.full(3, np.inf)) == np.inf


def test_grader_and_core_agree_on_any_percussions():
    """Random laws, kinds of contacts and restitution, percussions that solve nothing."""
    rng = np.random.default_rng(4)
    slender = [
        asp.FrictionLaw(asp.Ellipse(1.0, 0.5, angle=0.4), asp.Ellipse(1.0, 0.01)),
        asp.FrictionLaw(asp.Superellipse(1.0, 0.5, 0.5, angle=0.4), asp.Ellipse(1.0, 0.05)),
        asp.FrictionLaw(asp.Interval(-1.0, 1.0), asp.Interval(-1.0, 0.01)),
    ]
    for _ in range(200):
        contacts = int(rng.integers(1, 12))
        made = random_problem(rng, LAWS + 3 * slender, contacts, rng.random(contacts) < 0.7)
        size = made.free_velocity.size
        made = made.replace(
            normal_restitution=rng.random(contacts),
            tangential_restitution=rng.random(contacts),
            initial_velocity=rng.normal(size=size),
        )
        percussion = rng.normal(size=size)
        assert natural_map(made, percussion) == pytest.approx(
            made.natural_map(percussion), rel=1e-9
        )
