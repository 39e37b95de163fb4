"""What `inspect_file` makes of files as programs of tribometers write them."""

import laboratory_files as lab
import numpy as np
import pytest
from asperity import identify
from asperity.commands.main import main
from asperity.errors import AsperityError, RecordError
from asperity.identify.records.tables import clock

RUN = lab.run(sample_rate=250.0)
DATA = identify.process(identify.RawData([RUN]))

# What is left to be said of each file, begins of sentences.
FILES = {
    "one column of time": (lambda run: lab.labview_measurement(run), []),
    "no column of time": (lambda run: lab.labview_measurement(run, x="No"), []),
    "columns of time": (lambda run: lab.labview_measurement(run, x="Multi"), []),
    "parts": (lambda run: lab.labview_measurement(run, parts=5), []),
    "parts without time": (lambda run: lab.labview_measurement(run, x="No", parts=5), []),
    "decimal commas": (lambda run: lab.labview_measurement(run, decimal=","), []),
    "no comments": (lambda run: lab.labview_measurement(run, comment=False), []),
    "whole numbers in groups": (lab.whole_numbers, ["counts_per_turn: 4096 by where it starts"]),
    "durations": (lambda run: lab.matlab(run, time="duration"), ["angle: no unit"]),
    "dates with names": (lambda run: lab.matlab(run, time="date"), ["angle: no unit"]),
    "blanks": (lab.marked_blanks, []),
    "umt": (lab.umt, ["normal: negative"]),
    "rtec": (lab.rtec, []),
    "csm": (lab.csm, []),
    "catman": (lab.catman, []),
    "date and time": (lab.date_and_time, []),
}


@pytest.mark.parametrize("name", FILES)
def test_inspection_alone_reads_files_of_programs(name, tmp_path):
    make, notes = FILES[name]
    path = tmp_path / "run.lvm"
    path.write_text(make(RUN), encoding="utf-8")
    found = identify.inspect_file(path)
    assert len(found.notes) >= len(notes)
    assert all(note.startswith(tuple(notes)) or "N is taken" in note for note in found.notes)
    found.write(tmp_path / "run.toml")
    data = identify.load(path, tmp_path / "run.toml")
    assert data.turns == DATA.turns
    whole = name == "whole numbers in groups"
    np.testing.assert_allclose(data.force, DATA.force, atol=1e-2 if whole else 2e-5)
    # Ranges are those of all parts, in the units of the file.
    angle = next(one for one in found.columns if one.role == "angle")
    highest = {"counts": 4092.0, "": 20.1}.get(angle.unit, 359.8)
    assert angle.low == 0.0
    assert angle.high == pytest.approx(highest, rel=3e-3)


def test_counts_that_do_not_start_again_do_not_tell_a_turn(tmp_path):
    counts = np.floor(RUN.angle / (2.0 * np.pi) * 4096)
    columns = np.column_stack([RUN.time, counts, RUN.readings])
    body = [";".join(f"{x:.5f}" for x in row) for row in columns]
    path = tmp_path / "run.csv"
    path.write_text("\n".join(["t [s];Encoder [counts];Ft [N];Fr [N];Fn [N]", *body]))
    found = identify.inspect_file(path)
    assert "counts_per_turn" not in found.sections["file"]
    assert found.notes[0].startswith("counts_per_turn: the counts do not start again")
    sections = found.sections | {"file": found.sections["file"] | {"counts_per_turn": 4096}}
    assert identify.load(path, sections).turns == 3


def book(path, *, info=True):
    """Write a workbook whose data, with a rest of the disk first, are on its second sheet."""
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("openpyxl")
    raw = lab.machine(no_load_time=6.0, zero=0.02, sample_rate=350.0).record()
    parts = [lab.table(one) for one in (raw.no_load[0], raw.recordings[0])]
    columns = np.vstack(parts)
    columns[:, 0] -= columns[0, 0]
    counts = np.floor(columns[:, 1] / (2.0 * np.pi) * 4096).astype(int) % 4096
    names = ["Zeit [s]", "Encoder [counts]", "Ft [N]", "Fr [N]", "Fn [N]"]
    values = [columns[:, 0], counts, *columns[:, 2:].T]
    data = pandas.DataFrame(dict(zip(names, values, strict=True)))
    said = pandas.DataFrame([["Prüfer", "Müller"], ["Last", 9.3], ["Radius", 0.05]])
    weighed = pandas.DataFrame({"Last [N]": [0.0, 5.0, 10.0], "Anzeige [V]": [0.0, 1.1, 2.2]})
    with pandas.ExcelWriter(path) as writer:
        if info:
            said.to_excel(writer, sheet_name="Info", index=False, header=False)
        data.to_excel(writer, sheet_name="Daten", index=False)
        weighed.to_excel(writer, sheet_name="Kalibrierung", index=False)
    return columns


def test_the_sheet_with_the_data_is_found_and_named(tmp_path, capsys):
    path = tmp_path / "run.xlsx"
    columns = book(path)
    found = identify.inspect_file(path)
    assert found.sections["file"]["sheet"] == "Daten"
    assert found.notes[0] == "sheet: 'Daten' seems to hold the data, beside 'Info', 'Kalibrierung'"
    window = {"run": {"from": 6.0}, "no_load": {"to": 5.9}}
    assert identify.load(path, found.sections | window).turns == 3
    for given, kept in (("Daten", 'sheet = "Daten"'), ("1", "sheet = 1"), (None, '"Daten"')):
        config = tmp_path / f"{given}.toml"
        options = ["--sheet", given] if given else []
        assert main(["identify", "--inspect", str(path), "--config", str(config), *options]) == 1
        assert kept in config.read_text()
        assert f"{columns[-1, 0]:.6g}" in capsys.readouterr().out
    assert main(["identify", "--inspect", str(path), "--sheet", "Info"]) == 2
    assert "holds no table of numbers" in capsys.readouterr().err
    assert main(["identify", str(path), "--sheet", "Daten", "--config", str(config)]) == 2
    assert "--sheet: is for --inspect" in capsys.readouterr().err
    with pytest.raises(AsperityError, match=r"has no column 'time', only .*; see columns, sheet"):
        identify.read_csv(path)


def test_durations_and_names_of_months():
    assert clock.seconds("0.25 sec") == 0.25
    assert clock.seconds("1.5 min") == 90.0
    day = clock.seconds("2026-11-23 12:00:00")
    assert clock.seconds("23-Nov-2026 12:00:00") == clock.seconds("23.Nov.2026 12:00:00") == day
    assert clock.seconds("23/Nov/2026 12:00:00") == day
    assert clock.seconds("05-Mär-2026 00:00:00") == clock.seconds("05.03.2026 00:00:00")
    assert np.isnan(clock.seconds("23-Foo-2026 12:00:00"))
    assert np.isnan(clock.seconds("1.5 parsec"))


def test_one_axis_that_moves_is_a_line(tmp_path):
    time, place, velocity = lab.back_and_forth(
        "sine", length=10e-3, speed=10e-3, dwell=0.2, rate=200.0, repeats=5
    )
    random = np.random.default_rng(1)
    along, across = 4.0 * np.sign(velocity), 0.2 * np.sign(velocity)
    noise = 0.01 * random.normal(size=(3, time.size))
    columns = np.stack([time, 1e3 * place, along + noise[0], across + noise[1], -9.3 + noise[2]])
    body = [",".join(f"{x:.4f}" for x in row) for row in columns.T]
    path = tmp_path / "run.csv"
    names = "Timestamp(sec),Y Position(mm),Ff(N),Fy(N),Fz(N)"
    path.write_text("\n".join(["Step 1", names, *body]))
    found = identify.inspect_file(path)
    roles = ["time", "position", "tangential", "radial", "normal"]
    assert [one.role for one in found.columns] == roles
    assert identify.load(path, found.sections).turns == 10
    # Forces along x and y leave open which is across, and of which sign.
    path.write_text("\n".join([names.replace("Ff", "Fx"), *body]))
    assert "position" not in [one.role for one in identify.inspect_file(path).columns]


def test_times_that_are_rounded_have_no_gaps(tmp_path):
    """Whole ms at 700 Hz are steps of one and of two."""
    run = lab.run(sample_rate=700.0)
    columns = lab.table(run)
    columns[:, 0] = np.floor(1e3 * columns[:, 0])
    path = tmp_path / "run.csv"
    body = [",".join(f"{x:.6f}" for x in row) for row in columns]
    path.write_text("\n".join(["time,angle,tangential,radial,normal", *body]))
    with pytest.raises(RecordError, match=r"rounded or out of order after .*see sample_rate"):
        identify.read_csv(path, units={"time": "ms"})
    lost = np.delete(np.arange(len(columns)), [700, 1100, 1500])
    columns[:, 0] = 1e3 * lab.table(run)[:, 0]
    body = [",".join(f"{x:.6f}" for x in columns[at]) for at in lost]
    path.write_text("\n".join(["time,angle,tangential,radial,normal", *body]))
    with pytest.raises(RecordError, match=r"sampling gap after lines 701, 1100, 1499"):
        identify.read_csv(path, units={"time": "ms"})
