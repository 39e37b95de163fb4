"""Times of day and durations, and windows of them; tables in memory with words for numbers."""

import re

import laboratory_files as lab
import numpy as np
import pytest
from asperity import identify
from asperity.errors import AsperityError, ParameterError, RecordError
from asperity.identify.records.tables.text_table import Format, number_in

pandas = pytest.importorskip("pandas")

RUN = lab.run(sample_rate=500.0)
TABLE = lab.table(RUN)
CLOCK = {"units": {"time": "clock"}}
# The run begins three seconds before midnight.
START = pandas.Timestamp("2026-11-23 23:59:57")
MOMENTS = START + pandas.to_timedelta(TABLE[:, 0], unit="s")


def frame(time):
    names = ("angle", "tangential", "radial", "normal")
    return pandas.DataFrame({"time": time, **dict(zip(names, TABLE[:, 1:].T, strict=True))})


TIMES = {
    "undated": MOMENTS.strftime("%H:%M:%S.%f"),
    "dated": MOMENTS.strftime("%Y-%m-%d %H:%M:%S.%f"),
    "datetime64": MOMENTS,
    "datetime.time": [moment.time() for moment in MOMENTS],
}


@pytest.mark.parametrize("kind", TIMES)
@pytest.mark.parametrize(
    ("begin", "end", "first", "samples"),
    [
        ("23:59:58", "00:00:02", 1.0, 2001),
        ("00:00:00.5", "00:00:03", 3.5, 1251),
        ("23:50:00", "00:00:02", 0.0, 2501),
        ("23:59:58", "00:10:00", 1.0, 2700),
        ("23:59:58", None, 1.0, 2700),
    ],
)
def test_windows_without_dates_pass_midnight(kind, begin, end, first, samples):
    window = {"from": begin} if end is None else {"from": begin, "to": end}
    data = identify.load(frame(TIMES[kind]), CLOCK | {"run": window})
    assert len(data.phi) == samples
    assert data.phi[0] == pytest.approx(RUN.angle[round(500 * first)])


def test_windows_that_hold_nothing_are_refused_in_times_of_the_clock():
    held = frame(TIMES["undated"])
    with pytest.raises(
        RecordError,
        match=r"no samples from 00:01:00 .*: its times go from 23:59:57 to 00:00:03\.39",
    ):
        identify.load(held, CLOCK | {"run": {"from": "00:01:00"}})
    with pytest.raises(
        RecordError, match=r"memory from 23:59:57\.5 to 23:59:59: angle: covers 0.75"
    ):
        identify.load(held, CLOCK | {"run": {"from": "23:59:57.5", "to": "23:59:59"}})
    with pytest.raises(ParameterError, match="must have times without a date, like those read"):
        identify.load(held, CLOCK | {"run": {"from": "2026-11-23 23:59:58"}})
    dated = frame(TIMES["dated"])
    whole = identify.load(dated, CLOCK | {"run": {"from": "2026-11-24 00:00:00"}})
    assert len(whole.phi) == 1700
    with pytest.raises(RecordError, match=r"go from 2026-11-23 23:59:57 to 2026-11-24 00:00:03"):
        identify.load(dated, CLOCK | {"run": {"from": "2026-11-25 00:00:00"}})


def test_durations_are_times():
    lasting = frame(pandas.to_timedelta(TABLE[:, 0], unit="s"))
    data = identify.load(lasting, CLOCK)
    np.testing.assert_allclose(data.time, RUN.time, atol=1e-9)
    window = {"from": "00:00:01", "to": "00:00:05"}
    assert len(identify.load(lasting, CLOCK | {"run": window}).phi) == 2001
    for held in (lasting, frame(MOMENTS)):
        with pytest.raises(RecordError, match=r"column 'time' .*: its unit is 'clock'; see units"):
            identify.load(held, {})
    gone = lasting.copy()
    gone.loc[5, "time"] = pandas.NaT
    with pytest.raises(RecordError, match=r"column 'time' \(time\): no number in line 6"):
        identify.load(gone, CLOCK)


def test_words_for_numbers_are_refused_by_what_they_say():
    held = frame(TABLE[:, 0])
    german = held.assign(tangential=[lab.number(x, 5, ",") for x in TABLE[:, 2]])
    with pytest.raises(
        RecordError,
        match=r"column 'tangential' \(tangential\): line 1 reads '5,04393': its decimal mark seems "
        r"to be ','; see decimal",
    ):
        identify.load(german, {})
    read = identify.load(german, {"file": {"decimal": ","}})
    np.testing.assert_allclose(read.force, identify.load(held, {}).force, atol=1e-5)
    groups = held.assign(normal=[lab.number(1e3 * x, 2, thousands=",") for x in TABLE[:, 4]])
    with pytest.raises(
        RecordError, match=r"reads '9,\d\d\d\.\d\d': its digits stand in groups of "
    ):
        identify.load(groups, {"units": {"normal": "mN"}})
    found = identify.load(groups, {"file": {"thousands": ","}, "units": {"normal": "mN"}})
    assert found.turns == 3
    words = held.assign(radial="overload")
    with pytest.raises(AsperityError, match=r"column 'radial' \(radial\): no number in lines 1, 2"):
        identify.load(words, {})


@pytest.mark.parametrize(
    ("decimal", "thousands", "cell", "says"),
    [
        (",", None, "9.5", r"its decimal mark seems to be '\.'; see .*decimal"),
        (",", None, "9.500", r"decimal mark seems to be '\.', or its digits stand in groups of"),
        (
            ",",
            ".",
            "9.5",
            r"'\.' parts groups of three digits, which these are not; see .*thousands",
        ),
        (",", ".", "0.950", r"'\.' parts groups of three digits"),
        (".", ",", "9,5", r"decimal mark seems to be ','|',' parts groups of three digits"),
        (".", " ", "9 5", r"' ' parts groups of three digits"),
    ],
)
def test_a_mark_at_the_wrong_place_is_refused_with_line_and_column(
    tmp_path, decimal, thousands, cell, says
):
    """A point where commas are decimal is an error, and so is a group of other than 3 digits."""
    held = pandas.DataFrame(
        [[lab.number(x, 6, decimal, thousands or "") for x in row] for row in TABLE],
        columns=["time", "angle", "tangential", "radial", "normal"],
    )
    form = {"delimiter": ";", "decimal": decimal}
    form |= {} if thousands is None else {"thousands": thousands}
    held.to_csv(tmp_path / "sound.csv", index=False, sep=";")
    read = identify.load(tmp_path / "sound.csv", {"file": form})
    np.testing.assert_allclose(read.force, identify.load(frame(TABLE[:, 0]), {}).force, atol=1e-5)
    held.loc[6, "normal"] = cell
    held.to_csv(tmp_path / "mixed.csv", index=False, sep=";")
    where = f"column 'normal': line 8 reads '{re.escape(cell)}': .*"
    with pytest.raises(RecordError, match=where + says):
        identify.load(tmp_path / "mixed.csv", {"file": form})


def test_a_point_is_no_delimiter_and_powers_have_no_groups(tmp_path):
    held = pandas.DataFrame(
        [[lab.number(x, 6, ",") for x in row] for row in TABLE],
        columns=["time", "angle", "tangential", "radial", "normal"],
    )
    form = {"delimiter": "?", "decimal": ","}
    held.to_csv(tmp_path / "sound.csv", index=False, sep="?")
    sound = identify.load(tmp_path / "sound.csv", {"file": form})
    assert len(sound.force) == len(TABLE)
    held.assign(normal="9.5").to_csv(tmp_path / "points.csv", index=False, sep="?")
    with pytest.raises(RecordError, match=r"decimal mark seems to be '\.'"):
        identify.load(tmp_path / "points.csv", {"file": form})
    assert np.isnan(number_in("1e1.234", Format(delimiter=";", decimal=",", thousands=".")))


def test_texts_spreadsheets_and_frames_are_refused_in_the_same_words(tmp_path):
    """Integers of four digits may hold a decimal comma or a comma between groups."""
    pytest.importorskip("openpyxl")
    held = frame(TABLE[:, 0])
    words = held.assign(normal=[f"{1000 + i % 3:,}" for i in range(len(held))])
    held.to_csv(tmp_path / "plain.csv", index=False, sep=";")
    words.to_csv(tmp_path / "words.csv", index=False, sep=";")
    held.to_excel(tmp_path / "plain.xlsx", index=False)
    words.to_excel(tmp_path / "words.xlsx", index=False)
    form = {"file": {"delimiter": ";"}}
    for one in (tmp_path / "words.csv", tmp_path / "words.xlsx", words):
        with pytest.raises(RecordError, match=r"decimal mark seems .* groups of") as refused:
            identify.load(one, form)
        assert refused.value.options == ("decimal", "thousands")
    for one in (tmp_path / "plain.csv", tmp_path / "plain.xlsx", held):
        with pytest.raises(RecordError, match=r"'0(\.0)?': not a time of day; see units"):
            identify.load(one, CLOCK | form)
