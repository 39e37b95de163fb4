"""``asperity identify``: from files to figures, tables and a report; garbage exits with 2."""

import csv
import re

import numpy as np
import pytest
from asperity import Ellipse, FrictionLaw
from asperity.commands.main import main
from asperity.demo import table1
from asperity.identify import MeasuredSets, VirtualTribometer, write_raw
from asperity.identify.campaigns.forces import FILES
from scipy.stats import t

LAW = table1.LAWS["extended, superellipses C, D"]


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    folder = tmp_path_factory.mktemp("campaign")
    virtual = VirtualTribometer(
        LAW, normal_force=9.3, turns=4, turn_rate=0.5, sample_rate=500.0, seed=3
    )
    write_raw(virtual.record(), folder)
    return folder


def identify(folder, *files, out, config="tribometer.toml", options=()):
    paths = [str(folder / name) for name in files]
    return main(["identify", *paths, "--config", str(folder / config), "--out", str(out), *options])


def test_a_law_is_identified_from_files(campaign, tmp_path, capsys):
    out = tmp_path / "new" / "out"
    assert identify(campaign, "run_1.csv", out=out) == 0
    assert sorted(file.name for file in out.iterdir()) == sorted(FILES)
    printed = capsys.readouterr().out
    for words in (
        "4 turns",
        "C on e1, e2",
        "closure of D",
        "reservoir.exponent",
        "semi-axes of C at",
    ):
        assert words in printed
    with (out / "parameters.csv").open() as file:
        found = {row["parameter"]: row for row in csv.DictReader(file)}
    for name, value in (
        ("reservoir.a", 4.99 / 9.3),
        ("reservoir.b", 4.25 / 9.3),
        ("reservoir.exponent", 2.94),
        ("direction.ratio", 1.84 / 1.19),
        ("direction.exponent", 2.51),
    ):
        assert float(found[name]["value"]) == pytest.approx(value, rel=0.03)
    assert found["direction.scale"]["identifiable"] == "False"
    assert (out / "report.html").read_text().count("data:image/png;base64") == 4


def test_the_best_models_are_fitted_and_listed(campaign, tmp_path, capsys):
    raw = VirtualTribometer(
        FrictionLaw.collinear(Ellipse(0.5, 0.4)),
        normal_force=9.3,
        turns=4,
        turn_rate=0.5,
        sample_rate=500.0,
        seed=3,
    ).record()
    write_raw(raw, tmp_path)
    assert identify(tmp_path, "run_1.csv", out=tmp_path / "usual") == 0
    assert "(smallest BIC) is ellipse for C and circle for D; fit them" in capsys.readouterr().out
    options = ("--reservoir", "best", "--direction", "best")
    assert identify(tmp_path, "run_1.csv", out=tmp_path / "out", options=options) == 0
    assert "(smallest BIC) is ellipse for C and circle for D\n" in capsys.readouterr().out
    with (tmp_path / "out" / "models.csv").open() as file:
        best = [row for row in csv.DictReader(file) if float(row["bic"]) == 0.0]
    assert [row["model"] for row in best] == ["ellipse, circle"]
    with (tmp_path / "out" / "turns.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["channel"] for row in rows] == ["tangential"] * 4 + ["radial"] * 4 + ["normal"] * 4
    for row in rows[-4:]:
        assert float(row["mean"]) == pytest.approx(9.3, rel=0.02)
    for first in (0, 4, 8):
        means, offsets = (
            np.array([float(row[name]) for row in rows[first : first + 4]])
            for name in ("mean", "offset")
        )
        np.testing.assert_allclose(means - offsets, means.mean())
        half = t.ppf(0.975, 3) * means.std(ddof=1) / 2.0
        assert float(rows[first]["high"]) == pytest.approx(means.mean() + half)
        assert float(rows[first]["low"]) == pytest.approx(means.mean() - half)


def test_the_table_over_directions_holds_measurement_and_model(campaign, tmp_path):
    assert identify(campaign, "run_1.csv", out=tmp_path) == 0
    table = np.genfromtxt(tmp_path / "directions.csv", delimiter=",", names=True)
    phi = table["phi_rad"]
    assert len(phi) == 360
    slip = np.stack([np.cos(phi), np.sin(phi)], axis=1)
    against = -np.sum(LAW.force(slip) * slip, axis=1)
    assert table["model_l_t"] == pytest.approx(against, abs=0.02)
    assert table["measured_l_t"] == pytest.approx(against, abs=0.06)
    assert (table["half_width_l_t"] > 0.0).all()


def test_several_files_are_one_campaign_and_models_can_be_chosen(campaign, tmp_path, capsys):
    header, *lines = (campaign / "run_1.csv").read_text().splitlines()
    for number, half in enumerate((lines[:2000], lines[2000:])):
        (campaign / f"half_{number}.csv").write_text("\n".join([header, *half]))
    code = identify(
        campaign,
        "half_0.csv",
        "half_1.csv",
        out=tmp_path,
        options=["--reservoir", "ellipse", "--direction", "circle", "--loss", "huber"],
    )
    # An ellipse and a disk are not the law: the results are written, to be read with the warning.
    assert code == 1
    printed = capsys.readouterr().out
    assert "warning: the model does not fit" in printed
    assert "4 turns, 2 runs" in printed
    assert "reservoir.exponent" not in printed


def test_the_same_run_twice_is_refused(campaign, tmp_path, capsys):
    assert identify(campaign, "run_1.csv", "run_1.csv", out=tmp_path / "out") == 2
    assert "run_1.csv: is the same as" in capsys.readouterr().err


def broken(folder, kind):
    """Return the text or bytes of a file that is no recording."""
    lines = (folder / "run_1.csv").read_text().splitlines()
    cells = [line.split(",") for line in lines]
    constant = [",".join([*row[:2], "1.25", *row[3:]]) for row in cells[1:]]
    return {
        "empty": "",
        "text": "Dear reader,\nthese are no numbers.\n",
        "missing channel": "\n".join(",".join(row[:4]) for row in cells),
        "constant": "\n".join([lines[0], *constant]),
        "half a turn": "\n".join(lines[:500]),
        "encoding": "\n".join(lines).replace("time", "tîme").encode("utf-16"),
    }[kind]


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("empty", "empty"),
        ("text", "column"),
        ("missing channel", "normal"),
        ("constant", "tangential"),
        ("half a turn", "turn"),
        ("encoding", "encoding"),
    ],
)
def test_garbage_exits_with_2_one_line_and_nothing_written(campaign, tmp_path, capsys, kind, words):
    content = broken(campaign, kind)
    file = campaign / "broken.csv"
    if isinstance(content, bytes):
        file.write_bytes(content)
    else:
        file.write_text(content)
    out = tmp_path / "out"
    assert identify(campaign, "broken.csv", out=out) == 2
    error = capsys.readouterr().err.strip()
    assert error.startswith("asperity: ")
    assert "\n" not in error
    assert "broken.csv" in error
    assert words in error
    assert not out.exists()


@pytest.mark.parametrize(
    ("text", "words"),
    [(None, "none.toml"), ("[columns", "TOML"), ("[colours]\ntime = 1\n", "colours")],
)
def test_configurations_that_cannot_be_used_exit_with_2(campaign, tmp_path, capsys, text, words):
    name = "none.toml"
    if text is not None:
        name = "bad.toml"
        (campaign / name).write_text(text)
    assert identify(campaign, "run_1.csv", out=tmp_path / "out", config=name) == 2
    assert words in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_missing_file_exits_with_2(campaign, tmp_path, capsys):
    assert identify(campaign, "absent.csv", out=tmp_path / "out") == 2
    assert "absent.csv" in capsys.readouterr().err


def test_a_folder_that_cannot_take_the_files_is_refused_at_once(campaign, tmp_path, capsys):
    file = tmp_path / "file"
    file.write_text("kept")
    for out in (file, file / "below"):
        assert identify(campaign, "run_1.csv", out=out) == 2
        assert re.search("--out: must name a folder, .*file is a file", capsys.readouterr().err)
    assert file.read_text() == "kept"
    (tmp_path / "out" / "report.html").mkdir(parents=True)
    assert identify(campaign, "run_1.csv", out=tmp_path / "out") == 2
    assert "--out: must hold no folder of the name report.html" in capsys.readouterr().err
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["report.html"]


def test_results_are_replaced_all_or_none(campaign, tmp_path, monkeypatch):
    def fails(*_, **__):
        raise OSError("disk full")

    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "sets.png").write_text("old")
    monkeypatch.setattr("asperity.identify.campaigns.forces.write_report", fails)
    for out in (tmp_path / "old", tmp_path / "new" / "out"):
        assert identify(campaign, "run_1.csv", out=out) == 2
    assert [path.read_text() for path in (tmp_path / "old").iterdir()] == ["old"]
    assert not (tmp_path / "new").exists()


def test_a_calibration_with_three_loads_is_left_out_of_the_bands(campaign, tmp_path, capsys):
    header, *lines = (campaign / "calibration.csv").read_text().splitlines()
    (campaign / "three.csv").write_text("\n".join([header, *lines[5::6]]))
    (campaign / "three.toml").write_text('[calibration]\nfile = "three.csv"\n')
    assert identify(campaign, "run_1.csv", out=tmp_path, config="three.toml") == 1
    printed = capsys.readouterr().out
    assert "a fourth load or reading_error" in printed
    assert "warning: a calibration without an error: the error of the gains is not known" in printed
    assert "zero              none" in printed


LEFT_OUT = {"calibration": ("gains", "calibration"), "no_load": ("zeros", "zero")}


@pytest.mark.parametrize("section", LEFT_OUT)
def test_errors_that_no_record_tells_are_not_known(campaign, tmp_path, capsys, section):
    """A zero or a gain that is off by 1 % moves C by far more than its bands."""
    what, line = LEFT_OUT[section]
    blocks = (campaign / "tribometer.toml").read_text().split("\n\n")
    rest = [block for block in blocks if not block.startswith(f"[{section}]")]
    assert len(rest) == len(blocks) - 1
    (campaign / "less.toml").write_text("\n\n".join(rest))
    assert identify(campaign, "run_1.csv", out=tmp_path / "all") == 0
    printed = capsys.readouterr().out
    assert "warning" not in printed
    assert "zero              2 records without load" in printed
    assert "not known" not in (tmp_path / "all" / "report.html").read_text()
    assert identify(campaign, "run_1.csv", out=tmp_path / "less", config="less.toml") == 1
    printed = capsys.readouterr().out
    assert f"{line:<18}none" in printed
    assert f"the error of the {what} is not known, 1 %" in printed
    report = (tmp_path / "less" / "report.html").read_text()
    # Seven coordinates, and the sentence.
    assert report.count("<td>not known</td>") == 7
    assert f"the error of the {what} is not known" in report
    assert sorted(path.name for path in (tmp_path / "less").iterdir()) == sorted(FILES)


def test_half_a_turn_beside_a_good_run_is_named(campaign, tmp_path, capsys):
    lines = (campaign / "run_1.csv").read_text().splitlines()
    (campaign / "good.csv").write_text("\n".join(lines[:3501]))
    (campaign / "short.csv").write_text("\n".join([lines[0], *lines[3501:]]))
    out = tmp_path / "out"
    assert identify(campaign, "good.csv", "short.csv", out=out) == 2
    assert "short.csv: angle: covers 0.4" in capsys.readouterr().err


def test_one_turn_is_fitted_without_bands(tmp_path, capsys):
    virtual = VirtualTribometer(LAW, normal_force=9.3, turns=1.2, sample_rate=500.0, seed=1)
    write_raw(virtual.record(), tmp_path)
    assert identify(tmp_path, "run_1.csv", out=tmp_path / "out") == 1
    printed = capsys.readouterr().out
    assert "nan" not in printed
    assert "warning: there are no confidence intervals: one complete turn" in printed
    assert "there are no confidence intervals" in (tmp_path / "out" / "report.html").read_text()


def test_radii_on_the_axes_are_those_of_the_reservoir():
    phi = 2.0 * np.pi * (np.arange(360) + 0.5) / 360
    sets = MeasuredSets(phi, -LAW.force(np.stack([np.cos(phi), np.sin(phi)], axis=1)))
    found = sets.radii_on_axes
    assert found == pytest.approx((4.99 / 9.3, 4.25 / 9.3), rel=5e-3)


def test_options_are_named_as_they_are_typed(campaign, tmp_path, capsys):
    for options, words in (
        (("--confidence", "2"), "--confidence: must lie between 0 and 1"),
        (("--confidence", "1"), "--confidence: must"),
    ):
        assert identify(campaign, "run_1.csv", out=tmp_path / "out", options=options) == 2
        assert words in capsys.readouterr().err


def test_remedies_are_named_as_the_configuration_has_them(campaign, tmp_path, capsys):
    lines = (campaign / "run_1.csv").read_text().splitlines()
    (campaign / "hole.csv").write_text("\n".join([*lines[:100], "0.1,,,,", *lines[101:]]))
    assert identify(campaign, "hole.csv", out=tmp_path / "out") == 2
    told = capsys.readouterr().err
    assert "or split it there; see [file] on_defect in" in told
    assert "tribometer.toml" in told
