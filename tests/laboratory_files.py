"""Files of tribometers as laboratories export them, of one virtual run."""

import asperity as asp
import numpy as np

LAW = asp.FrictionLaw(
    asp.Superellipse(4.99 / 9.3, 4.25 / 9.3, 2.94), asp.Superellipse(1.84, 1.19, 2.51)
)
# Without flat sides, a few directions tell the law.
ROUND = asp.FrictionLaw(asp.Ellipse(0.54, 0.46), asp.Ellipse(1.5, 1.0))
TURNED = asp.FrictionLaw(asp.Ellipse(0.54, 0.46, angle=0.2), asp.Ellipse(1.5, 1.0, angle=0.05))
LOAD, RATE = 9.3, 1000.0


def machine(**options):
    given = {"normal_force": LOAD, "turns": 3.2, "turn_rate": 0.5, "sample_rate": RATE, "seed": 1}
    given |= {"no_load_time": 0.0, "zero": 0.0, "calibration_loads": 0, "crosstalk": 0.0}
    return asp.identify.VirtualTribometer(LAW, **{**given, **options})


def run(**options):
    return machine(**options).record().recordings[0]


def table(recording):
    """Return the columns time, angle and channels."""
    return np.column_stack([recording.time, recording.angle, recording.readings])


def number(value, digits=4, decimal=".", thousands=""):
    text = f"{value:,.{digits}f}"
    return text.replace(",", "#").replace(".", decimal).replace("#", thousands)


def german(recording):
    """Return text with a preamble, commas for points, ms, °, mN, kN, and a delimiter at the end."""
    t, angle, *forces = table(recording).T
    columns = [
        1e3 * t,
        np.rad2deg(angle) % 360.0,
        1e3 * forces[0],
        1e3 * forces[1],
        1e-3 * forces[2],
    ]
    digits = (1, 4, 2, 2, 7)
    head = [
        "Messprogramm;TriboControl 3.2;",
        "Prüfer;Müller;",
        "Datum;23.11.2026;",
        "",
        "Zeit [ms];Winkel [°];Tangentialkraft [mN];Radialkraft [mN];Normalkraft [kN];",
    ]
    rows = zip(*columns, strict=True)
    body = [
        "".join(f"{number(x, d, ',')};" for x, d in zip(row, digits, strict=True)) for row in rows
    ]
    return "\n".join([*head, *body]) + "\n"


def labview(recording):
    """Return text with a line of names, one of units, and tabs."""
    head = ["Time\tPhi\tFt\tFr\tFn", "s\tdeg\tN\tN\tN"]
    columns = table(recording) * [1.0, 180.0 / np.pi, 1.0, 1.0, 1.0]
    body = ["\t".join(f"{x:.6f}" for x in row) for row in columns]
    return "\n".join([*head, *body]) + "\n"


def american(recording):
    """Return text with commas between columns and between groups of digits, in quotes."""
    columns = table(recording) * [1.0, 180.0 / np.pi, 1e3, 1e3, 1e3]
    head = "Time (s),Angle (deg),Tangential force (mN),Radial force (mN),Normal force (mN)"

    def cell(value):
        text = number(value, 3, thousands=",")
        return f'"{text}"' if "," in text else text

    return "\n".join([head, *(",".join(map(cell, row)) for row in columns)]) + "\n"


def clock_and_counts(recording, start=12 * 3600):
    """Return text with times of day and counts of an encoder of 4096 a turn."""

    def clock(t):
        seconds = start + t
        hours, rest = divmod(seconds, 3600.0)
        minutes, left = divmod(rest, 60.0)
        return f"{int(hours):02d}:{int(minutes):02d}:{left:06.3f}"

    body = []
    for t, angle, *forces in table(recording):
        counts = int(np.floor(angle / (2.0 * np.pi) * 4096)) % 4096
        body.append(f"{clock(t)};{counts};" + ";".join(f"{x:.5f}" for x in forces))
    return "\n".join(["Clock;Encoder [counts];Ft [N];Fr [N];Fn [N]", *body]) + "\n"


def rotations(recording):
    """Return text with the speed of rotation in rpm in place of an angle."""
    rate = 60.0 * np.gradient(recording.angle, recording.time) / (2.0 * np.pi)
    columns = np.column_stack([recording.time, rate, recording.readings])
    body = [",".join(f"{x:.6f}" for x in row) for row in columns]
    return "\n".join(["t [s],n [rpm],Ft [N],Fr [N],Fn [N]", *body]) + "\n"


def rest_run_rest():
    """Return text that has records without load before and after the run, and a run of them all."""
    raw = machine(no_load_time=4.0, zero=0.02).record()
    parts = [raw.no_load[0], raw.recordings[0], raw.no_load[1]]
    tables = [table(part) for part in parts]
    # The disk stays where it has come to rest.
    tables[2][:, 1] = tables[1][-1, 1]
    whole = np.vstack(tables)
    whole[:, 0] -= whole[0, 0]
    body = [",".join(f"{x:.6f}" for x in row) for row in whole]
    return "\n".join(["time,angle,tangential,radial,normal", *body]) + "\n", raw


def with_defects(recording):
    """Return text with a cell of text, an empty one, and a footer."""
    lines = [",".join(f"{x:.6f}" for x in row) for row in table(recording)]
    for line, text in ((1500, "OVL"), (3500, "")):
        cells = lines[line].split(",")
        cells[2] = text
        lines[line] = ",".join(cells)
    return "\n".join(["time,angle,tangential,radial,normal", *lines, "End of measurement"]) + "\n"


def strokes(angles, *, repeats=3, speed=0.01, half=0.02, noise=0.01, seed=2, load=LOAD, law=LAW):
    """Return time, position, stage angle and the channels along the stroke, by stage angle.

    A stage goes back and forth, at a speed that is a sine, under a pin that presses all the time.
    """
    random = np.random.default_rng(seed)
    omega = speed / half
    time = np.arange(0.0, repeats * 2.0 * np.pi / omega, 1.0 / 200.0)
    place, velocity = -half * np.cos(omega * time), speed * np.sin(omega * time)
    found = []
    for angle in angles:
        along = np.array([np.cos(angle), np.sin(angle)])
        across = np.array([-along[1], along[0]])
        slip = np.sign(velocity)[:, None] * along
        slip[velocity == 0.0] = along
        force = -law.force(slip, normal_force=load)
        force += noise * load * random.normal(size=force.shape)
        normal = load + 0.002 * load * random.normal(size=time.size)
        found.append((time, place, force @ along, force @ across, normal))
    return found


def plane_path(
    *, turns=4, speed=0.01, radius=0.01, noise=0.01, seed=3, load=LOAD, zero=(0, 0, 0), law=LAW
):
    """Return time, place, velocity and forces along x and y of a stage that goes round."""
    random = np.random.default_rng(seed)
    omega = speed / radius
    time = np.arange(0.0, turns * 2.0 * np.pi / omega + 0.05, 1.0 / 200.0)
    angle = omega * time + 0.3
    slip = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    place = radius * np.stack([np.sin(angle), -np.cos(angle)], axis=-1)
    force = -law.force(slip, normal_force=load)
    force += noise * load * random.normal(size=force.shape) + np.array(zero[:2])
    normal = load + 0.002 * load * random.normal(size=time.size) + zero[2]
    return time, place, speed * slip, force, normal


def back_and_forth(kind, *, length, speed, dwell, rate, repeats=4):
    """Return time, place and velocity of a motion along a line that rests where it turns back.

    Args:
        kind: "sine", of which `speed` is the greatest, or "ramp", whose speed is constant.
        length: of a stroke.
        speed: of the motion.
        dwell: time at rest at either end.
        rate: of the samples.
        repeats: strokes there and back.
    """
    lasts = (0.5 * np.pi if kind == "sine" else 1.0) * length / speed
    samples = int((2 * repeats * (lasts + dwell) + dwell) * rate)
    time = (np.arange(samples) + 0.37) / rate
    stroke = np.floor((time - dwell) / (lasts + dwell)).astype(int)
    share = np.clip((time - dwell - stroke * (lasts + dwell)) / lasts, 0.0, 1.0)
    moves = (stroke >= 0) & (stroke < 2 * repeats) & (share > 0.0) & (share < 1.0)
    place, velocity = share, np.full(samples, 1.0 / lasts)
    if kind == "sine":
        place = 0.5 - 0.5 * np.cos(np.pi * share)
        velocity = 0.5 * np.pi / lasts * np.sin(np.pi * share)
    back = stroke % 2 == 1
    place = np.where((stroke < 0) | (stroke >= 2 * repeats), 0.0, np.where(back, 1 - place, place))
    return time, length * place, length * np.where(moves, np.where(back, -velocity, velocity), 0.0)


def encoded(place, *, step, noise=0.0, seed=0):
    """Return what an encoder reads, with noise before its steps."""
    read = place + noise * np.random.default_rng(seed).normal(size=place.shape)
    return step * np.round(read / step) if step else read


def in_degrees(recording):
    """Return the columns time, angle in degrees within a turn, and channels."""
    columns = table(recording) * [1.0, 180.0 / np.pi, 1.0, 1.0, 1.0]
    columns[:, 1] %= 360.0
    return columns


def labview_measurement(recording, *, x="One", decimal=".", parts=1, comment=True):
    """Return text of LabVIEW's "Write To Measurement File".

    Args:
        recording: what was measured.
        x: how many columns of time there are: "No", "One" or "Multi".
        decimal: mark.
        parts: how often it was written, each time with a heading.
        comment: whether the last column is one of comments.
    """
    columns = in_degrees(recording)
    names, units = ["Phi", "Ft", "Fr", "Fn"], ["deg", "N", "N", "N"]
    gap = "\t\t" if x == "Multi" else "\t"
    lines = ["LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab"]
    lines += [f"Decimal_Separator\t{decimal}", "Multi_Headings\tYes", f"X_Columns\t{x}"]
    lines += ["Time_Pref\tAbsolute", "Operator\tlab", "Date\t2026/11/23"]
    lines += ["Time\t13:46:58.1234567890123456789", "***End_of_Header***\t", "\t"]

    def tag(name, values):
        return f"{name}\t{gap.join(values)}\t"

    for rows in np.array_split(columns, parts):
        step = 1.0 / recording.sample_rate
        lines += ["Channels\t4\t\t\t\t", tag("Samples", [str(len(rows))] * 4)]
        lines += [tag("Date", ["2026/11/23"] * 4), tag("Time", ["13:46:58.123456789"] * 4)]
        lines += [tag("Y_Unit_Label", units), tag("X_Dimension", ["Time"] * 4)]
        lines += [tag("X0", [f"{rows[0, 0]:.16E}"] * 4), tag("Delta_X", [f"{step:.6E}"] * 4)]
        lines.append("***End_of_Header***\t\t\t\t\t")
        named = [f"X_Value\t{name}" for name in names] if x == "Multi" else ["X_Value", *names]
        lines.append("\t".join([*named, *(["Comment"] * comment)]))
        for time, *values in rows:
            if x == "Multi":
                cells = [f"{time:.6f}\t{value:.6f}" for value in values]
            else:
                cells = [f"{time:.6f}" * (x == "One"), *(f"{value:.6f}" for value in values)]
            lines.append("\t".join(cells).replace(".", decimal))
        lines.append("")
    return "\n".join(lines)


def whole_numbers(recording):
    """Return text with semicolons, whole numbers of ms, counts and mN, and groups of digits."""
    t, angle, *forces = table(recording).T
    counts = np.floor(angle / (2.0 * np.pi) * 4096) % 4096
    columns = np.stack([1e3 * t, counts, *(1e3 * force for force in forces)], axis=-1)
    body = [";".join(f"{value:,.0f}" for value in row) for row in columns]
    return "\n".join(["t [ms];Encoder [counts];Ft [mN];Fr [mN];Fn [mN]", *body]) + "\n"


def matlab(recording, *, time):
    """Return text of MATLAB's writetimetable, with a duration or a date for the time."""
    how = "{:.6g} sec" if time == "duration" else "23-Nov-2026 12:00:{:06.3f}"
    rows = table(recording)
    body = [",".join([how.format(t), *(f"{x:.15g}" for x in row)]) for t, *row in rows]
    return "\n".join(["Time,phi,Ft,Fr,Fn", *body]) + "\n"


def marked_blanks(recording):
    """Return text with blanks between columns, and between names and their units."""
    body = ["  ".join(f"{x:.6e}" for x in row) for row in in_degrees(recording)]
    return "\n".join(["% t [s]  phi [deg]  Ft [N]  Fr [N]  Fn [N]", *body]) + "\n"


def umt(recording):
    """Return text of a tester that counts pressing as negative, with a coefficient beside."""
    head = [
        "Bruker UMT TriboLab",
        "File Name: run1.tstx",
        "Date: 11/23/2026 1:46:58 PM",
        "",
        "Step 1",
    ]
    head += ["Timestamp(sec),Angle(deg),Fx(N),Fy(N),Fz(N),COF"]
    body = [
        f"{t:.4f},{a:.3f},{x:.5f},{y:.5f},{-z:.5f},{x / z:.4f}"
        for t, a, x, y, z in in_degrees(recording)
    ]
    return "\n".join([*head, *body]) + "\n"


def rtec(recording):
    """Return text with a recipe before the table and columns that are none of ours in it."""
    head = ["Recipe,rotary", "Sample,PVC"]
    head += ["Time (s),Step,Position (deg),Speed (rpm),Fx (N),Fy (N),Fz (N),COF,DAQ.Temp (C)"]
    body = [
        f"{t:.4f},1,{a:.3f},30.0,{x:.5f},{y:.5f},{z:.5f},{x / z:.4f},23.4"
        for t, a, x, y, z in in_degrees(recording)
    ]
    return "\n".join([*head, *body]) + "\n"


def csm(recording):
    """Return text with sections of what was set, laps, and a coefficient."""
    head = ["CSM Instruments", "Tribometer 4.4.S", "", "[Sample]", "Name : PVC"]
    head += ["Temperature : 23.00 [°C]", "Humidity : 50.00 [%]", "", "[Data]"]
    head += ["Time [s]\tAngle [°]\tlaps\tFt [N]\tFr [N]\tFn [N]\tµ"]
    body = [
        f"{t:.4f}\t{a:.3f}\t{0.5 * t:.3f}\t{x:.5f}\t{y:.5f}\t{z:.5f}\t{x / z:.4f}"
        for t, a, x, y, z in in_degrees(recording)
    ]
    return "\n".join([*head, *body]) + "\n"


def catman(recording):
    """Return text with long names, commas for points, and tabs."""
    head = ["HBM_CATMAN_DATAFILE_ASCII", "Prüfstand\tTribo", "Kanäle\t5", ""]
    names = ["Zeit  1 - Standardabtastrate [s]", "Drehwinkel [°]", "Reibkraft [N]"]
    names += ["Querkraft [N]", "Normalkraft [N]"]
    body = ["\t".join(number(x, 6, ",") for x in row) for row in in_degrees(recording)]
    return "\n".join([*head, "\t".join(names), *body]) + "\n"


def date_and_time(recording):
    """Return text with the date and the time of day in two columns."""
    body = [
        f"23.11.2026;12:00:{number(t, 3, ',').zfill(6)};" + ";".join(number(x, 6, ",") for x in row)
        for t, *row in in_degrees(recording)
    ]
    return "\n".join(["Datum;Uhrzeit;Winkel [°];Ft [N];Fr [N];Fn [N]", *body]) + "\n"
