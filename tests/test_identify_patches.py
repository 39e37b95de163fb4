"""Laws of contact patches from pairs of wrench and twist, of truths that are known."""

import itertools
import pickle

import asperity as asp
import numpy as np
import pytest
from asperity import identify
from asperity.errors import FitError
from asperity.identify import PatchFit, compare_patches, fit_patch, fit_supports
from asperity.identify.evidence.wrenches.pairs import Pairs, in_ground
from asperity.identify.evidence.wrenches.solving import descend
from asperity.identify.models.patches import (
    EllipsoidPatch,
    ExtendedPatch,
    ExtendedPoints,
    PointsPatch,
)
from profiles import counts, every

PHI = 2.0 * np.pi * np.arange(5) / 5 + 0.2
PLACES = 0.9 * np.stack([np.cos(PHI), np.sin(PHI)], axis=-1)
LOADS = np.array([0.1, 0.05, 0.08, 0.04, 0.06])
TILTED = asp.Ellipsoid([0.4, 0.3, 0.2]).mapped([[1.0, 0.0, 0.0], [0.2, 1.0, 0.0], [0.1, -0.2, 1.0]])
AREA = asp.CoulombContensou(0.3).mapped([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.1, 0.2, 0.7]])
STRETCH = np.array([[1.1, 0.1], [0.1, 0.95]])
STRETCH /= np.sqrt(np.linalg.det(STRETCH))


def support(place, load, stretch=None, spot=0.01):
    """The set of a support point, an image of a ball, as its definition has it."""
    image = np.zeros((3, 3))
    image[:2, :2] = np.eye(2) if stretch is None else stretch
    image[2, :2] = np.array([-place[1], place[0]]) @ image[:2, :2]
    image[2, 2] = spot
    return asp.Ball(1.0).mapped(load * image)


def supports(stretch=None):
    sets = [support(place, load, stretch) for place, load in zip(PLACES, LOADS, strict=True)]
    return asp.sets.MinkowskiSum(sets)


TRUTHS = {
    "ellipsoid": (asp.FrictionLaw.associated(TILTED), {}),
    "ellipsoids": (
        asp.FrictionLaw(TILTED, asp.Ellipsoid([1.0, 0.7, 0.8])),
        {"direction": "ellipsoid"},
    ),
    "area": (asp.FrictionLaw.associated(AREA), {"reservoir": "contensou"}),
    "points": (asp.FrictionLaw.associated(supports()), {"reservoir": "supports"}),
    "known points": (
        asp.FrictionLaw.associated(supports(STRETCH)),
        {"reservoir": "supports", "places": PLACES, "loads": LOADS, "friction": "ellipse"},
    ),
}
every_truth = pytest.mark.parametrize("name", TRUTHS)


def twists(random, n):
    """Twists of pushes, five neighbours of which are nearly alike."""
    return np.repeat(random.normal(size=(n // 5, 3)), 5, axis=0) + 0.1 * random.normal(size=(n, 3))


def noise(random, wrench):
    """Noise of which half is common to neighbours."""
    n = len(wrench)
    common = np.repeat(random.normal(size=(n // 5, 3)), 5, axis=0)
    return 0.02 * np.abs(wrench).mean() * (common + random.normal(size=(n, 3)))


MODELS = [
    EllipsoidPatch(),
    EllipsoidPatch(frame="ground"),
    PointsPatch(4, radius=0.01),
    PointsPatch(4, radius=0.01, friction="ellipse"),
    PointsPatch(3, radius=0.05, friction="ellipse", frame="ground"),
    PointsPatch(3, radius=0.01, places=PLACES[:3], loads=LOADS[:3], friction="ellipse"),
    PointsPatch(3, radius=0.01, loads=LOADS[:3]),
    PointsPatch(3, radius=0.001, known=True, friction="ellipse", frame="ground"),
    PointsPatch(1, radius=None),
    PointsPatch(1, radius=None, friction="ellipse", frame="ground", pressure="uniform"),
    ExtendedPatch(EllipsoidPatch()),
    ExtendedPatch(EllipsoidPatch(frame="ground")),
    ExtendedPatch(PointsPatch(3, radius=0.1)),
    ExtendedPatch(PointsPatch(1, radius=None)),
    ExtendedPoints(frame="ground"),
    ExtendedPoints(frame="body"),
]


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.words)
def test_derivatives_are_those_of_differences(model):
    random = np.random.default_rng(1)
    pairs = Pairs(
        random.normal(size=(30, 3)),
        random.normal(size=(30, 3)),
        angle=random.uniform(0.0, 6.0, 30),
        places=random.normal(size=(30, 3, 2)),
        loads=random.uniform(1.0, 2.0, (30, 3)),
    )
    p = 0.4 * random.normal(size=model.size)
    by = model.both(p, pairs)[1]
    step = 1e-6
    for k, unit in enumerate(step * np.eye(model.size)):
        difference = model.both(p + unit, pairs)[0] - model.both(p - unit, pairs)[0]
        np.testing.assert_allclose(by[:, :, k], difference / (2.0 * step), atol=1e-7 * by.max())


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.words)
def test_steps_that_go_too_far_are_taken_back(model):
    """A search may try coordinates whose exponentials are beyond the range of numbers."""
    random = np.random.default_rng(3)
    pairs = Pairs(
        random.normal(size=(20, 3)),
        random.normal(size=(20, 3)),
        angle=random.uniform(0.0, 6.0, 20),
        places=random.normal(size=(20, 3, 2)),
        loads=random.uniform(1.0, 2.0, (20, 3)),
    )
    start = np.full(model.size, 0.1)
    asked = []

    class Far(type(model)):
        def __init__(self, of):
            self._keep(_of=of, coordinates=of.coordinates)

        def both(self, p, pairs):
            asked.append(p)
            # The second place that the search asks for is far away.
            return self._of.both(np.full_like(p, 2000.0) if len(asked) == 2 else p, pairs)

    found = descend(Far(model), pairs, start, "soft_l1", 1.0, 20, 1e-8)
    assert len(asked) > 2
    assert np.isfinite(found.p).all()
    assert np.isfinite(found.cost)


@pytest.mark.parametrize("model", MODELS[:-2], ids=lambda model: model.words)
def test_wrenches_are_those_of_the_law(model):
    """What is fitted and what the sets of the law give is the same to rounding."""
    if getattr(model, "known", False):
        return
    random = np.random.default_rng(2)
    p, twist = 0.4 * random.normal(size=model.size), random.normal(size=(50, 3))
    wrench = model.both(p, Pairs(np.zeros_like(twist), twist))[0]
    scale = np.abs(wrench).max()
    np.testing.assert_allclose(-model.law(p).force(twist), wrench, atol=1e-12 * scale)


def test_an_ellipse_fits_no_worse_than_isotropic_friction():
    """Models that hold each other start from each other."""
    law, options = TRUTHS["points"]
    random = np.random.default_rng(12)
    twist = twists(random, 300)
    wrench = -law.force(twist)
    wrench += noise(random, wrench)
    round_one, long_one = (
        fit_patch(wrench, twist, loss="linear", friction=one, **options)
        for one in ("isotropic", "ellipse")
    )
    assert long_one.rms <= round_one.rms * (1.0 + 1e-9)


@every_truth
def test_without_noise_the_law_is_found_to_rounding(name):
    law, options = TRUTHS[name]
    random = np.random.default_rng(3)
    twist = twists(random, 600)
    fit = fit_patch(-law.force(twist), twist, **options)
    probe = random.normal(size=(100, 3))
    np.testing.assert_allclose(fit.law.force(probe), law.force(probe), atol=1e-6)
    np.testing.assert_allclose(fit.wrench(probe), -law.force(probe), atol=1e-6)
    assert fit.converged
    assert fit.warnings == ()


@counts(10, 200)
@every_truth
def test_bands_hold_the_truth(name, count):
    """Nominally 95 %; the lower limits are passed by chance with less than one case in 1000."""
    law, options = TRUTHS[name]
    exact = twists(np.random.default_rng(99), 1500)
    truth = fit_patch(-law.force(exact), exact, loss="linear", **options).parameters
    held = dict.fromkeys(truth, 0)
    for seed in range(count):
        random = np.random.default_rng(seed)
        twist = twists(random, 400)
        wrench = -law.force(twist)
        found = fit_patch(wrench + noise(random, wrench), twist, **options).parameters
        for key, one in found.items():
            held[key] += one.covers(truth[key].value)
    least = {10: 7, 200: 180}[count]
    assert {key: times for key, times in held.items() if times < least} == {}


def test_the_bands_of_blocks_are_wider_than_those_of_rows():
    """Neighbours share their noise: a block for each pair would promise too much."""
    law, options = TRUTHS["area"]
    random = np.random.default_rng(0)
    twist = np.repeat(random.normal(size=(80, 3)), 5, axis=0)
    wrench = -law.force(twist)
    wrench += 0.01 * np.repeat(random.normal(size=(80, 3)), 5, axis=0)
    by_blocks = fit_patch(wrench, twist, blocks=20, **options).parameters["mu"]
    by_rows = fit_patch(wrench, twist, blocks=np.arange(400), **options).parameters["mu"]
    assert 1.5 < by_blocks.standard_error / by_rows.standard_error < 4.0


def test_a_law_of_the_ground_turns_against_the_body():
    law, _ = TRUTHS["ellipsoids"]
    random = np.random.default_rng(4)
    twist, angle = twists(random, 400), random.uniform(0.0, 2.0 * np.pi, 400)
    wrench = in_ground(-law.force(in_ground(twist, angle)), -angle)
    fit = fit_patch(wrench, twist, direction="ellipsoid", frame="ground", angle=angle)
    assert fit.rms < 1e-6
    np.testing.assert_allclose(fit.wrench(twist, angle=angle), wrench, atol=1e-6)
    probe = random.normal(size=(50, 3))
    np.testing.assert_allclose(fit.law.force(probe), law.force(probe), atol=1e-6)
    assert fit_patch(wrench, twist, direction="ellipsoid").rms > 0.05


def test_ellipses_of_the_ground_at_points_of_the_body():
    random = np.random.default_rng(5)
    twist, angle = twists(random, 300), random.uniform(0.0, 2.0 * np.pi, 300)
    wrench = np.empty_like(twist)
    for k, (one, turn) in enumerate(zip(twist, angle, strict=True)):
        c, s = np.cos(turn), np.sin(turn)
        R = np.array([[c, -s], [s, c]])
        sets = [
            support(place, load, R.T @ STRETCH @ R)
            for place, load in zip(PLACES, LOADS, strict=True)
        ]
        wrench[k] = sum(one_set.support_point(one) for one_set in sets)
    options = {"reservoir": "supports", "places": PLACES, "loads": LOADS, "friction": "ellipse"}
    fit = fit_patch(wrench, twist, frame="ground", angle=angle, **options)
    assert fit.rms < 1e-6
    long, short = np.linalg.eigvalsh(STRETCH)[::-1]
    assert fit.parameters["friction.ratio"].value == pytest.approx(long / short, rel=1e-6)
    assert fit_patch(wrench, twist, **options).rms > 0.02


def test_lengths_and_loads_have_their_units():
    """The law is per unit normal force and of (v, ω ℓ), places are in metres."""
    law, options = TRUTHS["area"]
    random = np.random.default_rng(6)
    twist = twists(random, 400)
    wrench = -law.force(twist)
    length, load = 0.05, 12.0
    fit = fit_patch(
        load * wrench * [1.0, 1.0, length],
        twist / [1.0, 1.0, length],
        length=length,
        normal_force=load,
        **options,
    )
    np.testing.assert_allclose(fit.law.force(twist), law.force(twist), atol=1e-6)
    assert fit.parameters["radius"].value == pytest.approx(0.7 * length, rel=1e-5)
    assert fit.parameters["centre.1"].value == pytest.approx(0.2 * length, rel=1e-5)
    assert fit.parameters["mu"].value == pytest.approx(0.3, rel=1e-5)


@pytest.mark.parametrize("unit", [1e-9, 1e-6, 1e6])
@every_truth
def test_the_unit_of_forces_does_not_matter(name, unit):
    """Wrenches of micronewtons are fitted as well as those of newtons."""
    law, options = TRUTHS[name]
    random = np.random.default_rng(5)
    twist = twists(random, 200)
    wrench = -law.force(twist)
    wrench += noise(random, wrench)
    plain, small = (fit_patch(factor * wrench, twist, **options) for factor in (1.0, unit))
    assert small.warnings == plain.warnings
    for key, one in plain.parameters.items():
        other = small.parameters[key]
        kind, _, quantity = key.partition(".")
        is_force = quantity.startswith(("force", "moment")) and kind == "reservoir"
        factor = unit if key in ("mu", "load") or quantity == "load" or is_force else 1.0
        assert other.value == pytest.approx(
            factor * one.value, abs=2e-3 * factor * one.standard_error
        )
        assert other.standard_error == pytest.approx(factor * one.standard_error, rel=1e-3)


@every_truth
def test_the_order_the_mirror_image_and_the_size_of_twists_do_not_matter(name):
    law, options = TRUTHS[name]
    random = np.random.default_rng(5)
    twist = twists(random, 200)
    wrench = -law.force(twist)
    wrench += noise(random, wrench)
    plain = fit_patch(wrench, twist, **options)
    order, mirror = random.permutation(200), np.array([1.0, -1.0, -1.0])
    turned = {**options}
    if "places" in options:
        turned["places"] = options["places"] * [1.0, -1.0]
    for other, fit in (
        (1.0, fit_patch(-wrench, -twist, **options)),
        (1.0, fit_patch(wrench, twist * random.uniform(0.1, 10.0, (200, 1)), **options)),
        (1.0, fit_patch(wrench[order], twist[order], blocks=plain.blocks[order], **options)),
        (mirror, fit_patch(wrench * mirror, twist * mirror, **turned)),
    ):
        assert fit.rms == pytest.approx(plain.rms, rel=1e-6)
        np.testing.assert_allclose(
            fit.wrench(twist * other), plain.wrench(twist) * other, atol=1e-5
        )


def test_outliers_hardly_move_the_fit():
    law, options = TRUTHS["area"]
    random = np.random.default_rng(7)
    twist = twists(random, 400)
    wrench = -law.force(twist) + 0.002 * random.normal(size=(400, 3))
    wrench[random.random(400) < 0.03] *= 3.0
    robust = fit_patch(wrench, twist, **options).parameters["mu"].value
    plain = fit_patch(wrench, twist, loss="linear", **options).parameters["mu"].value
    assert abs(robust - 0.3) < 0.005 < abs(plain - 0.3)


def test_the_law_is_that_of_a_contact_problem_and_of_bodies():
    """A block that is pushed on its patch slides and turns as the balance of wrenches says."""
    law, options = TRUTHS["points"]
    random = np.random.default_rng(8)
    twist = twists(random, 400)
    wrench = -law.force(twist)
    fit = fit_patch(wrench + noise(random, wrench), twist, **options)
    free = np.array([-1.0, 0.8, -0.3, 0.5])
    solution = asp.ContactProblem(np.eye(4), free_velocity=free, laws=fit.law).solve()
    assert solution.residual < 1e-12
    # In slip the percussion is that of the law at the sliding velocity.
    slip = solution.velocity[1:]
    assert np.linalg.norm(slip) > 0.1
    np.testing.assert_allclose(
        solution.percussion[1:],
        fit.law.force(slip, normal_force=solution.percussion[0]),
        atol=1e-12,
    )
    radius = 0.05
    body = asp.Body.ball(1.0, radius=radius, position=(0.0, 0.0, radius), velocity=(0.5, 0.2, 0.0))
    contact = asp.SpherePlane(0, radius=radius, plane=asp.Plane(), law=fit.law, patch_radius=0.01)
    run = asp.simulate(asp.RigidBodies([body], pairs=[contact]), dt=1e-3, t_end=0.05)
    force = run.force[-1, 0]
    assert np.linalg.norm(force) > 0.0
    assert fit.reservoir.gauge(-force / 9.81) < 1.0 + 1e-6


@every_truth
def test_fits_are_values_and_are_read_as_they_were_written(name, tmp_path):
    """A fit that another process has made equals that of this one, to the bit."""
    law, options = TRUTHS[name]
    twist = twists(np.random.default_rng(9), 200)
    fit = fit_patch(-law.force(twist), twist, **options)
    read = pickle.loads(pickle.dumps(fit))
    assert read == fit
    assert hash(read) == hash(fit)
    assert read.parameters == fit.parameters
    assert fit.replace(confidence=0.5) != fit
    fit.save(tmp_path / "fit.npz")
    loaded = PatchFit.load(tmp_path / "fit.npz")
    assert loaded == fit
    assert loaded.blocks.dtype == fit.blocks.dtype
    assert loaded.summary() == fit.summary()
    assert loaded.law == fit.law
    models = {"this": fit.model, "ellipsoid": EllipsoidPatch()}
    assert loaded.compare(models) == fit.compare(models)


def test_the_law_is_saved_with_its_sets(tmp_path):
    for name, (law, options) in TRUTHS.items():
        twist = twists(np.random.default_rng(9), 300)
        found = fit_patch(-law.force(twist), twist, **options).law
        found.save(tmp_path / f"{name}.toml")
        assert asp.FrictionLaw.load(tmp_path / f"{name}.toml") == found


def test_the_comparison_finds_the_model_and_whether_the_law_is_associated():
    """C ≠ D is claimed where it is true, and not where a crude C would take it for its shape."""
    models = {
        "ellipsoid": {},
        "ellipsoids C and D": {"direction": "ellipsoid"},
        "area": {"reservoir": "contensou"},
    }
    best, gains = {}, {}
    for name in ("ellipsoid", "ellipsoids", "area"):
        law = TRUTHS[name][0]
        random = np.random.default_rng(10)
        twist = twists(random, 400)
        wrench = -law.force(twist)
        found = compare_patches(wrench + noise(random, wrench), twist, models=models)
        best[name] = found.best.name, found.best_predicting.name
        gains[name] = found.improvement("ellipsoids C and D", over="ellipsoid")
    assert best["ellipsoid"][0] == "ellipsoid"
    assert best["ellipsoids"] == ("ellipsoids C and D",) * 2
    assert best["area"] == ("area", "area")
    assert gains["ellipsoids"].low > 0.5
    assert gains["ellipsoid"].low < 0.0 < 0.1
    assert gains["ellipsoid"].value < 0.02


def test_points_that_are_no_places_are_named():
    """Light points far outside describe a torque, which no place of the patch does."""
    random = np.random.default_rng(11)
    twist = twists(random, 400)
    sets = [support(place, load) for place, load in zip(PLACES, LOADS, strict=True)]
    far = asp.sets.MinkowskiSum([*sets[:4], support([20.0, 5.0], 0.003)])
    wrench = -asp.FrictionLaw.associated(far).force(twist)
    fit = fit_patch(wrench, twist, reservoir="supports")
    (warning,) = fit.warnings
    assert "is no place of the patch" in warning


# Pushes of bodies on known points.
TRIANGLE = np.array([[0.08, -0.04], [-0.04, -0.04], [-0.04, 0.08]])
WEIGHT = 15.0


def pushes(law, seed, n=120, points=TRIANGLE, turned=True):
    """Pushes of a body whose friction keeps its axes in the ground, or turns with the body."""
    random = np.random.default_rng(seed)
    pose = np.column_stack([random.normal(size=(n, 2)), random.uniform(0.0, 6.3, n)])
    move = random.normal(size=(n, 3)) * [0.01, 0.01, 0.2]
    shape = np.vstack([points.T, np.ones(3)])
    loads = np.linalg.solve(shape, [0.0, 0.0, WEIGHT])
    applied = np.zeros((n, 3))
    for row, load in zip(points, loads, strict=True):
        arm = in_ground(np.broadcast_to(row, (n, 2)), pose[:, 2])
        slip = move[:, :2] + move[:, 2:] * np.stack([-arm[:, 1], arm[:, 0]], axis=-1)
        if turned:
            force = -law.force(slip, normal_force=load)
        else:
            force = -law.force(in_ground(slip, -pose[:, 2]), normal_force=load)
            force = in_ground(force, pose[:, 2])
        applied[:, :2] += force
        applied[:, 2] += arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
    applied += np.array([0.1, 0.1, 0.007]) * random.normal(size=(n, 3))
    return np.column_stack([pose, move, applied])


def test_isotropic_friction_is_found_and_no_anisotropy_is_claimed():
    law = asp.FrictionLaw.isotropic(0.3)
    held, claims = 0, 0
    for seed in range(20):
        table = pushes(law, seed)
        fit = fit_supports(table, TRIANGLE, weight=WEIGHT)
        held += fit.parameters["mu"].covers(0.3)
        ellipse = fit_supports(table, TRIANGLE, weight=WEIGHT, friction="ellipse")
        claims += ellipse.parameters["friction.ratio"].identifiable
        if seed < 3:
            assert not fit.anisotropic
    assert held >= 16
    assert claims <= 2


@pytest.mark.parametrize("frame", ["ground", "body"])
def test_what_carries_the_axes_is_found(frame):
    law = asp.FrictionLaw.associated(asp.Ellipse(0.35, 0.28, angle=0.4))
    table = pushes(law, 1, turned=frame == "ground")
    fit = fit_supports(table, TRIANGLE, weight=WEIGHT, friction="ellipse", frame=frame)
    assert fit.comparison.best.name == f"ellipse in the {frame}"
    assert fit.anisotropic == (frame == "ground")
    found = fit.parameters
    assert found["friction.ratio"].covers(0.35 / 0.28)
    assert found["friction.angle"].covers(0.4)
    assert found["mu"].covers(np.sqrt(0.35 * 0.28))
    assert fit.law.is_associated
    assert fit.law.reservoir.a == pytest.approx(0.35, rel=0.02)


def test_the_direction_set_of_points_is_found():
    law = asp.FrictionLaw(asp.Ellipse(0.35, 0.28, angle=0.4), asp.Ellipse(1.0, 1.4, angle=0.1))
    truth = {"friction.ratio": 0.35 / 0.28, "friction.angle": 0.4, "direction.ratio": 1.4}
    held = dict.fromkeys(truth, 0)
    for seed in range(10):
        fit = fit_supports(pushes(law, seed), TRIANGLE, weight=WEIGHT, direction="ellipse")
        for name, value in truth.items():
            held[name] += fit.parameters[name].covers(value)
    assert min(held.values()) >= 7
    assert fit.comparison.best.name == "ellipses C and D in the ground"
    assert not fit.law.is_associated


def test_logs_with_points_of_their_own_are_left_out_in_turn():
    law = asp.FrictionLaw.isotropic(0.3)
    corners = [TRIANGLE, 0.5 * TRIANGLE, TRIANGLE[:, ::-1] * [1.0, -1.0]]
    logs = [pushes(law, k, n=40, points=one) for k, one in enumerate(corners)]
    fit = fit_supports(logs, corners, weight=WEIGHT)
    assert fit.parameters["mu"].covers(0.3)
    assert np.bincount(fit.folds).tolist() == [40, 40, 40]
    # Blocks of one session that went through all logs must not be on both sides.
    sessions = np.arange(120) % 6
    mixed = fit_supports(logs, corners, weight=WEIGHT, blocks=sessions)
    for block in range(6):
        assert len(np.unique(mixed.folds[sessions == block])) == 1
    within = fit_supports(logs, corners, weight=WEIGHT, blocks=np.arange(120) // 10)
    assert np.array_equal(within.folds, fit.folds)
    loads = np.full(3, WEIGHT / 3.0)
    centred = [one - one.mean(axis=0) for one in corners]
    same = [fit_supports(logs, centred, **one) for one in ({"weight": WEIGHT}, {"loads": loads})]
    assert same[0].parameters["mu"].value == pytest.approx(same[1].parameters["mu"].value)


def test_arguments_are_refused_by_name():
    random = np.random.default_rng(0)
    twist = random.normal(size=(60, 3))
    wrench = -TRUTHS["area"][0].force(twist)

    def refused(match, function=fit_patch, subject=(wrench, twist), **options):
        with pytest.raises(asp.AsperityError, match=match):
            function(*subject, **options)

    refused("power of 100% of the pairs is negative", subject=(-wrench, twist))
    most = np.where(np.arange(len(wrench))[:, None] < 0.6 * len(wrench), -wrench, wrench)
    refused("power of 60% of the pairs is negative", subject=(most, twist))
    refused("2 pairs do not tell 6 parameters", subject=(wrench[:2], twist[:2]), blocks=2)
    refused(
        "twist: must not vanish, does so in row 3",
        subject=(wrench, twist * (np.arange(60) != 3)[:, None]),
    )
    refused("angle: must be given", frame="ground")
    refused("friction: is no matter of an ellipsoid", friction="ellipse")
    refused("places: are those of", places=PLACES)
    refused("loads: must be 5 numbers, got 3", reservoir="supports", places=PLACES, loads=[1, 1, 1])
    refused("loads: must be positive", reservoir="supports", loads=[1.0, -1.0, 1.0])
    refused(
        "direction: must be None",
        reservoir="contensou",
        direction="ellipsoid",
        frame="ground",
        angle=np.zeros(60),
    )
    refused("points: must be 2 or more", reservoir="supports", points=1)
    refused("blocks: must be 60 or fewer", blocks=61)
    refused("blocks: must be two or more", blocks=np.zeros(60))
    refused("models: must name at least one", compare_patches, models={})
    table = pushes(asp.FrictionLaw.isotropic(0.3), 0)
    refused("weight: must be given", fit_supports, (table, TRIANGLE))
    refused("9 columns", fit_supports, (table[:, :8], TRIANGLE), weight=1.0)
    refused(
        "points: must have the centre of mass", fit_supports, (table, TRIANGLE + 1.0), weight=1.0
    )
    refused(
        "points: must not lie on a line",
        fit_supports,
        (table, [[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]]),
        weight=1.0,
    )
    refused("statics do not tell those of 5 points", fit_supports, (table, PLACES), weight=1.0)
    refused(
        "points: must be those of 2 logs", fit_supports, ([table, table], [TRIANGLE]), weight=1.0
    )


DEGREE = np.pi / 180.0
TURNED, PLAIN = (1.0, 1.0, -1.0), (1.0, 1.0, 1.0)
# What is done to wrench and twist, and what the sentence says of it.
MISTAKES = {
    "sign of the torque": (TURNED, PLAIN, "the sign of the torque or of the rotation turned"),
    "N mm": ((1.0, 1.0, 1e3), PLAIN, "torques divided by 1000, as of N mm"),
    "mm/s": (PLAIN, (1e3, 1e3, 1.0), "velocities divided by 1000, as of mm/s"),
    "degrees": (PLAIN, (1.0, 1.0, 1.0 / DEGREE), "rotations in rad for those in degrees"),
    "first force": ((-1.0, 1.0, 1.0), PLAIN, "the sign of the first force turned"),
    "second force": ((1.0, -1.0, 1.0), PLAIN, "the sign of the second force turned"),
}


# A fit of free points takes seconds: `make test` takes one of its mistakes.
SIGNS = [
    *itertools.product(("ellipsoid", "area", "known points"), MISTAKES),
    *every(len(MISTAKES), [("points", mistake) for mistake in MISTAKES]),
]


@pytest.mark.parametrize(("name", "mistake"), SIGNS)
def test_wrong_signs_and_units_are_named(name, mistake):
    law, options = TRUTHS[name]
    of_wrench, of_twist, words = MISTAKES[mistake]
    random = np.random.default_rng(0)
    twist = twists(random, 300)
    wrench = -law.force(twist)
    wrench += noise(random, wrench)
    assert fit_patch(wrench, twist, **options).mistake is None
    try:
        said = fit_patch(wrench * of_wrench, twist * of_twist, **options).warnings
    except FitError as error:
        # Half of the power and more is negative.
        said = (str(error),)
        words = words.removeprefix("the ").removesuffix(" or of the rotation turned")
    (one,) = (text for text in said if words in text)
    assert "not fit" in one or "power" in one


@pytest.mark.parametrize("name", ["ellipsoid", "area", "points", "known points"])
def test_torques_about_another_point_are_named(name):
    law, options = TRUTHS[name]
    random = np.random.default_rng(0)
    twist = twists(random, 300) * [1.0, 1.0, 20.0]
    wrench = -law.force(twist * [1.0, 1.0, 0.05])
    wrench += noise(random, wrench)
    wrench[:, 2] *= 0.05
    place = 0.1, 0.05
    wrench[:, 2] -= place[0] * wrench[:, 1] - place[1] * wrench[:, 0]
    if "places" in options:
        options = {**options, "places": 0.05 * PLACES}
    found = fit_patch(wrench, twist, length=0.05, **options).mistake
    assert found.words.startswith("torques taken as those about (")
    x, y = (float(one) for one in found.words.split("(")[1].split(")")[0].split(","))
    assert (x, y) == pytest.approx(place, abs=0.005)
    assert found.misfit < 0.06


def test_wrong_frames_and_angles_are_named():
    law = asp.FrictionLaw(asp.Ellipsoid([0.5, 0.2, 0.3]), asp.Ellipsoid([0.5, 0.2, 0.3]))
    random = np.random.default_rng(2)
    twist, angle = twists(random, 300), random.uniform(0.0, 2.0 * np.pi, 300)
    wrench = -law.force(twist)
    fit = fit_patch(in_ground(wrench, angle), in_ground(twist, angle), angle=angle)
    assert fit.mistake.words == "wrenches and twists in the axes of the ground"
    fit = fit_patch(in_ground(wrench, angle), twist, angle=angle)
    assert fit.mistake.words == "wrenches in the axes of the ground"
    ground = in_ground(-law.force(in_ground(twist, angle)), -angle)
    fit = fit_patch(ground, twist, angle=angle / DEGREE, frame="ground")
    assert fit.mistake.words == "angles in rad for those in degrees"


@pytest.mark.parametrize(
    ("column", "factor", "words"),
    [
        (8, -1.0, "the sign of the torque"),
        (8, 1e3, "as of N mm"),
        (5, 1.0 / DEGREE, "rotations in rad for those in degrees"),
        (2, 1.0 / DEGREE, "angles in rad for those in degrees"),
        ((3, 4), 1e3, "velocities divided by 1000"),
    ],
)
def test_wrong_columns_of_pushes_are_named(column, factor, words):
    table = pushes(asp.FrictionLaw.isotropic(0.3), 0)
    assert fit_supports(table, TRIANGLE, weight=WEIGHT).mistake is None
    table[:, column] *= factor
    try:
        said = " ".join(fit_supports(table, TRIANGLE, weight=WEIGHT).warnings)
    except FitError as error:
        said = str(error)
    assert words in said
    points = fit_supports(pushes(asp.FrictionLaw.isotropic(0.3), 0), 1e3 * TRIANGLE, weight=WEIGHT)
    assert "points divided by 1000, as of mm for m" in points.mistake.words


def test_a_model_that_is_too_simple_is_no_mistake():
    for name, options in (
        ("points", {}),
        ("points", {"reservoir": "contensou"}),
        ("ellipsoids", {}),
        ("ellipsoids", {"reservoir": "contensou"}),
    ):
        twist = twists(np.random.default_rng(1), 300)
        assert fit_patch(-TRUTHS[name][0].force(twist), twist, **options).mistake is None


def test_wrenches_of_no_law_at_all_are_said_not_to_fit():
    random = np.random.default_rng(0)
    twist = random.normal(size=(300, 3))
    wrench = 0.3 * twist / np.linalg.norm(twist, axis=1)[:, None] + random.normal(size=(300, 3))
    fit = fit_patch(wrench, twist)
    assert fit.mistake is None
    assert any("The model does not fit" in one for one in fit.warnings)


def test_what_the_data_do_not_tell_of_friction_and_direction_is_said():
    """Bodies that never turn say nothing of D's third axis."""
    law, _ = TRUTHS["ellipsoids"]
    random = np.random.default_rng(0)
    twist = twists(random, 300) * [1.0, 1.0, 0.0]
    wrench = -law.force(twist)
    fit = fit_patch(wrench + noise(random, wrench), twist, direction="ellipsoid")
    (said,) = (one for one in fit.warnings if "The data do not tell" in one)
    assert "direction.moment_ratio" in said
    assert not fit.parameters["direction.moment_ratio"].identifiable
    assert "direction.force_2_ratio" not in said
    # Friction that is isotropic has no axes to be told, which is no want of the data.
    table = pushes(asp.FrictionLaw.isotropic(0.3), 0)
    found = fit_supports(table, TRIANGLE, weight=WEIGHT, friction="ellipse")
    assert not found.parameters["friction.angle"].identifiable
    assert found.warnings == ()


@pytest.mark.parametrize("name", ["points", "known points"])
def test_spots_that_are_no_points_are_named(name):
    """The radius of spots is a part of the length: of a small patch in metres it is too large."""
    law, options = TRUTHS[name]
    twist = twists(np.random.default_rng(0), 300)
    wrench = -law.force(twist)
    small = 0.02
    if "places" in options:
        options = {**options, "places": small * PLACES}
    pairs = wrench * [1.0, 1.0, small], twist / [1.0, 1.0, small]
    right = fit_patch(*pairs, length=small, **options)
    assert right.warnings == ()
    warned = fit_patch(*pairs, **options).warnings
    (said,) = (one for one in warned if "Spots of the radius 0.01 are no points" in one)
    lever = float(said.split("lever of ")[1].split(":")[0])
    assert fit_patch(*pairs, length=lever, **options).rms < 0.02
    assert fit_patch(*pairs).warnings == ()


def test_outliers_and_missing_torques_are_no_mistake():
    law, options = TRUTHS["area"]
    random = np.random.default_rng(0)
    twist = twists(random, 300)
    wrench = -law.force(twist)
    far = np.where(random.random((300, 1)) < 0.2, 10.0 * random.normal(size=(300, 3)), wrench)
    fit = fit_patch(far, twist, **options)
    assert fit.rms > 0.9
    assert fit.warnings == ()
    for part in ([1.0, 1.0, 0.0], [0.0, 0.0, 1.0]):
        for name in ("area", "known points"):
            law, options = TRUTHS[name]
            found = fit_patch(-law.force(twist) * part, twist, **options).mistake
            assert found is None or found.misfit < 0.5


def test_wrenches_beyond_the_sizes_of_sets_are_refused():
    twist = np.random.default_rng(0).normal(size=(60, 3))
    wrench = -TRUTHS["area"][0].force(twist)
    for size in (1e100, 1e-100):
        with pytest.raises(FitError, match=r"wrench: must be between 1e-50 and 1e\+50"):
            fit_patch(size * wrench, twist)


def test_loads_that_vanish_are_reported():
    """The search may end where a point carries nothing that a number can say."""
    law, options = TRUTHS["points"]
    twist = twists(np.random.default_rng(0), 300)
    fit = fit_patch(-law.force(twist) * [-1.0, 1.0, 1.0], twist, **options)
    assert fit.mistake.words == "the sign of the first force turned"
    p = fit.coordinates.copy()
    p[0] = -1000.0
    light = fit.replace(found=fit.found.replace(p=p)).parameters["point_1.load"]
    assert light.value == 0.0


def test_a_comparison_does_not_depend_on_the_order_of_its_models():
    """The angle is that of the pairs: a model of the ground turns whatever the first one is."""
    law, _ = TRUTHS["ellipsoid"]
    random = np.random.default_rng(4)
    twist, angle = twists(random, 100), random.uniform(0.0, 2.0 * np.pi, 100)
    wrench = in_ground(-law.force(in_ground(twist, angle)), -angle)
    models = {"body": {}, "ground": {"frame": "ground"}}
    for names in (("body", "ground"), ("ground", "body")):
        found = compare_patches(
            wrench, twist, models={name: models[name] for name in names}, angle=angle
        )
        rms = {one.name: one.rms for one in found.candidates}
        assert rms["ground"] < 1e-6
        assert rms["body"] > 0.05
    with pytest.raises(asp.ParameterError, match="angle: must be given"):
        fit_patch(wrench, twist).compare({"ground": EllipsoidPatch(frame="ground")})


@pytest.mark.parametrize(
    "name", ["length", "loss", "normal_force", "blocks", "confidence", "angle"]
)
def test_options_of_a_model_that_all_models_share_are_refused(name):
    random = np.random.default_rng(0)
    twist = random.normal(size=(60, 3))
    wrench = -TRUTHS["area"][0].force(twist)
    for key, words in ((name, "is for all models"), ("reservior", "is no option")):
        with pytest.raises(asp.ParameterError, match=f"models: .*{key}.*'second' {words}"):
            compare_patches(wrench, twist, models={"first": {}, "second": {key: 1}})
    with pytest.raises(asp.ParameterError, match="models: 'second' must be"):
        compare_patches(wrench, twist, models={"first": {}, "second": "contensou"})


def test_loads_are_shares_of_the_normal_force():
    law = asp.FrictionLaw.associated(supports())
    twist = np.random.default_rng(0).normal(size=(60, 3))
    options = {"reservoir": "supports", "places": PLACES, "normal_force": LOADS.sum()}
    for scale in (1.0, 100.0):
        fit = fit_patch(-law.force(twist), twist, loads=scale * LOADS, **options)
        assert fit.parameters["mu"].value == pytest.approx(1.0, rel=1e-6)


def test_a_block_is_left_out_as_a_whole():
    random = np.random.default_rng(0)
    twist = random.normal(size=(60, 3))
    wrench = -TRUTHS["area"][0].force(twist)
    table = pushes(asp.FrictionLaw.isotropic(0.3), 0, n=60)
    for labels in (np.arange(60) % 7, np.repeat([5, 3, 9], [40, 13, 7]), np.arange(60) < 59):
        fits = (
            fit_patch(wrench, twist, blocks=labels),
            fit_supports(table, TRIANGLE, weight=WEIGHT, blocks=labels),
        )
        for fit in fits:
            parts = [set(fit.folds[fit.blocks == one]) for one in np.unique(fit.blocks)]
            assert {len(part) for part in parts} == {1}
            assert set(fit.folds) == set(range(fit.folds.max() + 1))
            assert fit.folds.max() >= 1


def test_wrenches_and_lengths_of_zero_are_refused_by_name():
    twist = np.random.default_rng(0).normal(size=(60, 3))
    for options in ({}, {"reservoir": "contensou"}, {"reservoir": "supports", "points": 3}):
        with pytest.raises(asp.FitError, match="wrench: must not vanish in all pairs"):
            fit_patch(np.zeros((60, 3)), twist, **options)
    table = pushes(asp.FrictionLaw.isotropic(0.3), 0)
    with pytest.raises(asp.ParameterError, match="length: must be given"):
        fit_supports(table, [[0.0, 0.0]], loads=[WEIGHT])


def test_what_a_single_block_tells_is_not_told():
    """Without that block nothing is known of it, so that its scatter over blocks is unknown."""
    random = np.random.default_rng(0)
    twist = random.normal(size=(200, 3))
    twist[10:, 2] = 0.0
    wrench = -TRUTHS["area"][0].force(twist)
    wrench += 0.01 * random.normal(size=wrench.shape)
    fit = fit_patch(wrench, twist, reservoir="contensou")
    assert not fit.parameters["radius"].identifiable
    assert fit.parameters["mu"].identifiable
    assert fit.parameters["centre.1"].identifiable
    assert "radius" in " ".join(fit.warnings)


def test_load_and_centre_are_told_by_pure_translation():
    random = np.random.default_rng(0)
    twist = np.column_stack([random.normal(size=(200, 2)), np.zeros(200)])
    wrench = -asp.FrictionLaw.associated(supports()).force(twist)
    wrench += 0.01 * random.normal(size=wrench.shape)
    found = fit_patch(wrench, twist, reservoir="supports", points=3).parameters
    told = {name for name, one in found.items() if one.identifiable}
    assert told == {"load", "centre.1", "centre.2"}


def test_public_names_are_in_the_room():
    assert {"PatchFit", "SupportsFit"} <= set(identify.__all__)
