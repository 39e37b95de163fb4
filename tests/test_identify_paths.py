"""Laws from measured paths: virtual films, launches, intervals by path, files, the command."""

import math
import pickle
import time
import tomllib
from types import SimpleNamespace

import asperity as asp
import numpy as np
import pytest
from asperity.commands.main import main
from asperity.demo import table1
from asperity.errors import FitError, ParameterError, RecordError
from asperity.identify import FourierReservoir, IdentifiedLaw, Launch, PathFit, fit_paths
from asperity.identify.campaigns.paths import FILES
from asperity.identify.estimator.loss import Loss
from asperity.identify.evidence.paths.launch import known_of
from asperity.identify.evidence.paths.misfits import Misfits
from asperity.identify.evidence.paths.motions import Motions
from asperity.identify.evidence.paths.observed import observed, read_path
from asperity.identify.evidence.paths.solution import Solution
from asperity.identify.models.directions import CircleDirection
from asperity.identify.models.reservoirs import SuperellipseReservoir
from asperity.identify.models.structure import PlanarStructure
from asperity.runs.comparison import hermite
from asperity.track import MeasuredPath
from profiles import counts, every

LAW = table1.LAWS["extended, superellipses C, D"]
ELLIPSES = asp.FrictionLaw(asp.Ellipse(0.55, 0.42), asp.Ellipse(1.5, 1.0))
TRUTH = {
    "reservoir.a": 4.99 / 9.3,
    "reservoir.b": 4.25 / 9.3,
    "reservoir.exponent": 2.94,
    "direction.ratio": 1.84 / 1.19,
    "direction.exponent": 2.51,
}
GOALS = {
    "reservoir.a": 0.01,
    "reservoir.b": 0.01,
    "reservoir.exponent": 0.06,
    "direction.ratio": 0.006,
    "direction.exponent": 0.06,
}
AXES = {"reservoir.angle": 0.0, "direction.angle": 0.0}
ERROR, ANGLE_ERROR = 3e-4, math.radians(0.2)


class Films:
    """Virtual films of launches at angles in degrees; the truth is integrated once."""

    def __init__(self, law, angles, speed=1.52):
        self.system = asp.SlidingPoint(0.018, law=law)
        self.phi = np.deg2rad(angles)
        many = asp.integrate_many(
            self.system,
            t_end=1.0,
            u0=speed * np.stack([np.cos(self.phi), np.sin(self.phi)], axis=-1),
            keep=5e-4,
        )
        series = (many.samples[name] for name in ("t", "q", "u"))
        self.runs = list(zip(*series, strict=True))
        self.rest = [float(t[np.hypot(*u.T).argmin()]) for t, _, u in self.runs]

    def draw(self, seed, points=12):
        """Return measured paths, and what is known of their launches.

        Friction does not depend on the speed: s times as fast, a body slides s times as long and
        s² times as far on the same curve.
        """
        random = np.random.default_rng(seed)
        paths, launches = [], []
        for phi, (t, q, u), rest in zip(self.phi, self.runs, self.rest, strict=True):
            s, begin = 1.0 + 0.01 * random.normal(), 0.002 * random.normal()
            times = np.linspace(0.02, rest + 0.02, points)
            x = s**2 * hermite(t, q, u, (times - begin) / s)
            x += ERROR * random.normal(size=x.shape)
            error = np.full(x.shape, ERROR)
            paths.append(SimpleNamespace(time=times, position=x, position_error=error))
            told = phi + ANGLE_ERROR * random.normal()
            launches.append(Launch(place=(0.0, 0.0), direction=told, direction_error=ANGLE_ERROR))
        return paths, launches


@pytest.fixture(scope="module")
def films():
    return Films(LAW, np.linspace(5.0, 87.0, 12))


@pytest.fixture(scope="module")
def few():
    return Films(ELLIPSES, [10.0, 60.0, 130.0])


@pytest.fixture(scope="module")
def round_films():
    """Films of a disk, quickly fitted."""
    return Films(asp.FrictionLaw.isotropic(0.4), [10.0, 80.0, 200.0, 300.0])


def round_fit(films, paths, launches=None, **options):
    models = {"reservoir": "circle", "direction": "circle"}
    return fit_paths(paths, system=films.system, launch=launches, **models, **options)


# In draw 0 the ratio of D is 2.9 standard errors off, as happens once in two hundred.
@pytest.mark.parametrize("seeds", [range(1, 2), pytest.param(range(200), marks=pytest.mark.long)])
def test_table_1_is_found_from_twelve_films(films, seeds):
    """Semi-axes within 1 %, exponents 6 %, the ratio of D 0.6 %, in intervals of 95 %."""
    found, seconds, count = [], [], len(seeds)
    for seed in seeds:
        paths, launches = films.draw(seed)
        begin = time.process_time()
        fit = fit_paths(paths, system=films.system, launch=launches, fixed=AXES, length_error=0.0)
        seconds.append(time.process_time() - begin)
        assert fit.slope_error < 1e-2
        found.append([fit.parameters[name] for name in TRUTH])
        speeds = [path.launch_speed for path in fit.paths]
        assert all(0.5e-3 < one.standard_error < 0.02 for one in speeds)
    good = sum(
        all(
            abs(one.value / TRUTH[name] - 1.0) <= GOALS[name]
            for name, one in zip(TRUTH, row, strict=True)
        )
        for row in found
    )
    assert good >= 0.975 * count
    held = {
        name: sum(row[k].covers(truth) for row in found)
        for k, (name, truth) in enumerate(TRUTH.items())
    }
    least, most = (180, 199) if count == 200 else (count, count)
    assert all(least <= one <= most for one in held.values()), held
    # Of two cores, which share it.
    assert np.median(seconds) < 10.0


@counts(3, 100)
def test_three_films_suffice_for_ellipses(few, count):
    truth = {"reservoir.a": 0.55, "reservoir.b": 0.42, "direction.ratio": 1.5}
    held = dict.fromkeys(truth, 0)
    for seed in range(count):
        paths, launches = few.draw(seed)
        fit = fit_paths(
            paths, system=few.system, reservoir="ellipse", direction="ellipse", launch=launches
        )
        for name, value in truth.items():
            one = fit.parameters[name]
            assert one.value == pytest.approx(value, rel=0.03)
            held[name] += one.covers(value)
    assert min(held.values()) >= 0.88 * count, held


def test_angles_of_the_sets_are_found_if_they_have_any():
    law = asp.FrictionLaw(asp.Ellipse(0.55, 0.42, angle=0.35), asp.Ellipse(1.5, 1.0, angle=-0.25))
    films = Films(law, np.arange(8) * 45.0 + 7.0)
    paths, launches = films.draw(4)
    models = {"reservoir": "ellipse", "direction": "ellipse", "launch": launches}
    found = fit_paths(paths, system=films.system, **models).parameters
    assert found["reservoir.angle"].value == pytest.approx(0.35, abs=0.03)
    assert found["direction.angle"].value == pytest.approx(-0.25, abs=0.02)
    assert found["reservoir.angle"].identifiable
    assert found["direction.angle"].identifiable
    round_one = Films(asp.FrictionLaw.isotropic(0.4), np.arange(8) * 45.0 + 7.0)
    paths, _ = round_one.draw(4)
    found = fit_paths(paths, system=round_one.system, **models).parameters
    assert not found["reservoir.angle"].identifiable
    assert not found["direction.angle"].identifiable


@pytest.mark.long
def test_superellipses_are_found_from_films_all_around():
    films = Films(LAW, np.arange(12) * 30.0 + 7.0)
    paths, launches = films.draw(0)
    fit = fit_paths(paths, system=films.system, launch=launches, length_error=0.0)
    assert fit.warnings == ()
    for name, truth in {**TRUTH, **AXES}.items():
        assert fit.parameters[name].identifiable
        assert fit.parameters[name].covers(truth), name


def moved(paths, launches, turn, sign, place, begin):
    """Return films of the same bodies by a camera that is turned, mirrored, elsewhere, later."""
    axes = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    films = [
        SimpleNamespace(
            time=p.time + begin,
            position=(p.position * [1.0, sign]) @ axes.T + place,
            position_error=p.position_error,
        )
        for p in paths
    ]
    told = [one.replace(place=place, direction=sign * one.direction + turn) for one in launches]
    return films, told


def test_the_law_does_not_depend_on_the_camera_nor_on_the_order_of_films():
    law = asp.FrictionLaw(asp.Ellipse(0.55, 0.42, angle=0.2), asp.Ellipse(1.5, 1.0, angle=-0.1))
    films = Films(law, np.arange(6) * 60.0 + 7.0)
    paths, launches = films.draw(0)
    options = {"reservoir": "ellipse", "direction": "ellipse", "length_error": 0.0}
    plain = fit_paths(paths, system=films.system, launch=launches, **options)
    order = [3, 0, 5, 1, 4, 2]
    for turn, sign, place, begin in (
        (0.0, 1.0, (0.0, 0.0), 0.0),
        (0.3, 1.0, (0.0, 0.0), 0.0),
        (0.0, -1.0, (0.0, 0.0), 0.0),
        (2.0 * math.pi, 1.0, (5.0, -3.0), 100.0),
    ):
        seen, told = moved(paths, launches, turn, sign, place, begin)
        fit = fit_paths(
            [seen[k] for k in order],
            system=films.system.replace(mass=1.8, law=asp.FrictionLaw.isotropic(0.1)),
            launch=[told[k] for k in order],
            **options,
        )
        assert fit.warnings == plain.warnings
        assert fit.misfit == pytest.approx(plain.misfit, rel=1e-6)
        for name, one in plain.parameters.items():
            other, value = fit.parameters[name], one.value
            if name.endswith("angle"):
                value = sign * value + turn % math.pi
            if name != "direction.scale":
                assert other.value == pytest.approx(value, abs=0.02 * one.standard_error)
                assert other.standard_error == pytest.approx(one.standard_error, rel=0.01)


def test_launches_are_found_without_a_word_about_them(few):
    paths, _ = few.draw(3)
    fit = fit_paths(paths, system=few.system, reservoir="ellipse", direction="ellipse")
    for path, phi in zip(fit.paths, few.phi, strict=True):
        # At the first measured point, which has an error.
        assert path.launch["time"].value == path.time[0]
        assert path.launch["time"].standard_error == 0.0
        assert np.hypot(*(path.simulated[0] - path.position[0])) < 5 * ERROR
        assert path.launch["direction"].value % (2 * np.pi) == pytest.approx(phi, abs=0.03)
        assert 1.3 < path.launch["speed"].value < 1.55
    assert fit.parameters["reservoir.a"].value == pytest.approx(0.55, rel=0.03)
    assert 0.7 < fit.misfit < 1.3


def test_what_is_known_of_a_launch_enters_once(round_films):
    paths, _ = round_films.draw(1)
    free = round_fit(round_films, paths, Launch(place=(0.0, 0.0)))
    speed = free.paths[0].launch["speed"]
    alone = round_fit(round_films, paths[:1], Launch(place=(0.0, 0.0))).paths[0].launch["speed"]
    stated = alone.value + alone.standard_error
    prior = Launch(place=(0.0, 0.0), speed=stated, speed_error=speed.standard_error)
    told = round_fit(round_films, paths[:1], prior).paths[0].launch["speed"]
    weights = alone.standard_error**-2, speed.standard_error**-2
    mean = (weights[0] * alone.value + weights[1] * stated) / sum(weights)
    assert told.value == pytest.approx(mean, abs=0.05 * speed.standard_error)
    assert told.standard_error == pytest.approx(sum(weights) ** -0.5, rel=0.01)
    exact = round_fit(round_films, paths, Launch(place=(0.0, 0.0), speed=1.52))
    assert exact.paths[0].launch["speed"] == asp.identify.Estimate(1.52, 1.52, 1.52, 0.0)


def misfits_of(films, seed=0):
    paths, launches = films.draw(seed)
    given = observed(paths, None)
    pairs = [known_of(one, 0.0) for one in launches]
    known, errors = (np.stack(part) for part in zip(*pairs, strict=True))
    motions = Motions(films.system, [path.time for path in given], 1e-8, None)

    def law(p):
        a, b, ratio = np.exp(p)
        return asp.FrictionLaw(asp.Ellipse(a, b), asp.Ellipse(ratio, 1.0))

    misfits = Misfits(given, motions, law, known, errors, 3)
    start = known.copy()
    start[:, 0], start[:, 2] = 1.5, 0.001
    return misfits, misfits.joined(np.log([0.5, 0.45, 1.4]), start)


def test_derivatives_agree_at_two_step_sizes_and_with_other_differences(few):
    misfits, z = misfits_of(few)
    jacobian = misfits.jacobian(z)
    size = np.linalg.norm(jacobian, axis=0)
    for other in (misfits.jacobian(z, factor=2.0), misfits.jacobian(z, factor=0.3)):
        assert np.linalg.norm(other - jacobian, axis=0) == pytest.approx(0.0, abs=2e-3 * size.max())
    one_sided = misfits.jacobian(z, central=False)
    assert np.abs(np.linalg.norm(one_sided - jacobian, axis=0) / size).max() < 2e-2
    random = np.random.default_rng(0)
    along = random.normal(size=misfits.count) * 1e-4
    change = 0.5 * (misfits.residuals(z + along) - misfits.residuals(z - along))
    np.testing.assert_allclose(change, jacobian @ along, atol=2e-3 * np.abs(change).max())


class Linear:
    """A linear model in place of paths: unknowns of all paths, and some of each."""

    def __init__(self, count, random, size=3, rows=8, own=2):
        self.paths, self.size, self._rows, self._own = range(count), size, rows, own
        self.jacobian = np.zeros((count * rows, size + count * own))
        # Paths do not tell everything alike.
        strength = np.geomspace(0.3, 3.0, count)[:, None, None]
        shared = strength * random.normal(size=(count, rows, size))
        self.jacobian[:, :size] = shared.reshape(-1, size)
        for k in self.paths:
            self.jacobian[self.of(k), self.unknowns_of(k)] = random.normal(size=(rows, own))

    def of(self, k):
        return slice(k * self._rows, (k + 1) * self._rows)

    def unknowns_of(self, k):
        return slice(self.size + k * self._own, self.size + (k + 1) * self._own)

    def names_of_launches(self):
        return ["launch"] * (len(self.paths) * self._own)

    def covariance(self, residuals):
        solution = Solution(
            structure=PlanarStructure(SuperellipseReservoir(2.0), CircleDirection()),
            held=np.full(self.size, np.nan),
            misfits=self,
            motions=None,
            loss=Loss(components=1),
            z=np.zeros(self.jacobian.shape[1]),
            others=(),
        )
        vars(solution).update(jacobian=self.jacobian, residuals=residuals)
        return solution.covariance(None)


@pytest.mark.parametrize("count", [3, 6, 12])
def test_scatter_between_paths_is_unbiased_and_its_intervals_hold(count):
    random = np.random.default_rng(count)
    model = Linear(count, random)
    draws = 1000
    hat = model.jacobian @ np.linalg.pinv(model.jacobian)
    noise = random.normal(size=(draws, len(hat)))
    covariances, held = np.zeros((3, 3)), np.zeros(3)
    inverse = np.linalg.pinv(model.jacobian)[:3]
    for one in noise:
        found = model.covariance(one - hat @ one)
        covariances += found.scatter / draws
        widths = found.half_widths(np.eye(3), 0.95)
        held += np.abs(inverse @ one) <= widths
    np.testing.assert_allclose(found.leverage.inverse, inverse @ inverse.T, rtol=1e-9)
    scale = np.sqrt(np.diag(found.leverage.inverse))
    assert np.abs(covariances - found.leverage.inverse).max() < 0.12 * np.max(scale) ** 2
    # Satterthwaite's approximation is a little off for few paths that tell unlike amounts.
    assert (held / draws > 0.92).all()
    assert (held / draws < 0.99).all()


def test_intervals_follow_what_differs_between_paths(round_films):
    """Friction that differs from launch to launch is not in the errors of the positions."""
    paths, _ = round_films.draw(2)
    scales = np.array([0.97, 1.03, 0.96, 1.04])
    unlike = [
        SimpleNamespace(time=p.time, position=p.position * s, position_error=p.position_error)
        for p, s in zip(paths, scales, strict=True)
    ]
    same, other = (
        round_fit(round_films, one, Launch(place=(0.0, 0.0)), length_error=0.0)
        for one in (paths, unlike)
    )
    assert same.parameters["reservoir.radius"].standard_error < 0.004
    error = other.parameters["reservoir.radius"].standard_error / 0.4
    assert error == pytest.approx(np.std(scales, ddof=1) / 2.0, rel=0.4)


def test_the_length_scale_enters_the_intervals(round_films):
    paths, _ = round_films.draw(0)
    plain = round_fit(round_films, paths, length_error=0.0)
    assert plain.warnings == ()
    told = round_fit(round_films, paths, length_error=0.03)
    radius = told.parameters["reservoir.radius"]
    assert radius.standard_error == pytest.approx(0.03 * radius.value, rel=0.03)
    longer = [
        SimpleNamespace(time=p.time, position=1.02 * p.position, position_error=ERROR)
        for p in paths
    ]
    moved = round_fit(round_films, longer, length_error=0.0).parameters["reservoir.radius"].value
    assert moved / plain.parameters["reservoir.radius"].value == pytest.approx(1.02, abs=2e-4)
    (warning,) = round_fit(round_films, paths).warnings
    assert (
        "the error of the length scale is not known: 1 % would change reservoir.radius by 1 %"
        in (warning)
    )


def test_the_size_of_c_against_a_dependence_on_the_speed_is_said(round_films):
    """The sentence is what happens: with a factor that falls by 1 %, C comes out smaller."""
    paths, _ = round_films.draw(0)
    fit = round_fit(round_films, paths, length_error=0.0)
    limit, scale = fit.limits
    assert "friction is taken as independent of the speed: if it fell by 1 % from rest" in limit
    assert "direction.scale has no value" in scale
    speed = np.median([path.launch_speed.value for path in fit.paths])
    law = round_films.system.law.replace(rate=asp.Stribeck(speed, ratio=1.0, viscous=0.01 / speed))
    rising = round_fit(round_films, paths, length_error=0.0)
    rated = fit_paths(
        paths,
        system=round_films.system.replace(law=law),
        reservoir="circle",
        direction="circle",
        length_error=0.0,
    )
    assert rated.law.rate == law.rate
    assert "is taken from the system" in rated.limits[0]
    # Without the factor the fit is larger by what growth of 1 % makes of it.
    change = (
        rising.parameters["reservoir.radius"].value / rated.parameters["reservoir.radius"].value
    )
    stated = float(limit.split("reservoir.radius by ")[1].split(" %")[0])
    assert stated < 0.0
    assert 100.0 * (change - 1.0) == pytest.approx(-stated, abs=0.03)


def test_directions_in_degrees_are_called_so(few):
    paths, launches = few.draw(0)
    told = [one.replace(direction=float(np.rad2deg(one.direction))) for one in launches]
    with pytest.raises(FitError, match=r"must be in rad; .* read in degrees: np.deg2rad"):
        fit_paths(paths, system=few.system, reservoir="circle", direction="circle", launch=told)


def test_a_model_that_does_not_fit_is_named(few):
    paths, launches = few.draw(0)
    fit = fit_paths(
        paths, system=few.system, reservoir="circle", direction="circle", launch=launches
    )
    assert any("the model does not fit" in one for one in fit.warnings)
    assert fit.misfit > 5.0


def test_one_path_has_no_intervals(few):
    paths, launches = few.draw(0)
    fit = round_fit(few, paths[:1], launches[:1], length_error=0.01)
    assert any("one path has no scatter between paths" in one for one in fit.warnings)
    assert math.isnan(fit.parameters["reservoir.radius"].low)
    with pytest.raises(ParameterError, match="covariance"):
        _ = fit.identified_law.covariance


@pytest.mark.parametrize("confidence", [0.95, None])
def test_parameters_that_are_fixed_have_no_errors(few, confidence):
    paths, launches = few.draw(1)
    models = {"reservoir": "ellipse", "direction": "ellipse", "fixed": AXES}
    fit = fit_paths(paths, system=few.system, launch=launches, confidence=confidence, **models)
    for name in AXES:
        found = fit.parameters[name]
        assert found.identifiable
        assert (found.low, found.high, found.standard_error) == (0.0, 0.0, 0.0)
        assert str(found) == "0 (fixed)"


def test_unknowns_that_paths_do_not_tell_are_refused(few):
    paths, launches = few.draw(0)
    straight = [SimpleNamespace(**{**vars(p), "time": p.time[:4], "position": p.position[:4],
                                   "position_error": ERROR}) for p in paths]  # fmt: skip
    with pytest.raises(FitError, match=r"cannot tell|do not tell|no minimum"):
        fit_paths(straight[:1], system=few.system, launch=launches[0], fixed=AXES)


@pytest.mark.long
def test_two_sets_that_are_as_near_are_told(films):
    """Without the axes, launches in a quarter of the circle leave two superellipses for C."""
    paths, launches = films.draw(0)
    fit = fit_paths(paths, system=films.system, launch=launches, length_error=0.0)
    assert any("another set C is as near to the paths" in one for one in fit.warnings)


@pytest.mark.parametrize(
    "system",
    [
        asp.SlidingPoint(0.018, law=ELLIPSES),
        pytest.param(asp.SlidingDisk(ELLIPSES), marks=pytest.mark.long),
    ],
    ids=["point", "disk"],
)
def test_time_stepping_takes_the_place_of_integration(few, system):
    paths, launches = few.draw(0)
    models = {"reservoir": "ellipse", "direction": "ellipse", "fixed": AXES}
    first, second = (
        fit_paths(paths, system=one, launch=launches, **models, dt=dt)
        for one, dt in ((few.system, None), (system, 1e-3))
    )
    for name in ("reservoir.a", "reservoir.b", "direction.ratio"):
        one, other = (fit.parameters[name].value for fit in (first, second))
        assert other == pytest.approx(one, rel=5e-3)


def test_disks_are_not_tried_where_they_tip(round_films, monkeypatch):
    """Their motions there are long to compute, and may fail; far sizes were tried before."""
    sizes, paths_of = set(), Motions.paths

    def noted(self, laws, *args, **options):
        sizes.update(float(law.reservoir.radius(0.0)) for law in laws)
        if max(sizes) > 1.0:
            pytest.fail("a disk that tips is simulated")
        return paths_of(self, laws, *args, **options)

    monkeypatch.setattr(Motions, "paths", noted)
    paths, _ = round_films.draw(1)
    disk = asp.SlidingDisk(asp.FrictionLaw.isotropic(0.4))
    models = {"system": disk, "reservoir": "circle", "direction": "circle"}
    fit = fit_paths(paths[:3], launch=Launch(place=(0.0, 0.0)), **models)
    assert fit.parameters["reservoir.radius"].value == pytest.approx(0.4, rel=0.02)


def test_a_size_without_motions_is_infinitely_far(round_films, monkeypatch):
    """Sizes are tried outward until there are motions, and the others are still compared."""
    paths, _ = round_films.draw(1)
    paths_of, refused = Motions.paths, []

    def paths_or_none(self, laws, *args, **options):
        if len(refused) < 2 and laws[0].reservoir.radius(0.0) > 0.1:
            refused.append(laws)
            return None
        return paths_of(self, laws, *args, **options)

    monkeypatch.setattr(Motions, "paths", paths_or_none)
    fit = round_fit(round_films, paths)
    assert fit.parameters["reservoir.radius"].value == pytest.approx(0.4, rel=0.02)
    monkeypatch.setattr(Motions, "paths", lambda *args, **options: None)
    with pytest.raises(FitError, match="no paths could be simulated"):
        round_fit(round_films, paths)


def test_the_law_is_kept_with_its_covariance(few, tmp_path):
    paths, launches = few.draw(1)
    fit = fit_paths(
        paths, system=few.system, reservoir="ellipse", direction="ellipse", launch=launches,
        fixed={"reservoir.angle": 0.0}, length_error=0.01,
    )  # fmt: skip
    fit.save_law(tmp_path / "law.toml")
    assert asp.FrictionLaw.load(tmp_path / "law.toml") == fit.law
    known = IdentifiedLaw.load(tmp_path / "law.toml")
    errors = dict(zip(known.names, known.standard_errors, strict=True))
    assert errors["reservoir.angle"] == 0.0
    for name in ("reservoir.a", "direction.ratio"):
        assert errors[name] == pytest.approx(fit.parameters[name].standard_error, rel=1e-9)
    assert len(known.sample(5, seed=1)) == 5
    twin = pickle.loads(pickle.dumps(fit))
    assert twin == fit
    assert hash(twin) == hash(fit)
    with pytest.raises(AttributeError, match="immutable"):
        fit.misfit = 0.0


def test_a_fit_is_read_as_it_was_written(round_films, tmp_path):
    """With models that have no name, one path that has no interval, a rate factor."""
    paths, _ = round_films.draw(0)
    rated = asp.FrictionLaw.isotropic(0.4).replace(rate=asp.Stribeck(1.0, ratio=0.9))
    for given, options in (
        (paths, {"system": round_films.system.replace(law=rated), "reservoir": "circle"}),
        (paths[:1], {"system": round_films.system, "reservoir": "circle"}),
        (paths, {"system": round_films.system, "reservoir": FourierReservoir(2)}),
    ):
        fit = fit_paths(given, direction="circle", **options)
        fit.save(tmp_path / "fit.npz")
        read = PathFit.load(tmp_path / "fit.npz")
        assert read == fit
        assert read.summary() == fit.summary()
        assert read.identified_law == fit.identified_law
        assert read.law == fit.law
        assert read.to_pandas().equals(fit.to_pandas())
        assert str(read.launch_columns()) == str(fit.launch_columns())


# What is given.


def test_launches_say_what_they_need():
    with pytest.raises(ParameterError, match="speed_error: needs the speed"):
        Launch(speed_error=0.1)
    with pytest.raises(ParameterError, match="time_error: needs a place"):
        Launch(time=0.1, time_error=0.01)
    with pytest.raises(ParameterError, match="place"):
        Launch(place=(0.0, 1.0, 2.0))


FALLEN = SimpleNamespace(
    time=np.arange(5.0), position=np.ones((5, 2)), position_error=np.ones((5, 2))
)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"fixed": {"reservoir.angel": 0.0}}, "did you mean 'reservoir.angle'"),
        ({"fixed": {"reservoir.a": -1.0}}, "must be above 0"),
        ({"launch": [Launch()]}, "one for each of the 3 paths"),
        ({"confidence": 1.0}, "confidence: must lie between 0 and 1"),
        ({"system": 3}, "system: must be a system"),
        ({"system": asp.LinearSystem(np.eye(2))}, "must slide in the plane"),
        ({"launch": Launch(time=9.0)}, "leaves 0 points after it"),
        ({"paths": []}, "must hold a path"),
        ({"paths": [FALLEN, FALLEN]}, r"paths\[1\]: is paths\[0\] once more"),
        ({"paths": [3.0]}, r"paths\[0\]: must be a path"),
        ({"paths": [SimpleNamespace(time=np.arange(5.0), position=np.zeros((5, 2)))]},
         "position_error: is needed"),
    ],
)  # fmt: skip
def test_wrong_arguments_are_named(few, options, words):
    given = {"paths": few.draw(0)[0], "system": few.system, **options}
    with pytest.raises(ParameterError, match=words):
        fit_paths(**given)


@pytest.mark.parametrize("shape", ["circle", "ellipse"])
@pytest.mark.parametrize(
    "wrong",
    [
        lambda known, k: {"direction": math.degrees(known.direction), "direction_error": 0.003},
        lambda known, k: {"direction": 3.0 if k == 0 else known.direction},
        lambda known, k: {"direction": 3.0},
        lambda known, k: {"place": (0.1, 0.1), "direction": known.direction},
        lambda known, k: {"speed": 1500.0},
    ],
    ids=["degrees", "one direction", "directions", "place", "speed"],
)
def test_wrong_launches_are_refused_or_do_not_fit(round_films, shape, wrong):
    paths, launches = round_films.draw(1)
    told = [Launch(**{"place": (0.0, 0.0), **wrong(one, k)}) for k, one in enumerate(launches)]
    models = {"system": round_films.system, "reservoir": shape, "direction": shape}
    words = ("the model does not fit",)
    try:
        said = fit_paths(paths, launch=told, **models).warnings
    except FitError as error:
        said, words = (str(error),), ("do not tell", "launches", "simpler model")
    assert any(word in one for one in said for word in words)


def in_units(films, slower, longer, seed=1):
    """Return films with times and lengths in other units."""
    return [
        SimpleNamespace(
            time=slower * p.time, position=longer * p.position, position_error=longer * ERROR
        )
        for p in films.draw(seed)[0]
    ]


@pytest.mark.parametrize(
    ("slower", "longer"), [(1.0, 1e3), (1e3, 1.0), (1e-3, 1e3), (1e3, 1e-3), (1e6, 1.0)]
)
def test_all_units_that_belong_together_will_do(few, slower, longer):
    """Millimetres, milliseconds, bodies that creep: the law has no unit."""
    models = {"reservoir": "ellipse", "direction": "ellipse", "length_error": 0.0}
    plain = fit_paths(in_units(few, 1.0, 1.0), system=few.system, **models)
    system = few.system.replace(gravity=9.81 * longer / slower**2)
    other = fit_paths(in_units(few, slower, longer), system=system, **models)
    assert other.warnings == plain.warnings
    assert other.misfit == pytest.approx(plain.misfit, rel=1e-6)
    for name in ("reservoir.a", "reservoir.b", "direction.ratio"):
        one, same = other.parameters[name], plain.parameters[name]
        assert one.value == pytest.approx(same.value, rel=1e-5)
        assert one.standard_error == pytest.approx(same.standard_error, rel=1e-3)
    speeds = [fit.paths[0].launch_speed.value for fit in (plain, other)]
    assert speeds[1] == pytest.approx(speeds[0] * longer / slower, rel=1e-5)


@pytest.mark.parametrize(("slower", "longer"), [(1.0, 1e3), (1e-3, 1.0)])
@pytest.mark.parametrize("kind", ["point", "disk"])
def test_units_that_do_not_belong_together_are_named(round_films, slower, longer, kind):
    system = round_films.system
    if kind == "disk":
        system = asp.SlidingDisk(asp.FrictionLaw.isotropic(0.4))
    with pytest.raises(FitError, match="check the units of times and lengths"):
        fit_paths(
            in_units(round_films, slower, longer),
            system=system,
            reservoir="circle",
            direction="circle",
        )


def test_films_that_are_unlike_the_others_are_named(few):
    paths, _ = few.draw(0)
    mixed = [*paths[:2], in_units(few, 1.0, 1e3, seed=0)[2]]
    models = {"system": few.system, "reservoir": "ellipse", "direction": "ellipse"}
    with pytest.raises(FitError, match=r"paths\[2\]: the body decelerates .* times as much"):
        fit_paths(mixed, **models)
    noise = ERROR * np.random.default_rng(0).normal(size=(12, 2))
    resting = SimpleNamespace(time=paths[0].time, position=noise, position_error=ERROR)
    with pytest.raises(FitError, match=r"paths\[2\]: nothing moves farther than errors"):
        fit_paths([*paths[:2], resting], **models)
    with pytest.raises(FitError, match="no body slides where it was measured"):
        fit_paths(paths, launch=Launch(place=(0.0, 0.0), time=-5.0), **models)


def test_angles_beside_fixed_parameters_are_within_a_half_turn(few):
    paths, launches = few.draw(0)
    for fixed in ({"reservoir.exponent": 1e9}, {"reservoir.a": 0.55}):
        shape = "superellipse" if "reservoir.exponent" in fixed else "ellipse"
        fit = fit_paths(
            paths, system=few.system, reservoir=shape, direction="ellipse", launch=launches,
            fixed=fixed,
        )  # fmt: skip
        assert abs(fit.parameters["reservoir.angle"].value) <= 0.5 * math.pi


def test_a_body_that_creeps_is_fitted_with_a_word_about_units(round_films):
    fit = round_fit(round_films, in_units(round_films, 1e3, 1.0), length_error=0.0)
    assert fit.parameters["reservoir.radius"].value == pytest.approx(0.4e-6, rel=0.02)
    (warning,) = fit.warnings
    assert "about 4e-07, which no known surfaces have: check the units of times" in warning


@pytest.mark.parametrize(("first", "second"), every(3, [(30.0, 30.0), (30.0, 210.0), (30.0, 35.0)]))
def test_what_launches_along_one_direction_do_not_tell_is_said(first, second):
    """Two launches along a line tell neither axes nor exponents: a sentence says so."""
    films, refused = Films(ELLIPSES, (first, second)), []
    for shape, seed in (("ellipse", 0), ("ellipse", 1), ("superellipse", 0)):
        paths, launches = films.draw(seed)
        models = {"reservoir": shape, "direction": shape, "length_error": 0.0}
        try:
            fit = fit_paths(paths, system=films.system, launch=launches, **models)
        except FitError as error:
            refused.append(str(error))
            continue
        said = " ".join(fit.warnings)
        assert "launch in more directions" in said
        for name, one in fit.parameters.items():
            if not one.identifiable or name.endswith("angle"):
                continue
            least = 1.0 if name == "direction.exponent" else 0.0
            if one.high - least > 4.0 * (one.low - least):
                assert f"{name} " in said
                assert one.high - least < 100.0 * (one.low - least)
    assert all("launch in more directions" in one for one in refused)


def test_what_another_law_has_otherwise_is_not_told():
    """Four launches along one line: turned superellipses are as near, and none is claimed."""
    films = Films(ELLIPSES, [30.0] * 4)
    paths, launches = films.draw(0)
    fit = fit_paths(paths, system=films.system, launch=launches, length_error=0.0)
    assert any("another set C is as near to the paths" in one for one in fit.warnings)
    for name, truth in (("a", 0.55), ("b", 0.42), ("exponent", 2.0)):
        one = fit.parameters[f"reservoir.{name}"]
        assert one.covers(truth) or not one.identifiable
    assert not fit.parameters["reservoir.a"].identifiable


def test_steps_of_the_search_stay_within_the_range_of_laws(few):
    """A law beyond it is a failed trial: no exponential overflows."""
    misfits, z = misfits_of(few)
    for step in (1e3, -1e3):
        z[0] = step
        assert np.isinf(misfits.residuals(z)).all()
        with pytest.raises(FitError, match="the parameters of the law run away"):
            misfits.jacobian(z)


def test_points_before_the_launch_are_left_out(round_films):
    """A film that begins with a body at rest, or one that is pushed until a time that is given."""
    paths, _ = round_films.draw(0, points=60)
    waiting = []
    for path in paths:
        t = np.concatenate([[-0.03, -0.02, -0.01, 0.0], path.time])
        x = np.concatenate([np.zeros((4, 2)), path.position])
        x[:4] += ERROR * np.random.default_rng(0).normal(size=(4, 2))
        waiting.append(MeasuredPath(t, x, np.full(x.shape, ERROR)))
    fit = round_fit(round_films, waiting)
    assert fit.paths[0].time[0] >= waiting[0].section[0]
    assert fit.parameters["reservoir.radius"].value == pytest.approx(0.4, rel=0.02)
    late = round_fit(round_films, waiting, Launch(time=0.1))
    assert late.paths[0].time[0] >= 0.1
    assert late.parameters["reservoir.radius"].value == pytest.approx(0.4, rel=0.02)


def write(path, x, file, head="t [s],x1 [m],x2 [m],x1 error [m],x2 error [m]", length=1.0):
    rows = [head]
    for t, (x1, x2) in zip(path.time.tolist(), x.tolist(), strict=True):
        rows.append(",".join(map(repr, (t, x1 / length, x2 / length, ERROR, ERROR))))
    file.write_text("\n".join(rows) + "\n")
    return file


def test_files_are_read_as_paths(round_films, tmp_path):
    paths, launches = round_films.draw(0)
    tracked = [MeasuredPath(p.time, p.position, p.position_error) for p in paths]
    files = []
    for k, path in enumerate(tracked):
        files.append(tmp_path / f"{k}.csv")
        path.to_csv(files[-1])
    expected = round_fit(round_films, tracked, launches)
    found = round_fit(round_films, files, launches)
    radii = [fit.parameters["reservoir.radius"].value for fit in (expected, found)]
    assert radii[1] == pytest.approx(radii[0], rel=1e-6)
    assert [path.name for path in found.paths] == list(map(str, files))
    plain = [
        write(p, p.position, tmp_path / f"mm_{k}.csv", "t [s],x [mm],y [mm],a,b", 1e-3)
        for k, p in enumerate(paths)
    ]
    again = round_fit(round_films, plain, launches, position_error=ERROR)
    assert again.parameters["reservoir.radius"].value == pytest.approx(radii[0], rel=1e-6)
    with pytest.raises(ParameterError, match=r"position_error: is needed: .*in \[paths\]"):
        round_fit(round_films, plain, launches)


TRACKERS = {
    "tracker": ("mass A\nt\tx\ty", "\t", ".", 1.0),
    "tracker, decimal commas": ("masse A\nt\tx\ty", "\t", ",", 1.0),
    "brackets": ("Time (s),X (mm),Y (mm)", ",", ".", 1e-3),
    "semicolons": ("Zeit [s];x [cm];y [cm]", ";", ",", 1e-2),
    "suffixes": ("frame,time_s,x_mm,y_mm", ",", ".", 1e-3),
    "line of units": ("t,x,y\n\ns,mm,mm", ",", ".", 1e-3),
    "blanks": ("# t x y", " ", ".", 1.0),
}


@pytest.mark.parametrize("name", TRACKERS)
def test_exports_of_trackers_are_read(name, tmp_path):
    head, mark, decimal, length = TRACKERS[name]
    time = np.arange(31) / 60.0
    x = np.stack([0.3 * time - 0.1 * time**2, 0.1 * time], axis=-1)
    columns = [time, *(x.T / length)]
    columns = [np.arange(31.0), *columns] if head.startswith("frame") else columns
    rows = [
        mark.join(f"{v:.6f}".replace(".", decimal) for v in row) for row in np.stack(columns, -1)
    ]
    file = tmp_path / "path.txt"
    file.write_text("\n".join([head, *rows]))
    found_time, found, error = read_path(file)
    np.testing.assert_allclose(found_time, time, atol=1e-6)
    np.testing.assert_allclose(found, x, atol=1e-6)
    assert error is None


def test_configurations_say_how_paths_are_read(tmp_path):
    """Without names in the file, or of two bodies in one file."""
    file = tmp_path / "path.txt"
    rows = "\n".join(f"{k};{0.1 * k};{0.2 * k};{0.3 * k};{0.4 * k}" for k in range(5))
    file.write_text("t;x;y;x;y\n" + rows.replace(".", ","))
    with pytest.raises(RecordError, match=r"x1: columns 1, 3 are all called 'x'"):
        read_path(file)
    columns = {"time": "t", "x1": 3, "x2": 4}
    _, x, _ = read_path(file, {"columns": columns, "units": {"x1": "mm", "x2": "mm"}})
    np.testing.assert_allclose(x[:, 0], 0.3e-3 * np.arange(5))
    file.write_text(rows)
    form = {"delimiter": ";", "header": 0}
    _, x, _ = read_path(file, {"file": form, "columns": {**columns, "time": 0}})
    np.testing.assert_allclose(x[:, 1], 0.4 * np.arange(5))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is empty"),
        ("t,x1\n0,1\n", "no column seems to be x2, of 't', 'x1'"),
        ("t [h],x1,x2\n0,1,2\n", r"no column seems to be time.*unit 'h' of 't \[h\]'.* not known"),
        ("t,x1,x2\n0,1,2\n1,1,2\n2,1,two\n", "line 4: must hold numbers, holds 'two'"),
        ("t,x1,x2\n0,1,2\n1,1,2\n,1,2\n", "must hold a time in every line"),
        ("t,x1\n0,1,2\n1,1,2\n", "line 1 has 2 headings, the numbers have 3 columns"),
        ("t,x,y [mm]\n0,1,2\n1,1,3\n", "x1 has no unit, the other coordinate has"),
        ("t,x,x\n0,1,2\n1,1,3\n", "columns 1, 2 are all called 'x'"),
    ],
)
def test_wrong_files_are_refused(tmp_path, text, words):
    (tmp_path / "path.csv").write_text(text)
    with pytest.raises(RecordError, match=words):
        fit_paths(tmp_path / "path.csv", system=asp.SlidingPoint(1.0, law=LAW))


# The command.


CONFIG = """\
[system]
gravity = 9.81
[paths]
length_error = 0.001
[launch]
place = [0.0, 0.0]
direction_error = 0.0035
[fixed.reservoir]
angle = 0.0
[fixed.direction]
angle = 0.0
"""


@pytest.fixture
def folder(few, tmp_path):
    paths, launches = few.draw(0)
    for k, path in enumerate(paths):
        write(path, path.position, tmp_path / f"path_{k}.csv")
    told = "".join(f"[[launches]]\ndirection = {one.direction!r}\n" for one in launches)
    (tmp_path / "paths.toml").write_text(CONFIG + told)
    return tmp_path


def identify(folder, *options):
    files = [str(folder / f"path_{k}.csv") for k in range(3)]
    models = ["--reservoir", "ellipse", "--direction", "ellipse", "--out", str(folder / "out")]
    return main(
        ["identify-paths", *files, *models, "--config", str(folder / "paths.toml"), *options]
    )


def test_a_law_is_identified_from_files(folder, capsys):
    assert identify(folder) == 0
    assert sorted(file.name for file in (folder / "out").iterdir()) == sorted(FILES)
    printed = capsys.readouterr().out
    assert "reservoir.a: 0.5" in printed
    law = tomllib.loads((folder / "out" / "law.toml").read_text())
    assert "identify-paths" in law["provenance"]["made_by"]
    assert IdentifiedLaw.load(folder / "out" / "law.toml").values[0] == pytest.approx(
        0.55, rel=0.03
    )
    launches = (folder / "out" / "launches.csv").read_text().splitlines()
    assert launches[0].startswith("path,speed [m/s],speed error [m/s],direction [rad]")
    assert len(launches) == 4


def test_the_command_takes_a_robust_loss(folder, capsys):
    """A point that was tracked wrongly widens the intervals of least squares, hardly the others."""
    table = folder / "path_1.csv"
    lines = table.read_text().splitlines()
    cells = lines[6].split(",")
    lines[6] = ",".join([cells[0], str(float(cells[1]) + 0.01), *cells[2:]])
    table.write_text("\n".join(lines))
    found = {}
    for loss in ("linear", "cauchy"):
        identify(folder, "--loss", loss)
        law = IdentifiedLaw.load(folder / "out" / "law.toml")
        found[loss] = law.standard_errors[0]
        assert f"--loss {loss}" in law.provenance.made_by
    assert found["cauchy"] < 0.5 * found["linear"], found


def test_the_command_inspects_a_path(folder, capsys):
    files = [str(folder / f"path_{k}.csv") for k in range(3)]
    config = folder / "read.toml"
    for _ in range(2):
        assert main(["identify-paths", "--inspect", files[0], "--config", str(config)]) == 0
        printed = capsys.readouterr().out
        assert "x1 error [m]" in printed
    assert "is there already and stays as it is" in printed
    text = config.read_text() + (folder / "paths.toml").read_text()
    (folder / "paths.toml").write_text(text)
    assert identify(folder) == 0
    wrong = text.replace('"x1 [m]"', '"x9 [m]"')
    (folder / "paths.toml").write_text(wrong)
    assert identify(folder) == 2
    assert "has no column 'x9 [m]'" in capsys.readouterr().err
    for options, words in (
        (["--out", "out"], "DATA: names no file"),
        ([files[0]], "--out: must be given"),
        ([files[0], "--inspect", files[0]], "--inspect: takes one file"),
    ):
        assert main(["identify-paths", *options]) == 2
        assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("place = [0.0, 0.0]", "place = [0.0]", "place: must have shape (2,)"),
        ("gravity = 9.81", "gravity = -1.0", "gravity: must be positive"),
        ("length_error = 0.001", "lenght_error = 0.001", "did you mean 'length_error'"),
        ("[[launches]]\n", "[[launches]]\n[[launches]]\n", "must be as many as there are paths"),
        ("[fixed.reservoir]\nangle", "[fixed.reservoir]\nexponent", "is no parameter"),
    ],
)
def test_wrong_configurations_are_named(folder, capsys, old, new, words):
    text = (folder / "paths.toml").read_text()
    assert old in text
    (folder / "paths.toml").write_text(text.replace(old, new, 1))
    assert identify(folder) == 2
    assert words in capsys.readouterr().err
    assert not (folder / "out").exists()
