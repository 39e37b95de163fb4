"""What laboratories export: each file is read, or refused with the reason and the remedy."""

import laboratory_files as lab
import numpy as np
import pytest
from asperity import identify
from asperity.commands.main import main
from asperity.errors import AsperityError, FitError, ParameterError, RecordError

RUN = lab.run()
DATA = identify.process(identify.RawData([RUN]))

GUESSED = {
    "german": (lab.german, "utf-8-sig"),
    "german, utf-16": (lab.german, "utf-16"),
    "german, latin-1": (lab.german, "latin-1"),
    "labview": (lab.labview, "utf-8"),
    "american": (lab.american, "utf-8"),
    "rotations": (lab.rotations, "utf-8"),
}


@pytest.fixture
def write(tmp_path):
    def make(text, name="run.csv", encoding="utf-8"):
        path = tmp_path / name
        path.write_text(text, encoding=encoding)
        return path

    return make


@pytest.mark.parametrize("name", GUESSED)
def test_inspection_alone_reads_a_file(name, write, tmp_path):
    make, encoding = GUESSED[name]
    path = write(make(RUN), encoding=encoding)
    found = identify.inspect_file(path)
    assert not found.notes
    assert {one.role for one in found.columns} > {"time", "tangential", "radial", "normal"}
    found.write(tmp_path / "run.toml")
    data = identify.load(path, tmp_path / "run.toml")
    assert data.turns == DATA.turns
    np.testing.assert_allclose(data.force, DATA.force, atol=2e-5)
    # Ranges are those of the file in its own units.
    (angle,) = (one for one in found.columns if one.role in ("angle", "turn_rate"))
    assert angle.high >= angle.low >= 0.0


def test_clock_times_and_counts_of_an_encoder(write, tmp_path):
    path = write(lab.clock_and_counts(RUN))
    found = identify.inspect_file(path)
    assert found.sections["units"] == {"time": "clock", "angle": "counts"}
    assert found.sections["file"]["counts_per_turn"] == 4096
    found.write(tmp_path / "run.toml")
    data = identify.load(path, tmp_path / "run.toml")
    assert data.turns == 3
    # The angle is known to a count.
    assert abs(data.phi - DATA.phi).max() < 2.0 * np.pi / 4096 + 1e-6
    np.testing.assert_allclose(data.time, DATA.time + 12 * 3600, atol=1e-6)
    # Over midnight the clock starts again, time does not.
    late = write(lab.clock_and_counts(RUN, start=24 * 3600 - 2).replace("24:", "00:"), "late.csv")
    again = identify.load(late, tmp_path / "run.toml")
    np.testing.assert_allclose(np.diff(again.time), 1e-3, atol=1e-6)
    with pytest.raises(ParameterError, match="counts_per_turn: must be given"):
        identify.read_csv(path, delimiter=";", units={"angle": "counts"})
    wrong = found.sections | {"file": {**found.sections["file"], "counts_per_turn": 1000}}
    with pytest.raises(RecordError, match=r"jumps by 409\d.* counts, which is no turn"):
        identify.load(path, wrong)


def test_rest_run_and_rest_in_one_file(write):
    text, raw = lab.rest_run_rest()
    path = write(text)
    first, last = raw.recordings[0].time[[0, -1]] - raw.no_load[0].time[0]
    config = path.with_name("rig.toml")
    config.write_text("")
    with pytest.raises(RecordError, match=r"no pressure at row .* window .*; see \[run\] in .*rig"):
        identify.load(path, config)
    end = float(last) + 5e-4
    config.write_text(
        f"[run]\nfrom = {first - 5e-4}\nto = {end}\n"
        f"[no_load]\nfrom = [0.0, {end}]\nto = [{first - 6e-4}, 99.0]\n"
    )
    data = identify.load(path, config)
    expected = identify.process(raw)
    assert data.turns == expected.turns
    np.testing.assert_allclose(data.force, expected.force, atol=1e-4)
    np.testing.assert_allclose(data.zero_covariance, expected.zero_covariance, rtol=1e-2)
    config.write_text("[run]\nfrom = 90\nto = 91\n")
    with pytest.raises(
        RecordError, match=r"no samples from 90 to 91: its times go from 0 to 14\.3"
    ):
        identify.load(path, config)
    config.write_text("[run]\nfrom = '12:00:05'\n")
    with pytest.raises(AsperityError, match=r"line 1: \[run\]: must have a number in the unit"):
        identify.load(path, config)
    config.write_text("[run]\nfrom = [1, 2]\nto = [3]\n")
    with pytest.raises(AsperityError, match=r"\[run\]: must have as many ends as begins"):
        identify.load(path, config)


def test_pieces_of_a_record_keep_their_turns(write):
    whole = lab.run(turns=5.3)
    path = write(lab.with_defects(whole))
    pieces = identify.read_csv(path, on_defect="split")
    assert len(pieces) == 3
    data = identify.process(identify.RawData(pieces))
    assert data.turns == 5
    full = identify.process(identify.RawData([whole]))
    rows = np.delete(np.arange(len(whole)), [1500, 3500])
    # Digits of the file decide where a turn begins.
    assert np.count_nonzero(data.turn != full.turn[rows]) <= 5
    # Wrapped angles lose no turn in a gap, and a turn that lacks much of it does not count.
    lines = path.read_text().splitlines()
    cells = [line.split(",") for line in lines[1:-1]]
    table = [[c[0], repr(float(c[1]) % (2.0 * np.pi)), *c[2:]] for c in cells]
    table = table[:2200] + table[2700:]
    wrapped = write("\n".join([lines[0], *map(",".join, table)]), "wrapped.csv")
    data = identify.process(identify.RawData(identify.read_csv(wrapped, on_defect="split")))
    assert data.turns == 4
    assert data.turn.max() == 3
    # The scatter of pieces is that of turns, not of runs.
    fit = identify.fit_law(data, reservoir="ellipse", direction="ellipse")
    assert fit.turns == 4


PLAIN = "time,angle,tangential,radial,normal"
WRONG = {
    "mN not declared": ({2: 1e3, 3: 1e3}, "", RecordError, r"force units: .*see \[units\]"),
    "degrees not declared": ({1: 57.29577951}, "", RecordError, r"degrees.*see \[units\]"),
    "normal sign": ({4: -1.0}, "", RecordError, r"compression .* a minus .*see \[units\]"),
    "tangential sign": (
        {2: -1.0},
        "",
        FitError,
        r"does not oppose sliding.*check the signs of the channels",
    ),
    "time in ms": ({0: 1e3}, "", RecordError, r"turns at 0.0005 turns/s.*see \[units\]"),
    "typo": ({}, "[units]\ntiem = 's'", AsperityError, r"line 2: .*did you mean 'time'"),
    "thousands": ({4: 1e3}, "", RecordError, r"groups of three.*see \[file\] thousands"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_refused_with_the_remedy_of_the_configuration(name, write):
    factors, text, kind, message = WRONG[name]
    table = lab.table(RUN)
    for column, factor in factors.items():
        table[:, column] *= factor
    digits = "{:,.5f}" if name == "thousands" else "{:.5f}"
    body = (",".join(f'"{digits.format(x)}"' for x in row) for row in table)
    path = write("\n".join([PLAIN, *body]))
    config = write(text, "rig.toml")
    with pytest.raises(kind, match=message):
        identify.fit_law(identify.load(path, config))


def test_spreadsheets_and_tables_in_memory(tmp_path):
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("openpyxl")
    names = ["Time [s]", "Angle [deg]", "Ft [N]", "Fr [N]", "Fn [N]"]
    table = lab.table(RUN)[::4] * [1.0, 180.0 / np.pi, 1.0, 1.0, 1.0]
    frame = pandas.DataFrame(table, columns=names)
    path = tmp_path / "run.xlsx"
    with pandas.ExcelWriter(path) as book:
        pandas.DataFrame([["Rig 3"]]).to_excel(book, index=False, header=False)
        frame.to_excel(book, index=False, startrow=2, sheet_name="Sheet1")
    found = identify.inspect_file(path)
    assert found.sections["file"] == {"header": 3}
    read = identify.load(path, found.sections)
    held = identify.load(frame, {name: found.sections[name] for name in ("columns", "units")})
    assert read.turns == held.turns == 3
    np.testing.assert_allclose(read.force, held.force, atol=1e-12)
    np.testing.assert_allclose(held.force, DATA.force[::4], atol=1e-6)
    bad = frame.copy()
    bad.loc[7, "Ft [N]"] = np.nan
    with pytest.raises(
        RecordError, match=r"table in memory: column 'Ft \[N\]' .*no number in line 8"
    ):
        identify.load(bad, {name: found.sections[name] for name in ("columns", "units")})
    (tmp_path / "no.xlsx").write_text("no")
    with pytest.raises(RecordError, match="is no spreadsheet"):
        identify.load(tmp_path / "no.xlsx")
    with pytest.raises(RecordError, match="see sheet"):
        identify.inspect_file(path, sheet="Other")
    with pytest.raises(ParameterError, match="paths: must be files or tables"):
        identify.load([3])


def plane(motion, **options):
    pandas = pytest.importorskip("pandas")
    time, place, velocity, force, normal = lab.plane_path(**options)
    moved = 1e3 * (velocity if motion == "velocity" else place)
    unit = "mm/s" if motion == "velocity" else "mm"
    columns = {"t": time, "mx": moved[:, 0], "my": moved[:, 1]}
    frame = pandas.DataFrame(columns | {"Fx": force[:, 0], "Fy": force[:, 1], "Fz": normal})
    names = {"time": "t", f"{motion}_x": "mx", f"{motion}_y": "my"}
    names |= {"force_x": "Fx", "force_y": "Fy", "normal": "Fz"}
    return frame, {"columns": names, "units": {f"{motion}_{axis}": unit for axis in "xy"}}


def agree(one, other, names=("reservoir.a", "reservoir.b", "direction.ratio")):
    """Assert that two fits agree within three standard errors of their difference."""
    for name in names:
        a, b = one.parameters[name], other.parameters[name]
        assert abs(a.value - b.value) < 3.0 * np.hypot(a.standard_error, b.standard_error), name


@pytest.fixture(scope="module")
def turning():
    return identify.fit_law(identify.process(identify.RawData([lab.run(turns=5.0, noise=0.02)])))


@pytest.mark.parametrize("motion", ["velocity", "position"])
def test_tables_of_x_and_y_give_the_same_law(motion, turning):
    frame, sections = plane(motion)
    data = identify.load(frame, sections)
    assert data.turns == 4
    assert data.goes_round
    np.testing.assert_allclose(data.speed[data.turn >= 0], 0.01, rtol=1e-3)
    fit = identify.fit_law(data)
    agree(fit, turning)
    # A surface that lies otherwise has its axes there.
    turned = identify.load(frame, sections | {"run": {"angles": 0.5}})
    np.testing.assert_allclose(turned.phi, data.phi + 0.5, atol=1e-12)
    means = data.averaged(36)
    resistance = lab.LAW.force(np.stack([np.cos(means.phi), np.sin(means.phi)], axis=-1))
    np.testing.assert_allclose(means.force / lab.LOAD, -resistance, atol=0.02)


ANGLES = np.deg2rad(np.arange(0.0, 180.0, 10.0))


def reciprocating(motion="position", **options):
    pandas = pytest.importorskip("pandas")
    columns = ["t", "s", "Ft", "Fr", "Fn"]
    frames = []
    for parts in lab.strokes(ANGLES, **{"law": lab.ROUND, **options}):
        frame = pandas.DataFrame(dict(zip(columns, parts, strict=True)))
        if motion == "velocity":
            frame["s"] = np.gradient(frame["s"], frame["t"])
        frames.append(frame)
    names = {"time": "t", motion: "s", "tangential": "Ft", "radial": "Fr", "normal": "Fn"}
    lie = {"angles": np.rad2deg(ANGLES).tolist()}
    return frames, {"columns": names, "units": {"angle": "deg"}, "run": lie}


@pytest.mark.parametrize(("step", "coarse"), [(1e-3, False), (0.25, True)])
def test_strokes_of_rounded_readings_are_read(step, coarse):
    """Steps count beside the noise of 0.09 N, as they do on a disk."""
    frames, sections = reciprocating()
    names = ["Ft", "Fr"]
    rounded = [frame.assign(**(frame[names] / step).round() * step) for frame in frames]
    fits = [identify.fit_law(identify.load(one, sections)) for one in (frames, rounded)]
    assert any("channel has steps of 0.25" in one for one in fits[1].warnings) == coarse
    assert bool(fits[1].coarse_channels) == coarse
    agree(*fits)


@pytest.mark.parametrize("motion", ["position", "velocity"])
def test_strokes_there_and_back_give_the_same_law(motion):
    data = identify.load(*reciprocating(motion))
    assert not data.goes_round
    # Three times there and back at each angle.
    assert data.turns == 6 * len(ANGLES)
    directions = np.unique(np.rad2deg(data.phi[data.turn >= 0]).round() % 360)
    np.testing.assert_allclose(directions, np.arange(0, 360, 10))
    assert set(data.stroke_means()) == {"tangential", "radial", "normal"}
    options = {"reservoir": "ellipse", "direction": "ellipse"}
    fit = identify.fit_law(data, **options)
    disk = identify.VirtualTribometer(
        lab.ROUND, normal_force=lab.LOAD, turns=5, turn_rate=0.5, sample_rate=1000.0, seed=3
    )
    agree(fit, identify.fit_law(identify.process(disk.record()), **options))
    for name, value in {"reservoir.a": 0.54, "reservoir.b": 0.46, "direction.ratio": 1.5}.items():
        one = fit.parameters[name]
        assert abs(one.value - value) < 4.0 * one.standard_error, name


def test_motions_are_one_kind_each():
    names = {"velocity_x": 1, "tangential": 2, "radial": 3, "normal": 4}
    for columns, message in (
        (names, r"must name one motion \("),
        ({"velocity": 1, "position": 2}, "must name one motion"),
        ({"turn_rate": 1, "angle": 2}, "angle or turn_rate, not both"),
        ({"velocity": 1, "turn_rate": 2}, "a motion of the stage or turn_rate"),
        ({"force_x": 1}, "must name velocity_x and velocity_y"),
        (
            {"velocity_x": 1, "velocity_y": 2, "force_x": 3, "radial": 4},
            "tangential and radial, or",
        ),
        ({"velocity": 1, "force_x": 3, "force_y": 4}, "motions along x and y beside"),
    ):
        with pytest.raises(ParameterError, match=message):
            identify.read_csv("run.csv", columns=columns)
    with pytest.raises(ParameterError, match="angles: are for a stage"):
        identify.read_csv("run.csv", angles=3.0)
    with pytest.raises(ParameterError, match="one for each of 1 files"):
        identify.read_csv("run.csv", columns={"velocity": 1}, angles=[3.0, 4.0])


def test_the_command_inspects_and_overwrites_nothing(write, capsys):
    path = write(lab.german(RUN), encoding="latin-1")
    config = path.with_suffix(".toml")
    assert main(["identify", "--inspect", str(path)]) == 0
    printed = capsys.readouterr().out
    assert "Winkel [°]" in printed
    assert "359.8" in printed
    before = config.read_text()
    config.write_text(before + "# edited\n")
    assert main(["identify", "--inspect", str(path)]) == 0
    again = capsys.readouterr().out
    assert again.startswith(printed.partition("\nconfiguration")[0])
    assert f"{config} is there already and stays as it is" in again
    assert config.read_text() == before + "# edited\n"
    assert main(["identify", "--inspect", str(path), "--config", str(path) + "2.toml"]) == 0
    out = str(path.with_name("out"))
    assert main(["identify", str(path), "--config", str(config), "--out", out]) == 1
    for options, message in (
        ([], "DATA: names no file"),
        ([str(path), "--out", out], r"--config: must be given"),
        ([str(path), "--config", str(config)], "--out: must be given"),
        ([str(path), "--inspect", str(path)], "--inspect: takes one file"),
    ):
        capsys.readouterr()
        assert main(["identify", *options]) == 2
        assert message in capsys.readouterr().err


def test_files_that_are_hard_to_guess(write):
    white = "\n".join(
        f"  {k * 0.01:.2f}   {k * 0.1:.3f}  {1 + k % 3}.5 0.{k % 7} 9.{k % 5}" for k in range(50)
    )
    found = identify.inspect_file(write(white))
    assert found.sections["file"] == {"delimiter": " ", "header": 0}
    assert any("name it in [columns]" in note for note in found.notes)
    marked = write("# rig 3\n# t[s] phi[rad] Ft[N] Fr[N] Fn[N]\n" + white, "marked.txt")
    found = identify.inspect_file(marked)
    assert [one.role for one in found.columns] == [
        "time",
        "angle",
        "tangential",
        "radial",
        "normal",
    ]
    sections = found.sections | {"file": {**found.sections["file"], "check_units": False}}
    assert len(identify.Configuration(sections).read(marked).recordings[0]) == 50
    for text in ("", "It was a dark\nand stormy night\n" * 9):
        with pytest.raises(RecordError, match=r"is empty|holds no table of numbers"):
            identify.inspect_file(write(text))
    lines = [f"{k * 1.0};{3000.0 + k:,.1f}".replace(",", "#").replace(".", ",") for k in range(50)]
    points = "\n".join(["t [s];Fz [N]", *lines]).replace("#", ".")
    found = identify.inspect_file(write(points))
    assert found.sections["file"]["thousands"] == "."
    assert found.columns[1].high == 3049.0


def straight_strokes(directions, *, start=0, motion_noise=1e-4):
    """Return processed data of strokes there and back, three in each direction, 10 mm/s fast.

    Args:
        directions: how many there are over half a circle.
        start: the first of them in degrees.
        motion_noise: of the velocity, as a part of it.
    """
    pandas = pytest.importorskip("pandas")
    random = np.random.default_rng(2)
    step = 180 / directions
    angles = np.deg2rad(np.repeat([start + step * k for k in range(directions)] * 3, 200))
    speed = np.tile(np.repeat([10.0, -10.0], 100), 3 * directions)
    slip = np.stack([np.cos(angles), np.sin(angles)], axis=-1) * np.sign(speed)[:, None]
    # The pin rests for a moment where it turns back.
    moves = np.arange(len(slip)) % 100 >= 2
    moved = 10.0 * (moves[:, None] * slip + motion_noise * random.normal(size=slip.shape))
    force = -lab.LAW.force(slip, normal_force=lab.LOAD) + 0.01 * random.normal(size=slip.shape)
    columns = {"t": np.arange(len(slip)) * 1e-3, "mx": moved[:, 0], "my": moved[:, 1]}
    columns |= {"Fx": force[:, 0], "Fy": force[:, 1]}
    columns["Fz"] = lab.LOAD + 0.01 * random.normal(size=len(slip))
    _, sections = plane("velocity")
    return identify.load(pandas.DataFrame(columns), sections)


def test_noise_of_the_motion_is_no_direction_of_sliding():
    options = {"reservoir": "ellipse", "direction": "ellipse"}
    with pytest.raises(FitError, match="forces in 4 sliding directions"):
        identify.fit_law(straight_strokes(2, motion_noise=0.01), **options)
    fit = identify.fit_law(straight_strokes(12, motion_noise=0.01), **options)
    assert len(fit.coverage.phi) == 24
    assert not fit.gaps


def test_angles_of_the_wrong_sign_are_named_beside_the_radial_channel():
    frames, sections = reciprocating(law=lab.TURNED)
    angles = [-angle for angle in sections["run"]["angles"]]
    changed = sections | {"run": {"angles": angles}}
    fit = identify.fit_law(identify.load(frames, changed))
    assert fit.mistake is not None
    assert "the sign of the radial channel or the sign of the angles turned" in fit.mistake.words
