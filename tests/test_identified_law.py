"""Laws with the covariance of their parameters: in files, and drawn at random."""

import csv
import hashlib
import math
import re

import asperity as asp
import numpy as np
import pytest
from asperity.commands.main import main
from asperity.identify import (
    CircleDirection,
    FourierDirection,
    FourierReservoir,
    IdentifiedLaw,
    SuperellipseReservoir,
    VirtualTribometer,
    fit_law,
    process,
    write_raw,
)
from mutations import MUTATIONS, mutated
from scipy import stats

LAW = asp.FrictionLaw(asp.Superellipse(0.54, 0.46, 2.9), asp.Ellipse(1.5, 1.0))
RAW = VirtualTribometer(
    LAW, normal_force=9.3, turns=6, turn_rate=0.5, sample_rate=250.0, seed=2
).record()
DATA = process(RAW)
FIT = fit_law(DATA, reservoir="superellipse", direction="ellipse")
# Names, models, whether there are bands.
FITS = {
    "superellipse": FIT,
    "without bands": fit_law(DATA, reservoir="ellipse", direction="circle", confidence=None),
    "series": fit_law(DATA, reservoir=FourierReservoir(4), direction=FourierDirection(2, odd=True)),
    "fixed exponent": fit_law(DATA, reservoir=SuperellipseReservoir(2.5), direction="circle"),
}

# A law whose estimates are all of different kinds, with a covariance that is large enough to see.
SPREAD = np.array(
    [
        [4e-4, 1e-4, -2e-4, 0.0, 1e-4],
        [1e-4, 9e-4, 1e-4, 1e-4, 0.0],
        [-2e-4, 1e-4, 2.5e-3, 0.0, 3e-4],
        [0.0, 1e-4, 0.0, 1e-3, 2e-4],
        [1e-4, 0.0, 3e-4, 2e-4, 1.6e-3],
    ]
)
NAMES = [
    "reservoir.a",
    "reservoir.b",
    "reservoir.angle",
    "direction.ratio",
    "direction.angle",
]
VALUES = [0.5, 0.3, 0.2, 1.6, -0.3]
KNOWN = IdentifiedLaw(
    asp.FrictionLaw(asp.Ellipse(0.5, 0.3, angle=0.2), asp.Ellipse(1.6, 1.0, angle=-0.3)),
    reservoir_model="ellipse",
    direction_model="ellipse",
    values=VALUES,
    turns=SPREAD,
)


@pytest.mark.parametrize("name", FITS)
def test_a_fit_keeps_law_parameters_and_covariance_in_its_file(name, tmp_path):
    fit, path = FITS[name], tmp_path / "law.toml"
    assert fit.save_law(path, provenance=asp.Provenance(note="dry")) == path
    read = IdentifiedLaw.load(path)
    assert read.law == fit.law == asp.FrictionLaw.load(path) == asp.LawFile.load(path).law
    assert read.provenance.note == "dry"
    expected = {n: one.value for n, one in fit.parameters.items() if n != "direction.scale"}
    assert dict(zip(read.names, read.values.tolist(), strict=True)) == expected
    assert read.replace(provenance=None) == fit.identified_law
    assert repr(read.replace(provenance=None)) == repr(fit.identified_law)
    if fit.covariance is None:
        assert read.turns is None
        with pytest.raises(asp.ParameterError, match="covariance: is not known: fit with bands"):
            read.sample(2, seed=0)
    else:
        assert np.array_equal(read.covariance, fit.covariance.total)
        errors = [one.standard_error for one in fit.parameters.values()]
        np.testing.assert_allclose(read.standard_errors, errors[:-1], rtol=1e-12)
    assert read.law_of(read.values).direction.radius(0.3) == pytest.approx(
        fit.law.direction.radius(0.3), rel=1e-12
    )
    read.save(tmp_path / "again.toml")
    assert (tmp_path / "again.toml").read_text() == path.read_text()


def test_drawn_parameters_scatter_with_the_covariance():
    count = 1500
    drawn = KNOWN.sample_values(count, seed=5)
    assert list(KNOWN.names) == NAMES
    coordinates = np.where([True, True, False, True, False], np.log(np.abs(drawn)), drawn)
    centre = np.where([True, True, False, True, False], np.log(np.abs(VALUES)), VALUES)
    # Whitened, they are independent and of unit variance: the scatter follows Wishart's law.
    white = np.linalg.solve(np.linalg.cholesky(SPREAD), (coordinates - centre).T)
    scatter = white @ white.T / count
    expected = np.sqrt((1.0 + np.eye(5)) / count)
    assert (np.abs(scatter - np.eye(5)) < 4.5 * expected).all()
    assert (np.abs(white.mean(axis=1)) < 4.5 / math.sqrt(count)).all()
    assert all(stats.kstest(row, "norm").pvalue > 1e-4 for row in white)


def test_laws_are_those_of_the_drawn_parameters():
    laws, values = KNOWN.sample(20, seed=6), KNOWN.sample_values(20, seed=6)
    for law, (a, b, angle, ratio, turn) in zip(laws, values, strict=True):
        assert law.reservoir == asp.Ellipse(a, b, angle=angle) or math.isclose(law.reservoir.a, a)
        expected = asp.FrictionLaw(
            asp.Ellipse(a, b, angle=angle), asp.Ellipse(ratio, 1.0, angle=turn)
        )
        slip = np.array([[1.0, 0.3], [-0.2, 1.0]])
        np.testing.assert_allclose(law.force(slip), expected.force(slip), rtol=1e-9)
    assert laws == KNOWN.sample(20, seed=6) != KNOWN.sample(20, seed=7)
    rate = asp.Stribeck(0.1, ratio=0.5)
    rated = KNOWN.replace(law=KNOWN.law.replace(rate=rate))
    assert {law.rate for law in rated.sample(3, seed=0)} == {rate}


def test_few_turns_are_drawn_from_students_t():
    """Bands of the draws are those of the fit: the quantiles of t, not those of the normal law."""
    count, degrees = 1000, 2
    few = KNOWN.replace(degrees_of_freedom=(degrees, math.inf, math.inf))
    drawn = few.sample_values(count, seed=8)
    standard = (drawn[:, 2] - 0.2) / math.sqrt(SPREAD[2, 2])
    assert stats.kstest(standard, stats.t(degrees).cdf).pvalue > 1e-3
    assert stats.kstest(standard, "norm").pvalue < 1e-3


def test_bands_of_draws_are_those_of_the_fit():
    drawn = FIT.identified_law.sample_values(400, seed=1)
    for column, name in zip(drawn.T, FIT.identified_law.names, strict=True):
        band = FIT.parameters[name]
        ends = np.quantile(column, [0.025, 0.975])
        assert ends == pytest.approx([band.low, band.high], abs=0.5 * band.standard_error)


def test_causes_of_errors_add_up():
    zero = np.zeros((5, 5))
    parts = KNOWN.replace(turns=zero, calibration=SPREAD, zeros=2.0 * SPREAD)
    assert np.array_equal(parts.covariance, 3.0 * SPREAD)
    drawn = parts.sample_values(500, seed=2)
    assert drawn[:, 2].std() == pytest.approx(math.sqrt(3.0 * SPREAD[2, 2]), rel=0.15)
    still = KNOWN.replace(turns=zero)
    np.testing.assert_allclose(still.sample_values(3, seed=0), [VALUES] * 3, rtol=1e-15)


def test_draws_that_are_no_law_are_repeated_or_said_to_be_too_many():
    fit = FITS["series"].identified_law
    k = len(fit.names)
    # D of a series is convex near the estimate only.
    wide = fit.replace(turns=0.05**2 * np.eye(k), calibration=None, zeros=None)
    laws = wide.sample(20, seed=3)
    assert len(laws) == 20
    assert all(law.direction.is_convex for law in laws)
    wild = fit.replace(turns=1e4 * np.eye(k), calibration=None, zeros=None)
    with pytest.raises(asp.FitError, match=r"only \d of 240 draws are laws"):
        wild.sample(2, seed=3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"values": VALUES[:4]}, r"values: must have shape \(5,\), got \(4,\)"),
        ({"values": [-0.5, *VALUES[1:]]}, "values: reservoir.a must be above 0, got -0.5"),
        ({"values": [0.4, *VALUES[1:]]}, "law.reservoir: must be that of the parameters, its"),
        ({"values": [*VALUES[:3], 1.7, -0.3]}, "law.direction: must be that of the parameters"),
        ({"turns": np.eye(4)}, r"turns: must have shape \(5, 5\)"),
        ({"turns": SPREAD + np.eye(5, k=1)}, "turns: must be a covariance, it is not symmetric"),
        ({"zeros": SPREAD - np.eye(5)}, "zeros: must be a covariance, it has the eigenvalue -1"),
        ({"degrees_of_freedom": (0.0, 1.0, 1.0)}, "degrees_of_freedom: must be positive"),
        ({"degrees_of_freedom": (1.0, 1.0)}, "degrees_of_freedom: must hold 3 numbers"),
        ({"reservoir_model": "elipse"}, "reservoir_model: must be 'circle', 'ellipse'"),
        ({"law": 0.3}, "law: must be a FrictionLaw, got 0.3"),
        ({"law": asp.FrictionLaw.isotropic(0.3, dimension=3)}, "law: must have p = 2"),
        ({"provenance": "dry"}, "provenance: must be a Provenance or None"),
    ],
)
def test_arguments_are_named(changes, message):
    with pytest.raises(asp.ParameterError, match=message):
        KNOWN.replace(**changes)


def test_models_of_users_are_refused_by_name(tmp_path):
    class OwnDirection(CircleDirection):
        pass

    own = fit_law(DATA, reservoir="ellipse", direction=OwnDirection())
    with pytest.raises(asp.ParameterError, match=r"parameters.direction_model: .* OwnDirection is"):
        own.save_law(tmp_path / "law.toml")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "[parameters]",
            "[provenance.configuration]",
            r"line 42: \[parameters\] reservoir_model: is missing",
        ),
        ('"ellipse"', '"elipse"', r"\[parameters\] reservoir_model: 'elipse' is not known, did"),
        ('"ellipse"\n', "3\n", r"\[parameters\] reservoir_model: must be a model: its name, or"),
        (
            '"reservoir.angle"',
            '"reservoir.angel"',
            r"\[parameters\] names: must be \['reservoir.a',",
        ),
        ("values = [", "values = [1.0, ", r"\[parameters\] values: must have shape \(5,\)"),
        ("values = [", "value = [", r"\[parameters\] value: is not known, did you mean 'values'"),
        ("a = 0.5\n", "a = 0.6\n", r"line 10: \[law\] reservoir: must be that of the parameters"),
        (
            "matrix = [\n    [0",
            "matrix = [\n    [-0",
            r"\[parameters.covariance.turns\] matrix: .*co",
        ),
        ("[parameters.covariance.turns]", "[parameters.covariance.runs]", "runs: is not known"),
        ("matrix =", "matrices =", r"\] matrices: is not known, did you mean 'matrix'"),
    ],
)
def test_what_is_wrong_with_the_parameters_is_named(old, new, message, tmp_path):
    path = tmp_path / "law.toml"
    KNOWN.save(path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(asp.ConfigurationError, match=message) as refused:
        IdentifiedLaw.load(path)
    assert refused.value.line


def test_a_law_without_parameters_says_who_reads_it(tmp_path):
    LAW.save(tmp_path / "law.toml")
    with pytest.raises(
        asp.ConfigurationError, match=r"parameters.*: is missing: .* FrictionLaw.load reads"
    ):
        IdentifiedLaw.load(tmp_path / "law.toml")


@pytest.mark.parametrize("count", [60, pytest.param(2000, marks=pytest.mark.long)])
def test_mutated_files_are_refused_with_line_and_key(count, tmp_path):
    KNOWN.replace(
        degrees_of_freedom=(5.0, math.inf, math.inf), provenance=asp.Provenance(note="dry")
    ).save(tmp_path / "law.toml")
    text = (tmp_path / "law.toml").read_text()
    text = text[text.index("format =") :]
    rng, path, refused = np.random.default_rng(1), tmp_path / "mutant.toml", set()
    for _ in range(count):
        kind, content = mutated(text, rng)
        path.write_bytes(content)
        try:
            IdentifiedLaw.load(path)
        except asp.ConfigurationError as error:
            told = error
        else:
            continue
        refused.add(kind)
        # A line that is none of TOML may have lost its key; it is told by its number.
        assert told.key or (told.line and "is not TOML" in told.message), told
        assert told.line or "is missing" in told.message, told
    assert count < 2000 or refused == set(MUTATIONS)


def test_the_command_writes_law_parameters_and_provenance(tmp_path, capsys):
    write_raw(RAW, tmp_path)
    config = tmp_path / "tribometer.toml"
    paths = [str(tmp_path / "run_1.csv"), "--config", str(config), "--out", str(tmp_path / "A")]
    assert main(["identify", *paths, "--direction", "ellipse"]) == 0
    capsys.readouterr()
    found = IdentifiedLaw.load(tmp_path / "A" / "law.toml")
    with (tmp_path / "A" / "parameters.csv").open() as file:
        table = {row["parameter"]: row for row in csv.DictReader(file)}
    for name, value, error in zip(found.names, found.values, found.standard_errors, strict=True):
        assert float(table[name]["value"]) == pytest.approx(value)
        assert float(table[name]["standard error"]) == pytest.approx(error)
    origin = found.provenance
    assert origin.made_by.startswith("asperity identify --reservoir superellipse --direction ell")
    assert dict(origin.files).keys() >= {"run_1.csv", "tribometer.toml"}
    for name, digest in origin.files:
        assert hashlib.sha256((tmp_path / name).read_bytes()).hexdigest() == digest
    sections = {key for key in re.findall(r"^\[(\w+)\]", config.read_text(), re.M)}
    assert set(origin.configuration) == sections
    assert {"calibration.csv"} < dict(origin.files).keys()
