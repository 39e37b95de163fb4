"""Scenarios: from files to motions, bands, stability and what a law is."""

import json
import re
import shlex
from pathlib import Path

import asperity as asp
import numpy as np
import pytest
from asperity import identify, predict
from asperity._base.storage import data, toml
from asperity.commands.main import main
from asperity.predict import Scenario, describe_law, describe_stability, simulate_scenario
from asperity.predict.kinds import KINDS

LAW = asp.FrictionLaw(
    asp.Superellipse(4.99 / 9.3, 4.25 / 9.3, 2.94), asp.Superellipse(1.84, 1.19, 2.51)
)
ANGLE = np.deg2rad(32.0)
LAUNCH = 1.52 * np.array([np.cos(ANGLE), np.sin(ANGLE)])


def identified(seed, turns=5):
    machine = identify.VirtualTribometer(
        LAW, normal_force=9.3, turns=turns, sample_rate=500.0, seed=seed
    )
    return identify.fit_law(identify.process(machine.record())).identified_law


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """The file of a law that was identified."""
    path = tmp_path_factory.mktemp("law") / "measured.toml"
    identified(seed=1).save(path)
    return path


@pytest.fixture
def point(tmp_path):
    """An example of a scenario, to change."""
    return predict.write_example("sliding point", tmp_path / "point")[0]


def changed(path, old, new):
    text = path.read_text()
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))
    return path


@pytest.mark.parametrize("kind", KINDS)
def test_examples_of_all_kinds_run_and_write_what_they_announce(kind, tmp_path):
    scenario, law = predict.write_example(kind, tmp_path / "in")
    assert asp.FrictionLaw.load(law).dimension == 2
    done = simulate_scenario(scenario, out=tmp_path / "out")
    assert not done.warnings
    assert {one.name for one in (tmp_path / "out").iterdir()} == set(predict.simulation.FILES)
    assert asp.Trajectory.load(tmp_path / "out" / "run.npz") == done.run
    names = [one.name for one in done.quantities]
    assert all(name in done.summary() for name in names)
    assert len(set(names)) == len(names)
    rows = (tmp_path / "out" / "results.csv").read_text().splitlines()
    assert len(rows) == 1 + len(names)


def test_a_point_ends_where_simulate_says(point):
    done = simulate_scenario(point)
    run = asp.simulate(
        asp.SlidingPoint(0.018, law=LAW), dt=1e-4, t_end=1.0, u0=LAUNCH, until_rest=True
    )
    found = {one.name: one.value for one in done.quantities}
    assert np.allclose([found["end point e1"], found["end point e2"]], run.q[-1], atol=1e-15)
    assert found["time until rest"] == pytest.approx(run.t[-1], abs=1.1e-4)
    way = np.rad2deg(np.arctan2(run.q[-1, 1], run.q[-1, 0]))
    assert found["direction of the end point"] == pytest.approx(way)


def test_isotropic_friction_stops_a_point_after_v2_over_2_mu_g(point):
    asp.FrictionLaw.isotropic(0.3).save(point.parent / "law.toml")
    found = {one.name: one.value for one in simulate_scenario(point).quantities}
    way = found["distance of the end point from the start"]
    assert way == pytest.approx(1.52**2 / (2.0 * 0.3 * 9.81), rel=1e-3)
    assert found["direction of the end point"] == pytest.approx(32.0, abs=1e-9)


def test_both_methods_agree_to_the_step(point):
    stepped = simulate_scenario(point)
    changed(point, "step = 1e-4                 # s\n", 'method = "event-driven"\n')
    changed(point, "until_rest = true           # end when it rests\n", "")
    exact = simulate_scenario(point)
    for one, other in zip(stepped.quantities[:2], exact.quantities[:2], strict=True):
        assert one.value == pytest.approx(other.value, abs=1e-4)


def test_a_velocity_may_be_given_by_components(point):
    expected = simulate_scenario(point).quantities
    changed(point, "speed = 1.52                # m/s\n", f"velocity = {LAUNCH.tolist()}\n")
    changed(point, "direction_deg = 32.0        # or, instead of both, velocity", "# velocity")
    assert simulate_scenario(point).quantities == expected


def test_rigid_bodies_of_a_scenario_are_those_of_the_package(tmp_path):
    scenario, _ = predict.write_example("rigid bodies", tmp_path)
    found = {one.name: one.value for one in simulate_scenario(scenario).quantities}
    # The ball rolls in the end, whatever the law: 5/7 of its velocity, and less on its way there.
    assert found["end of ball, z"] == pytest.approx(0.03, abs=1e-6)
    assert 5 / 7 < found["end of ball, x"] < 1.0
    assert found["end of box, z"] == pytest.approx(0.02, abs=1e-6)


WRONG = [
    ("mass = 0.018                # kg", "mass = -1.0", "[system] mass", "positive"),
    ("mass = 0.018                # kg", "", "[system] mass", "is missing"),
    ("mass = 0.018 ", "mas = 0.018 ", "[system] mas", "did you mean 'mass'"),
    ('type = "SlidingPoint"', 'type = "SlidingPint"', "[system] type", "mean 'SlidingPoint'"),
    ('type = "SlidingPoint"', "", "[system] type", "is missing"),
    ('type = "SlidingPoint"', 'type = "LinearSystem"', "[system] type", "known are SlidingPoint"),
    ('law = "law.toml" ', 'law = "lav.toml" ', "law", "not there"),
    ('law = "law.toml" ', "# ", "law", "is missing"),
    ("direction_deg = 32.0 ", "# ", "[start] direction_deg", "is missing"),
    ("position = [0.0, 0.0]", "position = [0.0]", "[start] position", "2 numbers"),
    ("duration = 1.0 ", "duration = 0.0 ", "[run] duration", "positive"),
    ("duration = 1.0 ", "# ", "[run] duration", "is missing"),
    ("step = 1e-4 ", "step = 2.0 ", "[run] step", "longer than the duration"),
    ("step = 1e-4 ", "step = 1e-12 ", "[run] step", "at most 1e+09 steps"),
    ("step = 1e-4 ", 'method = "magic" #', "[run] method", "not known"),
    ("step = 1e-4 ", 'step = "fine" #', "[run] step", "a number"),
    ("samples = 400 ", "samples = 3 ", "[bands] samples", "at least 40"),
    ("confidence = 0.95", "confidence = 95", "[bands] confidence", "in (0, 1)"),
    ("[bands] ", "[band] ", "band", "did you mean 'bands'"),
]


@pytest.mark.parametrize(("old", "new", "key", "words"), WRONG, ids=lambda one: str(one)[:20])
def test_wrong_files_are_refused_with_line_and_key(old, new, key, words, point, tmp_path):
    changed(point, old, new)
    with pytest.raises(asp.ConfigurationError) as refused:
        simulate_scenario(point, out=tmp_path / "out")
    assert refused.value.key == key
    assert words in str(refused.value)
    assert str(point) in str(refused.value)
    if old != "mass = 0.018                # kg" or new:
        assert refused.value.line is not None or words == "is missing"
    assert not (tmp_path / "out").exists()


SPRING = """
[[system.springs]]
type = "Spring"
body = 0
point = [0.0, 0.0, 0.0]
other = 3
stiffness = 1.0
[run]"""
BODIES = [
    ('type = "Body.ball"', 'type = "Body.bal"', "did you mean 'Body.ball'"),
    ("radius = 0.03               # m", "height = 0.03", "[system.bodies[1]] height: is not known"),
    ('name = "ball"', "name = 3", "name"),
    ("half_sizes = [0.05, 0.05, 0.02] # m", "half_sizes = [0.05, 0.05]", "shape (3,)"),
    ("half_sizes = [0.05, 0.05, 0.02] # m", "half_sizes = [0.05, 0.05, -0.02]", "positive"),
    ("orientation = [0.984807753, 0.0, 0.0, 0.173648178]", "orientation = [0, 0, 0, 0]", "vanish"),
    ("axis = [1.0, 0.0, 0.0]}", "axis = [0.0, 0.0, 1.0]}", "axis"),
    ("position = [0.0, 0.0, 0.02] ", "position = [0.0, 0.0, 0.0] ", "overlap: box"),
    ("position = [0.0, 0.3, 0.03]", "position = [0.0, 0.3, 0.02]", "does by 0.01 m"),
    ("axis = [1.0, 0.0, 0.0]}", "normal = [0.0, 0.342, 0.940]}", "overlap"),
    ("body = 1\n", "body = 2\n", "[system.pairs[1]] body: must be below 2"),
    ('"Plane"}', '"Plane", body = 2}', "[system.pairs[1].plane] body: must be below 2"),
    ("[run]", SPRING, "[system.springs[0]] other: must be below 2"),
    ("[run]", "[start]\nspeed = 1.0\n[run]", "each body has its own"),
]


@pytest.mark.parametrize(("old", "new", "words"), BODIES, ids=lambda one: str(one)[:20])
def test_wrong_bodies_are_refused_in_the_words_of_the_file(old, new, words, tmp_path):
    scenario, _ = predict.write_example("rigid bodies", tmp_path)
    changed(scenario, old, new)
    with pytest.raises(asp.ConfigurationError, match=r"scenario\.toml") as refused:
        simulate_scenario(scenario)
    assert words in str(refused.value)
    assert refused.value.line is not None


def test_bands_hold_the_scatter_of_the_law(point, measured, tmp_path):
    changed(point, "step = 1e-4 ", "step = 1e-3 ")
    done = simulate_scenario(point, law=measured, bands=True, out=tmp_path)
    bands = done.bands
    truth = asp.simulate(
        asp.SlidingPoint(0.018, law=LAW), dt=1e-4, t_end=1.0, u0=LAUNCH, until_rest=True
    )
    assert len(bands.draws) == 400
    assert not bands.failed
    assert not bands.doubts
    # The k-th of 400 sorted draws is the quantile k/401: 0.025 lies between the 10th and 11th.
    lowest, highest = np.sort(bands.draws, axis=0)[9:11], np.sort(bands.draws, axis=0)[-11:-9]
    np.testing.assert_allclose(bands.low, [0.975, 0.025] @ lowest, rtol=1e-12)
    np.testing.assert_allclose(bands.high, [0.025, 0.975] @ highest, rtol=1e-12)
    assert bands.region.contains(truth.q[-1])
    assert not bands.region.contains(truth.q[-1] + [0.005, 0.0])
    inside = np.mean([bands.region.contains(end) for end in bands.ends])
    assert inside == pytest.approx(0.95, abs=0.005)
    # First order: the scatter of the end points is that of the parameters times their derivatives.
    law = asp.LawFile.load(measured)
    step = 0.1 * law.standard_errors
    scenario = Scenario.load(point, law=measured)
    columns = []
    for i in range(len(law.values)):
        ends = []
        for sign in (1.0, -1.0):
            values = law.values.copy()
            values[i] += sign * step[i]
            run = scenario.run({"law.toml": law.law_of(values)})
            # The time until rest is resolved to a step, the place to its square.
            ends.append(run.q[-1])
        columns.append((ends[0] - ends[1]) / (2.0 * step[i]))
    sizes = law.standard_errors
    correlation = law.covariance / np.sqrt(np.outer(*[np.diag(law.covariance)] * 2))
    jacobian = np.stack(columns, axis=1) * sizes
    linear = np.sqrt(np.diag(jacobian @ correlation @ jacobian.T))
    assert np.allclose(bands.ends.std(axis=0, ddof=1), linear, rtol=0.25)
    assert "95 % from" in done.summary()
    assert (tmp_path / "draws.csv").read_text().count("\n") == 401


# Events of many contacts take minutes.
LONG = {("rigid bodies", "event-driven"), ("sliding disk", "event-driven")}
CASES = [
    pytest.param(kind, method, marks=[pytest.mark.long] * ((kind, method) in LONG))
    for kind in KINDS
    for method in ("time stepping", "event-driven")
]


@pytest.mark.parametrize(("kind", "method"), CASES)
def test_draws_are_the_motions_of_single_runs(kind, method, measured, tmp_path):
    """Bands come from ensembles, in lanes where these fit: to rounding they change nothing."""
    path, _ = predict.write_example(kind, tmp_path)
    text = re.sub(r"samples = \d+", "samples = 40", path.read_text())
    text = re.sub(r"step = \S+", "step = 2e-3", text).replace("duration = 20.0", "duration = 2.0")
    if method == "event-driven":
        text = re.sub(r"(step|until_rest) = .*\n", "", text)
        text = text.replace("[run]", '[run]\nmethod = "event-driven"')
    path.write_text(text)
    scenario = Scenario.load(path, law=measured)
    done = simulate_scenario(path, law=measured, bands=True)
    laws = scenario.laws["law.toml"].sample(40, seed=scenario.bands.seed)
    assert not done.bands.failed
    for i in (0, 17, 39):
        single = scenario.quantities(scenario.run({"law.toml": laws[i]}))
        expected = [one.value for one in single]
        np.testing.assert_allclose(done.bands.draws[i], expected, rtol=1e-7, atol=1e-8)


def test_draws_that_take_longer_than_expected_are_computed_to_their_end(
    measured, tmp_path, monkeypatch
):
    scenario, _ = predict.write_example("sliding disk", tmp_path)
    text = scenario.read_text().replace("samples = 200", "samples = 40")
    scenario.write_text(text.replace("step = 1e-4", "step = 2e-3"))
    expected = simulate_scenario(scenario, law=measured, bands=True).bands.draws
    # All draws are cut at half of the time until rest with the law of the file.
    monkeypatch.setattr(predict.bands, "_LONGER", 0.5)
    found = simulate_scenario(scenario, law=measured, bands=True).bands.draws
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_bands_need_a_law_with_a_covariance(point):
    with pytest.raises(asp.ParameterError, match="covariance"):
        simulate_scenario(point, bands=True)


def test_the_same_seed_gives_the_same_bands(point, measured):
    changed(point, "samples = 400 ", "samples = 40 ")
    one, other = (simulate_scenario(point, law=measured, bands=True).bands for _ in range(2))
    assert np.array_equal(one.draws, other.draws)


def test_a_stray_draw_does_not_shape_the_region(point, tmp_path):
    """Two turns have one degree of freedom: a few of the laws that are drawn are far off."""
    path = tmp_path / "two_turns.toml"
    identified(seed=1, turns=2).save(path)
    changed(point, "step = 1e-4 ", "step = 1e-3 ")
    bands = simulate_scenario(point, law=path, bands=True).bands
    inside = np.array([bands.region.contains(end) for end in bands.ends])
    assert inside.mean() == pytest.approx(0.95, abs=0.005)
    stray = np.linalg.norm(bands.ends - bands.region.centre, axis=1).max()
    sizes = np.sqrt(np.linalg.eigvalsh(bands.region.covariance)) * bands.region.radius
    assert stray > 0.02  # m
    assert sizes.max() < 0.003
    # The ellipse has about the shape of the end points that it holds.
    expected = np.sqrt(np.linalg.eigvalsh(np.cov(bands.ends[inside].T))) * bands.region.radius
    assert np.allclose(sizes, expected, rtol=0.05)


def test_an_interval_of_an_angle_does_not_go_round_the_circle(point, measured):
    """A point that slides along -e1 ends at 180 degrees, or at -180."""
    changed(point, "direction_deg = 32.0 ", "direction_deg = 180.0 ")
    changed(point, "samples = 400 ", "samples = 40 ")
    done = simulate_scenario(point, law=measured, bands=True)
    (i,) = [k for k, one in enumerate(done.quantities) if one.name == "direction of the end point"]
    low, high = done.bands.low[i], done.bands.high[i]
    assert low <= done.quantities[i].value <= high
    assert high - low < 1.0


def test_draws_that_do_not_come_to_rest_are_told(point, measured):
    nominal = simulate_scenario(point, law=measured)
    rest = nominal.quantities[-1].value
    changed(point, "duration = 1.0 ", f"duration = {rest + 2e-4:.4f} ")
    changed(point, "samples = 400 ", "samples = 40 ")
    done = simulate_scenario(point, law=measured, bands=True)
    assert not done.scenario.doubts(done.run)
    assert 0 < len(done.bands.doubts) < 40
    (warning,) = done.warnings
    assert f"{len(done.bands.doubts)} drawn law" in warning
    assert "does not come to rest" in warning


@pytest.mark.long
def test_the_band_of_the_end_point_holds_the_truth_as_often_as_it_says(point):
    """100 measurements of one law: 95 % of the regions should hold its end point."""
    changed(point, "samples = 400 ", "samples = 200 ")
    truth = asp.simulate(
        asp.SlidingPoint(0.018, law=LAW), dt=1e-4, t_end=1.0, u0=LAUNCH, until_rest=True
    ).q[-1]
    held = 0
    for seed in range(100):
        path = point.parent / "measured.toml"
        identified(seed).save(path)
        held += simulate_scenario(point, law=path, bands=True).bands.region.contains(truth)
    assert 90 <= held <= 99


def test_a_run_that_does_not_end_in_time_is_doubtful(point, capsys):
    changed(point, "duration = 1.0 ", "duration = 0.1 ")
    assert main(["simulate", str(point)]) == 1
    assert "does not come to rest within 0.1 s" in capsys.readouterr().out
    # That the file does not ask to end at rest does not make it an end point.
    changed(point, "until_rest = true ", "until_rest = false ")
    assert main(["simulate", str(point)]) == 1
    assert "does not come to rest within 0.1 s" in capsys.readouterr().out


def test_a_step_as_long_as_the_motion_is_doubtful(point, capsys):
    changed(point, "step = 1e-4 ", "step = 0.05 ")
    assert main(["simulate", str(point)]) == 1
    assert "give a shorter step" in capsys.readouterr().out


def test_a_point_that_starts_at_rest_stays_there(point):
    changed(point, "speed = 1.52 ", "speed = 0.0 ")
    done = simulate_scenario(point)
    assert not done.warnings
    assert [one.value for one in done.quantities[:3]] == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("until_rest", [True, False])
def test_time_until_rest_is_not_that_of_the_run(point, until_rest):
    expected = simulate_scenario(point).quantities[-1]
    if until_rest:
        changed(point, "step = 1e-4                 # s\n", 'method = "event-driven"\n')
        changed(point, "until_rest = true           # end when it rests\n", "")
    else:
        changed(point, "until_rest = true ", "until_rest = false ")
    done = simulate_scenario(point)
    assert done.run.t[-1] == pytest.approx(1.0)
    assert done.quantities[-1].name == expected.name == "time until rest"
    assert done.quantities[-1].value == pytest.approx(expected.value, abs=5e-4)


def test_contacts_with_laws_of_their_own(tmp_path, capsys):
    scenario, law = predict.write_example("rigid bodies", tmp_path)
    expected = {one.name: one.value for one in simulate_scenario(scenario).quantities}
    asp.FrictionLaw.isotropic(0.8).save(tmp_path / "law")
    changed(scenario, 'type = "BoxPlane"\n', 'type = "BoxPlane"\nlaw = "law"\n')
    found = {one.name: one.value for one in simulate_scenario(scenario).quantities}
    assert found["end of ball, x"] == pytest.approx(expected["end of ball, x"], abs=1e-9)
    # The box stops after v²/2μg.
    way = np.hypot(found["end of box, x"], found["end of box, y"])
    assert way == pytest.approx((1.0 + 0.25) / (2.0 * 0.8 * 9.81), rel=1e-2)
    # When every contact has its own law, none is needed for all of them, and none is replaced.
    changed(scenario, 'type = "SpherePlane"\n', f'type = "SpherePlane"\nlaw = "{law.name}"\n')
    changed(scenario, 'law = "law.toml"            #', "#")
    again = {one.name: one.value for one in simulate_scenario(scenario).quantities}
    assert again == found
    assert main(["simulate", str(scenario), "--law", str(law)]) == 2
    assert "--law: does not apply" in capsys.readouterr().err
    # The line is that of the contact whose law is not there.
    changed(scenario, 'law = "law"\n', 'law = "lav"\n')
    with pytest.raises(asp.ConfigurationError, match="not there") as refused:
        simulate_scenario(scenario)
    assert refused.value.key == "[system.pairs[0]] law"


@pytest.mark.parametrize(("turn", "height"), [([1, 0, 0, 0], 0.05), ([1, 0, 1, 0], 0.03)])
def test_a_cylinder_stands_or_lies_on_a_moving_plane(turn, height, tmp_path):
    """Its speed becomes that of the belt under it."""
    scenario, _ = predict.write_example("rigid bodies", tmp_path)
    head = scenario.read_text().split("[[system.bodies]]")[0]
    scenario.write_text(
        head
        + f"""
[[system.bodies]]
type = "Body.cylinder"
mass = 1.0
radius = 0.03
height = 0.1
position = [0.0, 0.0, {height}]
orientation = {turn}

[[system.pairs]]
type = "PointPlane.cylinder"
body = 0
radius = 0.03
height = 0.1
plane = {{type = "Plane", velocity = [0.1, 0.0]}}

[run]
duration = 0.5
step = 1e-3
"""
    )
    done = simulate_scenario(scenario)
    assert not done.warnings
    assert done.run.u[-1, 0] == pytest.approx(0.1, abs=1e-6)
    changed(scenario, f"{height}]", f"{0.5 * height}]")
    with pytest.raises(asp.ConfigurationError, match="overlap"):
        simulate_scenario(scenario)


def test_results_name_the_file_of_the_law_that_was_used(point, measured, capsys):
    assert main(["simulate", str(point), "--law", str(measured), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["laws"] == {"law.toml": str(measured)}


def test_what_files_hold_of_systems_is_a_scenario(point):
    """The section of a system is what files of runs hold of it."""
    expected = simulate_scenario(point).quantities
    table = data.typed(asp.SlidingPoint(0.018, law=LAW), "system", asp.runs.origin.KNOWN)
    text = point.read_text()
    end = text[text.index("[start]") :]
    point.write_text(toml.text({"system": table}) + "\n" + end)
    assert simulate_scenario(point).quantities == expected


@pytest.mark.parametrize("kind", KINDS)
def test_scenarios_refuse_laws_of_the_line(kind, tmp_path):
    scenario, law = predict.write_example(kind, tmp_path)
    asp.FrictionLaw.isotropic(0.3, dimension=1).save(law)
    with pytest.raises(asp.ConfigurationError, match="dimension"):
        simulate_scenario(scenario)


def test_from_measured_forces_to_a_predicted_path_in_the_shell(tmp_path, monkeypatch, capsys):
    """The commands of the README: a raw CSV, a law with its uncertainty, a path with its band."""
    readme = (Path(__file__).resolve().parents[1] / "README.md").read_text()
    section = readme[readme.index("## From the law to a prediction") :]
    commands = re.findall(r"^    asperity (.*)$", section[: section.index("```")], re.MULTILINE)
    assert [one.split()[0] for one in commands] == ["identify", "init", "simulate"]
    monkeypatch.chdir(tmp_path)
    machine = identify.VirtualTribometer(LAW, normal_force=9.3, turns=4, sample_rate=500.0, seed=2)
    machine.write("campaign")
    for command in commands[:-1]:
        assert main(shlex.split(command)) == 0
    capsys.readouterr()
    assert main([*shlex.split(commands[-1]), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    truth = asp.simulate(
        asp.SlidingPoint(0.018, law=LAW), dt=1e-4, t_end=1.0, u0=LAUNCH, until_rest=True
    )
    for one, value in zip(found["quantities"][:2], truth.q[-1], strict=True):
        assert one["low"] < value < one["high"]
        assert one["high"] - one["low"] < 0.01
    assert found["draws"] == 400
    assert (tmp_path / "C" / "report.html").stat().st_size > 10_000


def test_law_says_what_a_law_is(measured, tmp_path, capsys):
    assert main(["law", str(measured), "--out", str(tmp_path / "law")]) == 0
    printed = capsys.readouterr().out
    for words in ("reservoir.exponent", "largest friction coefficient", "dissipative", "yes"):
        assert words in printed
    assert {one.name for one in (tmp_path / "law").iterdir()} == set(predict.law_sheet.FILES)
    sheet = describe_law(measured)
    law = asp.FrictionLaw.load(measured)
    columns = sheet.coefficients(30.0)
    phi = np.deg2rad(columns["sliding direction [deg]"])
    slip = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    force = np.linalg.norm(law.force(slip), axis=-1)
    assert np.allclose(columns["friction coefficient [-]"], force, rtol=1e-14)
    along = columns["friction coefficient [-]"] * np.cos(
        np.deg2rad(columns["deflection of the force [deg]"])
    )
    assert np.allclose(columns["resistance against sliding [-]"], along, rtol=1e-12)
    assert main(["law", str(measured), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["parameters"].keys() == set(law_names(measured))


def law_names(path):
    return identify.IdentifiedLaw.load(path).names


def test_stability_names_the_critical_directions(tmp_path, capsys):
    path = tmp_path / "tilted.toml"
    law = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))
    law.save(path)
    assert main(["stability", str(path), "--out", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr().out
    assert "44.11° to 75.89°" in printed
    assert "unstable by anisotropy alone" in printed
    assert {one.name for one in (tmp_path / "out").iterdir()} == set(predict.stability_sheet.FILES)
    sheet = describe_stability(path)
    at_50 = sheet.growth[50]
    assert np.rad2deg(sheet.chart.phi[50]) == pytest.approx(50.0)
    assert at_50 == pytest.approx(0.381927, abs=1e-6)  # of Fig. 17's belt, docs/stability.md
    assert main(["stability", str(path), "--mass", "-1"]) == 2
    assert "--mass" in capsys.readouterr().err


def test_directions_in_which_d_is_flat_do_not_hide_the_growth_in_others(tmp_path):
    path = tmp_path / "flat.toml"
    reservoir = asp.Ellipse(30.0, 10.0, angle=np.pi / 6)
    asp.FrictionLaw(reservoir, asp.Superellipse(3.0, 1.0, 4.0)).save(path)
    sheet = describe_stability(path)
    assert np.isnan(sheet.growth).any()
    assert sheet.fastest == np.nanmax(sheet.growth) > 0.0
    assert "exp(" in sheet.text()
    assert sheet.unstable


def test_an_associated_law_is_stable(tmp_path):
    path = tmp_path / "law.toml"
    asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.3)).save(path)
    sheet = describe_stability(path)
    assert not sheet.unstable
    assert sheet.growth.max() == 0.0
    assert "no direction of sliding unstable" in sheet.verdict()
    # Where D = C, the sliding is along the normal of C at the force.
    np.testing.assert_allclose(sheet.margins, 0.5 * np.pi, atol=1e-6)
    tilted = asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.pi / 6), asp.Ellipse(3.0, 1.0))
    tilted.save(path)
    sheet = describe_stability(path)
    critical = np.zeros(len(sheet.margins), dtype=bool)
    for a, b in sheet.directions:
        critical |= (sheet.chart.phi - np.pi - a) % (2.0 * np.pi) < b - a
    np.testing.assert_array_equal(sheet.margins < 0.0, critical)
    assert "margin to instability by anisotropy" in sheet.text()


def test_laws_that_are_not_planar_are_refused(tmp_path, capsys):
    path = tmp_path / "line.toml"
    asp.FrictionLaw.isotropic(0.3, dimension=1).save(path)
    for verb in ("law", "stability"):
        assert main([verb, str(path)]) == 2
        said = capsys.readouterr().err
        assert "must be planar" in said
        # The law is no option of these commands.
        assert "--law" not in said


def test_coefficients_are_those_without_the_dependence_on_the_speed(tmp_path):
    path = tmp_path / "law.toml"
    LAW.replace(rate=asp.Stribeck(0.1, ratio=0.5)).save(path)
    sheet = describe_law(path)
    found = sheet.coefficients(90.0)["friction coefficient [-]"]
    assert found[0] == pytest.approx(4.99 / 9.3)
    assert "dependence on the speed" in sheet.text()


def test_what_is_known_of_an_engines_law_is_said(tmp_path, capsys):
    path = tmp_path / "law.toml"
    law = asp.FrictionLaw.like("mujoco", friction=(0.4, 0.6), frame=[0, 0, 1, 0, 1, 0, -1, 0, 0])
    law.save(path)
    assert main(["law", str(path), "--out", str(tmp_path / "out")]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    report = law.report
    for words in ("like the engine: mujoco, version 4.0.0", report.axes, report.deviation, "90°"):
        assert words in printed
    assert "what it does otherwise" in (tmp_path / "out" / "report.html").read_text("utf-8")
    assert main(["law", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["report"]["creep"] == report.creep
    # Laws from forces have a report, too; laws of sets have none.
    asp.FrictionLaw.tensor([[0.5, 0.0], [0.0, 0.4]]).save(path)
    assert "report" not in describe_law(path).data()
    phi = np.linspace(0.0, 2.0 * np.pi, 90, endpoint=False)
    forces = 0.3 * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    asp.FrictionLaw.from_samples(phi, force=forces).save(path)
    assert "90 directions" in describe_law(path).text()


def test_both_sheets_of_a_law_agree_on_stability(tmp_path):
    """An associated law whose force falls with the speed makes steady sliding unstable."""
    path, falling = tmp_path / "law.toml", asp.Stribeck(1.0, ratio=0.5)
    for rate in (None, falling):
        asp.FrictionLaw.isotropic(0.5).replace(rate=rate).save(path)
        said = describe_law(path).text()
        assert describe_stability(path).unstable is (rate is not None)
        assert ("steady sliding is stable" in said) is (rate is None)
        assert ("the dependence on the speed may" in said) is (rate is not None)


def test_init_offers_the_kinds_there_are(tmp_path, capsys):
    for kind in KINDS:
        folder = tmp_path / f"a {kind}"
        assert main(["init", "--kind", kind, "--out", str(folder)]) == 0
        # The command that is printed can be pasted.
        command = capsys.readouterr().out.splitlines()[-1].removeprefix("now: asperity ")
        assert shlex.split(command) == ["simulate", str(folder / "scenario.toml")]


def test_a_folder_is_no_law(tmp_path, capsys):
    assert main(["init", "--kind", "sliding point", "--out", str(tmp_path / "B")]) == 0
    scenario = str(tmp_path / "B" / "scenario.toml")
    given = ["--law", str(tmp_path / "B"), "--out", str(tmp_path / "C")]
    assert main(["simulate", scenario, *given]) == 2
    assert "is a folder: name the law's file in it" in capsys.readouterr().err


def test_init_overwrites_nothing(tmp_path, capsys):
    assert main(["init", "--kind", "sliding disk", "--out", str(tmp_path)]) == 0
    before = (tmp_path / "scenario.toml").read_text()
    assert main(["init", "--out", str(tmp_path)]) == 2
    assert "scenario.toml" in capsys.readouterr().err
    assert (tmp_path / "scenario.toml").read_text() == before


def test_examples_say_what_every_line_means():
    for kind in KINDS.values():
        assert kind.example.startswith("# ")
        assert Path("law.toml").name in kind.example


def rewritten(scenario, *pairs):
    """Write a scenario anew with other words in it."""
    text = scenario.read_text()
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    scenario.write_text(text)
    return scenario


def test_a_coarse_step_is_doubtful_whatever_is_kept(tmp_path):
    scenario, _ = predict.write_example("sliding point", tmp_path)
    coarse = rewritten(scenario, ("step = 1e-4", "step = 5e-3\noutput = 3.0"), ("until_rest", "# "))
    assert any("too coarse" in one for one in simulate_scenario(coarse).warnings)
    once = rewritten(scenario, ("step = 5e-3\noutput = 3.0", "step = 0.3"))
    assert any("too coarse" in one for one in simulate_scenario(once).warnings)


def test_a_short_slide_is_doubtful_however_little_it_moves(tmp_path):
    """It slides for 4 nm and four steps."""
    scenario, _ = predict.write_example("sliding point", tmp_path)
    changes = ("speed = 1.52", "speed = 2e-4"), ("step = 1e-4", "step = 1e-5")
    done = simulate_scenario(rewritten(scenario, *changes))
    assert np.linalg.norm(done.run.q[-1]) < 1e-8
    assert any("it slides for" in one for one in done.warnings)


@pytest.mark.parametrize(("step", "output"), [("1e-3", 1e-3), ("2e-5", 5e-5)])
def test_all_steps_are_kept_up_to_twenty_thousand(step, output, tmp_path):
    scenario, _ = predict.write_example("sliding point", tmp_path)
    options = Scenario.load(rewritten(scenario, ("step = 1e-4", f"step = {step}"))).options
    assert options.output == pytest.approx(output)


def test_the_first_contact_whose_law_is_missing_is_named(tmp_path):
    scenario, _ = predict.write_example("rigid bodies", tmp_path)
    pairs = (f'type = "{kind}"' for kind in ("BoxPlane", "SpherePlane"))
    rewritten(scenario, *((pair, f'{pair}\nlaw = "lav.toml"') for pair in pairs))
    with pytest.raises(asp.ConfigurationError, match="not there") as refused:
        Scenario.load(scenario)
    assert refused.value.key == "[system.pairs[0]] law"


def test_laws_of_different_files_are_drawn_independently(measured, tmp_path):
    """Two equal boxes, launched side by side, each on a law of its own file."""
    scenario, law = predict.write_example("rigid bodies", tmp_path)
    for name in (law.name, "other.toml"):
        (tmp_path / name).write_text(measured.read_text())
    box = '[[system.bodies]]\ntype = "Body.box"\nmass = 1.0\nhalf_sizes = [0.05, 0.05, 0.02]\n'
    contact = '[[system.pairs]]\ntype = "BoxPlane"\nhalf_sizes = [0.05, 0.05, 0.02]\n'
    text = f'law = "{law.name}"\n[system]\ntype = "RigidBodies"\n'
    for i in range(2):
        text += f"{box}position = [0.0, {i}.0, 0.02]\nvelocity = [1.0, 0.5, 0.0]\n"
    text += f'{contact}body = 0\nplane = {{type = "Plane"}}\n'
    text += f'{contact}body = 1\nplane = {{type = "Plane"}}\nlaw = "other.toml"\n'
    text += "[run]\nduration = 0.4\nstep = 2e-3\n[bands]\nsamples = 40\n"
    scenario.write_text(text)
    done = simulate_scenario(scenario, bands=True)
    names = [one.name for one in done.quantities]
    ends = [done.bands.draws[:, names.index(f"end of body {i}, x")] for i in range(2)]
    assert abs(np.corrcoef(*ends)[0, 1]) < 0.5  # of 40 independent draws, three standard deviations


def test_a_type_that_is_no_text_is_named_with_its_line(tmp_path):
    scenario, _ = predict.write_example("sliding point", tmp_path)
    rewritten(scenario, ('type = "SlidingPoint"', 'type = ["SlidingPoint"]'))
    with pytest.raises(asp.ConfigurationError, match=r"line 7: \[system\] type: must be a text"):
        predict.Scenario.load(scenario)


def test_a_law_of_a_contact_is_its_own_whatever_the_other_file_is_called(tmp_path, monkeypatch):
    beside, elsewhere = tmp_path / "beside", tmp_path / "elsewhere"
    elsewhere.mkdir()
    scenario, _ = predict.write_example("rigid bodies", beside)
    text = scenario.read_text()
    pair = text.index("[[system.pairs]]") + len("[[system.pairs]]")
    scenario.write_text(text[:pair] + '\nlaw = "own.toml"' + text[pair:])
    asp.FrictionLaw.isotropic(0.9).save(beside / "own.toml")
    asp.FrictionLaw.isotropic(0.05).save(elsewhere / "own.toml")
    rewritten(scenario, ('law = "law.toml"', "# "))
    monkeypatch.chdir(elsewhere)
    system, _ = predict.Scenario.load(scenario, law="own.toml").setup()
    own, *others = [pair.law.reservoir for pair in system.pairs]
    assert own == asp.Disk(0.9)
    assert others == [asp.Disk(0.05)] * len(others) != []
