"""`asperity squeal`: a finite-element model as a file, its modes as tables, pictures and JSON."""

import json
import re
import tarfile
from pathlib import Path

import asperity as asp
import numpy as np
import pytest
import scipy.io
from asperity import predict
from asperity.commands.main import main
from brake_pads import pad, pad_system

LAW = asp.FrictionLaw(asp.Ellipse(0.6, 0.4, angle=0.5), asp.Disk(1.0))


@pytest.fixture
def example(tmp_path):
    return predict.write_example("squeal", tmp_path / "in")[0]


def edited(path, **changes):
    """Change a file by patterns and their replacements."""
    text = path.read_text()
    for pattern, words in changes.values():
        assert re.search(pattern, text, re.M), pattern
        text = re.sub(pattern, words, text, flags=re.M)
    path.write_text(text)
    return path


def test_the_example_says_what_python_says(example, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["squeal", str(example), "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "steady sliding is unstable between 0 and 15000 Hz, at 1 times the friction" in said
    assert {one.name for one in out.iterdir()} == set(predict.squeal_sheet.FILES)
    report = (out / "report.html").read_text()
    for words in ("Squeal of a bar on a belt", "Modes that grow", "0.12, 0.12, 0.12"):
        assert words in report
    table = np.genfromtxt(out / "modes.csv", delimiter=",", skip_header=1)
    model = asp.read_matrices(
        mass=example.parent / "bar_MASS1.mtx",
        stiffness=example.parent / "bar_STIF1.mtx",
        deck=example.parent / "bar.inp",
    )
    force = np.zeros(180)
    force[2::3] = -50.0
    for friction in (0.5, 1.0):
        law = LAW.replace(reservoir=LAW.reservoir.scaled(friction))
        contacts = asp.MeshContacts(
            law, coordinates=model.coordinates("CONTACT"), velocity=[5.0, 0.0, 0.0]
        )
        K = model.stiffness
        bar = asp.LinearSystem(
            model.mass, damping=1e-8 * K, stiffness=K, force=force, contacts=contacts
        )
        modes = asp.stability(bar, band=(0.0, 2e4 * 1.5 * np.pi))
        rows = table[table[:, 0] == friction]
        np.testing.assert_allclose(rows[:, 2], modes.frequencies, rtol=1e-9)
        np.testing.assert_allclose(rows[:, 3], modes.growth_rates, rtol=1e-6, atol=1e-6)
    assert main(["squeal", str(example), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["unstable"]
    assert np.shape(found["modes"]) == table.shape
    sheet = predict.describe_squeal(example)
    assert sheet.unstable
    assert "Small motions grow like" in sheet.summary()


def test_what_does_not_slide_is_doubtful_and_wrong_files_are_named(example, capsys):
    text = example.read_text()
    example.write_text(text.replace("-3000.0", "3000.0"))
    assert main(["squeal", str(example)]) == 1
    assert "No contact is closed at 0.5 times the friction" in capsys.readouterr().out
    example.write_text(text.replace("velocity = [5.0, ", "velocity = [0.0, "))
    assert main(["squeal", str(example)]) == 1
    assert "there is no result between 0 and 15000 Hz" in capsys.readouterr().out
    for old, new, said in (
        ('"CONTACT"', "[11, 11]", "[contacts] nodes: must name every coordinate once"),
        ("tangent = [1.0, 0.0, 0.0]", "tangent = [0.0, 0.0, 1.0]", "[contacts] tangent: "),
        ('mass = "bar_MASS1.mtx"', 'mass = "bar.inp"', "[model] mass: "),
    ):
        assert old in text
        example.write_text(text.replace(old, new))
        assert main(["squeal", str(example)]) == 2
        assert said in capsys.readouterr().err


def test_files_that_are_there_are_kept(example, tmp_path, capsys):
    assert main(["init", "--kind", "squeal", "--out", str(example.parent)]) == 2
    assert "holds a file squeal.toml already" in capsys.readouterr().err
    assert main(["init", "--kind", "squeal", "--out", str(tmp_path / "new")]) == 0
    assert "now: asperity squeal" in capsys.readouterr().out
    assert (tmp_path / "new" / "squeal.toml").read_bytes() == example.read_bytes()


def test_a_disc_and_matrices_of_matlab(tmp_path):
    """Against the pad of the other tests, made in Python."""
    system = pad_system((3, 2, 1), LAW, disc=True)
    M, C, K, f, positions, nodes = pad((3, 2, 1))
    scipy.io.savemat(tmp_path / "pad.mat", {"MGG": M, "K": K, "B": C - 1e-8 * K})
    LAW.save(tmp_path / "law.toml")
    deck = "".join(f"{i + 1}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(positions.tolist()))
    (tmp_path / "pad.inp").write_text(f"*NODE\n{deck}")
    loads = "".join(
        f"[[loads]]\nnodes = [{i // 3 + 1}]\nforce = [0.0, 0.0, {f[i]!r}]\n"
        for i in np.flatnonzero(f).tolist()
    ).replace("np.float64(", "").replace(")]", "]")  # fmt: skip
    loads = re.sub(r"np\.float64\(([^)]*)\)", r"\1", loads)
    model = tmp_path / "pad.toml"
    model.write_text(
        f"""law = "law.toml"
[model]
mass = "pad.mat"
mass_name = "MGG"
stiffness = "pad.mat"
damping = "pad.mat"
damping_name = "B"
deck = "pad.inp"
first_node = 1
[damping]
stiffness = 1e-8
[contacts]
nodes = {(nodes + 1).tolist()}
[surface]
rate = [0.0, 0.0, 60.0]
centre = [0.04, -0.1, 0.0]
circles = true
{loads}
[squeal]
band = [0.0, 12000.0]
"""
    )
    sheet = predict.describe_squeal(model)
    expected = asp.stability(system, band=(0.0, 2.4e4 * np.pi))
    found = sheet.cases[0].modes
    np.testing.assert_allclose(found.eigenvalues, expected.eigenvalues, rtol=1e-8)
    assert sheet.unstable == bool(expected.unstable.any())


def test_directions_turn_the_surface(example):
    edited(
        example,
        scan=("^direction_deg = .*", "direction_deg = [0.0, 40.0]"),
        factor=("^friction = .*", "friction = 1.0"),
        quick=("^certify = true", "certify = false"),
    )
    turned = predict.describe_squeal(example).cases[1].modes
    angle = np.deg2rad(40.0)
    edited(
        example,
        scan=("^direction_deg = .*", "direction_deg = 0.0"),
        way=("^velocity = .*", f"velocity = [{5.0 * np.cos(angle)}, {5.0 * np.sin(angle)}, 0.0]"),
    )
    straight = predict.describe_squeal(example).cases[0].modes
    np.testing.assert_allclose(turned.eigenvalues, straight.eigenvalues, rtol=1e-8)


def test_lost_friction_is_doubtful(example, tmp_path, capsys):
    with tarfile.open(Path(__file__).parent / "calculix_pads.tar.xz") as archive:
        archive.extractall(example.parent, filter="data")
    edited(
        example,
        files=('^stiffness = "bar.*\nmass = .*', 'calculix = "slip"'),
        deck=('^deck = .*', ""),
        loads=('^nodes = "ALL"', 'nodes = "CONTACT"'),
        nodes=('^nodes = "CONTACT"\nnormal', 'nodes = "CONTACT"\nnormal'),
    )  # fmt: skip
    with pytest.warns(UserWarning, match="friction is lost"):
        assert main(["squeal", str(example), "--out", str(tmp_path / "out")]) == 1
    assert "warning: The input has friction in a contact pair" in capsys.readouterr().out


def test_directions_without_a_smooth_force_are_told(example, tmp_path):
    """Superellipses are flat on their axes."""
    law = asp.FrictionLaw(asp.Disk(0.3), asp.Superellipse(1.2, 1.0, 2.5))
    law.save(tmp_path / "flat.toml")
    edited(example, scan=("^direction_deg = .*", "direction_deg = [0.0, 10.0]"))
    sheet = predict.describe_squeal(example, law=tmp_path / "flat.toml")
    assert [one.modes is None for one in sheet.cases] == [True, False] * 2
    assert "No result at 0.5 times the friction, 0°: contact 0 slides along" in sheet.warnings[0]


def test_where_nothing_slides_steadily_the_case_is_told(example, capsys):
    edited(example, scan=("^friction = .*", "friction = [0.5, 60.0]"))
    assert main(["squeal", str(example)]) == 1
    said = capsys.readouterr().out
    assert "warning: No result at 60 times the friction" in said
    assert "at 0.5 times the friction, 0°  40 of 40 contacts closed" in said


@pytest.mark.parametrize(
    ("pattern", "words", "match"),
    [
        ("^law = .*", "", "law: is missing"),
        ("^law = .*", 'law = "none.toml"', "law: names the file"),
        ("^mass = .*", "", r"\[model\] mass: is missing"),
        ("^mass = .*", 'mass = "none.mtx"', r"line 1\d: \[model\] mass: names the file"),
        ("^mass = .*", 'mas = "none.mtx"', "did you mean 'mass'"),
        ("^mass = .*", 'mass = "law.toml"', r"\[model\] mass"),
        ("^mass = .*", 'mass = "bar_MASS1.mtx"\ncalculix = "job"', "does not go with calculix"),
        ("^stiffness = .*\nmass = .*", 'calculix = "job"', "calculix: cannot be read"),
        ('^nodes = "CONTACT"', 'nodes = "FRONT"', r"\[contacts\] nodes: must be a set"),
        ('^nodes = "CONTACT"', "", r"\[contacts\] nodes: is missing"),
        ('^nodes = "ALL"', "nodes = [999]", r"nodes: must have three coordinates"),
        ("^force = .*", "", "force: is missing"),
        ("^force = .*", "force = [1.0]", "force: must be three numbers"),
        ("^normal = .*", "normal = [0.0, 0.0, 0.0]", r"\[contacts\] normal: must not vanish"),
        ("^tangent = .*", "tangent = [0.0, 0.0, 1.0]", r"tangent: must not be along"),
        ("^velocity = .*", "", r"\[surface\].*needs either velocity"),
        ("^velocity = .*", "velocity = [1.0]", r"\[surface\] velocity: must be three numbers"),
        ("^velocity = .*", "rate = [0.0, 0.0, 1.0]\ncentre = [0.0]", r"\[surface\] centre"),
        ("^band = .*", "", r"\[squeal\] band: must be two frequencies"),
        ("^band = .*", "band = [5.0, 1.0]", r"\[squeal\] band: must be two frequencies"),
        ("^certify = .*", "growth = -1.0", r"\[squeal\] growth"),
        ("^certify = .*", "count = 0", r"\[squeal\] count"),
        ("^friction = .*", "friction = [0.0]", r"\[parameters\] friction: must be numbers"),
        ("^friction = .*", 'friction = "0.5"', r"\[parameters\] friction: must be numbers"),
        ("^friction = .*", "friction = []", r"\[parameters\] friction: must be numbers"),
    ],
)
def test_what_is_wrong_is_named_by_file_line_and_key(
    example, tmp_path, capsys, pattern, words, match
):
    edited(example, change=(pattern, words))
    out = tmp_path / "out"
    assert main(["squeal", str(example), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert re.search(match, said), said
    assert "squeal.toml" in said
    assert not out.exists()


def test_another_law_may_take_the_place_of_the_one_that_is_named(example, tmp_path, capsys):
    asp.FrictionLaw.isotropic(0.01).save(tmp_path / "weak.toml")
    assert main(["squeal", str(example), "--law", str(tmp_path / "weak.toml")]) == 0
    said = capsys.readouterr().out
    assert (
        "no mode between 0 and 15000 Hz and with |Re s| up to 4712 1/s is certain to grow" in said
    )
    asp.FrictionLaw.isotropic(0.3, dimension=1).save(tmp_path / "line.toml")
    assert main(["squeal", str(example), "--law", str(tmp_path / "line.toml")]) == 2
    assert "must be planar" in capsys.readouterr().err
