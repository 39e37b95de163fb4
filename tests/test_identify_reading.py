"""Reading runs of a tribometer: formats, and everything that can be wrong in a file."""

from contextlib import suppress

import asperity as asp
import numpy as np
import pytest
from asperity.errors import ConfigurationError, ParameterError, RecordError
from asperity.identify import (
    Configuration,
    VirtualTribometer,
    process,
    read_csv,
    read_raw,
    write_raw,
)
from asperity.identify.records.configuration import SCHEMA
from asperity.identify.records.tables.headings import factors

LAW = asp.FrictionLaw.collinear(asp.Ellipse(0.5, 0.3))
NAMES = ("time", "angle", "tangential", "radial", "normal")
RUN = VirtualTribometer(
    LAW,
    normal_force=10.0,
    turns=3,
    turn_rate=1.0,
    sample_rate=400.0,
    no_load_time=0.0,
    zero=0.0,
    seed=5,
)


def columns(run):
    return np.column_stack([run.time, run.angle, run.readings])


@pytest.fixture(scope="module")
def run():
    return RUN.record().recordings[0]


@pytest.fixture
def write(tmp_path):
    def make(lines, name="run.csv", encoding="utf-8"):
        path = tmp_path / name
        path.write_text("\n".join(lines) + "\n", encoding=encoding)
        return path

    return make


HEADER = ",".join(NAMES)


def lines_of(table, *, header=(HEADER,), delimiter=",", decimal="."):
    body = (delimiter.join(repr(float(x)).replace(".", decimal) for x in row) for row in table)
    return [*header, *body]


def test_a_plain_file_comes_back_to_the_bit(run, write):
    (read,) = read_csv(write(lines_of(columns(run))))
    assert (columns(read) == columns(run)).all()


def test_a_laboratory_s_file(run, write):
    t, angle, *forces = columns(run).T
    degrees = np.rad2deg(angle) % 360.0
    table = np.column_stack([-1e3 * forces[2], 0.0 * t, degrees, 1e3 * t, *forces[:2]])
    header = ["Rig 3", "", '"Fz (mN)";spare;phi;"t;ms";Ft;Fr']
    path = write(lines_of(table, header=header, delimiter=";", decimal=","), encoding="utf-16")
    where = {"time": "t;ms", "angle": "phi", "tangential": 4, "radial": "Fr", "normal": "Fz (mN)"}
    (read,) = read_csv(
        path,
        columns=where,
        units={"time": "ms", "angle": "deg", "normal": "-mN"},
        delimiter=";",
        decimal=",",
        header=3,
        encoding="utf-16",
    )
    np.testing.assert_allclose(columns(read), columns(run), atol=1e-9)


def test_white_space_and_rates_instead_of_time_and_angle(run, write):
    path = write(lines_of(columns(run)[:, 2:], header=("Ft Fr Fn",), delimiter="  "))
    (read,) = read_csv(
        path,
        columns={"tangential": "Ft", "radial": "Fr", "normal": "Fn"},
        delimiter=" ",
        sample_rate=400.0,
        turn_rate=1.0,
    )
    np.testing.assert_allclose(columns(read), columns(run), atol=1e-12)


def test_a_dead_weight_instead_of_a_normal_channel(run, write):
    path = write(lines_of(columns(run)[:, :4], header=(",".join(NAMES[:4]),)))
    (read,) = read_csv(path, normal_load=9.9)
    assert (read.readings[:, 2] == 9.9).all()
    with pytest.raises(ParameterError, match="normal_load: excludes a column"):
        read_csv(path, normal_load=9.9, columns={"normal": 3})


def test_several_files_are_one_campaign(run, write):
    table = columns(run)
    paths = [write(lines_of(table + 1e-6 * n), f"{n}.csv") for n in range(3)]
    runs = read_csv(paths)
    assert [read.source for read in runs] == [str(path) for path in paths]
    data = process(asp.identify.RawData(runs))
    with pytest.raises(RecordError, match=r"2\.csv: is the same as .*2\.csv"):
        asp.identify.RawData([*runs, runs[2].replace(time=runs[2].time + 10.0)])
    assert data.turns == 9
    assert data.turn[[0, 1200, 2400]].tolist() == [0, 3, 6]


@pytest.mark.parametrize("how", ["text", "empty", "nan", "short"])
def test_missing_numbers_are_reported_with_lines_and_split_off(run, write, how):
    lines = lines_of(columns(run))
    for line in (11, 12, 700):
        cells = lines[line - 1].split(",")
        cells[3] = {"text": "overload", "empty": "", "nan": "NaN", "short": ""}[how]
        lines[line - 1] = ",".join(cells[:3] if how == "short" else cells)
    # Blank lines are no samples, but lines.
    lines.insert(5, "")
    path = write(lines)
    with pytest.raises(RecordError) as caught:
        read_csv(path)
    assert str(path) in str(caught.value)
    assert "'radial'" in str(caught.value)
    assert "no number in lines 12, 13, 701" in str(caught.value)
    pieces = read_csv(path, on_defect="split", check_units=False)
    assert [len(piece) for piece in pieces] == [9, 687, 501]
    assert pieces[1].source.endswith("lines 14-700")


def test_gaps_are_reported_and_split(run, write):
    table = np.delete(columns(run), [100, 101, 500], axis=0)
    path = write(lines_of(table))
    with pytest.raises(RecordError, match=r"'time' \(time\): sampling gap after lines 101, 499"):
        read_csv(path)
    pieces = read_csv(path, on_defect="split", check_units=False)
    assert [len(piece) for piece in pieces] == [100, 398, 699]


def test_time_that_is_rounded_or_out_of_order(run, write):
    table = columns(run)
    table[:, 0] = table[:, 0].round(2)
    path = write(lines_of(table))
    with pytest.raises(
        RecordError, match=r"rounded or out of order after lines .*; see sample_rate, on_defect"
    ):
        read_csv(path)
    table[:, 0] = run.time
    table[[30, 31]] = table[[31, 30]]
    with pytest.raises(RecordError, match=r"out of order after line 32;"):
        read_csv(write(lines_of(table)))


def test_clipping_is_told_from_a_smooth_maximum(run, write):
    table = columns(run)
    limit = np.quantile(table[:, 2], 0.9)
    clipped = table.copy()
    clipped[:, 2] = np.minimum(table[:, 2], limit)
    with pytest.raises(RecordError, match=r"'tangential' .*: clipped in lines .* \(12[01] lines\)"):
        read_csv(write(lines_of(clipped)))
    # A quiet channel that toggles between two levels.
    quiet = columns(run)
    quiet[:, 3] = np.where(np.arange(len(quiet)) % 40 == 0, 0.0, 0.25)
    assert len(read_csv(write(lines_of(quiet)))) == 1
    # Flat tops of a coarse but unclipped channel.
    t = np.arange(20_000) / 2000.0
    step = 8.0 * 10.0 / 2**12
    smooth = [4.0 + np.sin(4.0 * np.pi * t), np.cos(4.0 * np.pi * t), 10.0 + np.sin(2 * np.pi * t)]
    rounded = np.column_stack([t, 2.0 * np.pi * t, *(step * np.round(np.array(smooth) / step))])
    assert len(read_csv(write(lines_of(rounded)))) == 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({1: 180.0 / np.pi}, "as if it were given in degrees"),
        ({1: np.pi / 180.0}, "radians|turns at"),
        ({0: 1e3}, "sample rate of"),
        ({0: 1e-3}, "turns at"),
        ({4: 1e3}, "friction coefficient"),
        ({2: 1e3, 3: 1e3}, "friction coefficient"),
        ({2: 1e4, 3: 1e4, 4: 1e4}, r"normal channel: mean of 9\.518e\+04 N"),
    ],
)
def test_wrong_units_are_told(run, write, change, message):
    table = columns(run)
    for column, factor in change.items():
        table[:, column] *= factor
    path = write(lines_of(table))
    with pytest.raises(RecordError, match=message):
        read_csv(path)
    assert len(read_csv(path, check_units=False)) == 1


@pytest.mark.parametrize(("turn", "unit"), [(360.0, "deg"), (1.0, "turn")])
def test_wrapped_angles_betray_their_unit(run, write, turn, unit):
    table = columns(run)
    table[:, 1] = (table[:, 1] / (2.0 * np.pi) * turn) % turn
    path = write(lines_of(table))
    with pytest.raises(RecordError, match=f"its unit seems to be '{unit}'"):
        read_csv(path)
    (read,) = read_csv(path, units={"angle": unit})
    np.testing.assert_allclose(read.angle, run.angle, atol=1e-9)


GARBAGE = {
    "empty": ("", "is empty"),
    "header only": (",".join(NAMES) + "\n", "holds no numbers"),
    "prose": ("It was a dark\nand stormy, night\n" * 9, "has no column 'time'"),
    "wrong delimiter": (
        ",".join(NAMES) + "\n" + "1;2;3;4;5\n" * 9,
        "see delimiter, decimal, header",
    ),
    "missing channel": ("time,angle,tangential,radial\n1,2,3,4\n", "has no column 'normal'"),
    "constant": (
        "\n".join(
            [",".join(NAMES), *(f"{k / 100},{k / 10},1.0,{k % 3},{9 + k % 2}" for k in range(400))]
        ),
        r"'tangential' \(tangential\): does not change",
    ),
    "at rest": (
        "\n".join(
            [",".join(NAMES), *(f"{k / 100},0.5,{k % 5},{k % 3},{9 + k % 2}" for k in range(400))]
        ),
        r"'angle' \(angle\): does not change",
    ),
}


@pytest.mark.parametrize("name", GARBAGE)
def test_garbage_gets_one_line_with_file_and_remedy(name, tmp_path):
    text, message = GARBAGE[name]
    path = tmp_path / "garbage.csv"
    path.write_text(text)
    with pytest.raises(RecordError, match=message) as caught:
        read_csv(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("content", [b"\xff\xfe\x00\x01" * 50, bytes(range(256)) * 4, b"\x00" * 64])
def test_binary_files_are_refused(tmp_path, content):
    path = tmp_path / "run.csv"
    path.write_bytes(content)
    with pytest.raises(RecordError) as caught:
        read_csv(path)
    assert "\n" not in str(caught.value)


def test_files_that_are_not_there(tmp_path):
    with pytest.raises(RecordError, match="cannot be read: No such file"):
        read_csv(tmp_path / "none.csv")
    with pytest.raises(RecordError, match="is a folder: name the file in it"):
        read_csv(tmp_path)
    with pytest.raises(ParameterError, match="paths"):
        read_csv([])


@pytest.mark.parametrize(
    ("options", "argument"),
    [
        ({"columns": {"vertical": 3}}, "columns"),
        ({"columns": {"time": 0.5}}, "columns"),
        ({"columns": {"time": -1}}, "columns"),
        ({"units": {"angle": "gon"}}, "units"),
        ({"units": {"vertical": "N"}}, "units"),
        ({"delimiter": "::"}, "delimiter"),
        ({"delimiter": ",", "decimal": ","}, "delimiter"),
        ({"decimal": "'"}, "decimal"),
        ({"header": -1}, "header"),
        ({"encoding": "klingon"}, "encoding"),
        ({"on_defect": "patch"}, "on_defect"),
        ({"sample_rate": 0.0}, "sample_rate"),
    ],
)
def test_bad_options_name_themselves(run, write, options, argument):
    with pytest.raises(ParameterError) as caught:
        read_csv(write(lines_of(columns(run))), **options)
    assert caught.value.argument == argument


def test_signs_and_prefixes_of_units():
    found = factors({"time": "us", "angle": "deg", "radial": "-cN", "normal": "kN"})
    expected = {"time": 1e-6, "angle": np.pi / 180, "tangential": 1, "radial": -0.01, "normal": 1e3}
    assert {name: found[name] for name in expected} == pytest.approx(expected)


def test_raw_data_come_back_to_the_bit(tmp_path):
    virtual = VirtualTribometer(LAW, normal_force=10.0, turns=2, sample_rate=500.0, seed=6)
    names = virtual.write(tmp_path / "campaign")
    assert names == [
        "run_1.csv",
        "no_load_1.csv",
        "no_load_2.csv",
        "calibration.csv",
        "tribometer.toml",
    ]
    folder = tmp_path / "campaign"
    read, made = read_raw(folder / "run_1.csv", folder / "tribometer.toml"), virtual.record()
    assert read.calibration == made.calibration
    for one, other in zip(
        read.recordings + read.no_load, made.recordings + made.no_load, strict=True
    ):
        assert (columns(one) == columns(other)).all()
    assert (process(read).force == process(made).force).all()


def test_a_configuration_says_how_to_read_and_process(run, write, tmp_path):
    text = """
        [file]
        delimiter = ";"
        decimal = ","
        header = 0
        [columns]
        time = 0
        angle = 1
        tangential = 2
        radial = 3
        normal = 4
        [units]
        angle = "deg"
        [calibration]
        loads = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        readings = [[2, 0, 0], [0, 2, 0], [0, 0, 2]]
        [processing]
        cut_off = 30
        grid_angle = 0.1
    """
    (tmp_path / "rig.toml").write_text(text)
    table = columns(run) * [1.0, 180.0 / np.pi, 2.0, 2.0, 2.0]
    path = write(lines_of(table, header=(), delimiter=";", decimal=","))
    configuration = Configuration.load(tmp_path / "rig.toml")
    data = process(configuration.read(path))
    expected = process(asp.identify.RawData([run]), cut_off=30.0, grid_angle=0.1)
    np.testing.assert_allclose(data.force, expected.force, atol=1e-12)
    np.testing.assert_allclose(data.phi, expected.phi, atol=1e-12)


OPTIONS = {
    "cut_off": ("5.0", 5.0),
    "order": ("2", 2),
    "grid_angle": ("0.5", 0.5),
}


def test_every_option_of_processing_is_tried():
    assert set(OPTIONS) == set(SCHEMA["processing"])


@pytest.mark.parametrize("key", OPTIONS)
def test_what_is_read_is_processed_as_the_configuration_says(tmp_path, key):
    text, value = OPTIONS[key]
    machine = VirtualTribometer(
        asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.4)),
        normal_force=9.3,
        turns=3,
        turn_rate=1.0,
        sample_rate=200.0,
    )
    machine.write(tmp_path)
    config, path = tmp_path / "tribometer.toml", tmp_path / "run_1.csv"
    plain = process(read_raw(path, config))
    with config.open("a") as file:
        file.write(f"\n[processing]\n{key} = {text}\n")
    raw = read_raw(path, config)
    expected = process(machine.record(), **{key: value})
    data = process(raw)
    assert (data.force == expected.force).all()
    assert (data.phi == expected.phi).all()
    assert (data.normal_force == expected.normal_force).all()
    assert any(
        (getattr(expected, name) != getattr(plain, name)).any() for name in ("phi", "normal_force")
    )
    # What is given to `process` itself goes before, and options survive another round by files.
    assert process(raw, **{key: getattr(plain, key)}).force.tolist() == plain.force.tolist()
    write_raw(raw, tmp_path / "again")
    again = read_raw(tmp_path / "again" / "run_1.csv", tmp_path / "again" / "tribometer.toml")
    assert process(again).force.tolist() == expected.force.tolist()
    assert again.processing == raw.processing


@pytest.mark.parametrize("none", ["false", "'none'"])
def test_a_configuration_can_switch_the_filter_off(tmp_path, none):
    VirtualTribometer(
        asp.FrictionLaw.isotropic(0.2), normal_force=9.3, turns=3, turn_rate=1.0, sample_rate=200.0
    ).write(tmp_path)
    config = tmp_path / "tribometer.toml"
    with config.open("a") as file:
        file.write(f"\n[processing]\ncut_off = {none}\n")
    assert process(read_raw(tmp_path / "run_1.csv", config)).cut_off is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[file", r"rig\.toml.*: is not TOML"),
        (
            "\ufeffdelimiter = ';'",
            r"line 1: delimiter: is not known here, it belongs into \[file\]",
        ),
        ("\n[camera]\nfps = 3", r"line 2: camera: is not known; known are file, columns"),
        ("[unit]\ntime = 's'", r"line 1: unit: is not known, did you mean 'units'\?"),
        ("[units]\ntorque = 'm'", r"line 2: \[units\] torque: is not known; known are time"),
        ("[file]\n\ndelimeter = ';'", r"line 3: \[file\] delimeter: .* did you mean 'delimiter'"),
        ("[units]\ndecimal = ','", r"line 2: \[units\] decimal: .* belongs into \[file\]"),
        ("units = 3", r"line 1: \[units\]: must be a section"),
        ("[file]\nencoding = 5", r"\[file\] encoding: must be a text, got 5"),
        ("file.encoding = 5", r"\[file\] encoding: must be a text, got 5"),
        ("[file]\ncheck_units = 'no'", r"\[file\] check_units: must be true or false"),
        ("[file]\nheader = true", r"\[file\] header: must be a whole number"),
        ("[no_load]\nfiles = 5", r"\[no_load\] files: must be a text or several"),
        ("[no_load]\nfiles = [5]", r"\[no_load\] files: must be a text or several"),
        ("[columns]\ntime = [1]", r"\[columns\] time: must be a name or a number"),
        ("[units]\ntime = 5", r"\[units\] time: must be a text"),
        ("[calibration]\nfile = 5", r"\[calibration\] file: must be a text"),
        ("[calibration]\nloads = [['x']]", r"\[calibration\] loads: must be numbers"),
        ("[tribometer]\nradius = '5 cm'", r"\[tribometer\] radius: must be a number"),
        ("[processing]\ncut_off = true", r"\[processing\] cut_off: must be a number"),
    ],
)
def test_wrong_configurations_name_line_and_key(tmp_path, text, message):
    path = tmp_path / "rig.toml"
    path.write_text(text)
    with pytest.raises(ConfigurationError, match=message) as caught:
        Configuration.load(path)
    assert caught.value.file == str(path)


def test_wrong_calibration_files(run, write):
    path = write(lines_of(columns(run)))
    with pytest.raises(ParameterError, match="calibration: must give file, or loads"):
        Configuration({"calibration": {"loads": [[1, 2, 3]]}}).read(path)
    header = "load_tangential,load_radial,load_normal,tangential,radial,normal"
    weighings = write([header, "1,0,0,1,0,0", "0,1,0,0,x,0", "0,0,1,0,0,1"], "weights.csv")
    with pytest.raises(RecordError, match=r"weights\.csv: no number in line 3"):
        Configuration({"calibration": {"file": "weights.csv"}}, folder=path.parent).read(path)
    weighings.write_text(header + "\n1,0,0,1,0,0\n")
    with pytest.raises(RecordError, match="must act along all three axes"):
        Configuration({"calibration": {"file": "weights.csv"}}, folder=path.parent).read(path)


def test_damaged_files_raise_nothing_but_our_errors(run, tmp_path):
    whole = "\n".join(lines_of(columns(run)[:300])).encode()
    random, path = np.random.default_rng(7), tmp_path / "run.csv"
    for _ in range(150):
        damaged = bytearray(whole)
        for _ in range(random.integers(1, 40)):
            at = random.integers(len(damaged))
            kind = random.integers(3)
            if kind == 0:
                damaged[at] = random.integers(256)
            elif kind == 1:
                del damaged[at : at + random.integers(1, 200)]
            else:
                damaged[at:at] = damaged[: random.integers(1, 50)]
        path.write_bytes(bytes(damaged))
        for on_defect in ("raise", "split"):
            with suppress(RecordError):
                runs = read_csv(path, on_defect=on_defect)
                assert all(np.isfinite(columns(read)).all() for read in runs)


NORMAL_MIX = np.array([[1.0, 0.02, 0.06], [-0.03, 1.1, -0.05], [0.04, 0.01, 0.9]])


def test_a_given_load_keeps_the_crosstalk_of_the_normal_channel(tmp_path):
    virtual = VirtualTribometer(
        LAW,
        normal_force=10.0,
        turns=2,
        sample_rate=500.0,
        load_ripple=0.0,
        crosstalk=NORMAL_MIX,
        noise=0.001,
        drift=0.0,
        zero=0.1,
        seed=6,
    )
    raw = virtual.record().replace(normal_load=10.0)
    write_raw(raw, tmp_path)
    read = read_raw(tmp_path / "run_1.csv", tmp_path / "tribometer.toml")
    assert (columns(read.no_load[0]) == columns(raw.no_load[0])).all()
    assert (process(read).force == process(raw).force).all()
    means = process(read).averaged(72)
    exact = -LAW.force(np.stack([np.cos(means.phi), np.sin(means.phi)], axis=1), normal_force=10.0)
    np.testing.assert_allclose(means.force, exact, atol=0.03)


def test_a_load_cannot_stand_for_a_normal_channel_that_disturbs_the_others(run, write):
    table = columns(run)[:, :4]
    path = write(lines_of(table, header=(",".join(NAMES[:4]),)))
    idle = columns(run.replace(time=run.time - 10.0, readings=0.01 * run.readings))[:, :4]
    write(lines_of(idle, header=(",".join(NAMES[:4]),)), "idle.csv")
    loads = np.eye(3)

    def configuration(mixing):
        readings = (loads @ mixing.T).tolist()
        sections = {
            "tribometer": {"normal_load": 10.0},
            "no_load": {"files": ["idle.csv"]},
            "calibration": {"loads": loads.tolist(), "readings": readings, "reading_error": 1e-3},
        }
        return Configuration(sections, folder=path.parent)

    with pytest.raises(RecordError, match="give the column of the normal channel"):
        configuration(NORMAL_MIX).read(path)
    flat = NORMAL_MIX * [[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    raw = configuration(flat).read(path)
    # Without load there is none, whatever the runs carry.
    assert (raw.no_load[0].readings[:, 2] == 0.0).all()
    assert (raw.recordings[0].readings[:, 2] == 10.0).all()


def test_a_given_load_that_no_channel_shows_comes_back(run, tmp_path):
    readings = np.column_stack([run.readings[:, :2], np.full(len(run), 9.9)])
    raw = asp.identify.RawData([run.replace(readings=readings)], normal_load=9.9)
    write_raw(raw, tmp_path)
    assert (tmp_path / "run_1.csv").read_text().splitlines()[0] == ",".join(NAMES[:4])
    read = read_raw(tmp_path / "run_1.csv", tmp_path / "tribometer.toml")
    assert (columns(read.recordings[0]) == columns(raw.recordings[0])).all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[file]\nsample_rate = -1", r"rig\.toml, line 2: \[file\] sample_rate"),
        ("[processing]\norder = 0", r"rig\.toml, line 2: \[processing\] order"),
        (
            "\n[columns]\nradial = 'tangential'",
            r"rig\.toml, line 2: \[columns\]: give the same column for tangential and radial",
        ),
        (
            "[columns]\ntime = 99",
            r"run\.csv: has no column 99 \(time\), 5 columns; see \[columns\] in .*rig\.toml",
        ),
        ("[columns]\ntime = 't'", r"has no column 't', only .*'; see \[columns\] in .*rig\.toml"),
        (
            "[file]\nheader = 2",
            r"has no column 'time', only .*, the names in line 2, the last of the header: if .* "
            r"numbers of the columns, .*; see \[file\] names, \[columns\] in .*rig\.toml",
        ),
        (
            "[file]\ndelimiter = ';'\nheader = 0\n[columns]\ntime = 0\nangle = 1\n"
            "tangential = 2\nradial = 3\nnormal = 4",
            r"run\.csv: is not a table of numbers: line 1 reads .*; "
            r"see \[file\] delimiter, \[file\] decimal, \[file\] header in .*rig\.toml",
        ),
        (
            "[units]\nnormal = 'kN'",
            r"wrong unit\?; see \[units\], \[file\] check_units in .*rig\.toml",
        ),
        ("[file]\nencoding = 'utf-16'", r"is not utf-16 text.*; see \[file\] encoding in .*rig\.t"),
        (
            "[calibration]\nloads = [[1, 2, 3]]",
            r"rig\.toml, line 1: \[calibration\]: must give file",
        ),
    ],
)
def test_wrong_options_name_file_and_section(run, write, text, message):
    path = write(lines_of(columns(run)))
    config = write([text], "rig.toml")

    with pytest.raises((ConfigurationError, RecordError), match=message):
        read_raw(path, config)


def test_one_sample_is_no_run(run, write):
    path = write(lines_of(columns(run)[:1]))
    with pytest.raises(RecordError, match=r"run\.csv: holds one sample only"):
        read_csv(path)


def test_long_names_are_cut_and_latin_text_is_named(tmp_path):
    path = tmp_path / "run.csv"
    path.write_bytes(b"\0" * 1000)
    with pytest.raises(RecordError) as caught:
        read_csv(path)
    assert len(str(caught.value)) < len(str(path)) + 300
    path.write_bytes("Größe,1\n".encode("latin-1"))
    with pytest.raises(RecordError, match="'latin-1' or 'utf-16'"):
        read_csv(path)
