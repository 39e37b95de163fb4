"""Every reader of files: damaged ones are refused by an error of asperity, or read as valid.

Hypothesis makes the damage: bytes flipped, cut, inserted, swapped; keys removed, renamed, swapped,
of other types. No other exception may come out, and nothing may wait for ever.
"""

import copy
import datetime
import os
import re
import tomllib

import asperity as asp
import h5py
import numpy as np
import pytest
from asperity import identify, track
from asperity.contact.files import percussions
from asperity.identify import read_raw, write_raw
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from public_calls import PATCH, PATH_FIT
from test_problem_files import PROBLEMS, of_bodies

LAW = asp.FrictionLaw.isotropic(0.3)
DAMAGES = {"sample": 30, "long": 400}
every_amount = pytest.mark.parametrize(
    "amount", ["sample", pytest.param("long", marks=pytest.mark.long)]
)


def examples(amount):
    return settings(
        max_examples=DAMAGES[amount],
        derandomize=amount == "sample",
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )


def problem_file(problem, suffix):
    def write(folder):
        problem.save(folder / f"problem{suffix}")
        return folder / f"problem{suffix}"

    return write


def trajectory_file(folder):
    system = asp.SlidingPoint(1.0, law=LAW)
    asp.simulate(system, dt=0.01, t_end=0.1, u0=[1.0, 0.0]).save(folder / "run.npz")
    return folder / "run.npz"


def fit_file(folder):
    phi = np.linspace(0.0, 4.0 * np.pi, 100, endpoint=False)
    ray = np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    fit = identify.fit_law((phi, 0.3 * ray), reservoir="circle", direction="circle")
    fit.save(folder / "fit.npz")
    return folder / "fit.npz"


def path_fit_file(folder):
    PATH_FIT.save(folder / "paths.npz")
    return folder / "paths.npz"


def patch_fit_file(folder):
    PATCH.save(folder / "patch.npz")
    return folder / "patch.npz"


def stability_file(folder):
    belt = asp.MassOnBelt(1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=[1.0, 0.0])
    asp.stability(belt).save(folder / "stability.npz")
    return folder / "stability.npz"


def chart_file(folder):
    law = asp.FrictionLaw(asp.Ellipse(3.0, 1.0), asp.Ellipse(3.0, 1.0))
    belt = asp.MassOnBelt(1.0, stiffness=1.0, law=law, normal_force=1.0, belt_velocity=[1.0, 0.0])
    chart = asp.growth_chart(belt, phi=np.linspace(0.0, 3.0, 70), zeta=[0.0, 0.5])
    chart.save(folder / "chart.npz")
    return folder / "chart.npz"


def campaign(folder):
    """Write the files of a short measurement."""
    machine = identify.VirtualTribometer(
        LAW, normal_force=10.0, turns=1.2, sample_rate=20.0, no_load_time=1.0
    )
    write_raw(machine.record(), folder)
    return folder


def table_of_run(folder):
    return campaign(folder) / "run_1.csv"


def tribometer_toml(folder):
    path = campaign(folder) / "tribometer.toml"
    path.write_text(
        '[file]\ndelimiter = ","\ndecimal = "."\nheader = 1\ncheck_units = true\n'
        '[units]\ntime = "s"\nangle = "rad"\n' + path.read_text()
    )
    return path


def track_toml(folder):
    path = folder / "track.toml"
    path.write_text(
        "fps = 500.0\nbandwidth = 0.02\nstart = 0.1\nstop = 0.4\n"
        '[mark]\ncolour = "red"\ndiameter = 0.01\nthreshold = 30.0\n'
        "[scene]\npixels = [[100, 980], [1800, 985], [1790, 90], [110, 95]]\n"
        "plane = [[0.0, 0.0], [0.25, 0.0], [0.25, 0.13], [0.0, 0.13]]\n"
    )
    return path


def law_toml(folder):
    reservoir = asp.Ellipse(0.6, 0.2) & asp.sets.Mapped(asp.Disk(0.5), [[1.0, 0.1], [0.0, 1.0]])
    law = asp.FrictionLaw(reservoir, asp.Disk(1.0), rate=asp.Stribeck(0.1, ratio=0.5))
    origin = asp.Provenance(note="dry", files=[("run.csv", "0f")])
    asp.LawFile(law, provenance=origin).save(folder / "law.toml")
    return folder / "law.toml"


def identified_toml(folder):
    spread = np.array([[2e-4, 1e-4], [1e-4, 3e-4]])
    model = identify.FourierReservoir(1, odd=True)
    law = asp.FrictionLaw.collinear(model.reservoir(np.array([-1.0, 0.0, 0.0])))
    identify.IdentifiedLaw(
        law,
        reservoir_model=model,
        direction_model="circle",
        values=[-1.0, 0.0, 0.0],
        turns=np.pad(spread, (0, 1)),
        degrees_of_freedom=(3, 1, 1),
    ).save(folder / "identified.toml")
    return folder / "identified.toml"


def set_toml(folder):
    asp.sets.Union([asp.Ellipse(0.6, 0.2), asp.Polygon([[1, 0], [0, 1], [-1, -1]])]).save(
        folder / "set.toml"
    )
    return folder / "set.toml"


def image(suffix, pixels):
    def write(folder):
        from PIL import Image

        path = folder / f"0{suffix}"
        exif = Image.Exif()
        exif[0x0112] = 6
        Image.fromarray(pixels).save(path, exif=exif)
        return path

    return write


def video(folder):
    frames = [np.full((40, 60, 3), 20 * k, np.uint8) for k in range(8)]
    track.write_video(frames, folder / "film.mp4")
    return folder / "film.mp4"


def whole(frames):
    return [frame.crop(slice(None), slice(None)) for frame in frames]


def read_campaign(path):
    return read_raw([path.with_name("run_1.csv")], path.with_name("tribometer.toml"))


NOISE = np.random.default_rng(0).integers(0, 255, (20, 30, 3), dtype=np.uint8)
DEEP = np.random.default_rng(0).integers(20_000, 65_535, (20, 30), dtype=np.uint16)
load = asp.ContactProblem.load
# Name: what writes the file, what reads it, whether checksums protect it.
READERS = {
    "problem npz": (problem_file(PROBLEMS["everything"], ".npz"), load, True),
    "bodies npz": (problem_file(of_bodies(), ".npz"), load, True),
    "problem hdf5": (problem_file(PROBLEMS["everything"], ".h5"), load, True),
    "bodies hdf5": (problem_file(of_bodies(), ".h5"), load, True),
    "percussions": (problem_file(of_bodies(), ".h5"), percussions, True),
    "trajectory": (trajectory_file, asp.Trajectory.load, True),
    "fit": (fit_file, identify.Fit.load, True),
    "path fit": (path_fit_file, identify.PathFit.load, True),
    "patch fit": (patch_fit_file, identify.PatchFit.load, True),
    "stability": (stability_file, asp.steady_sliding.Stability.load, True),
    "chart": (chart_file, asp.steady_sliding.GrowthChart.load, True),
    "table": (table_of_run, identify.read_csv, False),
    "records": (table_of_run, read_campaign, False),
    "tribometer.toml": (tribometer_toml, read_campaign, False),
    "weighings": (lambda folder: campaign(folder) / "calibration.csv", read_campaign, False),
    "track.toml": (track_toml, track.read_config, False),
    "law.toml": (law_toml, asp.LawFile.load, False),
    "identified law": (identified_toml, identify.IdentifiedLaw.load, False),
    "set.toml": (set_toml, asp.StarSet.load, False),
    "png": (image(".png", NOISE), lambda p: whole(track.ImageFolder(p.parent)), False),
    "tiff": (image(".tiff", DEEP), lambda p: whole(track.ImageFolder(p.parent)), False),
    "jpeg": (image(".jpg", NOISE), lambda p: whole(track.ImageFolder(p.parent)), False),
    "video": (video, lambda p: whole(track.VideoFile(p)), False),
}


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    return lambda: tmp_path_factory.mktemp("damaged")


EDIT = st.tuples(
    st.sampled_from(["flip", "set", "cut", "end", "insert", "swap"]),
    st.floats(0.0, 1.0, exclude_max=True),
    st.floats(0.0, 1.0, exclude_max=True),
    st.binary(min_size=1, max_size=16),
)


def damaged(content, edits):
    """Return the bytes of a file after some edits at relative places."""
    changed = bytearray(content)
    for kind, place, other, fill in edits:
        i, j = int(place * len(changed)), int(other * len(changed))
        if kind == "insert":
            changed[i:i] = fill
        elif kind == "end":
            del changed[i:]
        elif kind == "cut":
            del changed[i : i + len(fill)]
        elif kind == "swap":
            a, b = changed[i : i + len(fill)], changed[j : j + len(fill)]
            changed[i : i + len(fill)], changed[j : j + len(fill)] = b, a
        elif changed:
            changed[i] = changed[i] ^ (fill[0] or 1) if kind == "flip" else fill[0]
    return bytes(changed)


def outcome(read, path):
    """Return what is read, or None if it is refused as it should be."""
    try:
        return read(path)
    except asp.AsperityError:
        return None


@every_amount
@pytest.mark.parametrize("name", READERS)
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_damaged_bytes_are_refused_or_valid(name, amount, folders):
    write, read, protected = READERS[name]
    path = write(folders())
    content, expected = path.read_bytes(), read(path)

    @examples(amount)
    @given(st.lists(EDIT, min_size=1, max_size=4))
    def attempt(edits):
        path.write_bytes(damaged(content, edits))
        found = outcome(read, path)
        if protected and found is not None:
            assert found == expected

    attempt()


def test_no_byte_of_an_archive_may_change_what_is_read(folders):
    write, read, _ = READERS["bodies npz"]
    path = write(folders())
    content, expected = path.read_bytes(), read(path)
    # The list of entries at the end; each byte of entries is covered by a checksum.
    for place in range(content.index(b"PK\x01\x02"), len(content)):
        changed = bytearray(content)
        changed[place] ^= (0x01, 0x80)[place % 2]
        path.write_bytes(changed)
        found = outcome(read, path)
        assert found is None or found == expected, place


ARRAYS = st.sampled_from(
    [
        np.array(0),
        np.array(-1.0),
        np.array(2**62),
        np.array("word"),
        np.array([]),
        np.zeros((2, 2)),
        np.array([np.nan]),
        np.array([1e308, -1e308]),
        np.array([True]),
        np.array([1 + 1j]),
        np.array([b"\xff"]),
        np.zeros(3, dtype=[("a", float)]),
        np.array(["2026-01-01"], dtype="M8[D]"),
        np.full((1, 1, 1, 1), 7, dtype=np.uint8),
    ]
)
KEY_EDIT = st.tuples(
    st.sampled_from(["remove", "rename", "swap", "replace", "reshape", "retype", "value"]),
    st.integers(0, 99),
    st.integers(0, 99),
    ARRAYS,
)


def with_other_keys(fields, edits):
    """Return arrays by name after some edits."""
    changed = dict(fields)
    for kind, first, second, array in edits:
        names = sorted(changed)
        if not names:
            break
        a, b = names[first % len(names)], names[second % len(names)]
        if kind == "remove":
            del changed[a]
        elif kind == "rename":
            changed[f"{a}_"] = changed.pop(a)
        elif kind == "swap":
            changed[a], changed[b] = changed[b], changed[a]
        elif kind == "replace":
            changed[a] = array
        elif kind == "reshape":
            changed[a] = changed[a][None] if second % 2 else changed[a].reshape(-1)
        elif kind == "retype":
            kinds = ("f4", "i8", "U8", "c16", "?", "u1")
            with np.errstate(all="ignore"):
                try:
                    changed[a] = changed[a].astype(kinds[second % len(kinds)])
                # Of dates as short texts, and of texts as bytes, NumPy says so in other ways.
                except (TypeError, ValueError, OverflowError, RuntimeError):
                    continue
        elif changed[a].size and changed[a].dtype.kind in "fi":
            entries = changed[a].copy().reshape(-1)
            worst = (-1, 0, 7) if changed[a].dtype.kind == "i" else (np.nan, np.inf, -1e308)
            entries[second % entries.size] = worst[second % 3]
            changed[a] = entries.reshape(changed[a].shape)
    return changed


@every_amount
@pytest.mark.parametrize("name", ["problem npz", "bodies npz"])
@pytest.mark.filterwarnings("ignore::numpy.exceptions.ComplexWarning")
def test_archives_with_other_keys_are_refused_or_valid(name, amount, folders):
    write, read, _ = READERS[name]
    path = write(folders())
    with np.load(path) as file:
        fields = dict(file)

    @examples(amount)
    @given(st.lists(KEY_EDIT, min_size=1, max_size=3))
    def attempt(edits):
        np.savez(path, **with_other_keys(fields, edits))
        found = outcome(read, path)
        # What is read can be used.
        if found is not None:
            assert found.residual(np.zeros(found.free_velocity.size)) >= 0.0

    attempt()


@every_amount
@pytest.mark.parametrize("name", ["problem hdf5", "bodies hdf5"])
@pytest.mark.filterwarnings("ignore::numpy.exceptions.ComplexWarning")
def test_groups_with_other_keys_are_refused_or_valid(name, amount, folders):
    write, read, _ = READERS[name]
    path = write(folders())
    fields = {}
    with h5py.File(path) as file:
        file.visititems(
            lambda key, one: fields.update({key: one[()]}) if hasattr(one, "shape") else None
        )

    @examples(amount)
    @given(st.lists(KEY_EDIT, min_size=1, max_size=3))
    def attempt(edits):
        with h5py.File(path, "w") as file:
            for key, values in with_other_keys(fields, edits).items():
                if values.dtype.kind == "U":
                    values = values.astype(h5py.string_dtype())
                elif values.dtype.kind == "M":
                    values = values.astype(int)
                file[key] = values
        found = outcome(read, path)
        if found is not None:
            assert found.residual(np.zeros(found.free_velocity.size)) >= 0.0

    attempt()


LITERALS = st.sampled_from(
    [
        "", "x", "\x7f", "run_1.csv", ".", "no_load_*.csv", "/", 0, 1, -1, 10**30, 1.5, -2.0, 1e308,
        float("inf"), float("nan"), True, False, [], [0], [[1.0, 2.0]], ["x", 1], {}, {"a": 1},
        datetime.date(2026, 1, 1), [[[0.0]]],
    ]
)  # fmt: skip
TOML_EDIT = st.tuples(
    st.sampled_from(["replace", "remove", "rename", "swap", "new"]),
    st.integers(0, 99),
    st.integers(0, 99),
    LITERALS,
)


def toml(value):
    """Return a value as TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return '"' + "".join(f"\\u{ord(letter):04x}" for letter in value) + '"'
    if isinstance(value, list):
        return f"[{', '.join(map(toml, value))}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key} = {toml(one)}' for key, one in value.items())}}}"
    return str(value)


def places(table):
    """Return all tables and keys of a document."""
    found = [(table, key) for key in table]
    for inner in table.values():
        if isinstance(inner, dict):
            found += places(inner)
    return found


@every_amount
@pytest.mark.parametrize(
    "name", ["tribometer.toml", "track.toml", "law.toml", "identified law", "set.toml"]
)
def test_configurations_with_other_values_are_refused_or_valid(name, amount, folders):
    write, read, _ = READERS[name]
    path = write(folders())
    text = path.read_text()

    @examples(amount)
    @given(st.lists(TOML_EDIT, min_size=1, max_size=3))
    def attempt(edits):
        document = tomllib.loads(text)
        for kind, first, second, given_literal in edits:
            # A table that is put in twice could be put into itself.
            literal, known = copy.deepcopy(given_literal), places(document)
            if not known:
                break
            (table, key), (other, another) = known[first % len(known)], known[second % len(known)]
            if kind == "remove":
                del table[key]
            elif kind == "rename":
                table[another] = table.pop(key)
            elif kind == "new":
                table["unheard_of"] = literal
            elif kind == "swap" and not isinstance(table[key], dict):
                if not isinstance(other[another], dict):
                    table[key], other[another] = other[another], table[key]
            else:
                table[key] = literal
        path.write_text("".join(f"{key} = {toml(value)}\n" for key, value in document.items()))
        outcome(read, path)

    attempt()


CELLS = st.sampled_from(
    ["", " ", "nan", "NaN", "inf", "-", "OVL", "1e999", "-1e308", "1,5", "0x10", '"', "\0", "é"]
)  # fmt: skip
CELL_EDIT = st.tuples(
    st.sampled_from(["cell", "short", "long", "double", "drop", "blank", "header"]),
    st.integers(0, 999),
    st.integers(0, 9),
    CELLS,
)


@every_amount
@pytest.mark.parametrize("name", ["table", "records", "weighings"])
@pytest.mark.parametrize("on_defect", ["raise", "split"])
def test_tables_with_other_cells_are_refused_or_valid(name, on_defect, amount, folders):
    write, read, _ = READERS[name]
    path = write(folders())
    text = path.read_text()
    if name == "table":

        def read(path):
            return identify.read_csv(path, on_defect=on_defect)

    elif on_defect == "split":
        config = path.with_name("tribometer.toml")
        config.write_text('[file]\non_defect = "split"\n' + config.read_text())

    @examples(amount)
    @given(st.lists(CELL_EDIT, min_size=1, max_size=4))
    def attempt(edits):
        rows = [line.split(",") for line in text.splitlines()]
        for kind, first, second, cell in edits:
            row = rows[0] if kind == "header" else rows[first % len(rows)]
            if kind in ("cell", "header"):
                row[second % len(row)] = cell
            elif kind == "short" and len(row) > 1:
                row.pop()
            elif kind == "long":
                row.append(cell)
            elif kind == "double":
                rows.insert(first % len(rows), list(row))
            elif kind == "drop" and len(rows) > 1:
                rows.remove(row)
            elif kind == "blank":
                rows.insert(first % len(rows), [""])
        path.write_text("\n".join(",".join(row) for row in rows), encoding="utf-8")
        outcome(read, path)

    attempt()


@pytest.mark.parametrize("name", READERS)
def test_what_is_no_file_is_said_so(name, tmp_path):
    write, read, _ = READERS[name]
    path = write(tmp_path)
    path.unlink()
    # Of images it is the folder that is read.
    named = f"{path.name}|{re.escape(str(tmp_path))}"
    with pytest.raises((asp.AsperityError, FileNotFoundError), match=named):
        read(path)
    os.mkdir(path)
    with pytest.raises(asp.AsperityError):
        read(path)
