"""Laws that leave: what other programs make of the exported parameters, and what is lost."""

from __future__ import annotations

import ast
import json
import re
from unittest.mock import Mock, call
from xml.etree import ElementTree

import asperity as asp
import numpy as np
import pytest
from asperity.commands.main import main
from asperity.identify import IdentifiedLaw
from asperity.law.export import TARGETS

PHI = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
E = np.stack([np.cos(PHI), np.sin(PHI)], axis=-1)
GROOVED = asp.FrictionLaw(asp.Ellipse(0.5, 0.4), asp.Ellipse(3.0, 2.0))
TURNED = asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.4, angle=0.3))
BOXED = asp.FrictionLaw.associated(asp.Rectangle(0.5, 0.4))
LAWS = {
    "isotropic": asp.FrictionLaw.isotropic(0.5),
    "boxed": BOXED,
    "grooved": GROOVED,
    "turned": TURNED,
}
NOT_RUN = {"abaqus", "ansys", "lsdyna"}
# Laws that a program has come back as they were.
EXACT = {
    "isotropic": set(TARGETS) - {"ode"},
    "boxed": {"bullet", "ode"},
    "turned": {"siconos", "pinocchio"},
}


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("target", TARGETS)
def test_prices_are_those_of_the_law_that_the_program_makes_of_it(target, name):
    law = LAWS[name]
    export = law.export(target)
    there = export.law
    if there is None:
        # The manual states the coefficients along the axes.
        assert (target, name != "isotropic") == ("ansys", True)
        along = np.linalg.norm(law.force(np.eye(2)), axis=1)
        assert list(export.parameters.values()) == pytest.approx(along, abs=1e-12)
        assert export.force_error is export.angle_error is export.end_distance is None
        return
    if target not in NOT_RUN:
        there = asp.FrictionLaw.like(target, **export.parameters)
        assert there == export.law
    force, other = law.force(E), there.force(E)
    size, there_size = np.linalg.norm(force, axis=1), np.linalg.norm(other, axis=1)
    assert export.force_error == pytest.approx(np.abs(size - there_size).max(), abs=1e-12)
    cosine = (force * other).sum(axis=1) / (size * there_size)
    off = np.arccos(np.clip(cosine, -1.0, 1.0)).max()
    assert export.angle_error == pytest.approx(off, abs=1e-7)
    ends = [path_end(one) for one in (law, there)]
    apart = np.linalg.norm(ends[0] - ends[1])
    # Steps of the price are a two-thousandth of the time, jumps of the force are of first order.
    assert export.end_distance == pytest.approx(apart, abs=1e-4)
    if target in EXACT.get(name, ()):
        assert export.end_distance <= 1e-9
        assert max(export.force_error, export.angle_error) <= 1e-9


def path_end(law):
    launch = 1.52 * np.array([np.cos(np.deg2rad(58.0)), np.sin(np.deg2rad(58.0))])
    point = asp.SlidingPoint(0.018, law=law.replace(rate=None))
    return asp.simulate(point, dt=2e-5, t_end=2.0, u0=launch, until_rest=True).q[-1]


def test_no_parameters_beside_come_nearer():
    export = GROOVED.export("mujoco")
    cost = np.sum((export.law.force(E) - GROOVED.force(E)) ** 2)
    a, b = export.parameters["friction"][:2]
    for factor in ((1.01, 1.0), (0.99, 1.0), (1.0, 1.01), (1.0, 0.99)):
        friction = (a * factor[0], b * factor[1], 0.005, 1e-4, 1e-4)
        beside = asp.FrictionLaw.like("mujoco", friction=friction, cone="elliptic")
        assert np.sum((beside.force(E) - GROOVED.force(E)) ** 2) > cost


def test_collinear_and_associated_laws_find_the_mode_that_has_them():
    collinear = asp.FrictionLaw.collinear(asp.Ellipse(0.5, 0.4))
    assert collinear.export("bullet").parameters["enableConeFriction"]
    assert collinear.export("bullet").force_error <= 1e-9
    assert collinear.export("cardillo").parameters["solver"] == "BackwardEuler"
    associated = asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.4))
    assert associated.export("cardillo").parameters["solver"] == "Moreau"
    diamond = asp.FrictionLaw.like("mujoco", friction=(0.5, 0.5))
    assert diamond.export("mujoco").parameters["cone"] == "pyramidal"
    tensor = asp.FrictionLaw.like("exudyn", dryFriction=(0.9, 0.3), dryFrictionAngle=0.2)
    assert tensor.export("exudyn").angle_error <= 1e-6


def test_mujoco_reads_its_own_text():
    mujoco = pytest.importorskip("mujoco")
    export = asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.4)).export("mujoco")
    body = export.text.replace("GEOM1", "floor").replace("GEOM2", "ball")
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco>{body}<worldbody><geom name="floor" type="plane" size="1 1 1"/><body><freejoint/>'
        '<geom name="ball" size="0.1"/></body></worldbody></mujoco>'
    )
    assert model.pair_friction[0] == pytest.approx([0.5, 0.4, 0.005, 1e-4, 1e-4])
    assert model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC


def test_calls_of_python_give_a_program_its_numbers():
    ode, contact = Mock(ContactApprox1=1, ContactMu2=2, ContactFDir1=4), Mock()
    exec(BOXED.export("ode").text, {"ode": ode, "contact": contact})
    assert contact.setMode.call_args == call(7)
    assert contact.setMu.call_args.args[0] == pytest.approx(0.5, abs=1e-8)
    assert contact.setMu2.call_args.args[0] == pytest.approx(0.4, abs=1e-8)
    assert contact.setFDir1.call_args == call((1.0, 0.0, 0.0))

    newton, builder = Mock(), Mock(shape_material_mu=[1.0, 1.0, 1.0])
    isotropic = LAWS["isotropic"].export("newton")
    exec(isotropic.text, {"newton": newton, "builder": builder, "first": 0, "second": 2})
    assert builder.shape_material_mu == pytest.approx([0.5, 1.0, 0.5], abs=1e-8)
    assert newton.solvers.SolverXPBD.call_args == call(builder.finalize())

    physx, force, known = Mock(), Mock(), {"np": np, "k": 1.0, "nu": 0.0}
    exec(LAWS["isotropic"].export("physx").text, {"physx": physx})
    assert physx.PhysxMaterial.call_args.args == pytest.approx((0.5, 0.5, 0.0), abs=1e-8)
    exec(LAWS["isotropic"].export("opensim").text, {"force": force})
    for word in ("Static", "Dynamic"):
        (mu,) = getattr(force, f"set{word}Friction").call_args.args
        assert mu == pytest.approx(0.5, abs=1e-8)
    assert force.setTransitionVelocity.call_args == call(0.001)
    export = TURNED.export("pyelastica")
    exec(export.text, known | {"RodPlaneContactWithAnisotropicFriction": (rod := Mock())})
    for word in ("static", "kinetic"):
        three = rod.call_args.kwargs[f"{word}_mu_array"]
        assert three == pytest.approx(export.parameters["kinetic_mu_array"], rel=1e-8)

    square = asp.FrictionLaw.associated(asp.Rectangle(0.5, 0.5))
    for law, solver in (LAWS["isotropic"], "NsgsFrictionSolver"), (square, "DantzigBoxedLcpSolver"):
        dartpy, world, node = Mock(), Mock(), Mock()
        body = Mock(getShapeNodes=lambda node=node: [node])
        exec(law.export("dart").text, {"dartpy": dartpy, "world": world, "body": body})
        (used,) = world.getConstraintSolver().setBoxedLcpSolver.call_args.args
        assert used is getattr(dartpy.constraint, solver)()
        (mu,) = node.getDynamicsAspect().setFrictionCoeff.call_args.args
        assert mu == pytest.approx(0.5, abs=1e-8)

    export, mbs = TURNED.export("exudyn"), Mock()
    names = ("ground", "body", "memory", "radius", "stiffness", "damping")
    own = {"mbs": mbs, "ObjectConnectorRollingDiscPenalty": dict, **dict.fromkeys(names)}
    exec(export.text, own)
    (disc,) = mbs.AddObject.call_args.args
    for name, number in export.parameters.items():
        assert disc[name] == pytest.approx(number, rel=1e-8)


def test_texts_say_how_far_a_program_is_from_its_own_law():
    text = LAWS["isotropic"].export("dart").text.replace("\n# ", " ")
    assert "A path of 0.24 m ends up to 0.077 mm beside that of its law." in text


def test_the_price_of_what_a_manual_does_not_state_is_not_known(tmp_path, capsys):
    one = LAWS["isotropic"].export("ansys")
    assert one.text.splitlines()[-2:] == ["TB,FRIC,1,,,ISO", "TBDATA,1,0.5"]
    two = GROOVED.export("ansys")
    assert two.text.splitlines()[-2:] == ["TB,FRIC,1,,,ORTHO", "TBDATA,1,0.5,0.4"]
    assert "Errors are not known" in two.text.replace("\n! ", " ")
    assert repr(two) == "<LawExport to ansys: errors are not known>"
    assert GROOVED.export("lsdyna").text.splitlines()[-2] == "$ fs, fd, dc"
    GROOVED.save(tmp_path / "law.toml")
    assert main(["export", str(tmp_path / "law.toml"), "--to", "ansys", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["end_error"] is None
    assert found["force_error"] is found["angle_error"] is found["end_distance"] is None
    assert found["parameters"] == pytest.approx({"MU1": 0.5, "MU2": 0.4})


def test_ends_of_a_rectangle_whose_sides_slow_down_each_by_itself():
    export = asp.FrictionLaw.associated(asp.Rectangle(0.4, 0.2)).export("drake")
    start = 1.52 * np.array([np.cos(np.deg2rad(58.0)), np.sin(np.deg2rad(58.0))])
    ends = start**2 / (2.0 * 9.81 * np.array([0.4, 0.2]))
    ends = ends - 1.52 * start / (2.0 * 9.81 * export.parameters["dynamic_friction"])
    assert export.end_distance == pytest.approx(np.linalg.norm(ends), rel=1e-4)


def test_ends_of_a_slender_law():
    law = asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.005))
    export = law.export("drake")
    start = 1.52 * np.array([np.cos(np.deg2rad(58.0)), np.sin(np.deg2rad(58.0))])
    motions = [
        asp.integrate(asp.SlidingPoint(0.018, law=one), t_end=40.0, u0=start)
        for one in (law, export.law)
    ]
    apart = motions[1].q[-1] - motions[0].q[-1]
    assert export.end_distance == pytest.approx(np.linalg.norm(apart), rel=1e-4)


def test_small_coefficients_keep_their_digits():
    law = asp.FrictionLaw.associated(asp.Ellipse(2e-10, 1e-10, angle=0.3))
    export = law.export("siconos")
    assert export.angle_error <= 1e-6
    _, factor = export.text.split("factor_of_tangential_rows = np.array(")
    factor = json.loads(factor.strip().removesuffix(")"))
    assert factor == pytest.approx(export.parameters["H"], rel=1e-8)


def test_round_laws_get_no_angle():
    assert asp.FrictionLaw.isotropic(0.5).export("exudyn").parameters["dryFrictionAngle"] == 0.0


def test_angles_are_at_most_a_quarter_turn():
    square = asp.FrictionLaw.associated(asp.Rectangle(0.5, 0.5)).export("exudyn")
    assert abs(square.parameters["dryFrictionAngle"]) <= 0.5 * np.pi


@pytest.mark.parametrize("target", TARGETS)
def test_texts_can_be_read_whatever_the_name_of_the_file(target, tmp_path, capsys):
    file = tmp_path / "a---b -- c.toml"
    TURNED.save(file)
    assert main(["export", str(file), "--to", target]) == 0
    text = capsys.readouterr().out
    if text.startswith("<!--"):
        ElementTree.fromstring(f'<sdf xmlns:drake="drake.mit.edu">{text}</sdf>')
    elif text.startswith("# "):
        ast.parse(text)


def plain(export):
    return " ".join(line.strip("#$!*/<>-, ") for line in export.text.splitlines())


@pytest.mark.parametrize("target", ["drake", "mujoco", "rapier"])
def test_one_coefficient_is_that_of_sliding(target):
    rate = asp.Stribeck(0.03, ratio=0.6)
    law = LAWS["isotropic"].replace(rate=rate)
    export = law.export(target)
    radius = export.law.reservoir.radius(PHI)
    assert radius == pytest.approx(np.full(PHI.size, 0.3), abs=1e-8)
    assert export.force_error == pytest.approx(0.2, abs=1e-8)
    assert "left out: Stribeck(0.03, ratio=0.6). Coefficients are those of sliding" in plain(export)
    # Above the speed that is said the factor is within 5 %.
    (above,) = [float(one.split()[0]) for one in plain(export).split("to 5% above ")[1:]]
    assert rate(above) == pytest.approx(1.05 * 0.6, rel=2e-3)
    start = 1.52 * np.array([np.cos(np.deg2rad(58.0)), np.sin(np.deg2rad(58.0))])
    ends = [
        asp.simulate(asp.SlidingPoint(1.0, law=one), dt=2e-5, t_end=2.0, u0=start, until_rest=True)
        for one in (law, export.law)
    ]
    apart = np.linalg.norm(ends[1].q[-1] - ends[0].q[-1])
    assert export.end_distance == pytest.approx(apart, abs=2e-5)
    assert apart > 1e-4


def test_drake_and_lsdyna_get_the_static_coefficient_as_well():
    law = LAWS["isotropic"].replace(rate=asp.Stribeck(0.03, ratio=0.6))
    drake = law.export("drake")
    assert "<drake:mu_dynamic>0.3<" in drake.text
    assert "<drake:mu_static>0.5<" in drake.text
    assert asp.FrictionLaw.like("drake", **drake.parameters) == drake.law
    own = law.export("lsdyna")
    fs, fd, dc = map(float, own.text.splitlines()[-1].split(","))
    speeds = np.linspace(0.0, 1.0, 50)
    given = fd + (fs - fd) * np.exp(-dc * speeds)
    assert given == pytest.approx(0.5 * law.rate(speeds), rel=1e-8)
    assert max(own.force_error, own.end_distance) <= 1e-8
    assert "is that of FS, FD and DC" in plain(own)
    other = law.replace(rate=asp.Stribeck(0.03, ratio=0.6, shape="hyperbolic")).export("lsdyna")
    x = np.geomspace(1e-3, 50.0, 1000)
    off = 0.5 * 0.4 * np.abs(np.exp(-x) - 1.0 / (1.0 + x)).max()
    assert other.force_error == pytest.approx(off, rel=1e-2)
    assert "becomes that of FS, FD and DC" in plain(other)


def test_a_force_that_falls_to_zero_leaves_the_coefficient_at_rest():
    export = LAWS["isotropic"].replace(rate=asp.Stribeck(0.03)).export("mujoco")
    assert export.parameters["friction"][0] == pytest.approx(0.5, abs=1e-8)
    assert export.force_error == pytest.approx(0.5, abs=1e-8)
    assert export.end_distance <= 1e-9
    assert "those at rest; of fast sliding they fall to zero" in plain(export)
    viscous = LAWS["isotropic"].replace(rate=asp.Stribeck(0.03, ratio=1.0, viscous=0.1))
    assert viscous.export("mujoco").force_error == pytest.approx(0.5 * 0.152, abs=1e-8)


@pytest.mark.parametrize("target", ["abaqus", "mujoco", "bullet"])
def test_turning_the_contact_is_said_where_it_helps(target):
    law = asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.4, angle=0.5))
    if target == "bullet":
        law = asp.FrictionLaw.collinear(asp.Ellipse(0.5, 0.4, angle=0.5))
    text = plain(law.export(target))
    assert "are turned by 28.6° from those of the contact" in text
    assert "differ by 0 λ_N, 0° and 0 mm." in text
    assert "are turned by" not in plain(law.rotated(-0.5).export(target))
    assert "are turned by" not in plain(LAWS["isotropic"].export(target))
    assert "are turned by" not in plain(law.export("exudyn"))


def test_rounding_is_not_printed():
    export = asp.FrictionLaw.associated(asp.Ellipse(0.5, 0.4)).export("exudyn")
    assert export.parameters["dryFrictionAngle"] == 0.0
    for target in TARGETS:
        for law in (LAWS["isotropic"], TURNED, BOXED):
            one = law.export(target)
            assert not re.search(r"\de-(0[8-9]|1\d)", repr(one) + one.text), one.text


def test_what_no_program_holds_is_said():
    with pytest.raises(asp.ParameterError, match=r"'mujuco' is not known.*mujoco"):
        GROOVED.export("mujuco")
    assert GROOVED.export("pybullet").text == GROOVED.export("bullet").text
    with pytest.raises(asp.DimensionError, match="planar"):
        asp.FrictionLaw.isotropic(0.3, dimension=1).export("mujoco")


def test_the_command_writes_standard_errors_as_comments(tmp_path, capsys):
    models = {"reservoir_model": "circle", "direction_model": "circle"}
    law = asp.FrictionLaw.isotropic(0.3)
    file = tmp_path / "law.toml"
    IdentifiedLaw(law, values=[0.3], turns=np.array([[1e-4]]), **models).save(file)
    assert main(["export", str(file), "--to", "abaqus"]) == 0
    text = capsys.readouterr().out
    assert "** reservoir.radius = 0.3 ± 0.003" in text
    assert text.splitlines()[-2:] == ["*FRICTION, ANISOTROPIC", "0.3, 0.3"]
    target = tmp_path / "pair.xml"
    assert main(["export", str(file), "--to", "mujoco", "--out", str(target), "--json"]) == 0
    assert target.read_text() == json.loads(capsys.readouterr().out)["text"]
    assert main(["export", str(file), "--to", "abacus"]) == 2
    assert "--to: 'abacus' is not known" in capsys.readouterr().err


@pytest.mark.parametrize("program", ["abaqus", "mujoco", "drake", "lsdyna"])
def test_the_covariance_of_a_law_is_json_in_the_comments(program, tmp_path, capsys):
    models = {"reservoir_model": "ellipse", "direction_model": "ellipse"}
    law = asp.FrictionLaw(asp.Ellipse(0.5, 0.4, angle=0.3), asp.Ellipse(1.5, 1.0, angle=0.2))
    root = 0.01 * np.random.default_rng(1).normal(size=(5, 5))
    spread, file = root @ root.T, tmp_path / "law.toml"
    IdentifiedLaw(law, values=[0.5, 0.4, 0.3, 1.5, 0.2], turns=spread, **models).save(file)
    assert main(["export", str(file), "--to", program, "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    _, _, rest = printed["text"].partition("covariance = ")
    # What follows the end of the JSON is no part of it.
    plain = re.sub(r"(?: -->)?\n(?:<!--|\*\*|#|\$|//) ", " ", rest)
    found, _ = json.JSONDecoder().raw_decode(plain)
    assert found == printed["covariance"]
    assert found["coordinates"][0] == "ln(reservoir.a)"
    np.testing.assert_allclose(found["matrix"], spread, rtol=1e-5)
