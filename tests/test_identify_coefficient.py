"""Friction coefficients along the sliding: one channel, mountings, loads, speeds, breakaway."""

import json
import math
import re

import asperity as asp
import laboratory_files as lab
import numpy as np
import pytest
import virtual_strokes
from asperity import identify
from asperity.commands.main import main
from asperity.errors import FitError, ParameterError, RecordError
from asperity.identify import (
    VirtualTribometer,
    breakaway,
    fit_law,
    fit_stribeck,
    friction_coefficient,
    process,
)
from asperity.identify.campaigns.coefficient import OneChannel, with_rate
from asperity.identify.evidence.coefficient.turns import independent, interval
from scipy.stats import binom

G = 9.80665
POUND = 0.45359237 * G
_RAMP = np.full(40, 1.0 / 40.0)
ISOTROPIC = asp.FrictionLaw.isotropic(0.3)


def machine(mu=0.3, **options):
    given = {"normal_force": 10.0, "turns": 6, "turn_rate": 0.5, "sample_rate": 50.0}
    return VirtualTribometer(asp.FrictionLaw.isotropic(mu), **{**given, **options})


def hits_of(seeds, covers, *, parts=1):
    """Assert that as many of all intervals hold the truth as 95 % allow: one test in 10⁴ fails."""
    hits = np.sum([covers(seed) for seed in range(seeds)], axis=0)
    low, high = binom.interval(1.0 - 1e-4 / parts, seeds, 0.95)
    if seeds >= 2000:
        low, high = 0.935 * seeds, 0.965 * seeds
    assert np.all((low <= hits) & (hits <= high)), hits / seeds


SEEDS = pytest.mark.parametrize("seeds", [100, pytest.param(2000, marks=pytest.mark.long)])

RUN = lab.run(sample_rate=250.0)
T, A, X, _, Z = lab.table(RUN).T
# Of the law that made the readings.
MEAN = lab.LAW.resistance(2.0 * np.pi * (np.arange(3600) + 0.5) / 3600)[0].mean()
HELD = {
    "s": T, "ms": 1e3 * T, "min": T / 60.0, "rad": A, "deg": np.rad2deg(A) % 360.0,
    "rev": A / (2.0 * np.pi), "cts": np.floor(A / (2.0 * np.pi) * 4096) % 4096,
    "rpm": np.full(T.size, 30.0), "x": X, "mx": 1e3 * X, "kgx": X / G, "gx": 1e3 * X / G,
    "lbx": X / POUND, "ozx": 16.0 * X / POUND,
    "inx": 0.04 * X / (0.0254 * POUND), "dax": 0.1 * X,
    "z": Z, "-z": -Z, "mz": 1e3 * Z, "kgz": Z / G,
    "lbz": Z / POUND, "kz": 1e-3 * Z, "Nm": 0.04 * X, "Nmm": 40.0 * X, "mNm": 40.0 * X,
    "Ncm": 4.0 * X, "cof": X / Z, "T": 20.0 + 0.01 * T, "wear": np.sin(T), "n": np.arange(T.size),
}  # fmt: skip
ARM = {"file": {"arm": 0.04}}
# The line of names, columns, and what a user adds to what is found.
HEADINGS = [
    ("Time [s],Angle [deg],Friction force [N],Normal force [N]", "s deg x z", {}),
    ("Time (s);Rotation (rev);Ff (N);Fn (N);COF", "s rev x z cof", {}),
    ("Zeit [s];Winkel [°];Reibkraft [N];Normalkraft [N]", "s deg x z", {}),
    ("t_s,phi_rad,Ft_N,Fn_N", "s rad x z", {}),
    ("time_ms,angle_deg,friction_force_mN,load_mN", "ms deg mx mz", {}),
    ("Time[min]\tSpeed[rpm]\tFt[N]\tFz[N]", "min rpm x z", {}),
    ("Time s,Angle deg,Drag force kgf,Load kgf", "s deg kgx kgz", {}),
    ("Time (sec),Fx (lbf),Fz (lbf),Angle (deg)", "s lbx lbz deg", {}),
    ("Timestamp,DAQ.Fx (N),DAQ.Fz (N),Rotary.Angle (deg)", "s x -z deg", {}),
    ("T,Time,Phi,Ft,Fn", "T s rad x z", {}),
    ("Temps [s];Angle [rad];Force tangentielle [N];Force normale [N]", "s rad x z", {}),
    ("Time [s],Angle [°],Friction force [N],Normal force [N],Wear [V]", "s deg x z wear", {}),
    ("Time [s],Angle [deg],Torque [N m],Normal force [N]", "s deg Nm z", ARM),
    ("t [s];n [rpm];Reibmoment [Nmm];Last [N]", "s rpm Nmm z", ARM),
    ("time_s,angle_deg,torque_mNm,Fn_N", "s deg mNm z", ARM),
    ("Zeit;Winkel;Drehmoment;Fz\ns;°;Ncm;N", "s deg Ncm z", ARM),
    ("Time [s],Angle [deg],Friction force [daN],Normal force [kN]", "s deg dax kz", {}),
    (
        "Time [s],Encoder [counts],Traction force [N],Normal force [N]",
        "s cts x z",
        {"file": {"counts_per_turn": 4096}},
    ),
    (
        "Time [s],Angle [deg],Friction [gf]",
        "s deg gx",
        {"tribometer": {"normal_load": lab.LOAD}},
    ),
    (
        "index,Friction force [N],Normal force [N]",
        "n x z",
        {"file": {"sample_rate": 250.0, "turn_rate": 0.5}},
    ),
]  # fmt: skip


def written(path, names, columns):
    mark = next(one for one in ";\t," if one in names)
    rows = zip(*(HELD[name] for name in columns.split()), strict=True)
    path.write_text("\n".join([names, *(mark.join(f"{x:.9g}" for x in r) for r in rows)]))
    return path


@pytest.mark.parametrize(("names", "columns", "more"), HEADINGS, ids=[h[0] for h in HEADINGS])
def test_one_channel_is_read_under_the_headings_of_laboratories(tmp_path, names, columns, more):
    file = written(tmp_path / "run.txt", names, columns)
    found = identify.inspect_file(file)
    assert "one_channel = true in [file]" in found.summary()
    sections = {name: dict(part) for name, part in found.sections.items()}
    for name, part in {"file": {}, **more}.items():
        sections[name] = {**sections.get(name, {}), **part}
    with pytest.raises(RecordError, match="one_channel = true in"):
        identify.load(file, sections)
    sections["file"]["one_channel"] = True
    coefficient = friction_coefficient(identify.load(file, sections)).mean
    # A normal force that is taken for constant leaves its ripple of 3 % in, which turns average.
    assert coefficient.value == pytest.approx(MEAN, rel=2e-3)
    assert coefficient.low < coefficient.value < coefficient.high


def test_one_channel_tells_no_direction_set():
    raw = machine(calibration_loads=0, crosstalk=0.0).record()
    readings = raw.recordings[0].readings * [1.0, 0.0, 1.0]
    one = raw.replace(recordings=[raw.recordings[0].replace(readings=readings)], one_channel=True)
    data = process(one)
    with pytest.raises(FitError, match="one channel tells no direction set"):
        fit_law(data, reservoir="circle", direction="circle")
    with pytest.raises(ParameterError, match="tells no sets"):
        _ = data.sets
    found = friction_coefficient(data)
    law = found.isotropic_law()
    assert law.law == asp.FrictionLaw.isotropic(found.mean.value)
    assert law.standard_errors[0] == pytest.approx(found.mean.standard_error)
    mixed = machine(crosstalk=0.05).record()
    with pytest.raises(ParameterError, match="crosstalk of the radial channel"):
        mixed.replace(one_channel=True)


def test_an_isotropic_law_is_refused_where_directions_do_not_allow_one():
    raw = identify.RawData([RUN.replace(readings=RUN.readings * [1.0, 0.0, 1.0])], one_channel=True)
    with pytest.raises(FitError, match=r"changes by .* over the directions"):
        friction_coefficient(process(raw)).isotropic_law()
    strokes = virtual_strokes.processed(virtual_strokes.records(1, compliance=1e-6))
    with pytest.raises(FitError, match="strokes along some lines do not tell"):
        friction_coefficient(strokes).isotropic_law()


@SEEDS
def test_intervals_of_one_channel_hold_the_truth(seeds):
    """The zeros are known from records without load."""

    def covers(seed):
        virtual = machine(
            seed=seed, noise=0.05, crosstalk=0.0, calibration_loads=0, no_load_time=10.0, drift=0.0
        )
        raw = virtual.record().replace(one_channel=True)
        return friction_coefficient(process(raw)).mean.covers(0.3)

    hits_of(seeds, covers)


def mountings(random, count, **options):
    """Return one campaign of several mountings, whose coefficients scatter by 3 %."""
    given = {"turns": 3, "noise": 0.01, "no_load_time": 0.0, "drift": 0.0, "zero": 0.0, **options}
    runs = [
        machine(mu, seed=seed, crosstalk=0.0, calibration_loads=0, **given).record().recordings[0]
        for mu, seed in zip(random.normal(0.3, 0.009, count), range(count), strict=True)
    ]
    return process(identify.RawData(runs, radius=0.05))


@SEEDS
def test_the_mean_of_mountings_is_in_its_interval(seeds):
    def covers(seed):
        random = np.random.default_rng(seed)
        found = friction_coefficient(mountings(random, 2 + seed % 4))
        return found.mean.covers(0.3)

    hits_of(seeds, covers)


def test_the_next_mounting_and_the_spread_between_them_are_told():
    found = friction_coefficient(mountings(np.random.default_rng(7), 40))
    (group,) = found.groups
    assert group.between == pytest.approx(0.03, rel=0.3)
    assert group.within < 0.003
    low, high = group.next
    assert (high - low) / 0.6 == pytest.approx(2.02 * 0.03, rel=0.3)
    assert found.mountings_differ
    assert "Mountings differ by" in found.summary()


@SEEDS
def test_parameters_of_a_stribeck_factor_are_in_their_intervals(seeds):
    truth = asp.Stribeck(0.03, ratio=0.6)
    speeds = np.geomspace(0.002, 0.5, 8)

    def covers(seed):
        scatter = 0.01 * np.random.default_rng(1000 + seed).normal(size=8)
        found = fit_stribeck(speeds, coefficients=0.4 * truth(speeds) * np.exp(scatter))
        return found.static.covers(0.4), found.ratio.covers(0.6), found.speed.covers(0.03)

    hits_of(seeds, covers, parts=3)


@pytest.mark.parametrize(
    ("speeds", "coefficients", "words"),
    [
        ([0.1, 0.2, 0.4], [0.4, 0.35, 0.32], "3 speeds that differ by 5 %"),
        (
            [0.1, 0.101, 0.2, 0.4, 0.401],
            [0.4, 0.4, 0.35, 0.32, 0.32],
            "3 speeds that differ by 5 %",
        ),
        (
            np.geomspace(0.01, 1.0, 8),
            0.3 + 0.001 * np.cos(9.0 * np.arange(8)),
            "do not depend|tell",
        ),
        (np.geomspace(0.01, 1.0, 8), 0.4 - 0.1 * np.exp(-np.geomspace(0.1, 10.0, 8)), "rises"),
        (
            np.geomspace(1.0, 2.0, 8),
            0.3 - 0.02 * np.geomspace(1.0, 2.0, 8) + 0.001 * np.cos(9.0 * np.arange(8.0)),
            "lies at their end",
        ),
    ],
)
def test_a_stribeck_factor_is_refused_where_speeds_do_not_tell_it(speeds, coefficients, words):
    with pytest.raises(FitError, match=words):
        fit_stribeck(speeds, coefficients=coefficients)


def campaign(folder, *, loads=(10.0,), rates=(0.5,), repeats=1, power=0.0, one_channel=True):
    """Write runs at loads and speeds; return the arguments of the command."""
    names = []
    for k, (load, rate) in enumerate(
        (load, rate) for load in loads for rate in rates for _ in range(repeats)
    ):
        speed = 2.0 * np.pi * rate * 0.05
        mu = 0.4 * asp.Stribeck(0.1, ratio=0.7)(speed) * (load / 10.0) ** power
        mu *= 1.0 + 0.002 * np.cos(2.0 + 7.0 * k)
        virtual = machine(
            mu, normal_force=load, turn_rate=rate, sample_rate=100.0 * rate, turns=3, seed=k,
            no_load_time=0.0, calibration_loads=0, crosstalk=0.0, zero=0.0, drift=0.0, radius=0.05,
        )  # fmt: skip
        identify.write_raw(virtual.record(), folder / f"m{k}")
        names.append(str(folder / f"m{k}" / "run_1.csv"))
    config = folder / "m0" / "tribometer.toml"
    text = config.read_text()
    assert "[file]" not in text
    config.write_text(("[file]\none_channel = true\n\n" if one_channel else "") + text)
    return ["identify", *names, "--config", str(config), "--out", str(folder / "out")]


def test_the_command_tells_load_speed_and_mountings(tmp_path, capsys):
    options = campaign(tmp_path, loads=(10.0, 20.0), repeats=2, power=-0.1, one_channel=False)
    circles = ["--reservoir", "circle", "--direction", "circle"]
    assert main([*options, *circles, "--json"]) == 1
    found = json.loads(capsys.readouterr().out)["coefficient"]
    assert [len(group["runs"]) for group in found["groups"]] == [2, 2]
    assert [round(group["load"]) for group in found["groups"]] == [10, 20]
    exponent, low, high = found["load_exponent"]
    assert low < -0.1 < high
    assert exponent == pytest.approx(-0.1, abs=0.02)
    assert found["speed_exponent"] is None
    assert found["stribeck"] == "speeds do not vary"
    assert len(found["turns"]["coefficient"]) == 12
    text = (tmp_path / "out" / "report.html").read_text()
    assert "the coefficient of the next mounting is expected within" in text
    assert "forces per unit load change by" in text
    assert (tmp_path / "out" / "runs.csv").read_text().count("\n") == 5


def test_the_command_fits_a_stribeck_factor_where_speeds_vary(tmp_path, capsys):
    assert main(campaign(tmp_path, rates=np.geomspace(0.05, 2.0, 8))) == 1
    printed = capsys.readouterr().out
    assert "For predictions: law.replace(rate=Stribeck(" in printed
    assert "identify the law at the speed that is predicted" in printed


@pytest.mark.parametrize("one_channel", [True, False])
def test_where_speeds_tell_a_stribeck_factor_a_law_has_it(one_channel, tmp_path, capsys):
    """Runs made with μ(v) = 0.4 f(v), f of v₀ = 0.1 m/s and ρ = 0.7."""
    circles = ["--reservoir", "circle", "--direction", "circle"]
    rates = np.geomspace(0.05, 2.0, 8)
    options = [*campaign(tmp_path, rates=rates, one_channel=one_channel), *circles]
    assert main(options) == 1
    assert "law_with_rate.toml has C at rest" in capsys.readouterr().out
    file = tmp_path / "out" / "law_with_rate.toml"
    law = asp.FrictionLaw.load(file)
    speeds = 2.0 * np.pi * rates * 0.05
    force = -law.force(np.stack([speeds, 0.0 * speeds], axis=-1))[:, 0]
    np.testing.assert_allclose(force, 0.4 * asp.Stribeck(0.1, ratio=0.7)(speeds), rtol=5e-3)
    assert not isinstance(asp.LawFile.load(file), identify.IdentifiedLaw)
    # Of one speed there is none, and that of before goes.
    assert main([*options[:2], *options[9:]]) == 1
    assert "law_with_rate" not in capsys.readouterr().out
    assert not file.exists()
    assert (tmp_path / "out" / "law.toml").exists()


def test_two_runs_at_two_loads_do_not_tell_the_load_from_the_mounting(tmp_path, capsys):
    assert main(campaign(tmp_path, loads=(10.0, 20.0))) == 1
    printed = capsys.readouterr().out
    assert "by two runs: whether that is the mounting they do not tell" in printed
    assert "No load and speed was recorded twice" in printed


def test_the_command_reads_one_channel_on_request_only(tmp_path, capsys):
    raw = machine(calibration_loads=0, crosstalk=0.0, zero=0.0, drift=0.0).record()
    table = lab.table(raw.recordings[0])[:, [0, 1, 2, 4]]
    rows = "\n".join(",".join(f"{x:.9g}" for x in row) for row in table)
    (tmp_path / "run.csv").write_text(f"time,angle,tangential,normal\n{rows}\n")
    config = tmp_path / "rig.toml"
    options = ["identify", str(tmp_path / "run.csv"), "--config", str(config)]
    options += ["--out", str(tmp_path / "out")]
    config.write_text("[file]\nheader = 1\n")
    assert main(options) == 2
    assert "one_channel = true in [file] does without it" in capsys.readouterr().err
    config.write_text("[file]\none_channel = true\n")
    assert main(options) == 1
    printed = capsys.readouterr().out
    assert "neither is a direction set" in printed
    names = {file.name for file in (tmp_path / "out").iterdir()}
    assert names == {"runs.csv", "turns.csv", "turns.png", "report.html"}
    assert main([*options, "--reservoir", "ellipse"]) == 2
    assert "one channel tells no direction set" in capsys.readouterr().err
    assert main([*options, "--reservoir", "circle", "--direction", "circle"]) == 1
    law = identify.IdentifiedLaw.load(tmp_path / "out" / "law.toml")
    assert law.law.reservoir.radius(0.0) == pytest.approx(0.3, rel=0.01)


def test_refusals_of_one_channel_name_what_takes_the_place_of_time_load_and_newtons(
    tmp_path, capsys
):
    n, turns, truth = 1000, 10, 0.3
    phi = 2.0 * np.pi * turns * np.arange(n) / n
    volts = 0.02 * 5.0 * truth * (1.0 + 0.1 * np.cos(2.0 * phi) + 0.01 * np.sin(0.1 * phi))
    table = np.stack([np.degrees(phi) % 360.0, volts], axis=-1)
    rows = "\n".join(f"{angle:.4f},{force:.6f}" for angle, force in table)
    (tmp_path / "run.csv").write_text(f"angle,tangential\n{rows}\n")
    config, options = tmp_path / "rig.toml", ["identify", str(tmp_path / "run.csv")]
    options += ["--config", str(config), "--out", str(tmp_path / "out"), "--json"]

    def refused(text):
        config.write_text(text)
        assert main(options) == 2
        return capsys.readouterr().err

    text = "[file]\none_channel = true\n"
    said = refused(text)
    assert "has no column 'time'" in said
    assert "sample_rate in [file] does without it" in said
    assert f"see [columns], [file] sample_rate in {config}" in said
    text += "sample_rate = 25.0\n"
    said = refused(text)
    assert "has no column 'normal'" in said
    assert "normal_load in [tribometer] does without it" in said
    text += "[tribometer]\nnormal_load = 5.0\n[units]\nangle = 'deg'\ntangential = 'V'\n"
    said = refused(text)
    assert "only a calibration turns into N: known loads and their readings in V" in said
    text += "[calibration]\nloads = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
    config.write_text(text + "readings = [[0.02, 0, 0], [0, 1, 0], [0, 0, 1]]\n")
    assert main(options) == 1
    found = json.loads(capsys.readouterr().out)
    mean = float(np.mean(table[:, 1]) / 0.02 / 5.0)
    (run,) = found["coefficient"]["runs"]
    assert run["coefficient"]["value"] == pytest.approx(mean, rel=2e-3)
    assert any(one.startswith("a calibration without an error") for one in found["warnings"])


def test_the_zero_of_the_sensor_cancels_in_strokes_there_and_back():
    given = virtual_strokes.records(6, ratio=1.0, scatter=0.0, zero=0.3, seed=4)
    for at in range(6):
        found = friction_coefficient(virtual_strokes.processed(given, at))
        assert found.mean.value == pytest.approx(given["kinetic"][at], rel=2e-3)
        loop = found.loop()
        assert loop.offset == pytest.approx(0.03, abs=0.02)


def test_the_work_of_a_loop_is_that_of_friction_and_of_what_yields():
    given = virtual_strokes.records(1, ratio=1.0, scatter=0.0, compliance=2e-6, cycles=6)
    mu, half = given["kinetic"][0], np.abs(given["place"]).max()
    loop = friction_coefficient(virtual_strokes.processed(given)).loop(bins=400)
    # The pin does not slide while it sticks, a way of 2 μ λ_N c at each reversal.
    slides = 4.0 * half - 2.0 * 2.0 * mu * 10.0 * 2e-6
    assert loop.work == pytest.approx(mu * slides, rel=5e-3)


@pytest.mark.parametrize("lines", [1, 6])
def test_strokes_at_several_loads_have_one_compliance_and_one_static_coefficient(lines):
    """The slope of force per unit normal force over the way is another one at each load."""
    runs = [
        virtual_strokes.star(
            virtual_strokes.records(
                lines,
                seed=20 + k,
                load=load,
                kinetic=0.25,
                ratio=1.25,
                compliance=5e-6,
                rate=2000.0,
            )
        )
        for k, load in enumerate((10.0, 30.0, 4.0, 30.0))
    ]
    # With and without a load below half of the usual one.
    for some in (runs[:2], runs):
        found = breakaway(process(identify.RawData(some, one_channel=lines == 1)))
        assert found.compliance == pytest.approx(5e-6, rel=0.01)
        assert found.ratio.covers(1.25)
        assert found.ratio.value == pytest.approx(1.25, rel=0.01)
        assert len(found.directions) == 2 * lines
        for one in found.directions:
            assert one.kinetic.value == pytest.approx(0.25, rel=2e-3)
            assert one.static.value == pytest.approx(0.3125, rel=0.02)


def test_the_zero_of_the_sensor_cancels_in_the_breakaway_there_and_back():
    given = virtual_strokes.records(
        3, seed=6, kinetic=0.25, ratio=1.2, compliance=5e-6, zero=0.3, rate=2000.0
    )
    for at in range(3):
        found = breakaway(virtual_strokes.processed(given, at))
        ahead, back = found.directions
        assert ahead.kinetic.value - back.kinetic.value == pytest.approx(0.06, rel=0.01)
        assert "The zeros of the sensor are not known" in found.summary()
        (mean,) = found.there_and_back
        assert mean.static.covers(0.3)
        assert mean.kinetic.value == pytest.approx(0.25, rel=1e-3)
        assert mean.ratio.covers(1.2)
        assert mean.strokes == ahead.strokes + back.strokes


def test_dependence_on_the_direction_is_no_scatter_and_no_change():
    """Two mountings that differ by 1 %, strokes along six lines one after the other."""
    mu = np.linspace(0.25, 0.35, 6)
    runs = [
        virtual_strokes.star(
            virtual_strokes.records(
                6, seed=k, kinetic=mu * gain, ratio=1.0, reach=2e-4, compliance=5e-6, rate=2000.0
            )
        )
        for k, gain in enumerate((1.0, 1.01))
    ]
    found = friction_coefficient(process(identify.RawData(runs)))
    (group,) = found.groups
    assert group.between == pytest.approx(0.01 / math.sqrt(2.0), rel=0.02)
    assert group.within < 1e-3
    for run, gain in zip(found.runs, (1.0, 1.01), strict=True):
        assert run.coefficient.value == pytest.approx(0.3 * gain, rel=5e-4)
        assert run.coefficient.high - run.coefficient.low < 5e-4
        assert abs(run.change.value) < 2e-3
    assert "from the first to the last" not in found.summary()


@SEEDS
def test_intervals_of_strokes_along_several_lines_hold_the_truth(seeds):
    """Of 5 % scatter from stroke to stroke; three pairs along each of four lines."""
    mu, direction = np.linspace(0.2, 0.4, 4), np.repeat(np.pi * np.arange(4) / 4.0, 6)

    def covers(seed):
        random = np.random.default_rng(seed)
        values = np.repeat(mu, 6) * (1.0 + 0.05 * random.normal(size=24))
        way = direction + np.pi * (np.arange(24) % 2)
        shuffled = random.permutation(24)
        one = independent(values[shuffled], way[shuffled])
        return interval(one.values, 0.95, degrees=one.degrees).covers(0.3)

    hits_of(seeds, covers)


def turning(coefficients, *, loads=10.0, rates=0.5, seed=0, name="run.csv"):
    """Return a run of turns with a coefficient, a load and a turn rate each."""
    random = np.random.default_rng(seed)
    mu, load, rate = np.broadcast_arrays(coefficients, loads, rates)
    steps = (200.0 / rate).astype(int)
    angle = 2.0 * np.pi * np.cumsum(np.repeat(rate, steps)) / 200.0
    normal = np.repeat(load, steps)
    force = np.repeat(mu, steps) * normal + 0.02 * random.normal(size=angle.size)
    readings = np.stack([force, 0.0 * force, normal], axis=-1)
    time = np.arange(angle.size) / 200.0
    return identify.Recording(time, angle=angle, readings=readings, source=name)


def coefficient_of(*runs, **options):
    raw = identify.RawData(runs, one_channel=True, **options)
    # The filter of the normal force goes with the mean turn rate.
    return friction_coefficient(process(raw, cut_off=None))


def test_a_running_in_that_mountings_share_is_no_scatter_of_turns():
    """Of 40 mountings that differ by 3 % and lose 30 % over their turns alike."""
    own = np.random.default_rng(3).normal(1.0, 0.03, 40)
    fall = 0.2 + 0.06 * np.exp(-np.arange(8) / 2.0)
    runs = [turning(x * fall, rates=5.0, seed=k, name=f"{k}.csv") for k, x in enumerate(own)]
    (group,) = coefficient_of(*runs).groups
    assert group.between == pytest.approx(own.std(ddof=1), rel=0.02)
    assert group.within < 0.005
    shorter = turning(own[0] * fall[:7], rates=5.0, name="0.csv")
    (unequal,) = coefficient_of(shorter, *runs[1:]).groups
    assert unequal.within == pytest.approx(group.within, rel=0.1)
    found = coefficient_of(*runs[:6])
    drifts = [one for one in found.sentences() if "from the first to the last turn" in one]
    assert [one.partition(" the coefficient")[0] for one in drifts] == ["In 0.csv and 5 more runs"]


def test_c_at_rest_is_that_of_all_directions_of_the_runs():
    """As many samples in all over 3600 as in a turn; friction is that of an ellipse."""
    law = asp.FrictionLaw.collinear(asp.Ellipse(0.5, 0.3))
    curve = asp.Stribeck(0.1, ratio=0.7)
    runs = []
    for k, rate in enumerate(np.geomspace(0.05, 2.0, 8)):
        angle = 2.0 * np.pi * np.arange(450 * 100 + 1) / 100.0
        along, across = law.resistance(-angle)
        force = np.stack([along, across, 0.0 * along + 1.0], axis=-1) * 10.0
        force[:, :2] *= float(curve(2.0 * np.pi * rate * 0.05))
        time = np.arange(angle.size) / (100.0 * rate)
        runs.append(identify.Recording(time, angle=angle, readings=force, source=f"{k}.csv"))
    found = friction_coefficient(process(identify.RawData(runs, radius=0.05), cut_off=None))
    assert int(found.over_turns.kept.sum()) // 3600 == 100
    rated = with_rate(found, law)
    assert rated is not None
    assert rated.reservoir.radius(0.0) == pytest.approx(0.5, rel=0.01)


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_coefficients_as_of_wrong_units_are_said(factor):
    found = coefficient_of(turning([0.3 * factor] * 6))
    assert f"the coefficient is {found.mean.value:.3g}, which is unlikely" in found.summary()
    one = OneChannel.of(found, asp.Provenance(), reservoir="superellipse", direction="superellipse")
    assert any("unlikely" in text for text in one.warnings)
    assert one.summary().count("unlikely") == 1
    assert not coefficient_of(turning([0.003] * 6)).unlikely


def test_names_of_many_runs_leave_room_for_the_curve():
    """Beside a legend the axes keep most of the figure, whatever the names."""
    from asperity.plot.coefficient import turns_figure

    for count, name in ((3, "a/long/path/of/a/folder/of/the/laboratory/"), (27, "")):
        runs = [turning([0.3] * 3, seed=k, name=f"{name}{k}.csv") for k in range(count)]
        figure = turns_figure(coefficient_of(*runs))
        figure.draw_without_rendering()
        for legend in figure.legends:
            box = legend.get_window_extent()
            assert box.x0 >= 0.0
            assert box.x1 <= figure.bbox.width
        assert figure.axes[0].get_window_extent().height > 0.5 * figure.bbox.height


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("Speed (mm/min)", 1e-3 / 60.0), ("Geschwindigkeit [m/min]", 1.0 / 60.0),
        ("Stroke (in)", 0.0254), ("Position_in", 0.0254), ("Velocity [in/s]", 0.0254),
        ("Speed [inches/s]", 0.0254), ("Speed [inch/min]", 0.0254 / 60.0),
        ("Speed [mm/minute]", 1e-3 / 60.0),
    ],
)  # fmt: skip
def test_motions_are_read_in_the_units_of_their_headings(name, unit, tmp_path):
    given = virtual_strokes.records(1, kinetic=0.3, compliance=1e-6, rate=2000.0)
    kind = "place" if name in ("Stroke (in)", "Position_in") else "velocity"
    motion = given[kind][:, 0] / unit
    table = np.column_stack([given["time"], motion, given["force"][:, 0], 10.0 + 0.0 * motion])
    table[:, 3] += 1e-3 * np.random.default_rng(0).normal(size=len(table))
    heading = f"Time [s];{name};Friction force [N];Load [N]"
    file = tmp_path / "run.csv"
    np.savetxt(file, table, delimiter=";", header=heading, comments="")
    sections = {key: dict(part) for key, part in identify.inspect_file(file).sections.items()}
    sections["file"] = {**sections.get("file", {}), "one_channel": True}
    (run,) = friction_coefficient(identify.load(file, sections)).runs
    half = np.abs(given["place"]).max()
    assert run.speed == pytest.approx(4.0 * half / 0.5, rel=0.01)


def test_an_arm_in_millimetres_is_refused(tmp_path):
    file = written(
        tmp_path / "run.txt", "Time [s],Angle [deg],Torque [N m],Normal force [N]", "s deg Nm z"
    )
    sections = {name: dict(part) for name, part in identify.inspect_file(file).sections.items()}
    sections["file"] |= {"one_channel": True, "arm": 40.0}
    with pytest.raises(RecordError, match="arm in m, or force units: friction coefficient"):
        identify.load(file, sections)


@pytest.mark.parametrize("rate", [10.0, 3.0, 1.0, 0.5])
def test_a_log_with_few_samples_of_a_turn_tells_the_coefficient(rate, tmp_path, capsys):
    """Of a disk that turns once a second, with 3 % more friction on one side of the track."""
    random, time = np.random.default_rng(int(rate)), np.arange(400) / rate
    turning_rate = 60.0 + 0.2 * random.normal(size=time.size)
    # The log is not in step with the disk.
    mu = 0.3 * (1.0 + 0.03 * np.sin(2.0 * np.pi * 1.0437 * time))
    force = 10.0 * mu * (1.0 + 0.02 * random.normal(size=time.size))
    load = 10.0 + 0.1 * random.normal(size=time.size)
    table = np.column_stack([time, turning_rate, force, load])
    names = "time,turn_rate,tangential,normal"
    np.savetxt(tmp_path / "run.csv", table, delimiter=",", header=names, comments="")
    config, folder = tmp_path / "rig.toml", tmp_path / "out"
    config.write_text(
        "[file]\none_channel = true\n[columns]\nturn_rate = 'turn_rate'\n"
        "[units]\nturn_rate = 'rpm'\n[tribometer]\nradius = 0.05\n"
    )
    options = ["identify", str(tmp_path / "run.csv"), "--config", str(config), "--out", str(folder)]
    assert main([*options, "--json"]) == 1
    found = json.loads(capsys.readouterr().out)["coefficient"]
    (run,) = found["runs"]
    assert run["coefficient"]["low"] < 0.3 < run["coefficient"]["high"]
    assert run["speed"] == pytest.approx(2.0 * np.pi * 0.05, rel=0.01)
    assert run["turns"] == pytest.approx(400 / (rate * math.ceil(4.0 / rate)), rel=0.03)
    together = any("turns are taken together" in text for text in found["sentences"])
    assert together == (rate < 4.0)
    code = main([*options, "--reservoir", "circle", "--direction", "circle"])
    assert code == (2 if rate < 8.0 else 1)
    assert ("sample faster" in capsys.readouterr().err) == (rate < 8.0)


def test_a_power_of_the_load_says_at_which_speed():
    """Where speeds have as many loads, that with most runs counts."""
    runs = [
        turning([0.3] * 6, loads=load, rates=rate, seed=10 * k + m, name=f"{k}{m}.csv")
        for k, (load, rate) in enumerate([(5.0, 0.5), (20.0, 0.5), (5.0, 2.0), (20.0, 2.0)])
        for m in range(1 + k // 2)
    ]
    found = coefficient_of(*runs, radius=0.05)
    assert found.load_dependence.values.size == 4
    assert "over 5 … 20 N at 0.6283 m/s" in found.summary()


def test_without_a_radius_turn_rates_tell_groups_apart():
    runs = [
        turning([0.5 - 0.1 * k] * 6, rates=rate, seed=10 * k + m, name=f"{k}{m}.csv")
        for k, rate in enumerate((0.1, 0.4, 1.6))
        for m in range(2)
    ]
    found = coefficient_of(*runs)
    assert [len(group.runs) for group in found.groups] == [2, 2, 2]
    assert [round(group.rate, 2) for group in found.groups] == [0.1, 0.4, 1.6]
    assert max(group.between for group in found.groups) < 0.01
    summary = found.summary()
    assert "0.4 N and" not in summary
    assert "Mountings at 10 N and 0.4 turns/s differ by" in summary
    assert "Runs turn at 0.1 … 1.6 turns/s: with radius in [tribometer]" in summary
    assert found.rows()[0][2] == "turns/s"
    with_radius = coefficient_of(*runs, radius=0.05)
    assert "turns/s" not in with_radius.summary()
    assert f"Mountings at 10 N and {2.0 * np.pi * 0.4 * 0.05:.4g} m/s differ by" in (
        with_radius.summary()
    )


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"loads": np.repeat([5.0, 10.0, 20.0], 4)}, "the load varies from 5 to 20 N"),
        (
            {"rates": np.repeat([0.1, 0.4, 1.6], 4)},
            r"the turn rate varies from 0\.1\d* to 1\.\d* turns/s",
        ),
    ],
)
def test_steps_of_load_or_speed_within_a_run_are_no_running_in(given, words):
    found = coefficient_of(turning(np.repeat([0.3, 0.28, 0.26], 4), **given))
    assert found.runs[0].change.high < 0.0
    assert "new or run in" not in found.summary()
    (sentence,) = found.unsteady
    assert re.search(words, sentence)
    assert "from and to in [run]" in sentence
    models = {"reservoir": "superellipse", "direction": "superellipse"}
    one = OneChannel.of(found, asp.Provenance(), **models)
    assert sentence in one.warnings
    assert one.summary().count(sentence) == 1
    steady = coefficient_of(turning(np.repeat([0.3, 0.28, 0.26], 4)))
    assert not steady.unsteady
    assert "new or run in" in steady.summary()


def test_few_speeds_do_not_tell_that_there_is_no_dependence():
    runs = [
        turning([mu] * 4, rates=rate, seed=k, name=f"{k}.csv")
        for k, (mu, rate) in enumerate([(0.48, 0.05), (0.41, 0.2), (0.315, 0.8)])
    ]
    found = coefficient_of(*runs, radius=0.05)
    assert found.speed_dependence.is_independent
    assert "No dependence" not in found.summary()
    assert "Whether the coefficient depends on the speed over" in found.summary()


@SEEDS
def test_drift_is_claimed_of_one_in_twenty_campaigns_without(seeds):
    def is_silent(seed):
        random = np.random.default_rng(seed)
        runs = [
            identify.Recording(one.time, angle=one.angle, readings=one.readings, source=f"{k}.csv")
            for k in range(6)
            for one in [turning(0.3 + 0.003 * random.normal(size=6), rates=5.0, seed=seed + k)]
        ]
        return all(run.change.covers(0.0) for run in coefficient_of(*runs).runs)

    hits_of(seeds, is_silent)


RECORDS = pytest.mark.parametrize("count", [16, pytest.param(100, marks=pytest.mark.long)])


@RECORDS
@pytest.mark.parametrize("sine", [False, True])
def test_breakaway_is_in_its_interval(sine, count):
    given = virtual_strokes.records(count, seed=1, sine=sine)
    hits, excess = 0, 0
    for at in range(count):
        found = breakaway(virtual_strokes.processed(given, at))
        first = found.directions[0]
        hits += first.static.identifiable and first.static.covers(given["static"][at])
        excess += found.has_excess
        assert found.compliance == pytest.approx(given["compliance"][at], rel=0.05)
        assert first.kinetic.value == pytest.approx(given["kinetic"][at], rel=0.01)
    # Of 100, 90 to 99; of fewer, what 95 % allow in all but one test of 10⁴.
    assert (90 <= hits <= 99) if count == 100 else hits >= binom.ppf(1e-4, count, 0.95)
    assert excess > 0.7 * count


@RECORDS
def test_no_excess_is_found_where_there_is_none(count):
    given = virtual_strokes.records(count, seed=2, ratio=1.0, scatter=0.0)
    found = [breakaway(virtual_strokes.processed(given, at)).has_excess for at in range(count)]
    assert sum(found) <= (5 if count == 100 else binom.isf(1e-4, count, 0.025))


def test_the_zero_of_the_sensor_does_not_bias_the_ratio():
    """Half of the kinetic force: (1.3 ± 0.5)/(1 ± 0.5) has the mean 1.4."""
    options = {"ratio": 1.3, "kinetic": 0.3, "compliance": 1e-6, "seed": 3}
    found, same = (
        breakaway(virtual_strokes.processed(virtual_strokes.records(1, zero=zero, **options))).ratio
        for zero in (1.5, 0.0)
    )
    assert found.value == pytest.approx(same.value, abs=1e-3)
    assert found.high - found.low < 1.1 * (same.high - same.low)
    assert found.covers(1.3)


@pytest.mark.parametrize(("rate", "said"), [(1e3, "cannot be told"), (2e4, "No excess of")])
def test_an_interval_that_allows_much_excess_is_not_taken_for_none(rate, said):
    given = virtual_strokes.records(1, ratio=1.0, scatter=0.0, compliance=1e-6, rate=rate, seed=3)
    found = breakaway(virtual_strokes.processed(given))
    assert found.ratio.covers(1.0)
    assert (found.ratio.high > 1.05) == (rate < 1e4)
    assert said in found.summary()


def test_a_sampling_rate_that_cannot_tell_is_said():
    given = virtual_strokes.records(1, compliance=1e-7, rate=500.0, seed=3)
    found = breakaway(virtual_strokes.processed(given))
    assert not found.ratio.identifiable
    assert not found.has_excess
    assert "The sampling rate cannot tell the static coefficient" in found.summary()
    # Where there is no sample of stick, a rate is a lower bound.
    rates = [500.0]
    while found.needed_rate is not None:
        rates.append(found.needed_rate)
        enough = virtual_strokes.records(1, compliance=1e-7, rate=rates[-1], seed=3)
        found = breakaway(virtual_strokes.processed(enough))
    assert found.ratio.identifiable
    assert 4000.0 <= rates[-1] <= 50_000.0
    assert len(rates) <= 4


@pytest.mark.parametrize("sine", [False, True])
@pytest.mark.parametrize(
    ("reach", "sticks"), [(0.2, True), (0.8, True), (1.05, True), (2.0, False)]
)
def test_strokes_that_hardly_slip_are_refused(reach, sticks, sine):
    """The pin slips where half the stroke exceeds c μ λ_N."""
    for seed in range(3):
        options = {"seed": seed, "ratio": 1.0, "rate": 2000.0, "zero": 0.5, "sine": sine}
        first = virtual_strokes.records(1, compliance=1e-6, **options)
        mu, half = first["kinetic"][0], np.abs(first["place"]).max()
        given = virtual_strokes.records(1, compliance=half / (reach * mu * 10.0), **options)
        data = virtual_strokes.processed(given)
        if sticks:
            for found in (friction_coefficient, breakaway):
                with pytest.raises(FitError, match=r"run 1: the pin sticks over .* the strokes"):
                    found(data)
        else:
            assert friction_coefficient(data).mean.value == pytest.approx(mu, rel=0.01)


def ringing(
    c, mu, *, mass=0.02, rate=5000.0, speed=1e-4, half=5e-5, load=10.0, seed=0, noise=0.005
):
    """Return a record of a pin with mass on a spring, without excess of static friction."""
    random = np.random.default_rng(seed)
    sub, period = 4, 4.0 * half / speed
    dt = 1.0 / rate / sub
    damping = 0.06 * math.sqrt(mass / c)
    x = u = 0.0
    force, way = [], []
    phase = random.uniform()
    inertia = mass + 0.5 * dt * damping + 0.25 * dt * dt / c
    for step in range(int(3.0 * period / dt)):
        at = (step * dt / period + phase) % 1.0
        v = speed if at < 0.5 else -speed
        free = (mass * u - dt * (x + 0.25 * dt * u) / c - 0.5 * dt * damping * u) / inertia
        new = free + min(max(inertia * (v - free), -mu * load * dt), mu * load * dt) / inertia
        x, u = x + 0.5 * dt * (u + new), new
        if step % sub == 0:
            force.append(x / c)
            way.append(v)
    noisy = np.array(force) + noise * mu * load * random.normal(size=len(force))
    time = np.arange(len(force)) / rate
    given = {"time": time, "force": noisy[:, None], "velocity": np.array(way)[:, None]}
    return {**given, "load": load}


def test_a_swing_that_samples_do_not_resolve_is_no_excess():
    untold = 0
    for seed, c in enumerate(np.geomspace(3e-7, 1.5e-6, 6)):
        found = breakaway(virtual_strokes.processed(ringing(c, 0.3, seed=seed)))
        assert not found.has_excess
        if found.ratio.identifiable and found.ratio.low > 1.0:
            untold += 1
            assert "cannot be told: a mass of pin and holder" in found.summary()
    assert untold >= 1


@pytest.mark.parametrize(
    ("c", "mass", "rate"), [(1e-7, 0.2, 3e3), (1e-7, 0.2, 5e3), (1e-6, 0.05, 4e3)]
)
def test_a_swing_under_the_least_load_is_no_excess_of_all(c, mass, rate):
    """The same inertia is much beside the kinetic force of 2 N, and little beside that of 60 N."""
    runs = []
    for k, load in enumerate((2.0, 60.0, 60.0)):
        options = {"load": load, "half": max(5e-5, 3.0 * c * 0.3 * load), "noise": 0.0005}
        given = ringing(c, 0.3, mass=mass, rate=rate, seed=k, **options)
        runs.append(virtual_strokes.recording(given))
    assert not breakaway(process(identify.RawData(runs, one_channel=True))).has_excess


def test_an_excess_is_found_under_several_loads():
    options = {"ratio": 1.2, "kinetic": 0.3, "compliance": 1e-6}
    runs = [
        virtual_strokes.recording(virtual_strokes.records(1, seed=k, load=load, **options))
        for k, load in enumerate((2.0, 10.0, 10.0))
    ]
    found = breakaway(process(identify.RawData(runs, one_channel=True)))
    assert found.has_excess
    assert found.ratio.covers(1.2)


def back_and_forth(force, **options):
    """Return a record of strokes with this force along the stage, of 10 N load, and its RawData."""
    time = np.arange(8000) / 1000.0
    speed = np.where(time % 2.0 < 1.0, 1e-3, -1e-3)
    still = np.zeros(time.size)
    run = identify.Recording(
        time,
        angle=still,
        readings=np.stack([force(np.sign(speed)), still, still + 10.0], axis=-1),
        velocity=np.stack([speed, still], axis=-1),
        **options,
    )
    return identify.RawData([run], one_channel=True)


def test_strokes_one_way_have_the_zero_of_the_sensor_in_them():
    given = back_and_forth(lambda way: 3.0 * way)
    run = given.recordings[0]
    lifted = run.readings * np.where(run.velocity[:, :1] < 0.0, 0.0, 1.0)
    for raw, goes_back in (
        (given, True),
        (given.replace(recordings=[run.replace(readings=lifted)]), False),
    ):
        found = friction_coefficient(process(raw))
        models = {"reservoir": "superellipse", "direction": "superellipse"}
        one = OneChannel.of(found, asp.Provenance(), **models)
        assert found.goes_back == goes_back
        assert any("an error of the zeros of 1 %" in text for text in one.warnings) != goes_back


def test_forces_that_do_not_oppose_the_sliding_are_said():
    noise = 0.01 * np.random.default_rng(0).normal(size=8000)
    wrong = process(back_and_forth(lambda way: noise - 3.0 * way))
    found = friction_coefficient(wrong)
    assert found.mean.value == pytest.approx(-0.3, rel=1e-3)
    assert "\nwarning: In run 1 the force goes with the sliding" in found.summary()
    origin = asp.Provenance()
    one = OneChannel.of(found, origin, reservoir="superellipse", direction="superellipse")
    assert one.warnings
    assert one.summary().count("goes with the sliding") == 1
    assert found.breakaway is None
    assert found.data()["breakaway"] is None
    with pytest.raises(FitError, match="its sign may be wrong"):
        breakaway(wrong)
    for force in (0.0, 3.0):
        one = process(back_and_forth(lambda way, force=force: 0.0 * way + force))
        with pytest.raises(FitError, match="run 1: the force is zero, or does not turn"):
            friction_coefficient(one)


@pytest.mark.parametrize("zero", [0.0, 0.5])
def test_a_force_without_its_sign_is_refused_and_gets_that_of_the_motion(zero, tmp_path):
    # A sensor whose zero is off keeps signs that differ, or forces that do.
    noise = 0.01 * np.random.default_rng(0).normal(size=8000)
    raw = back_and_forth(lambda way: 3.0 * np.tanh(20.0 * np.convolve(way, _RAMP, "same")) + noise)
    (run,) = raw.recordings
    for off in (zero, 2.0, 5.0, 30.0):
        moved = run.replace(readings=run.readings + np.array([off, 0.0, 0.0]))
        found = friction_coefficient(process(raw.replace(recordings=[moved])))
        assert found.mean.value == pytest.approx(0.3, rel=0.01)
    magnitude = run.replace(readings=np.abs(run.readings + np.array([zero, 0.0, 0.0])))
    one = raw.replace(recordings=[magnitude])
    with pytest.raises(RecordError, match=r"N there and .* N back.*rectified = true in .file."):
        process(one)
    with pytest.raises(RecordError, match=r"with its sign; rectified = true in .file., with one"):
        process(one.replace(one_channel=False))
    for name in ("velocity", "position"):
        text = f"[file]\none_channel = true\nrectified = true\n[columns]\n{name} = '{name}'\n"
        (tmp_path / f"{name}.toml").write_text(text)
    place = np.cumsum(run.velocity[:, 0]) * np.median(np.diff(run.time))
    table = np.column_stack([run.time, run.velocity[:, 0], place, *magnitude.readings.T[[0, 2]]])
    table[:, -1] += noise
    heading = "time,velocity,position,tangential,normal"
    np.savetxt(tmp_path / "run.csv", table, delimiter=",", header=heading, comments="")
    for name in ("velocity", "position"):
        data = identify.load(tmp_path / "run.csv", tmp_path / f"{name}.toml")
        assert friction_coefficient(data).mean.value == pytest.approx(0.3, rel=0.02)
    columns = {"velocity": "velocity", "radial": "normal"}
    with pytest.raises(ParameterError, match=r"rectified: is for one_channel = true"):
        identify.read_csv(tmp_path / "run.csv", columns=columns, rectified=True)


def test_a_disk_that_swings_gives_magnitudes_its_sign(tmp_path):
    time = np.arange(16_000) / 1000.0
    angle = 2.0 * np.sin(2.0 * np.pi * time / 4.0)
    force = 3.0 * np.abs(np.tanh(50.0 * np.cos(2.0 * np.pi * time / 4.0)))
    force += 0.01 * np.random.default_rng(0).normal(size=time.size)
    table = np.column_stack([time, angle, force, 10.0 + 0.01 * np.sin(time)])
    path = tmp_path / "run.csv"
    np.savetxt(path, table, delimiter=",", header="time,angle,tangential,normal", comments="")
    read = identify.read_csv(path, one_channel=True)
    with pytest.raises(RecordError, match="rectified = true"):
        process(identify.RawData(read, one_channel=True))
    read = identify.read_csv(path, one_channel=True, rectified=True)
    found = friction_coefficient(process(identify.RawData(read, one_channel=True)))
    assert found.mean.value == pytest.approx(0.3, rel=0.01)


def test_friction_that_varies_along_the_track_is_not_taken_for_sticking():
    place = np.abs(np.arange(8000) / 1000.0 % 2.0 - 1.0)
    data = process(back_and_forth(lambda way: 3.0 * way * (1.0 + 0.8 * (place - 0.5))))
    assert friction_coefficient(data).mean.value == pytest.approx(0.3, rel=1e-3)


def test_runs_of_one_file_name_have_names_of_their_own():
    random = np.random.default_rng(0)
    runs = [
        back_and_forth(
            lambda way: 3.0 * way + 0.01 * random.normal(size=8000), source=f"{folder}/run.csv"
        ).recordings[0]
        for folder in "aab"
    ]
    found = friction_coefficient(process(identify.RawData(runs, one_channel=True)))
    assert found.names == ("a/run.csv (1)", "a/run.csv (2)", "b/run.csv")


def test_one_channel_is_true_or_false():
    with pytest.raises(ParameterError, match="one_channel: must be True or False, got 'no'"):
        identify.RawData(machine().record().recordings, one_channel="no")


def test_a_law_of_wrong_signs_or_several_loads_is_refused():
    runs = [machine(normal_force=load, seed=int(load)).record().recordings[0] for load in (5, 20)]
    with pytest.raises(FitError, match="several loads or speeds"):
        friction_coefficient(process(identify.RawData(runs))).isotropic_law()
    one = runs[0].replace(readings=runs[0].readings * [-1.0, -1.0, 1.0])
    with pytest.raises(FitError, match="a minus before the unit turns the sign"):
        friction_coefficient(process(identify.RawData([one]))).isotropic_law()


@pytest.mark.parametrize("question", [friction_coefficient, breakaway])
def test_raw_data_are_to_be_processed(question):
    with pytest.raises(
        ParameterError, match=r"data: must be what process\(\) returns, got RawData"
    ):
        question(machine().record())
    with pytest.raises(ParameterError, match=r"data: must be what process\(\) returns, or several"):
        identify.load_dependence([machine().record()])


def test_turns_have_no_breakaway():
    with pytest.raises(FitError, match="does not reverse"):
        breakaway(process(machine().record()))
