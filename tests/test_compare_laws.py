"""Two identified laws side by side: closed forms of one coefficient, honest levels, the command."""

from __future__ import annotations

import json

import asperity as asp
import numpy as np
import pytest
from asperity import identify
from asperity.commands.main import main
from asperity.identify import IdentifiedLaw, compare_laws
from asperity.identify.estimator.identified_law import recorded_under
from asperity.identify.evidence.coefficient.turns import count_of_runs
from asperity.predict.comparison_sheet import describe_comparison
from scipy.stats import norm, t

MODELS = {"reservoir_model": "circle", "direction_model": "circle"}
ELLIPSE = asp.FrictionLaw(asp.Ellipse(0.5, 0.4), asp.Ellipse(3.0, 2.0))
DRIFT, NOISE = 0.01, 0.01


def specimen(mu, error, degrees=np.inf, **parts):
    """An isotropic law whose coefficient has a standard error, as of ln μ."""
    spread = np.array([[(error / mu) ** 2]])
    law = asp.FrictionLaw.isotropic(mu)
    freedom = (degrees, np.inf, np.inf)
    return IdentifiedLaw(
        law, values=[mu], turns=spread, degrees_of_freedom=freedom, **MODELS, **parts
    )


def measured(law, seed, turns=20):
    """A fit to turns that differ by a factor of their own, as mountings and days do."""
    random = np.random.default_rng(seed)
    phi = np.linspace(0.0, 2.0 * np.pi * turns, 60 * turns, endpoint=False)
    force = -law.force(np.stack([np.cos(phi), np.sin(phi)], axis=-1))
    factor = np.repeat(1.0 + DRIFT * random.normal(size=turns), 60)
    data = phi, force * factor[:, None] + NOISE * random.normal(size=force.shape)
    shape = "circle" if law.reservoir == law.direction else "ellipse"
    return identify.fit_law(data, reservoir=shape, direction=shape)


def called_different(law, other, count):
    found = [compare_laws(measured(law, 2 * k), measured(other, 2 * k + 1)) for k in range(count)]
    return np.mean([one.differ for one in found])


@pytest.mark.parametrize("degrees", [3.0, 9.0, np.inf])
@pytest.mark.parametrize("change", [0.001, 0.004, 0.008])
def test_one_coefficient_is_the_two_sided_test_of_welch(change, degrees):
    first, second = specimen(0.3, 0.002, degrees), specimen(0.3 + change, 0.001, 2.0 * degrees)
    found = compare_laws(first, second)
    error = np.hypot(0.002, 0.001)
    freedom = 1e9
    if np.isfinite(degrees):
        freedom = error**4 / (0.002**4 / degrees + 0.001**4 / (2.0 * degrees))
        assert found.degrees_of_freedom == pytest.approx(freedom, rel=1e-6)
    expected = 2.0 * t.sf(change / error, freedom)
    for p in (found.p_value, found.coefficient.p_value, found.reservoir.p_value):
        # Twenty thousand draws, four standard deviations.
        assert p == pytest.approx(expected, abs=4.0 * np.sqrt(expected / 20_000) + 1e-4)
    assert found.direction.p_value == 1.0
    assert found.coefficient.standard_error == pytest.approx(error, rel=1e-6)
    half = t.ppf(0.975, freedom) * error
    assert found.coefficient.half_width == pytest.approx(half, rel=0.03)
    radius = found.parameters["reservoir.radius"]
    assert (radius.value, radius.low) == pytest.approx((change, change - half), rel=1e-6)


def test_bands_hold_the_whole_curve():
    """The largest deviation of an ellipse's coefficient, against draws of its own parameters."""
    spread = np.diag([0.01, 0.02, 0.05, 0.01, 0.03]) ** 2
    models = {"reservoir_model": "ellipse", "direction_model": "ellipse"}
    values = [0.5, 0.4, 0.3, 1.5, 0.2]
    law = asp.FrictionLaw(asp.Ellipse(0.5, 0.4, angle=0.3), asp.Ellipse(1.5, 1.0, angle=0.2))
    first = IdentifiedLaw(law, values=values, turns=spread, **models)
    found = compare_laws(first, first)
    e = np.stack([np.cos(found.phi), np.sin(found.phi)], axis=-1)
    drawn = [np.linalg.norm(one.force(e), axis=1) for one in first.sample(2000, seed=1)]
    pairs = np.array(drawn[:1000]) - np.array(drawn[1000:])
    inside = (np.abs(pairs) <= found.coefficient.half_width).all(axis=1).mean()
    assert inside == pytest.approx(0.95, abs=0.025)
    assert found.p_value == 1.0
    assert not found.differ


def test_order_changes_signs_only():
    first, second = specimen(0.3, 0.002), specimen(0.31, 0.001)
    one, other = compare_laws(first, second), compare_laws(second, first)
    assert one.coefficient.difference == pytest.approx(-other.coefficient.difference)
    assert one.p_value == other.p_value


def test_laws_of_different_models_are_compared_by_their_curves():
    first, second = measured(ELLIPSE, 1), measured(ELLIPSE, 2)
    rich = identify.fit_law(second.data, reservoir="superellipse", direction="superellipse")
    found = compare_laws(first, rich)
    assert found.parameters == {}
    assert not found.differ
    worn = asp.FrictionLaw(ELLIPSE.reservoir, asp.Ellipse(3.0, 2.5))
    changed = compare_laws(first, measured(worn, 3))
    assert changed.direction.p_value < 0.01 < changed.reservoir.p_value


def test_axes_have_no_sense():
    turned = [
        IdentifiedLaw(
            asp.FrictionLaw.collinear(asp.Ellipse(0.5, 0.4, angle=angle)),
            reservoir_model="ellipse",
            direction_model="circle",
            values=[0.5, 0.4, angle],
            turns=1e-4 * np.eye(3),
        )
        for angle in (0.5 * np.pi - 0.01, -0.5 * np.pi + 0.01)
    ]
    assert compare_laws(*turned).parameters["reservoir.angle"].value == pytest.approx(0.02)


def test_axes_keep_their_names_where_a_quarter_turn_swaps_them():
    """The same law, told by its other axis: the parameters change by nothing, errors go along."""
    ellipse, direction = asp.Ellipse(0.5, 0.4, angle=0.75), asp.Ellipse(1.5, 1.0, angle=0.75)
    law = asp.FrictionLaw(ellipse, direction)
    models = {"reservoir_model": "ellipse", "direction_model": "ellipse"}
    other = 0.75 - 0.5 * np.pi
    errors, swapped = np.array([0.01, 0.02, 0.03, 0.04, 0.05]), [1, 0, 2, 3, 4]
    first, second = (
        IdentifiedLaw(law, values=values, turns=np.diag(spread**2), **models)
        for values, spread in (
            ([0.5, 0.4, 0.75, 1.5, 0.75], errors),
            ([0.4, 0.5, other, 1.0 / 1.5, other], errors[swapped]),
        )
    )
    found = compare_laws(first, second).parameters.values()
    assert [one.value for one in found] == pytest.approx(np.zeros(5), abs=1e-12)
    expected = np.sqrt(2.0) * errors * [0.5, 0.4, 1.0, 1.5, 1.0]
    assert [one.standard_error for one in found] == pytest.approx(expected)


def test_rounding_of_a_collinear_law_is_no_deflection():
    deflection = compare_laws(specimen(0.3, 0.002), specimen(0.31, 0.002)).deflection
    assert not deflection.difference.any()
    assert not deflection.half_width.any()


def test_rate_factors_are_left_out(tmp_path):
    files = tmp_path / "plain.toml", tmp_path / "falling.toml"
    plain = specimen(0.3, 0.002)
    plain.save(files[0])
    falling = plain.law.replace(rate=asp.Stribeck(0.1, ratio=0.5))
    IdentifiedLaw(falling, values=[0.3], turns=plain.turns, **MODELS).save(files[1])
    first, second = describe_comparison(files).paths
    assert np.array_equal(first[0], second[0])


def test_files_on_two_drives_keep_their_whole_names(tmp_path, monkeypatch):
    def refused(paths):
        raise ValueError("Paths don't have the same drive")

    files = [tmp_path / "new.toml", tmp_path / "worn.toml"]
    for file in files:
        specimen(0.3, 0.002).save(file)
    assert describe_comparison(files).names == ("new.toml", "worn.toml")
    monkeypatch.setattr("os.path.commonpath", refused)
    assert describe_comparison(files).names == tuple(file.as_posix() for file in files)


def test_a_common_calibration_is_left_out():
    known = {"calibration": np.array([[1e-2]])}
    first, second = specimen(0.3, 0.001, **known), specimen(0.31, 0.001, **known)
    assert not compare_laws(first, second).differ
    assert compare_laws(first, second, same_calibration=True).differ


def test_what_cannot_be_compared_is_refused():
    bare = IdentifiedLaw(asp.FrictionLaw.isotropic(0.3), values=[0.3], **MODELS)
    with pytest.raises(asp.ParameterError, match="second: has no covariance"):
        compare_laws(specimen(0.3, 0.01), bare)
    with pytest.raises(asp.ParameterError, match="first: must be a fit"):
        compare_laws(asp.FrictionLaw.isotropic(0.3), bare)
    with pytest.raises(asp.ParameterError, match="confidence"):
        compare_laws(specimen(0.3, 0.01), specimen(0.3, 0.01), confidence=1.0)


def test_levels_are_honest():
    # Of 100 at 5 %, more than 13 have a probability of 0.0005.
    assert called_different(ELLIPSE, ELLIPSE, 50) <= 0.16
    assert (
        called_different(asp.FrictionLaw.isotropic(0.4), asp.FrictionLaw.isotropic(0.4), 50) <= 0.16
    )


@pytest.mark.long
@pytest.mark.parametrize("law", [asp.FrictionLaw.isotropic(0.4), ELLIPSE])
def test_levels_over_many_seeds(law):
    assert 0.035 <= called_different(law, law, 2000) <= 0.065


@pytest.mark.long
def test_three_standard_errors_are_found():
    error = np.sqrt(2.0 * (DRIFT**2 + (NOISE / 0.4) ** 2 / 60.0) / 20.0)
    law, other = (asp.FrictionLaw.isotropic(0.4 * f) for f in (1.0, 1.0 + 3.0 * error))
    found = called_different(law, other, 2000)
    assert 0.8 <= found <= norm.sf(1.96 - 3.0) + 0.03


def test_the_command_compares_with_the_first_law(tmp_path, capsys):
    files = []
    for name, mu in (("new", 0.3), ("worn", 0.33), ("again", 0.301)):
        files.append(tmp_path / name / "law.toml")
        files[-1].parent.mkdir()
        specimen(mu, 0.002).save(files[-1])
    out = tmp_path / "out"
    assert main(["compare", *map(str, files), "--out", str(out)]) == 0
    text = capsys.readouterr().out
    assert "worn/law.toml beside new/law.toml: The laws differ" in text
    assert "again/law.toml beside new/law.toml: No difference" in text
    written = sorted(file.name for file in out.iterdir())
    assert written == ["comparison.csv", "comparison.png", "paths.png", "report.html"]
    assert main(["compare", *map(str, files[:2]), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    (one,) = printed["comparisons"]
    assert one["differs"]
    # Sliding with friction μ from 1 m/s ends after 1/(2 μ g).
    e = [np.cos(printed["launches"]), np.sin(printed["launches"])]
    for end, mu in zip(printed["ends"], (0.3, 0.33), strict=True):
        np.testing.assert_allclose(np.transpose(end), np.array(e) / (2.0 * mu * 9.81), atol=1e-5)
    assert one["end_distance"] == pytest.approx((1 / 0.3 - 1 / 0.33) / (2.0 * 9.81), abs=2e-5)
    assert one["coefficient_difference"] == pytest.approx([0.03] * 90)
    assert main(["compare", str(files[0])]) == 2
    assert "two files or more" in capsys.readouterr().err
    IdentifiedLaw(asp.FrictionLaw.isotropic(0.3), values=[0.3], **MODELS).save(files[2])
    assert main(["compare", *map(str, files)]) == 2
    assert "again" in capsys.readouterr().err


def test_the_command_says_where_laws_are_not_independent_or_of_another_load(tmp_path, capsys):
    def saved(name, mu, run, load):
        files = [(f"{run}.csv", run), ("machine.toml", "same")]
        origin = asp.Provenance(note=recorded_under(load, runs=len(load)), files=files)
        file = tmp_path / f"{name}.toml"
        specimen(mu, 0.002).replace(provenance=origin).save(file)
        return str(file)

    first = saved("first", 0.30, "a", [10.0])
    other = saved("other", 0.31, "b", [10.3])
    heavy = saved("heavy", 0.31, "c", [30.0, 10.0])
    again = saved("again", 0.31, "a", [10.0])
    assert main(["compare", first, other]) == 0
    (said,) = (line for line in capsys.readouterr().out.splitlines() if "warning" in line)
    assert said.startswith("warning: of first.toml, other.toml one run was recorded: bands leave")
    twice = [saved(f"twice_{k}", 0.3, f"t{k}", [10.0, 10.1]) for k in range(2)]
    assert main(["compare", *twice]) == 0
    assert "warning" not in capsys.readouterr().out
    assert main(["compare", first, heavy, again, "--out", str(tmp_path / "out")]) == 0
    text = capsys.readouterr().out
    assert text.count("warning: ") == 3
    assert "heavy.toml was recorded under 30, 10 N, first.toml under 10 N: a difference" in text
    assert "again.toml and first.toml both come from a.csv: they are not independent" in text
    assert "are not independent" in (tmp_path / "out" / "report.html").read_text("utf-8")
    assert main(["compare", first, other, first, "--json"]) == 0
    said, _ = json.loads(capsys.readouterr().out)["warnings"]
    assert said.startswith("first.toml holds the same law as first.toml: ")


def test_a_file_in_pieces_is_one_run(tmp_path):
    """One with a gap, which is split there, against two files."""
    law = asp.FrictionLaw.isotropic(0.3)
    machine = identify.VirtualTribometer(
        law, normal_force=10.0, turn_rate=1.0, sample_rate=200.0, turns=6, no_load_time=0.0
    )
    identify.write_raw(machine.record(), tmp_path)
    first, config = tmp_path / "run_1.csv", tmp_path / "tribometer.toml"
    config.write_text('[file]\non_defect = "split"\n\n' + config.read_text())
    lines = first.read_text().splitlines(keepends=True)
    second = tmp_path / "second.csv"
    second.write_text("".join(lines))
    middle = len(lines) // 2
    first.write_text("".join(lines[:middle] + lines[middle + 20 :]))
    for paths, runs in ([first], 1), ([first, second], 2):
        data = identify.load(paths, config)
        assert len(data.raw.recordings) == 1 + runs
        assert count_of_runs(data) == runs
        assert recorded_under(data.loads, runs=count_of_runs(data)).endswith("N by one run") == (
            runs == 1
        )


def test_changes_of_angles_are_told_in_degrees():
    first, second = (
        IdentifiedLaw(
            asp.FrictionLaw.collinear(asp.Ellipse(0.5, 0.4, angle=angle)),
            reservoir_model="ellipse",
            direction_model="circle",
            values=[0.5, 0.4, angle],
            turns=1e-4 * np.eye(3),
        )
        for angle in (0.0, np.deg2rad(3.0))
    )
    (line,) = [one for one in compare_laws(first, second).summary().splitlines() if ".angle" in one]
    half = norm.ppf(0.975) * np.rad2deg(np.sqrt(2.0) * 0.01)
    ends = f"{3.0 - half:.4g}° … {3.0 + half:.4g}°"
    assert line == f"reservoir.angle changes by 3° ({ends})."
