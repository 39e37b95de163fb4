"""Headings as machines and programs write them: columns are read as meant, or asked for."""

import datetime
import pickle

import laboratory_files as lab
import numpy as np
import pytest
from asperity import identify
from asperity.errors import RecordError

RUN = lab.run(sample_rate=250.0)
DATA = identify.process(identify.RawData([RUN]))
T, A, X, Y, Z = lab.table(RUN).T
N = T.size
RANDOM = np.random.default_rng(4)
G = 9.80665

# What columns hold, by a short name: what they are, and their numbers.
HELD = {
    "s": ("time", T),
    "ms": ("time", 1e3 * T),
    "min": ("time", T / 60.0),
    "deg": ("angle", np.rad2deg(A) % 360.0),
    "rad": ("angle", A),
    "rev": ("angle", A / (2.0 * np.pi)),
    "rpm": ("turn_rate", np.gradient(A, T) * 60.0 / (2.0 * np.pi)),
    **{
        f"{axis}{unit}": (role, force / factor)
        for axis, role, force in (("x", "tangential", X), ("y", "radial", Y), ("z", "normal", Z))
        for unit, factor in (("", 1.0), ("mN", 1e-3), ("daN", 10.0), ("kN", 1e3), ("V", 40.0),
                             ("g", 1e-3 * G), ("kg", G), ("lb", 0.45359237 * G), ("-", -1.0),
                             ("kg-", -G))
    },
    # What is none of them.
    "cof": ("", np.hypot(X, Y) / Z),
    "mag": ("", np.hypot(X, Y)),
    "temp": ("", 23.0 + 0.01 * T + 0.01 * RANDOM.normal(size=N)),
    "set": ("", np.full(N, lab.LOAD)),
    "wear": ("", 2.0 + 0.3 * RANDOM.normal(size=N)),
    "step": ("", np.ones(N)),
    "way": ("", 0.02 * A),
    "lin": ("position", 0.02 * np.sin(A)),
    "speed": ("", np.full(N, 0.06)),
    "count": ("", np.arange(N)),
}  # fmt: skip

# Heading lines, then what the columns hold, then the channels that are asked for. A semicolon parts
# cells where there is one, else a tab, else a comma, else blanks.
HEADINGS = {
    "umt, comma": ("Time (sec),Fx (N),Fy (N),Fz (N),COF,Angle (deg)", "s x y z- cof deg", ""),
    "umt, viewer": ("Fx\tFy\tFz\tA\tT\tCOF\nN\tN\tN\tdeg\tsec\t", "x y z deg s cof", ""),
    "umt, gram": ("Fx,Fz,Fy,T,A\n\ng,g,g,sec,deg", "xg zg yg s deg", ""),
    "umt, kg": ("T (s),A (deg),Fx (kg),Fy (kg),Fz (kg)", "s deg xkg ykg zkg-", "negative"),
    "umt, two axes": ("T (s),A (deg),Fx (N),Fz (N),Ff (N),AE (V)", "s deg x z x wear", "radial"),
    "umt, contact": ("Time[s],Angle[deg],Fx[N],Fz[N],ECR[mV]", "s deg x z wear", "radial"),
    "trb3": (
        "Time [s]\tDistance [m]\tLinear Position [m]\tAngular Position [rad]\tSpeed [m/s]\t"
        "Normal Force [N]\tFriction Force [N]\tOven Temperature [°C]\tCoefficient of Friction\t"
        "Nominal Load [N]",
        "s way lin rad speed z x temp cof set",
        "radial",
    ),
    "trb3, blanks": (
        "Time [s]  Distance [m]  laps  Sequence ID  Max Linear Speed [m/s]  Normal force [N]  "
        "Friction force [N]  Lateral force [N]  Angle [°]",
        "s way rev step speed z x y deg",
        "",
    ),
    "trb, one blank": ("Time s Angle deg Ft N Fr N Fn N", "s deg x y z", "time angle tangential "
                       "radial normal"),
    "csm": ("Time [s]\tµ\tFn [N]\tFt [N]\tFl [N]\tAngle [°]", "s cof z x y deg", "radial"),
    "nano": ("t (s);angle (°);Ft (mN);Fr (mN);Fn (mN)", "s deg xmN ymN zmN", ""),
    "rtec": (
        "Timestamp,Step,DAQ.Fz (N),DAQ.Fx (N),DAQ.Fy (N),Rotary.Position (deg),"
        "Rotary.Velocity (rpm)",
        "s step z x y deg rpm",
        "",
    ),
    "rtec, magnitude": ("Time (s),Position (deg),Fx (N),Fy (N),Fz (N),Ff (N)",
                        "s deg x y z mag", ""),
    "falex": ("Time (min),Load (lb),Friction Force (lb),Radial Force (lb),Rotation (rev)",
              "min zlb xlb ylb rev", ""),
    "te77": ("Time s,Force N,Load N,Stroke mm,Temp °C", "s x z lin temp",
             "tangential radial"),
    "te88": ("elapsed_time_s,friction_N,load_N,side_force_N,angle_deg", "s x z y deg", ""),
    "srv": ("Zeit [s];Normalkraft [N];Reibkraft [N];Reibungszahl [-];Hub [mm];Temperatur [°C]",
            "s z x cof lin temp", "radial"),
    "ducom": ("Time(Sec),Normal Load (N),Friction Force(N),Coefficient of Friction,Depth (Microns),"
              "Speed (RPM),Angle (Degree)", "s z x cof wear rpm deg", "radial"),
    "nanovea": ("Time(s),Revolution(rev),Friction Force (N),Load (N),COF", "s rev x z cof",
                "radial"),
    "koehler": ("Time, sec;Angle, deg;Friction, lbf;Lateral, lbf;Load, lbf",
                "s deg xlb ylb zlb", ""),
    "mtm": ("Step Time (s),Traction Force (N),Ball Load (N),Rolling Speed (mm/s),Angle (deg)",
            "s x z speed deg", "normal radial"),
    "labview, volts": ("Time (s)\tAngle (deg)\tVoltage_0 (V)\tVoltage_1 (V)\tVoltage_2 (V)",
                       "s deg xV yV zV", "calibration"),
    "volts": ("t [s],phi [°],Ft [V],Fr [V],Fn [N]", "s deg xV yV z", "calibration"),
    "diadem": ("Time,Angle,FT,FR,FN\ns,°,N,N,kN", "s deg x y zkN", ""),
    "diadem, label": ("Name;Zeit;Winkel;Reibkraft;Querkraft;Normalkraft\nEinheit;s;°;N;N;daN",
                      "s deg x y zdaN", ""),
    "kistler": ("Time [s];Fx [N];Fy [N];Fz [N];Mz [N·m];Winkel [°]", "s x y z wear deg", ""),
    "kistler, order": ("Time [s];Fz [N];Fy [N];Fx [N];Winkel [°]", "s z y x deg", ""),
    "catman": ("Zeit [s]\tDrehwinkel [°]\tKraft X [N]\tKraft Y [N]\tKraft Z [N]",
               "s deg x y z", ""),
    "catman, lines": ("Zeit\tWinkel\tKraft_X\tKraft_Y\tKraft_Z\ns\tGrad\tN\tN\tN\n\t\tCh 1\tCh 2\t"
                      "Ch 3", "s deg x y z", ""),
    "frames, symbols": ("t_ms,phi_rad,F_T,F_R,F_N", "ms rad x y z", ""),
    "frames, mixed": ("time_ms,phi_deg,ft_mN,fr_mN,fn_kN", "ms deg xmN ymN zkN", ""),
    "temperature": ("T,Time,Phi,Ft,Fr,Fn", "temp s deg x y z", ""),
    "temperature alone": ("T,Phi [deg],Ft [N],Fr [N],Fn [N]", "temp deg x y z", "time"),
    "speed first": ("Speed mm/sec,Ft [N],Fr [N],Fn [N],Angle [deg]", "speed x y z deg", "time"),
    "rpm": ("t [s],n [r/min],Ft [daN],Fr [daN],Fn [daN]", "s rpm xdaN ydaN zdaN", ""),
    "order": ("t [s],phi [deg],Kraft 1 [N],Kraft 2 [N],Kraft 3 [N]", "s deg x y z", "order"),
    "unknown units": ("t,phi,Ft,Fr,Fn,pH,RH\ns,deg,N,N,N,pH,%", "s deg x y z wear temp", ""),
    "strange unit": ("t [s],phi [deg],Ft [N],Fr [N],Fn [dyn]", "s deg x y z", "normal"),
    "setpoint first": ("t [s],phi [deg],Load setpoint [N],Ft [N],Fr [N],Load [N]",
                       "s deg set x y z", ""),
    "one name twice": ("time,angle,normal,tangential,radial,normal", "s rad zkg x y z", "normal"),
    "two loads": ("t [s],phi [deg],Fz [N],Load [N],Ft [N],Fr [N]", "s deg z zkg x y", "Load"),
    "friction or coefficient": ("t [s],phi [deg],Friction,Lateral [N],Load [N]",
                                "s deg cof y z", "tangential"),
    "row names": ("time,angle,tangential,radial,normal", "count s rad x y z", "time angle "
                  "tangential radial normal"),
    "french": ("Temps [s];Angle [°];Force tangentielle [N];Force radiale [N];Force normale [N]",
               "s deg x y z", ""),
    "blank and brackets": ("Time,Angle,Ft,Fr,Fn\n\n[s],[deg],[N],[N],[N]", "s deg x y z", ""),
    "units above": ("s,deg,N,N,N\nTime,Angle,Ft,Fr,Fn", "s deg x y z", ""),
    "label in a cell": ("t;phi;Ft;Fr;Fn\nUnits: s;deg;N;N;N", "s deg x y z", ""),
    "words": ("Zeit in s;Winkel in °;Kraft in Z-Richtung (N);Kraft in X-Richtung (N);"
              "Kraft in Y-Richtung (N)", "s deg z x y", ""),
    "capitals": ("TIME [S],ANGLE [DEG],FT [N],FR [N],FN [KN]", "s deg x y zkN", ""),
    "symbols": ("Time (s),Angle (phi) [deg],Friction force (Ft),Lateral force (Fr),Load (CH3)",
                "s deg x y z", ""),
    "comma in a name": ("t [s],phi [deg],Ft, filtered [N],Fr [N],Fn [N]", "s deg x y z",
                        "headings time tangential"),
    "speed in a line": ("Time,Speed,Load,Ft,Fr\ns,1/min,N,N,N", "s rpm z x y", ""),
    "units on both lines": ("Time,Angle,Ft,Fr,Load (kg)\nms,deg,mN,mN,", "ms deg xmN ymN zkg", ""),
    "slashes": ("t /s\tphi /°\tF_t /mN\tF_r /mN\tF_n /N", "s deg xmN ymN z", ""),
    "comments": ("#t,phi,Ft,Fr,Fn\n#s,deg,mN,mN,mN", "s deg xmN ymN zmN", ""),
    "points": ("Time (sec.),Angle (Deg.),Ft (N.),Fr (N.),Fn (N.)", "s deg x y z", ""),
    "volts beside": ("t [s],phi [deg],Friction [V],Friction [N],Fr [N],Fn [N]",
                     "s deg xV x y z", ""),
    "words in names": ("t [s],phi [deg],Normal force (z) [N],Friction force (x) [N],Side (y) [N]",
                       "s deg z x y", "tangential radial normal"),
}  # fmt: skip


def written(tmp_path, heading, held):
    mark = next((one for one in (";", "\t", ",") if one in heading), "  ")
    columns = [HELD[name][1] for name in held.split()]
    body = [mark.join(f"{x:.6f}" for x in row) for row in np.column_stack(columns)]
    path = tmp_path / "run.csv"
    path.write_text("\n".join([heading, *body]), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", HEADINGS)
def test_columns_are_read_as_meant_or_asked_for(name, tmp_path):
    heading, held, asked = HEADINGS[name]
    path = written(tmp_path, heading, held)
    found = identify.inspect_file(path)
    meant = [HELD[one][0] for one in held.split()]
    for one, role in zip(found.columns, meant, strict=True):
        assert one.role in (role, ""), one
    missing = {"time", "tangential", "radial", "normal"} - {one.role for one in found.columns}
    for word in {*missing, *asked.split()}:
        assert any(word in note for note in found.notes), word
    config = tmp_path / "run.toml"
    found.write(config)
    if asked in ("", "order", "Load", "negative"):
        data = identify.load(path, config)
        np.testing.assert_allclose(data.force, DATA.force, atol=1e-2)
        np.testing.assert_allclose(data.normal_force, DATA.normal_force, atol=1e-2)
        assert data.turns == DATA.turns
    else:
        with pytest.raises(RecordError, match=r"no column|several columns|only a calib"):
            identify.load(path, config)


def csv(heading, columns):
    return "\n".join([heading, *(",".join(f"{x:.6f}" for x in row) for row in columns)])


PLAIN = ("time", "angle", "tangential", "radial", "normal")


def test_two_columns_of_one_name_are_refused_with_both_numbers(tmp_path):
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("openpyxl")
    table = np.column_stack([lab.table(RUN), 2.0 * Z])
    path, book = tmp_path / "run.csv", tmp_path / "run.xlsx"
    path.write_text(csv(",".join([*PLAIN, "normal"]), table))
    frame = pandas.DataFrame(table, columns=[*PLAIN, "normal"])
    frame.to_excel(book, index=False)
    for source in (path, book, frame):
        with pytest.raises(
            RecordError, match=r"several columns 'normal': .* 4 and 5 .*see columns"
        ):
            identify.read_csv(source)
        (run,) = identify.read_csv(source, columns={"normal": 4})
        np.testing.assert_allclose(run.readings, RUN.readings, atol=1e-5)


def test_units_of_headings_count_and_contradictions_are_refused(tmp_path):
    path = tmp_path / "run.csv"
    heading = "time,angle,tangential,radial,normal"
    table = lab.table(RUN)
    path.write_text(csv(f"{heading}\nms,rad,mN,mN,kgf", table * [1e3, 1, 1e3, 1e3, 1 / G]))
    (run,) = identify.read_csv(path, header=2, names=1)
    np.testing.assert_allclose(run.readings, RUN.readings, atol=1e-5)
    np.testing.assert_allclose(run.time, RUN.time, atol=1e-6)
    wrong = {"header": 2, "names": 1, "units": {"normal": "-N"}}
    with pytest.raises(RecordError, match=r"\(normal\): its heading says 'kgf', .*'N': correct"):
        identify.read_csv(path, **wrong)
    # The configuration counts where nothing is checked.
    (run,) = identify.read_csv(path, **wrong, check_units=False)
    np.testing.assert_allclose(run.readings[:, 2], -RUN.readings[:, 2] / G, atol=1e-5)
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(table, columns=[*PLAIN[:4], "Fn [dyn]"])
    with pytest.raises(RecordError, match=r"heading says 'dyn', which is none of N.*see units"):
        identify.read_csv(frame, columns={"normal": "Fn [dyn]"})
    (run,) = identify.read_csv(frame, columns={"normal": "Fn [dyn]"}, units={"normal": "N"})
    np.testing.assert_array_equal(run.readings, RUN.readings)


def test_what_is_no_unit_is_not_taken_for_one(tmp_path):
    path = tmp_path / "run.csv"
    settings = "Weight;10;N\nRange;50;mN\nProbe;A;mm\n"
    path.write_text(settings + csv("t,phi,F_H,Ft_m,F_V", lab.table(RUN)).replace(",", ";"))
    columns = {"time": "t", "angle": "phi", "tangential": "F_H", "radial": "Ft_m", "normal": "F_V"}
    (run,) = identify.read_csv(path, delimiter=";", header=4, columns=columns)
    np.testing.assert_allclose(run.readings, RUN.readings, atol=1e-5)
    by_number = {name: at for at, name in enumerate(PLAIN)}
    (run,) = identify.read_csv(path, delimiter=";", header=4, names=3, columns=by_number)
    np.testing.assert_allclose(run.readings, RUN.readings, atol=1e-5)


def test_volts_are_no_forces_without_a_calibration(tmp_path):
    pandas = pytest.importorskip("pandas")
    names = ["time", "angle", "Ft [mV]", "Fr [mV]", "normal"]
    frame = pandas.DataFrame(lab.table(RUN) * [1, 1, 20.0, 20.0, 1], columns=names)
    columns = {"tangential": "Ft [mV]", "radial": "Fr [mV]"}
    (run,) = identify.read_csv(frame, columns=columns)
    with pytest.raises(RecordError, match=r"tangential: is in mV, which only a calibration"):
        identify.RawData([run])
    for copy in (pickle.loads(pickle.dumps(run)), run.replace(source="a copy")):
        with pytest.raises(RecordError, match=r"tangential: is in mV"):
            identify.RawData([copy])
    identify.RawData([run.replace(readings=run.readings / 20.0)])
    loads = (5.0 * np.eye(3)).tolist()
    sections = {"columns": columns}
    # Are the readings of the weighings in mV or in V?
    weighed = {"loads": loads, "readings": (np.diag([0.1, 0.1, 5.0])).tolist()}
    with pytest.raises(RecordError, match=r"heading says 'mV', the readings of the calibration do"):
        identify.load(frame, sections | {"calibration": weighed})
    stated = {"tangential": "mV", "radial": "mV"}
    data = identify.load(frame, sections | {"units": stated, "calibration": weighed})
    np.testing.assert_allclose(data.force, DATA.force, atol=1e-9)
    # Weighings in a file say their own units.
    (tmp_path / "weighed.csv").write_text(
        "load_tangential,load_radial,load_normal,Ft [V],Fr [V],normal\n"
        "5,0,0,0.1,0,0\n0,5,0,0,0.1,0\n0,0,5,0,0,5\n"
    )
    by_number = {"tangential": 3, "radial": 4, "normal": 5}
    volts = pandas.DataFrame(np.column_stack([T, A, T, 0.02 * X, 0.02 * Y, Z]), columns=[*"tabcde"])
    sections = {"columns": {"time": 0, "angle": 1, **by_number}, "units": dict.fromkeys(
        ("tangential", "radial"), "V")}  # fmt: skip
    config = identify.Configuration(
        sections | {"calibration": {"file": "weighed.csv"}}, folder=tmp_path
    )
    np.testing.assert_allclose(identify.load(volts, config).force, DATA.force, atol=1e-9)


def in_parts(*, x="One", first=0.0, pause=0.0, decimal="."):
    """Return text of LabVIEW in parts of which x begins with the same number in each.

    Args:
        x: how many columns of time there are, "One" or "No".
        first: number with which x begins.
        pause: before the third part.
        decimal: mark.
    """
    text = lab.labview_measurement(RUN, x=x, parts=4, comment=False).splitlines()
    at = [n for n, line in enumerate(text) if line.startswith("Channels")]
    lines = text[: at[0]]
    begins = datetime.datetime(2026, 11, 23, 13, 46, 58, 500_000)
    for number, rows in enumerate(np.array_split(np.arange(N), 4)):
        part = text[at[number] : [*at, len(text)][number + 1]]
        zero = T[rows[0]]
        later = datetime.timedelta(seconds=float(zero + pause * (number > 1)))
        for line in part:
            tag, *cells = line.split("\t")
            if tag == "Time":
                cells = [(begins + later).strftime("%H:%M:%S.%f")] * 4
            elif tag == "X0":
                cells = [f"{first:.6E}"] * 4
            elif x == "One" and tag[:1].isdigit():
                tag = f"{float(tag) - zero + first:.6f}"
            lines.append("\t".join([tag, *cells]))
    return "\n".join(lines).replace(".", decimal)


@pytest.mark.parametrize("options", [{}, {"first": 5.0}, {"x": "No"}, {"decimal": ","}], ids=repr)
def test_parts_whose_time_starts_again_go_on(options, tmp_path):
    path = tmp_path / "run.lvm"
    path.write_text(in_parts(**options))
    found = identify.inspect_file(path)
    assert not found.notes
    data = identify.load(path, found.sections)
    np.testing.assert_allclose(data.force, DATA.force, atol=2e-5)
    np.testing.assert_allclose(data.time - data.time[0], DATA.time, atol=1e-6)


@pytest.mark.parametrize("x", ["One", "No"])
def test_pauses_between_parts_are_gaps(x, tmp_path):
    path = tmp_path / "run.lvm"
    text = in_parts(x=x, pause=3.0)
    path.write_text(text)
    found = identify.inspect_file(path).sections
    file = {**found["file"], "on_defect": "raise"}
    with pytest.raises(RecordError, match=r"sampling gap after line \d+;") as caught:
        identify.load(path, {**found, "file": file})
    line = int(str(caught.value).partition("after line ")[2].partition(";")[0])
    assert text.splitlines()[line + 1].startswith("Channels")
    pieces = identify.load(path, {**found, "file": {**file, "on_defect": "split"}})
    assert np.diff(pieces.time).max() == pytest.approx(3.0 + 1.0 / 250.0)
    assert pieces.turns == 2
    # Pauses that the file shows at once are split there.
    assert found["file"].get("on_defect", "split") == "split"
    assert (x == "No") or "on_defect" in found["file"]


def test_headings_between_the_numbers_part_them(tmp_path):
    rows = np.column_stack([X, Y, -Z, np.rad2deg(A), T])
    rows[N // 2 :, 4] += 5.0
    head = "Step No. {}\n\nFx,Fy,Fz,A,T\nN,N,N,deg,sec\n"
    parts = [csv(head.format(k + 1), part) for k, part in enumerate(np.array_split(rows, 2))]
    path = tmp_path / "run.csv"
    path.write_text("\n\n\n".join(parts))
    found = identify.inspect_file(path)
    assert found.sections["file"]["on_defect"] == "split"
    assert identify.load(path, found.sections).turns == 3


def test_loads_in_kgf_under_newtons_get_a_sentence():
    frame = RUN.replace(readings=RUN.readings / [1.0, 1.0, G])
    fits = [
        identify.fit_law(identify.process(identify.RawData([run])), reservoir="ellipse",
                         direction="ellipse") for run in (RUN, frame)
    ]  # fmt: skip
    said = [[one for one in fit.warnings if "in kgf, under the heading N" in one] for fit in fits]
    assert [len(one) for one in said] == [0, 1]
    assert (
        "friction coefficients are 4" in said[1][0] or "friction coefficients are 5" in said[1][0]
    )


COEFFICIENTS = ("COF", "COF [-]", "µ", "mu (1)", "Friction coefficient", "Reibungszahl [-]",
                "Reibwert", "Friction [-]")  # fmt: skip


@pytest.mark.parametrize("name", COEFFICIENTS)
def test_a_coefficient_is_multiplied_by_the_load(name, tmp_path):
    path, config = tmp_path / "run.csv", tmp_path / "run.toml"
    heading = f"time [s],angle [rad],{name},load [N]"
    path.write_text(csv(heading, np.column_stack([T, A, X / Z, Z])))
    columns = {"tangential": name, "time": 0, "angle": 1, "normal": 3}
    (run,) = identify.read_csv(path, columns=columns, one_channel=True)
    np.testing.assert_allclose(run.readings[:, 0], X, atol=1e-5)
    found = identify.inspect_file(path)
    assert [one.role for one in found.columns] == ["time", "angle", "tangential", "normal"]
    assert any("multiplied by the load" in note for note in found.notes)
    config.write_text(found.text().replace("\n[file]\n", "\n[file]\none_channel = true\n"))
    expected = identify.friction_coefficient(DATA).mean.value
    coefficient = identify.friction_coefficient(identify.load(path, config)).mean.value
    assert coefficient == pytest.approx(expected, rel=1e-4)
    # A constant load will do; without any load it is asked for.
    path.write_text(csv(heading.rpartition(",")[0], np.column_stack([T, A, X / Z])))
    del columns["normal"]
    (run,) = identify.read_csv(path, columns=columns, one_channel=True, normal_load=10.0)
    np.testing.assert_allclose(run.readings[:, 0], 10.0 * X / Z, atol=1e-4)
    with pytest.raises(RecordError, match=r"no column 'normal'.*normal_load in .tribometer."):
        identify.read_csv(path, columns=columns, one_channel=True)


def test_a_force_counts_before_a_coefficient_and_stated_units_before_names(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text(csv("t [s],phi [rad],COF,Ft [N],Fn [V]", np.column_stack([T, A, X / Z, X, Z])))
    found = identify.inspect_file(path)
    assert [one.role for one in found.columns][2:4] == ["", "tangential"]
    columns = {"time": 0, "angle": 1, "tangential": "COF", "normal": 4}
    given = {"columns": columns, "one_channel": True, "check_units": False}
    with pytest.raises(RecordError, match=r"'COF' .*needs the load in N, not in V"):
        identify.read_csv(path, **given)
    (run,) = identify.read_csv(path, **given, units={"tangential": "N"})
    np.testing.assert_allclose(run.readings[:, 0], X / Z, atol=1e-6)
    given["columns"] = {**columns, "tangential": 3}
    (run,) = identify.read_csv(path, **given, units={"tangential": "1", "normal": "N"})
    np.testing.assert_allclose(run.readings[:, 0], X * Z, atol=1e-4)
    weighings = identify.Calibration(np.eye(3), np.eye(3))
    with pytest.raises(RecordError, match="coefficient of friction, to which no calibration"):
        identify.RawData(run, calibration=weighings)
