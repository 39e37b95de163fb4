"""The measure, the files and the bookkeeping of the comparison in `benches/peers`."""

import signal
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import csr_matrix

FOLDER = Path(__file__).resolve().parents[1] / "benches" / "peers"
sys.path.insert(0, str(FOLDER))
engines, problem, table, worker = map(__import__, ("engines", "problem", "table", "worker"))
sys.path.remove(str(FOLDER))

ONE = csr_matrix(np.eye(3))
FAKE = """
import json, os, pathlib, sys, time
import numpy as np
out, solver = pathlib.Path(sys.argv[2]), sys.argv[sys.argv.index("--solver") + 1]
if solver == "slow":
    import signal
    signal.setitimer(signal.ITIMER_REAL, float(sys.argv[sys.argv.index("--time-limit") + 1]) / 100)
    time.sleep(60)
if solver == "broken":
    sys.exit("no such thing")
if solver != "none":
    r = {"exact": [1.0, -0.5, 0.0], "boasting": [2.0, 0.0, 0.0], "late": [1.0, -0.5, 0.0]}[solver]
    np.savez(out.with_suffix(".npz"), percussion=np.array(r))
    time = 2.0 if solver == "late" else 1.0
    found = {"label": solver, "best": time, "median": time, "residual": 0.0}
    out.with_suffix(".json").write_text(json.dumps(found))
"""


@pytest.mark.parametrize(
    ("q", "r"),
    [
        ([1.0, 0.3, 0.0], [0.0, 0.0, 0.0]),
        ([-1.0, 0.2, 0.1], [1.0, -0.2, -0.1]),
        ([-1.0, 2.0, 0.0], [1.0, -0.5, 0.0]),
    ],
    ids=["open", "stick", "slip"],
)
def test_the_measure_vanishes_at_known_solutions_only(q, r):
    one = problem.Problem(ONE, np.array(q), np.array([0.5]))
    assert problem.grade(one, np.array(r)) < 1e-15
    for change in np.array([[0.1, 0.0, 0.0], [0.0, 0.0, 0.1], [np.nan, 0.0, 0.0]]):
        assert problem.grade(one, r + change) > 1e-3


def test_the_measure_does_not_see_units():
    rng = np.random.default_rng(0)
    matrix = np.cov(rng.normal(size=(12, 40)))
    q, mu, r = rng.normal(size=12), np.full(4, 0.4), rng.normal(size=12)
    values = [
        problem.grade(problem.Problem(csr_matrix(matrix * mass), q * mass * s, mu), r * s)
        for mass, s in ((1.0, 1.0), (1e-6, 1.0), (1e4, 1e5))
    ]
    np.testing.assert_allclose(values, values[0], rtol=1e-12)


def test_the_projection_is_the_nearest_point_of_the_cone():
    rng = np.random.default_rng(1)
    mu = rng.uniform(0.05, 1.5, 300)
    z = rng.normal(size=(300, 3))
    onto = problem.projected(z, mu)
    assert (np.linalg.norm(onto[:, 1:], axis=1) <= mu * onto[:, 0] + 1e-12).all()
    rest = z - onto
    # z − P(z) is orthogonal to P(z) and lies in the polar cone.
    np.testing.assert_allclose((rest * onto).sum(axis=1), 0.0, atol=1e-12)
    assert (rest[:, 0] + mu * np.linalg.norm(rest[:, 1:], axis=1) <= 1e-12).all()


def test_files_come_back(tmp_path):
    rng = np.random.default_rng(2)
    parts = [csr_matrix(rng.normal(size=(6, 6)) * (rng.random((6, 6)) < 0.4)) for _ in range(3)]
    written = problem.Problem(parts[0], rng.normal(size=6), np.array([0.1, 0.2]), tuple(parts[1:]))
    problem.save(tmp_path / "one.npz", written)
    found = problem.load(tmp_path / "one.npz")
    for mine, other in zip(
        (written.matrix, *written.bodies), (found.matrix, *found.bodies), strict=True
    ):
        np.testing.assert_array_equal(mine.toarray(), other.toarray())
    np.testing.assert_array_equal(written.q, found.q)
    np.testing.assert_array_equal(written.mu, found.mu)
    problem.save(tmp_path / "two.npz", written._replace(bodies=None))
    assert problem.load(tmp_path / "two.npz").bodies is None


@pytest.fixture
def fake(tmp_path, monkeypatch):
    (tmp_path / "fake_worker.py").write_text(FAKE)
    monkeypatch.setattr(engines, "HERE", tmp_path)
    one = problem.Problem(ONE, np.array([-1.0, 2.0, 0.0]), np.array([0.5]))

    def ask(*solvers):
        engine = engines.Engine("fake", solvers, "fake", "fake", "fake it")
        return engines.answer(engine, solvers, tmp_path / "none", one, (1e-8, 30.0, 1), None)

    return ask


def test_the_fastest_solved_answer_counts(fake):
    assert fake("late", "exact").label == "exact"
    assert fake("exact", "late").label == "exact"
    assert fake("boasting", "late").label == "late"


def test_an_engine_does_not_grade_itself(fake):
    found = fake("boasting")
    assert found.residual > 0.1
    assert not engines.solved(found, 1e-8)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="the limit is a timer of POSIX")
def test_a_time_limit_is_told(fake):
    assert fake("slow").label == "time limit"


def test_what_went_wrong_is_told(fake):
    assert "no such thing" in fake("broken").label
    assert fake("none").label == "not for this problem"


def test_an_absent_engine_is_named_with_what_to_install(monkeypatch):
    engine = engines.Engine("nowhere", (), "no_such_module", "nowhere", "install it")
    assert engine.version() is None
    assert "install it" in engine.advice()
    monkeypatch.setenv("ASPERITY_NOWHERE_PYTHON", "/no/such/python")
    assert engine.version() is None
    assert "ASPERITY_NOWHERE_PYTHON" in engine.advice()


def test_the_summary_compares_what_both_have_solved():
    def pair(ours, theirs):
        return {"asperity": engines.Answer("", *ours), "siconos": engines.Answer("", *theirs)}

    good, bad = 1e-9, 1e-3
    rows = [
        ("a", 1, pair((1.0, 1.0, good), (4.0, 4.0, good))),
        ("b", 2, pair((4.0, 4.0, good), (4.0, 4.0, good))),
        ("c", 3, pair((1.0, 1.0, bad), (4.0, 4.0, good))),
        ("d", 4, pair((1.0, 1.0, good), (4.0, 4.0, bad))),
    ]
    text = table.summary(rows, ["asperity", "siconos"], 1e-8)
    assert "geometric mean 0.5" in text
    assert "on 2 of the 3 problems" in text
    assert "asperity: 3 of 4 solved" in text


def test_the_best_attempt_of_a_worker():
    slow, fast = {"best": 2.0, "residual": 1e-9}, {"best": 1.0, "residual": 1e-9}
    wrong = {"best": 0.1, "residual": 1e-3}
    assert worker.better(fast, slow, 1e-8)
    assert not worker.better(wrong, slow, 1e-8)
    assert worker.better(slow, wrong, 1e-8)
    assert worker.better({"best": 9.0, "residual": 1e-4}, wrong, 1e-8)
