"""Files of laws and sets: what is written comes back to the bit, what is wrong is named."""

import json
import os
import re
import tomllib

import asperity as asp
import numpy as np
import pytest
import stored_laws
from asperity.sets.file import KINDS
from mutations import MUTATIONS, mutated
from random_laws import random_law
from samples import ALL_SETS, LAWS, PLANE_LAWS, identify, public_of
from test_values import VALUES

RATED = PLANE_LAWS[3].replace(rate=asp.Stribeck(0.1, ratio=0.5, shape="hyperbolic", viscous=-0.0))
ALL_LAWS = [*LAWS, *(one for one in VALUES if isinstance(one, asp.FrictionLaw)), RATED]


def assert_same(read, value):
    """Equal, and to the bit: what is printed tells minus zero from zero."""
    assert read == value
    assert repr(read) == repr(value)


@pytest.mark.parametrize("law", ALL_LAWS, ids=identify)
def test_every_law_comes_back_to_the_bit(law, tmp_path):
    law.save(tmp_path / "law.toml")
    assert_same(asp.FrictionLaw.load(tmp_path / "law.toml"), law)


@pytest.mark.parametrize("one", ALL_SETS, ids=identify)
def test_every_set_comes_back_to_the_bit(one, tmp_path):
    one.save(tmp_path / "set.toml", note="a set")
    assert_same(asp.StarSet.load(tmp_path / "set.toml"), one)
    assert_same(type(one).load(tmp_path / "set.toml"), one)


@pytest.mark.parametrize("count", [100, pytest.param(10_000, marks=pytest.mark.long)])
def test_random_laws_come_back_to_the_bit(count, tmp_path):
    path, kinds = tmp_path / "law.toml", set()
    for seed in range(count):
        law = random_law(np.random.default_rng(seed))
        law.save(path)
        assert_same(asp.FrictionLaw.load(path), law)
        kinds |= set(re.findall(r'^type = "(\w+)"', path.read_text(), re.M))
    # The random laws are of all kinds of sets.
    assert count < 10_000 or kinds == set(KINDS)


def test_every_public_set_has_its_word_in_files():
    public = {
        name
        for name, kind in public_of(asp).items()
        if isinstance(kind, type) and issubclass(kind, asp.StarSet) and kind is not asp.StarSet
    }
    assert set(KINDS) == public


@pytest.mark.parametrize("name", stored_laws.LAWS)
def test_the_crate_is_tested_with_what_is_written_today(name, tmp_path):
    law = stored_laws.LAWS[name]
    law.save(tmp_path / "law.toml")
    stored = stored_laws.FOLDER / f"{name}.toml"
    written = stored_laws.without_origin((tmp_path / "law.toml").read_text())
    assert written == stored_laws.without_origin(stored.read_text())
    assert_same(asp.FrictionLaw.load(stored), law)
    expected = json.loads((stored_laws.FOLDER / "forces.json").read_text())[name]
    np.testing.assert_allclose(
        law.force(expected["slip"], normal_force=2.0), expected["force"], atol=1e-12
    )


def test_the_crate_is_tested_with_every_kind_of_set():
    texts = "".join(one.read_text() for one in stored_laws.FOLDER.glob("*.toml"))
    assert set(re.findall(r'^type = "(\w+)"', texts, re.M)) == set(KINDS)


def test_a_file_can_be_read_by_people(tmp_path):
    law = asp.FrictionLaw.associated(asp.Ellipse(0.6, 0.2)).replace(rate=asp.Stribeck(0.1))
    asp.LawFile(law, provenance=asp.Provenance(note='PVC, "dry"', files=[("a.csv", "0f")])).save(
        tmp_path / "law.toml"
    )
    text = (tmp_path / "law.toml").read_text()
    data = "".join(line for line in text.splitlines(True) if not line.startswith("#"))
    assert re.sub(r"asperity = .*\ndate = .*\n", "", data) == (
        '\nformat = "asperity law"\nversion = 1\n'
        '\n[law.reservoir]\ntype = "Ellipse"\na = 0.6\nb = 0.2\nangle = 0.0\n'
        '\n[law.direction]\ntype = "Ellipse"\na = 0.6\nb = 0.2\nangle = 0.0\n'
        '\n[law.rate]\nspeed = 0.1\nratio = 0.0\nshape = "exponential"\nexponent = 1.0\n'
        "viscous = 0.0\n"
        '\n[provenance]\nnote = "PVC, \\"dry\\""\n'
        '\n[[provenance.files]]\nname = "a.csv"\nsha256 = "0f"\n'
    )
    assert max(map(len, text.splitlines())) <= 100
    assert [file.name for file in tmp_path.iterdir()] == ["law.toml"]


def test_provenance_comes_back(tmp_path):
    source = tmp_path / "run.csv"
    source.write_bytes(b"time,angle\n")
    origin = asp.Provenance.of_files(
        [source],
        made_by="a test",
        note="two\nlines \x7f \x00 é",
        configuration={"columns": {"my time": 0, "b.c": [1, 2.5, True]}, "empty": {}},
    )
    assert origin.files[0][1].startswith("c430eac1")
    asp.LawFile(RATED, provenance=origin).save(tmp_path / "law.toml")
    read = asp.LawFile.load(tmp_path / "law.toml")
    assert read.law == RATED
    assert read.provenance.asperity == asp.__version__
    assert re.fullmatch(r"\d{4}-\d\d-\d\d", read.provenance.date)
    assert read.provenance.replace(asperity="", date="") == origin
    # What is read and written again is the same file, on the same day.
    read.save(tmp_path / "again.toml")
    assert (tmp_path / "again.toml").read_text() == (tmp_path / "law.toml").read_text()


class OwnDisk(asp.Disk):
    """A set of a user."""


class OwnLaw(asp.FrictionLaw):
    """A law of a user."""


class OwnRate(asp.Stribeck):
    """A rate factor of a user."""


DISK = asp.Disk(0.3)


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (asp.FrictionLaw(OwnDisk(0.3), DISK), "law.reservoir: of the class OwnDisk is code"),
        (asp.FrictionLaw(DISK | OwnDisk(0.4), DISK), r"law.reservoir.sets\[1\]: .* OwnDisk is"),
        (OwnLaw(DISK, asp.Ellipse(2.0, 1.0)), "law: of the class OwnLaw is code"),
        (asp.FrictionLaw(DISK, DISK, rate=OwnRate(0.1)), "law.rate: of the class OwnRate is code"),
    ],
)
def test_classes_of_users_are_refused_by_name(law, message, tmp_path):
    with pytest.raises(asp.ParameterError, match=message):
        law.save(tmp_path / "law.toml")
    assert not list(tmp_path.iterdir())


def test_problems_with_laws_of_users_are_refused_by_name(tmp_path):
    law = asp.FrictionLaw(OwnDisk(0.3), DISK)
    problem = asp.ContactProblem(
        np.eye(3), free_velocity=[-1.0, 0.2, 3.0], laws=law, normal_restitution=0.5
    )
    with pytest.raises(asp.ParameterError, match=r"laws\[0\].reservoir: of the class OwnDisk is"):
        problem.save(tmp_path / "problem.npz")
    assert not list(tmp_path.iterdir())


TEXT = """\
format = "asperity law"
version = 1
[law.reservoir]
type = "Intersection"
[[law.reservoir.sets]]
type = "Ellipse"
a = 0.6
b = 0.2
[[law.reservoir.sets]]
type = "Mapped"
matrix = [
    [1.0, 0.0],
    [0.0, 1.0],
]
set = { type = "Disk", radius = 0.5 }
[law.direction]
type = "PolarCurve"
angle = [0.0, 1.5,
  3.0, 4.5]
radius = [1.0, 1.0, 1.0,
  1.0]
[law.rate]
speed = 0.1
"""


def loaded(text, folder):
    path = folder / "law.toml"
    path.write_text(text, encoding="utf-8")
    return asp.FrictionLaw.load(path)


def test_inline_tables_and_left_out_defaults_are_read(tmp_path):
    law = loaded(TEXT, tmp_path)
    mapped = asp.sets.Mapped(asp.Disk(0.5), np.eye(2))
    assert law.reservoir == asp.Ellipse(0.6, 0.2) & mapped
    assert law.rate == asp.Stribeck(0.1)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"asperity law"', '"law"', "line 1: format: must be 'asperity law', got 'law'"),
        ("version = 1", "version = 2", "line 2: version: must be 1 for this asperity, got 2"),
        ("version = 1\n", "", "law.toml: version: is missing: it is 1"),
        ("[law.reservoir]", "[law.reservior]", r"line 3: \[law\] reservior: .* 'reservoir'?"),
        ('"Ellipse"', '"Elipse"', "line 6: .* type: 'Elipse' is not known, did you mean 'Ellipse'"),
        ('"Ellipse"', "3", r"line 6: \[law.reservoir.sets\[0\]\] type: must be one of Ball,"),
        ('type = "Ellipse"\n', "", r"line 5: \[law.reservoir.sets\[0\]\] type: is missing: it is"),
        ("a = 0.6", "a = -0.6", r"line 7: \[law.reservoir.sets\[0\]\] a: must be positive"),
        ("a = 0.6", 'a = "wide"', r"line 7: .* a: must hold real numbers, got 'wide'"),
        ("a = 0.6", "a = true", r"line 7: .* a: must not be a truth value, got True"),
        ("[0.0, 1.0]", "[0, false]", r"line 13: .* matrix\[1\]\[1\]: must not be a truth value"),
        ("a = 0.6", "a = 0,6", r"line 7: .* a: is not TOML: .*; decimals take a point"),
        ("a = 0.6", "a = nan", r"line 7: .* a: must be finite, got nan"),
        ("a = 0.6", "a = 1e400", r"line 7: .* a: must be finite, got inf"),
        ("a = 0.6", f"a = {10**30}", r"line 7: .* a: must be a whole number of 64 bits"),
        ("a = 0.6", f"a = {'9' * 5000}", r"line 7: .* a: has too many digits"),
        ("a = 0.6", "a = 2026-11-22 07:30:00", r"line 7: .* a: must hold real numbers"),
        ("a = 0.6", "aa = 0.6", r"line 7: .* aa: is not known, did you mean 'a'"),
        ("a = 0.6\n", "", r"line 5: \[law.reservoir.sets\[0\]\] a: is missing"),
        ("a = 0.6\n", "a = 0.6\na = 0.6\n", r"line 8: .* a: is not TOML: Cannot overwrite"),
        ("radius = 0.5", "radius = 0", r"line 15: \[law.reservoir.sets\[1\].set\] radius: must be"),
        (
            "[0.0, 1.0]",
            "[0.0, nan]",
            r"line 13: \[law.reservoir.sets\[1\]\] matrix\[1\]\[1\]: must",
        ),
        ("[0.0, 1.0]", "[0.0, 0.0]", r"line 1\d: \[law.reservoir\] sets\[1\]: .*regular|matrix"),
        ("  1.0]\n", "  inf]\n", r"line 21: \[law.direction\] radius\[3\]: must be finite"),
        ("  1.0]\n", "  1.0\n", r"line 22: \[law.direction\] radius: is not TOML"),
        ("speed = 0.1", "sped = 0.1", r"line 23: \[law.rate\] sped: is not known, did you mean"),
        ("[law.rate]", "[rate]", r"line 22: rate: is not known here, it belongs into \[law\]"),
        ("set = {", "sets = {", r"line 15: .* sets: is not known, did you mean 'set'"),
        (
            '"PolarCurve"',
            '"Disk"',
            r"line 18: \[law.direction\] angle: is not known; known are rad",
        ),
        ("[law.direction]", "[law.extra]", r"line 16: \[law\] extra: is not known; known are"),
    ],
)
def test_what_is_wrong_is_named_with_line_and_key(old, new, message, tmp_path):
    assert old in TEXT
    with pytest.raises(asp.ConfigurationError, match=message) as refused:
        loaded(TEXT.replace(old, new, 1), tmp_path)
    assert refused.value.file == str(tmp_path / "law.toml")
    assert len(str(refused.value)) < 500


def test_files_that_are_none_are_named(tmp_path):
    for path, message in (
        (tmp_path / "none.toml", "none.toml: cannot be read: No such file"),
        (tmp_path, "is a folder: name the file in it"),
    ):
        with pytest.raises(asp.ConfigurationError, match=message):
            asp.FrictionLaw.load(path)
    (tmp_path / "bytes.toml").write_bytes(b'format = "asperity law"\nversion = 1 # \xff\n')
    with pytest.raises(
        asp.ConfigurationError, match=r"line 2: version: is not TOML: save it as UTF-8"
    ):
        asp.FrictionLaw.load(tmp_path / "bytes.toml")
    for deep in (
        "x = " + "[" * 5000,
        "x = " + "{a=" * 5000,
        "[law.reservoir" + ".set" * 5000 + "]",
    ):
        with pytest.raises(asp.ConfigurationError):
            loaded(f'format = "asperity law"\nversion = 1\n{deep}\n', tmp_path)


def nested(depth):
    head = 'format = "asperity set"\nversion = 1\n'
    tables = "".join(
        f'[set{".set" * k}]\ntype = "Mapped"\nmatrix = [[1.0, 0.0], [0.0, 1.0]]\n'
        for k in range(depth)
    )
    return f'{head}{tables}[set{".set" * depth}]\ntype = "Disk"\nradius = 1.0\n'


def test_sets_are_nested_to_a_limit_that_is_said(tmp_path):
    path = tmp_path / "set.toml"
    path.write_text(nested(40))
    assert asp.StarSet.load(path).radius(0.0) == pytest.approx(1.0)
    path.write_text(nested(60))
    with pytest.raises(asp.ConfigurationError, match="must not be nested in more than 50 tables"):
        asp.StarSet.load(path)


def refusal(path):
    """Return the error of reading a file; None if there is none, others than expected pass."""
    try:
        asp.LawFile.load(path)
    except asp.ConfigurationError as error:
        return error
    return None


MUTANTS = 200


@pytest.mark.parametrize("count", [MUTANTS, pytest.param(4000, marks=pytest.mark.long)])
def test_mutated_files_are_refused_with_line_and_key(count, tmp_path):
    """Or they are another law: a changed digit is no mistake that a reader can see."""
    rng = np.random.default_rng(0)
    texts = []
    for i, law in enumerate([RATED, *stored_laws.LAWS.values()]):
        origin = asp.Provenance(note="dry", files=[("a.csv", "0f")], configuration={"file": {}})
        asp.LawFile(law, provenance=origin).save(tmp_path / f"{i}.toml")
        texts.append((tmp_path / f"{i}.toml").read_text())
    path, refused, kinds = tmp_path / "mutant.toml", 0, set()
    while refused < count:
        kind, content = mutated(texts[rng.integers(len(texts))], rng)
        path.write_bytes(content)
        error = refusal(path)
        if error is not None:
            refused += 1
            kinds.add(kind)
            assert error.file == str(path)
            # No key can be named where none is written up to the line.
            above = b"\n".join(content.split(b"\n")[: error.line])
            assert error.key or not re.search(rb"^\[*\w", above, re.MULTILINE), error
            # What is missing above all tables has no line of its own.
            assert error.line or "is missing" in error.message, error
            assert "\n" not in str(error)
    assert kinds == set(MUTATIONS)


def test_nothing_in_a_file_is_executed(tmp_path):
    marker = tmp_path / "executed"
    for word in ("__import__", "os.system", "eval", "StarSet", "FrictionLaw", "Provenance"):
        text = TEXT.replace('"Ellipse"', json.dumps(word), 1).replace("a = 0.6", f'a = "{marker}"')
        with pytest.raises(asp.ConfigurationError, match=re.escape(f"'{word}' is not known")):
            loaded(text, tmp_path)
    assert not os.path.exists(marker)


def test_what_is_written_is_toml_of_any_reader(tmp_path):
    RATED.save(tmp_path / "law.toml", note='"""\\ \t \r\n é 𝛼 \ud800')
    read = tomllib.loads((tmp_path / "law.toml").read_text(encoding="utf-8"))
    assert read["provenance"]["note"] == '"""\\ \t \r\n é 𝛼 ?'
