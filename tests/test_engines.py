"""`FrictionLaw.like` against what other engines were seen to compute.

The sliding experiment: a body of 18 g on a horizontal plane, launched at 1.52 m/s at 58° to x, with
coefficients 5/9.3 and 4.49/9.3 along x and y, 0.5 where they are equal, and steps of 0.1 ms or
what is given.
"""

from dataclasses import dataclass
from pathlib import Path

import asperity as asp
import numpy as np
import pytest
from asperity.law.engines import ENGINES, known_of, parameters_of

MODES = [(engine, mode) for engine in ENGINES for mode in known_of(engine).get("modes", ())]
"""What benches/peers/atlas.py printed, with the parameters of `like`."""
ANGLES = (15.0, 30.0, 45.0, 60.0, 75.0)


def words_of(engine, mode):
    """Return the parameters of a mode, with the coefficient 0.5 unless it has another one."""
    word = {
        "btrigidbody": "friction",
        "bullet": "lateralFriction",
        "drake": "dynamic_friction",
        "mujoco": "geom_friction",
        "ode": "mu",
        "pyelastica": "kinetic_mu_array",
    }.get(engine) or known_of(engine)["coefficient"]
    given = {"yade": np.arctan(0.5), "pyelastica": (0.5, 0.5, 0.5)}.get(engine, 0.5)
    return {word: given, **mode["like"]}


M1, M2 = 5.00 / 9.3, 4.49 / 9.3
SCALE = {"mu": 0.5, "anisotropy": (M1 / 0.5, M2 / 0.5)}
ROWS = np.diag([M1, M2]) / 0.5
# Of a sphere on a horizontal plane: the first tangent is y.
FRAME = [0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0]
ELLIPTIC = {"cone": "elliptic", "frame": FRAME}
BULLET = {
    "lateralFriction": 1.0,
    "anisotropicFriction": (M1, M2, 1.0),
    "enableConeFriction": False,
}
TIME = 0.36
"""At which bodies that do not rest yet are compared."""

RECORDED = [
    # version, engine, parameters, position in m, time in s at which it stops if it does
    ("4.4.0", "siconos", {"mu": 0.5}, (0.1248038, 0.1997279), 0.30990),
    ("4.4.0", "siconos", {"mu": 0.5, "H": ROWS}, (0.1157060, 0.2067613), 0.31330),
    *(
        ("4.0.0", "mujoco", {"friction": friction, **options}, position, stop)
        for friction, options, positions, stops in (
            # The default contact with steps of 0.1 ms and of 2 ms, the default; then, with 0.1 ms,
            # solref="0.002 1" solimp="0.95 0.99 0.001", a stiffer one.
            (
                (0.5, 0.5),
                ELLIPTIC,
                ((0.1248203, 0.1997543), (0.1240611, 0.1985393), (0.1247643, 0.1996646)),
                (None, None, 0.3105),
            ),
            (
                (M1, M2),
                ELLIPTIC,
                ((0.1268773, 0.1869816), (0.1261363, 0.1856769), (0.1270200, 0.1867595)),
                (None, None, 0.2994),
            ),
            (
                (M2, M1),
                ELLIPTIC,
                ((0.1178780, 0.2054638), (0.1170770, 0.2042991), (0.1176056, 0.2055078)),
                (None, None, 0.3134),
            ),
            (
                (0.5, 0.5),
                {"frame": FRAME},
                ((0.2022869, 0.2337700), (0.2017399, 0.2326829), (0.2040509, 0.2320364)),
                (None, None, None),
            ),
            (
                (M1, M2),
                {"frame": FRAME},
                ((0.2027743, 0.2192479), (0.2023322, 0.2179836), (0.2042723, 0.2176197)),
                (None, None, None),
            ),
            (
                (M2, M1),
                {"frame": FRAME},
                ((0.1948292, 0.2424683), (0.1942397, 0.2413969), (0.1968984, 0.2406280)),
                (None, None, None),
            ),
        )
        for position, stop in zip(positions, stops, strict=True)
    ),
    *(
        (
            "1.51.1",
            "drake",
            {"dynamic_friction": 0.5, "discrete_contact_approximation": kind, "time_step": step},
            position,
            None,
        )
        for kind, step, position in (
            ("lagged", 3e-4, (0.1246830, 0.1995346)),
            ("lagged", 1e-3, (0.1244013, 0.1990837)),
            ("similar", 3e-4, (0.1246830, 0.1995345)),
            ("similar", 1e-3, (0.1244001, 0.1990818)),
            ("sap", 3e-4, (0.1246823, 0.1995333)),
            ("sap", 1e-3, (0.1244028, 0.1990861)),
            ("tamsi", 3e-4, (0.1246830, 0.1995345)),
            ("tamsi", 1e-3, (0.1244012, 0.1990836)),
        )
    ),
    (
        "1.51.1",
        "drake",
        {"dynamic_friction": 0.5, "time_step": 1e-4},
        (0.124764, 0.199663),
        0.3098,
    ),
    (
        "1.51.1",
        "drake",
        {
            "dynamic_friction": 0.5,
            "discrete_contact_approximation": "tamsi",
            "time_step": 1e-4,
        },
        (0.124764, 0.199663),
        0.3097,
    ),
    (
        "1.51.1",
        "drake",
        {
            "dynamic_friction": 0.5,
            "static_friction": 0.9,
            "discrete_contact_approximation": "similar",
            "time_step": 1e-4,
        },
        (0.1247588, 0.1996559),
        0.3098,
    ),
    (
        "1.51.1",
        "drake",
        {"dynamic_friction": 0.5, "discrete_contact_approximation": "sap", "time_step": 1e-4},
        (0.1247626, 0.1996619),
        0.3099,
    ),
    (
        "1.51.1",
        "drake",
        {"dynamic_friction": 0.5, "static_friction": 0.9, "time_step": 0.0},
        (0.124804, 0.199728),
        None,
    ),
    ("4.1.0", "pinocchio", {"mu": 0.5}, (0.124804, 0.199728), 0.3099),
    ("4.1.0", "pinocchio", {"mu": 0.5, "S": ROWS}, (0.115700, 0.206765), 0.3133),
    (
        "pybullet 3.2.7",
        "bullet",
        {"lateralFriction": 0.5, "enableConeFriction": True},
        (0.124764, 0.199663),
        0.3097,
    ),
    (
        "pybullet 3.2.7",
        "bullet",
        {"lateralFriction": 0.5, "enableConeFriction": False},
        (0.066096, 0.169314),
        0.2626,
    ),
    ("pybullet 3.2.7", "bullet", {**BULLET, "enableConeFriction": 1}, (0.125648, 0.201080), 0.3119),
    ("pybullet 3.2.7", "bullet", BULLET, (0.061466, 0.175350), 0.272),
    ("1.13.6", "exudyn", {"dryFriction": (0.5, 0.5)}, (0.124809, 0.199735), 0.3095),
    ("1.13.6", "exudyn", {"dryFriction": (M1, M2)}, (0.120619, 0.203852), 0.3120),
    (
        "0.1.2",
        "solve_nivp",
        {"projection": asp.Ellipse(M1, M2)},
        (0.1157060, 0.2067612),
        0.3133,
    ),
    # Of engines with one coefficient the table has the end points.
    *(
        (known_of(engine)["version"], engine, words_of(engine, mode), mode["end"], None)
        for engine, mode in MODES
        if "end" in mode
    ),
]

LAWS_OF_ONE = {
    "isotropic": asp.FrictionLaw.isotropic(0.5),
    "square": asp.FrictionLaw.associated(asp.Rectangle(0.5, 0.5)),
    "square diamond": asp.FrictionLaw.associated(asp.Superellipse(0.5, 0.5, 1.0)),
}
"""What one coefficient may mean."""
LAWS_OF_TWO = {
    "associated ellipse": asp.FrictionLaw.associated(asp.Ellipse(M1, M2)),
    "ellipse, axes exchanged": asp.FrictionLaw.associated(asp.Ellipse(M2, M1)),
    "collinear": asp.FrictionLaw.collinear(asp.Ellipse(M1, M2)),
    "tensor": asp.FrictionLaw.tensor([[M1, 0.0], [0.0, M2]]),
    "box": asp.FrictionLaw.associated(asp.Rectangle(M1, M2)),
    "diamond": asp.FrictionLaw.associated(asp.Superellipse(M1, M2, 1.0)),
    "diamond, axes exchanged": asp.FrictionLaw.associated(asp.Superellipse(M2, M1, 1.0)),
}
"""What two may mean."""


def slide(law):
    """Return the end of the sliding experiment and the time of rest."""
    speed = 1.52 * np.array([np.cos(np.deg2rad(58.0)), np.sin(np.deg2rad(58.0))])
    path = asp.simulate(asp.SlidingPoint(0.018, law=law), dt=1e-4, t_end=TIME, u0=speed)
    slow = np.linalg.norm(path.u, axis=-1) < 1e-6
    return path.q[-1], path.t[slow.argmax()] if slow.any() else None


ENDS = [{name: slide(law)[0] for name, law in laws.items()} for laws in (LAWS_OF_ONE, LAWS_OF_TWO)]


def like(engine, parameters):
    return asp.FrictionLaw.like(engine, **parameters)


def name_of(case):
    return (
        f"{case[1]}-{'-'.join(f'{k}={v}' for k, v in case[2].items() if isinstance(v, str | bool))}"
    )


@pytest.mark.parametrize("case", RECORDED, ids=name_of)
def test_the_law_is_the_one_that_the_engine_computes(case):
    version, engine, parameters, position, stop = case
    law = like(engine, parameters)
    end, rest = slide(law)
    off = np.linalg.norm(end - position)
    assert law.report.engine == engine
    assert law.report.version == version
    assert off <= law.report.end_error + 1e-6  # half a digit of what was recorded
    along, across = law.reservoir.radius([0.0, 0.5 * np.pi])
    ends = ENDS[0 if np.isclose(along, across) else 1]
    others = {name: np.linalg.norm(there - position) for name, there in ends.items()}
    # No other law that the same coefficients may mean is nearer.
    assert off <= min(others.values()) + 1e-9, others
    assert (stop is None) or abs(rest - stop) < 7e-4


@pytest.mark.parametrize("engine", sorted({case[1] for case in RECORDED}))
def test_stated_errors_are_those_that_were_recorded(engine):
    seen = {}
    for _, name, parameters, position, _ in RECORDED:
        if name == engine:
            law = like(engine, parameters)
            stated, off = law.report.end_error, np.linalg.norm(slide(law)[0] - position)
            seen[stated] = max(off, seen.get(stated, 0.0))
    assert seen
    for stated, largest in seen.items():
        assert stated <= 1.5 * largest + 1e-6, (stated, largest)


CREEP = [
    ("mujoco", {"friction": (0.5, 0.5), "cone": "elliptic"}, 2.20667e-3),
    ("mujoco", {"friction": (1.0, 1.0), "cone": "elliptic"}, 4.41334e-3),
    ("mujoco", {"friction": (0.5, 0.5)}, 3.21935e-3),
    ("mujoco", {"friction": (0.5, 0.5), "cone": "elliptic", "impratio": 10.0}, 2.20667e-4),
    ("mujoco", {"friction": (0.5, 0.5), "cone": "elliptic", "impratio": 0.5}, 4.41334e-3),
    ("drake", {"dynamic_friction": 0.5, "static_friction": 0.9}, 5.77351e-5),
    (
        "drake",
        {"dynamic_friction": 0.5, "discrete_contact_approximation": "similar"},
        5.77350e-5,
    ),
    ("drake", {"dynamic_friction": 0.5, "discrete_contact_approximation": "tamsi"}, 2.92929e-5),
    ("drake", {"dynamic_friction": 0.5, "discrete_contact_approximation": "sap"}, 1.41595e-6),
    (
        "drake",
        {
            "dynamic_friction": 0.5,
            "discrete_contact_approximation": "sap",
            "time_step": 1e-4,
        },
        1.41595e-7,
    ),
    *(
        (
            "exudyn",
            {
                "dryFriction": (0.5, 0.5),
                "dryFrictionProportionalZone": 1e-3,
                "useLinearProportionalZone": linear,
            },
            speed,
        )
        for linear, speed in ((True, 5.0e-4), (False, 2.92893e-4))
    ),
]
"""Speeds in m/s under half of the load that a contact can hold, of bodies that the laws hold."""


@pytest.mark.parametrize(("engine", "parameters", "speed"), CREEP)
def test_the_stated_creep_is_what_was_recorded(engine, parameters, speed):
    report = like(engine, parameters).report
    assert report.creep == pytest.approx(speed, rel=1e-3)
    shown = 1e3 * speed if engine == "mujoco" else speed
    assert f"{shown:.2g} m" in report.deviation


def test_coefficients_of_continuous_drake_over_the_speed():
    recorded = {
        1.0e-4: 0.9,
        1.2e-4: 0.896576,
        1.5e-4: 0.85859375,
        2.0e-4: 0.7,
        2.5e-4: 0.54140625,
        3.0e-4: 0.5,
        1.0e-3: 0.5,
    }
    law = like("drake", {"dynamic_friction": 0.5, "static_friction": 0.9, "time_step": 0})
    slip = np.array([[speed, 0.0] for speed in recorded])
    off = np.abs(-law.force(slip)[:, 0] - np.array(list(recorded.values())))
    assert off.max() <= 0.023 * 0.4 + 1e-6
    assert "0.0092" in law.report.deviation
    assert law.report.creep == 0.5e-4


@dataclass
class Constant:
    """A constant as the bindings of MuJoCo and Drake have them."""

    name: str


SAME_WORDS = [
    ("mujoco", {"friction": (0.5, 0.4)}, "cone", "elliptic", [1, "Elliptic", "mjCONE_ELLIPTIC"]),
    ("mujoco", {"friction": (0.5, 0.4)}, "cone", "elliptic", [Constant("mjCONE_ELLIPTIC")]),
    ("mujoco", {"friction": (0.5, 0.4)}, "cone", "pyramidal", [0, "PYRAMIDAL"]),
    (
        "drake",
        {"dynamic_friction": 0.5},
        "discrete_contact_approximation",
        "sap",
        ["SAP", "kSap", Constant("kSap")],
    ),
    ("cardillo", SCALE, "solver", "BackwardEuler", ["backwardeuler"]),
]


@pytest.mark.parametrize(("engine", "parameters", "name", "word", "others"), SAME_WORDS)
def test_words_are_taken_as_people_write_them(engine, parameters, name, word, others):
    law = like(engine, {**parameters, name: word})
    for other in others:
        assert like(engine, {**parameters, name: other}) == law
        assert like(engine.upper(), {**parameters, name: other}).report.engine == engine


def test_reports_say_what_holds_of_their_laws():
    """Sentences about unequal coefficients or a measured creep are there where these are."""
    for engine, given in (
        ("exudyn", {"dryFriction": (0.5, 0.5)}),
        ("btrigidbody", {"friction": 0.5}),
        ("bullet", {"lateralFriction": 0.5, "enableConeFriction": True}),
    ):
        law = like(engine, given)
        assert law.reservoir == law.direction == asp.Disk(0.5)
        for words in ("not associated", "ellipse"):
            assert words not in law.report.deviation
    assert "not associated" in like("exudyn", {"dryFriction": (0.5, 0.4)}).report.deviation
    cone = {"lateralFriction": 0.5, "anisotropicFriction": (1, 0.5, 1), "enableConeFriction": True}
    assert "coefficients form an ellipse" in like("bullet", cone).report.deviation
    for kind in ("elliptic", "pyramidal"):
        given = {"friction": (0.4, 0.6, 0.003, 0, 0), "condim": 4, "patch_radius": 0.01}
        report = like("mujoco", {**given, "cone": kind}).report
        assert report.creep is None
        assert "mm/s" not in report.deviation
        assert "not measured" in report.deviation


@pytest.mark.parametrize("case", RECORDED, ids=name_of)
def test_laws_with_their_reports_come_back_from_files(case, tmp_path):
    law = like(case[1], case[2])
    law.save(tmp_path / "law.toml")
    again = asp.FrictionLaw.load(tmp_path / "law.toml")
    assert again == law
    assert repr(again) == repr(law)


REFUSED = [
    ("mujco", {}, "engine: 'mujco' is not known, did you mean 'mujoco'?"),
    ("chrono", {}, "engine: 'chrono' is not known; known are box2d, btrigidbody"),
    (3, {}, "engine: 3 is not known; known are box2d, btrigidbody"),
    (
        "mujoco",
        {"mu": 0.5},
        "mu: is not a parameter of mujoco here; known are friction, geom_friction",
    ),
    ("bullet", {"friction": 0.5}, "friction: is not a parameter of bullet here; known are lateral"),
    ("bullet", {}, "lateralFriction: is missing"),
    (
        "siconos",
        {"mu": 0.5, "e_n": 0.2},
        "e_n: is not part of a law: it belongs to the contact, as",
    ),
    (
        "cardillo",
        {"mu": 0.5, "e_F": 0.2},
        "e_F: is not part of a law: it belongs to the contact, as",
    ),
    (
        "mujoco",
        {"friction": (1.0, 1.0), "solref": (0.02, 1.0)},
        "solref: is not part of a law: con",
    ),
    ("exudyn", {"dryFriction": (0.5, 0.4), "viscousFriction": (1.0, 1.0)}, "with the speed"),
    ("mujoco", {"geom_friction": (1.0, 0.005)}, "geom_friction: must have the three numbers"),
    (
        "mujoco",
        {"geom_friction": np.ones((3, 3))},
        "geom_friction: is of one geom or of two, got 3",
    ),
    ("mujoco", {"geom_friction": np.ones((0, 3))}, "geom_friction: "),
    ("mujoco", {"friction": (1.0, 1.0), "cone": 2}, "cone: must be 'pyramidal' or"),
    ("bullet", {"lateralFricton": 0.5}, "did you mean 'lateralFriction'"),
    ("siconos", {}, "mu: is missing: siconos has mu, size, H"),
    ("mujoco", {}, "friction: of a contact or geom_friction"),
    ("mujoco", {"friction": (1.0, 0.005, 0.0001)}, "three numbers of a geom are geom_friction"),
    ("mujoco", {"friction": (1.0, 1.0), "condim": 1}, "condim: 1 means contact without friction"),
    ("mujoco", {"friction": (1.0, 1.0), "condim": 6}, "condim: 6 has rolling friction"),
    ("mujoco", {"friction": (1.0, 1.0), "condim": 5}, "condim: must be 3 or 4, got 5"),
    ("mujoco", {"friction": (1.0, 1.0), "condim": 4}, "patch_radius: is missing"),
    (
        "mujoco",
        {"friction": (1.0, 1.0), "condim": 4, "patch_radius": 0.1},
        "friction: must have a positive third number",
    ),
    ("mujoco", {"friction": (1.0, 1.0), "patch_radius": 0.1}, "condim=3 has not"),
    ("mujoco", {"friction": (0.0, 0.0)}, "friction: must be positive"),
    ("mujoco", {"geom_friction": (0.0, 0.1, 0.1)}, "geom_friction: must be positive"),
    ("mujoco", {"friction": (1.0, 1.0), "cone": "round"}, "cone: must be 'pyramidal' or"),
    ("mujoco", {"friction": (1.0, 1.0), "frame": np.eye(3)}, "frame: must have a vertical normal"),
    ("mujoco", {"friction": (1.0, 1.0), "frame": np.ones(9)}, "frame: must have orthonormal rows"),
    ("mujoco", {"friction": (1.0, 1.0), "frame": np.ones(4)}, "the nine numbers"),
    (
        "bullet",
        {"lateralFriction": 0.5, "spinningFriction": 0.1},
        "spinningFriction: is not translated",
    ),
    (
        "bullet",
        {"lateralFriction": 0.5, "rollingFriction": 0.1},
        "rollingFriction: is not translated",
    ),
    (
        "bullet",
        {"lateralFriction": 0.5, "enableConeFriction": "yes"},
        "enableConeFriction: must be True or False",
    ),
    (
        "bullet",
        {"lateralFriction": 0.5, "anisotropicFriction": (1.0, -1.0, 1.0)},
        "anisotropicFriction: must be positive",
    ),
    ("drake", {"static_friction": 0.5}, "dynamic_friction: is missing"),
    ("drake", {"dynamic_friction": 0.5, "static_friction": 0.2}, "must not be below"),
    (
        "drake",
        {"dynamic_friction": 0.5, "discrete_contact_approximation": "lag"},
        "discrete_contact_approximation: must be 'lagged'",
    ),
    ("dart", {"mu": 0.5, "mu2": 0.4}, "mu2: is not part of a law: dartpy takes one coefficient"),
    ("jaxsim", {"mu": 0.5, "contact_model": "RigidContacts"}, "which stops a body in one step"),
    ("newton", {"mu": 0.5, "solver": "SolverStyle3D"}, "solver: must be 'SolverXPBD' or"),
    ("physx", {}, "dynamic_friction: is missing: physx has dynamic_friction, solver"),
    ("cardillo", {"mu": 0.3, "solver": "Moreaux"}, "solver: must be 'Moreau' or"),
    ("exudyn", {"dryFriction": 0.3}, "dryFriction: must have shape"),
    ("yade", {"frictionAngle": 1.6}, "frictionAngle: must be below π/2"),
    ("pyelastica", {"kinetic_mu_array": (0.9, 0.5, 0.3)}, "forwards and backwards, got 0.9, 0.5"),
    ("siconos", {"mu": 0.3, "size": 5}, "size: 5 has rolling friction"),
    ("siconos", {"mu": 0.3, "size": 4}, "size: must be 2 or 3"),
    ("siconos", {"mu": 0.3, "size": 2, "H": np.eye(2)}, "H: is for size=3"),
    ("siconos", {"mu": 0.3, "H": np.ones((2, 2))}, "H: must be regular"),
    ("solve_nivp", {}, "mu: of CoulombProjection"),
    ("solve_nivp", {"projection": 0.5}, "projection: "),
    ("solve_nivp", {"projection": asp.Superellipse(1.0, 1.0, 0.5)}, "projection: must be a convex"),
]


@pytest.mark.parametrize(("engine", "parameters", "words"), REFUSED)
def test_what_means_no_law_is_refused_in_the_engines_words(engine, parameters, words):
    with pytest.raises(asp.ParameterError) as refused:
        like(engine, parameters)
    assert words in str(refused.value)


NUMBERS = [
    (engine, parameters, name)
    for engine, parameters in (
        ("bullet", {**BULLET, "spinningFriction": 0.0, "rollingFriction": 0.0}),
        ("cardillo", SCALE),
        ("btrigidbody", {"friction": 0.5, "anisotropicFriction": (1.0, 0.5, 1.0)}),
        ("dart", {"mu": 0.5}),
        (
            "drake",
            {
                "dynamic_friction": 0.5,
                "static_friction": 0.9,
                "time_step": 1e-3,
                "stiction_tolerance": 1e-4,
            },
        ),
        (
            "exudyn",
            {
                "dryFriction": (0.5, 0.4),
                "dryFrictionAngle": 0.1,
                "dryFrictionProportionalZone": 1e-3,
            },
        ),
        ("mujoco", {"friction": (0.5, 0.4), "frame": FRAME}),
        ("mujoco", {"geom_friction": (0.5, 0.4, 0.1), "condim": 4, "patch_radius": 0.1}),
        ("ode", {"mu": 0.5, "mu2": 0.4}),
        ("pyelastica", {"kinetic_mu_array": (0.9, 0.9, 0.3)}),
        ("yade", {"frictionAngle": 0.5}),
        ("pinocchio", {"mu": 0.5, "S": ROWS}),
        ("rapier", {"friction": 0.5}),
        ("siconos", {"mu": 0.5, "H": ROWS, "size": 3}),
        ("solve_nivp", {"mu": 0.5}),
    )
    for name in parameters
]


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1.0 + 1.0j, "0.5"])
@pytest.mark.parametrize(("engine", "parameters", "name"), NUMBERS)
def test_what_is_no_number_is_refused_by_name(engine, parameters, name, bad):
    like(engine, parameters)
    value = np.array(parameters[name], dtype=object)
    value.flat[0] = bad
    spoilt = value.tolist()
    with pytest.raises(asp.ParameterError) as refused:
        like(engine, {**parameters, name: spoilt})
    assert refused.value.argument == name


@pytest.mark.parametrize("engine", ENGINES)
def test_what_belongs_elsewhere_is_refused_with_the_place(engine):
    assert set(parameters_of(engine)).isdisjoint(known_of(engine)["elsewhere"])
    for name, place in known_of(engine)["elsewhere"].items():
        with pytest.raises(asp.ParameterError) as refused:
            like(engine, {name: 0.1})
        assert refused.value.argument == name
        assert place in str(refused.value)


def test_every_engine_was_recorded_and_is_documented():
    seen = {case[1] for case in RECORDED} | {engine for engine, _ in MODES}
    assert seen == set(ENGINES) - {"cardillo"}
    # It could not be installed again: its law is that of its source, without numbers of a run.
    for solver in ("Moreau", "BackwardEuler"):
        law = like("cardillo", {**SCALE, "solver": solver})
        assert law.report.creep is law.report.end_error is None
        assert law.reservoir == asp.Ellipse(M1, M2)
        assert bool(law.is_associated) == (solver == "Moreau")
    words = asp.FrictionLaw.like.__doc__
    assert all(f"``{engine}``" in words for engine in ENGINES)


def test_mujoco_takes_its_least_coefficient_for_none():
    skate = asp.FrictionLaw.like("mujoco", friction=(0.8, 0.0), cone="elliptic")
    assert skate.reservoir == asp.Ellipse(0.8, 1e-5)


def test_solvers_of_dart_without_a_box_are_isotropic():
    law = like("dart", {"mu": 0.5, "solver": "FbfFrictionSolver"})
    assert law.reservoir == asp.Disk(0.5)
    assert like("dart", {}).reservoir == asp.Rectangle(1.0, 1.0)


def test_end_errors_of_mujoco_grow_with_the_ratio_of_its_coefficients():
    ratios = [(0.5, 0.5), (0.6, 0.4), (0.9, 0.3)]
    errors = [like("mujoco", {"friction": pair, **ELLIPTIC}).report.end_error for pair in ratios]
    assert errors == pytest.approx([1.5e-3, 10e-3, 22e-3])
    assert like("mujoco", {"friction": (0.9, 0.1), **ELLIPTIC}).report.end_error is None


@pytest.mark.parametrize(("engine", "mode"), MODES, ids=lambda one: str(one)[:30])
def test_laws_have_the_forces_that_were_seen(engine, mode):
    if "refused" in mode:
        with pytest.raises(asp.ParameterError, match="has no pair of sets"):
            like(engine, mode.get("like") or {known_of(engine)["option"]: mode["name"]})
        return
    law = like(engine, words_of(engine, mode))
    seen = np.array(mode["cube"])
    if law.dimension == 1:
        assert -law.force([[1.0]])[0, 0] == pytest.approx(seen[0, 1], rel=1e-2)
    elif mode["lift"] < 1e-5:  # m; where bodies hop, the page says how far off the engine is
        off = off_the_law(law, seen)
        assert off[0] <= 0.25, "degrees"
        assert off[1] <= 0.01 * 0.5
    if "coefficient" in known_of(engine):
        assert float(f"{law.report.creep:.3g}") == mode["creep"]
    rule, given = mode.get("of_two", known_of(engine)["of_two"]), np.array([0.2, 0.8])
    if rule in RULES and "two" in mode and mode["lift"] < 1e-5:
        assert mode["two"] == pytest.approx(RULES[rule](given), rel=1e-2)


RULES = {
    "product": np.prod,
    "smaller": np.min,
    "larger": np.max,
    "mean": np.mean,
    "geometric mean": lambda given: np.sqrt(given.prod()),
    "2ab/(a + b)": lambda given: 2.0 * given.prod() / given.sum(),
}


def off_the_law(law, seen):
    """Return by how many degrees and how much of the weight forces of an engine are off."""
    force = -law.force(np.array([[np.cos(a), np.sin(a)] for a in np.deg2rad(ANGLES)]))
    angles = np.rad2deg(np.arctan2(force[:, 1], force[:, 0]))
    return np.abs(angles - seen[:, 0]).max(), np.abs(np.hypot(*force.T) - seen[:, 1]).max()


def rows_of_the_atlas():
    """Return the rows of the tables in docs/engines.md that say what was seen."""
    modes, engines = [], []
    for engine in sorted(ENGINES):
        known = known_of(engine)
        for mode in known.get("modes", ()):
            name = f"{engine} {known['version']}, {mode['name'].replace('default', 'by default')}"
            law = mode["law"]
            if law == "interval":
                offs = ["—", "—"]
            else:
                other = asp.FrictionLaw.isotropic(0.5)
                if "beside" in mode:
                    other = like(engine, mode["beside"])
                one = other if "refused" in mode else like(engine, words_of(engine, mode))
                offs = [
                    "{:.1f}°, {:.3f}".format(*off_the_law(one, np.array(mode[body])))
                    for body in ("cube", "long")
                ]
            # In mm/s and mm; what was not run has no number.
            shown = [1e3 * mode[one] if one in mode else None for one in ("creep", "lift")]
            shown = ["—" if one is None else f"{one:.2g}" if one >= 1e-3 else "0" for one in shown]
            turns = [f"{1e3 * mode[one]:.3g}" if one in mode else "—" for one in ("spin", "roll")]
            modes.append(f"| {' | '.join([name, law, *offs, *shown, *turns])} |")
        if "of_two" in known:
            words = [
                known.get(one, "—") for one in ("of_two", "static", "spin", "reported", "traps")
            ]
            engines.append(f"| {engine}, {known['date']} | {' | '.join(words)} |")
    return modes, engines


@pytest.mark.parametrize("place", [0, 1])
def test_the_page_has_the_rows_of_the_table(place):
    page = (Path(__file__).parents[1] / "docs/engines.md").read_text(encoding="utf-8")
    rows = rows_of_the_atlas()[place]
    assert "\n".join(rows) in page, "\n".join(["", *rows])


def test_names_of_packages_are_understood_and_others_refused_with_the_reason():
    for name, engine, given in (
        ("dartpy", "dart", {"mu": 0.5}),
        ("pyb2d3", "box2d", {"friction": 0.5}),
        ("pydrake", "drake", {"dynamic_friction": 0.5}),
    ):
        assert asp.FrictionLaw.like(name, **given).report.engine == engine
    refused = {"simbody": "2ab/", "lavendersim": "no pair", "pybox3d": "tumble", "liggghts":
               "restitution only", "Abaqus": "export", "ansys": "export"}  # fmt: skip
    for name, reason in refused.items():
        words = f"engine: '{name}' is not translated: .*{reason}"
        with pytest.raises(asp.ParameterError, match=words):
            asp.FrictionLaw.like(name, mu=0.5)


def test_a_solver_that_was_not_given_is_named():
    law = asp.FrictionLaw.like("newton", mu=0.5)
    assert law.report.deviation.startswith("solver is SolverXPBD, as none was given. None was")
    named = asp.FrictionLaw.like("newton", mu=0.5, solver="SolverXPBD").report
    assert law.report.replace(deviation=named.deviation) == named
    assert "was given" not in asp.FrictionLaw.like("dart", mu=0.5).report.deviation
    assert "was given" not in asp.FrictionLaw.like("yade", frictionAngle=0.5).report.deviation
