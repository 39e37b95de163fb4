"""How far long work is, and what it tells the logger."""

import logging
import sys

import asperity as asp
import numpy as np
import pytest
from asperity import identify, mechanisms, predict, track
from asperity.identify.campaigns.forces import STAGES, identify_campaign

LAW = asp.FrictionLaw.isotropic(0.5)
BLOCK = asp.SlidingPoint(1.0, law=LAW)
PHI = np.linspace(0.0, 12.0 * np.pi, 3000, endpoint=False)
SLIP = np.stack([np.cos(PHI), np.sin(PHI)], axis=-1)
NOISE = 0.005 * np.random.default_rng(0).normal(size=SLIP.shape)
FORCES = (PHI, -LAW.force(SLIP) + NOISE)
FRAME = np.full((60, 80, 3), 120, dtype=np.uint8)
FRAME[20:40, 30:50] = 200, 30, 30


@pytest.fixture(scope="module", autouse=True)
def campaign(tmp_path_factory):
    """Write two runs of one turn."""
    folder = tmp_path_factory.mktemp("campaign")
    machine = identify.VirtualTribometer(
        LAW, normal_force=10.0, turns=1.2, sample_rate=60.0, no_load_time=0.0
    )
    first, second = (machine.replace(seed=seed).record() for seed in (1, 2))
    both = first.replace(recordings=[*first.recordings, *second.recordings])
    CAMPAIGN[:] = [folder / name for name in identify.write_raw(both, folder)]
    scenario, law = predict.write_example("sliding point", folder / "predict")
    scenario.write_text(scenario.read_text().replace("samples = 400", "samples = 40"))
    identify.fit_law(FORCES, reservoir="circle", direction="circle").save_law(law)
    yield
    CAMPAIGN.clear()


CAMPAIGN = []
LONG = {
    "simulate": lambda **o: asp.simulate(BLOCK, dt=1e-6, t_end=0.5, sample_every=0.5, **o),
    "integrate": lambda **o: asp.integrate(
        asp.LinearSystem(1.0, stiffness=1.0), t_end=2e4, q0=[1.0], sample_every=1e4, **o
    ),
    "limit_cycle": lambda **o: asp.limit_cycle(mechanisms.stribeck_block(), **o),
    "bifurcation_diagram": lambda **o: asp.bifurcation_diagram(
        mechanisms.stribeck_block, parameter="belt_velocity", values=[0.2, 0.3], **o
    ),
    "growth_chart": lambda **o: asp.growth_chart(
        asp.MassOnBelt(
            1.0,
            stiffness=1.0,
            law=asp.FrictionLaw(asp.Ellipse(3.0, 1.0), asp.Ellipse(3.0, 1.0)),
            normal_force=1.0,
            belt_velocity=[1.0, 0.0],
        ),
        phi=np.linspace(0.0, 3.0, 90),
        zeta=np.linspace(0.0, 3.0, 100),
        **o,
    ),
    "read_raw": lambda **o: identify.read_raw(CAMPAIGN[:2], CAMPAIGN[-1], **o),
    "identify_campaign": lambda **o: identify_campaign(
        CAMPAIGN[:2],
        CAMPAIGN[-1],
        CAMPAIGN[-1].parent / "out",
        reservoir="circle",
        direction="circle",
        **o,
    ),
    "compare_models": lambda **o: identify.compare_models(
        FORCES, pairs=[("circle", "circle"), ("ellipse", "circle")], **o
    ),
    "fit_law": lambda **o: identify.fit_law(FORCES, reservoir="best", direction="circle", **o),
    "track_mark": lambda **o: track.track_mark(
        [FRAME] * 3, fps=500.0, scene=track.PlaneView.from_scale(1e-3), **o
    ),
}
for bands in (False, True):
    LONG[f"simulate_scenario, bands={bands}"] = lambda bands=bands, **o: predict.simulate_scenario(
        CAMPAIGN[-1].parent / "predict" / "scenario.toml", bands=bands, **o
    ).data()
COUNTED = (
    "simulate_scenario, bands=True",
    "bifurcation_diagram",
    "growth_chart",
    "read_raw",
    "identify_campaign",
    "compare_models",
    "fit_law",
    "track_mark",
)


@pytest.mark.parametrize("name", LONG)
def test_progress_is_a_function_of_what_is_done_and_all(name):
    calls = []
    LONG[name](progress=lambda done, whole: calls.append((done, whole)))
    done = [one for one, _ in calls]
    assert all(0 <= one <= whole for one, whole in calls)
    if name in COUNTED:
        assert done == sorted(done)
        assert calls[-1][0] == calls[-1][1] > 1
    elif name != "limit_cycle":
        assert calls


@pytest.mark.parametrize("name", LONG)
def test_true_shows_a_bar(name, capsys):
    pytest.importorskip("tqdm")
    LONG[name](progress=True)
    shown = capsys.readouterr().err
    assert "/s" in shown
    assert "100%" in shown or name not in COUNTED


@pytest.mark.parametrize("name", LONG)
@pytest.mark.parametrize("wrong", [False, 3, "yes"])
def test_other_values_are_refused_by_name(name, wrong):
    with pytest.raises(asp.ParameterError, match="progress: must be True, None or a function"):
        LONG[name](progress=wrong)


def test_files_are_counted_one_by_one(capsys):
    for name, whole in (("read_raw", 2), ("identify_campaign", 4)):
        calls, names = [], []
        options = {"announce": names.append} if name == "identify_campaign" else {}
        LONG[name](progress=lambda *call, to=calls: to.append(call), **options)
        assert {one for _, one in calls} == {whole}
        done = sorted({one for one, _ in calls})
        assert done == ([0, 0.5, 1, 2, 3, 4] if options else [0, 1, 2])
        assert names == (list(STAGES) if options else [])


def test_without_tqdm_true_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    with pytest.raises(asp.ParameterError, match="pip install tqdm"):
        LONG["simulate"](progress=True)


@pytest.mark.parametrize("name", LONG)
def test_progress_changes_no_result(name):
    assert LONG[name](progress=lambda *_: None) == LONG[name]()


def test_samples_are_an_interval_apart_in_both_integrators():
    stepped = asp.simulate(BLOCK, dt=1e-3, t_end=0.1, u0=[1.0, 0.0], sample_every=0.02)
    exact = asp.integrate(BLOCK, t_end=0.1, u0=[1.0, 0.0], sample_every=0.02)
    np.testing.assert_allclose(stepped.t, exact.t, rtol=1e-12)
    for wrong in (0.0005, 0.0015, -0.02, np.nan):
        with pytest.raises(asp.ParameterError) as refused:
            asp.simulate(BLOCK, dt=1e-3, t_end=0.1, sample_every=wrong)
        assert refused.value.argument == "sample_every"


def messages(caplog):
    assert {record.name for record in caplog.records} == {"asperity"}
    return [record.getMessage() for record in caplog.records]


def test_steps_that_did_not_converge_are_logged(caplog):
    weak = asp.ProxJacobi(r=1e8, max_iterations=3)
    belt = asp.MassOnBelt(1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=[0.1, 0.0])
    with caplog.at_level(logging.WARNING, logger="asperity"):
        run = asp.simulate(belt, dt=1e-2, t_end=5.0, solver=weak, on_failure="record")
    assert run.failed_steps
    (message,) = messages(caplog)
    assert f"{run.failed_steps} of {run.steps} steps did not converge" in message


def test_the_library_shows_nothing_by_itself(capsys):
    LONG["fit_law"]()
    assert capsys.readouterr() == ("", "")
