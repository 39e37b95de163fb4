"""Systems: shapes, equilibrium, checks of subclasses."""

import inspect

import asperity as asp
import numpy as np
import pytest

LAW = asp.FrictionLaw.isotropic(0.5)
LINE = asp.FrictionLaw.isotropic(0.5, dimension=1)


def test_matrices_may_be_scalars_diagonals_or_full():
    contact = asp.Contact(LAW, direction=np.eye(2), normal_force=1.0)
    full = asp.LinearSystem(np.diag([2.0, 2.0]), stiffness=np.diag([1.0, 3.0]), contacts=[contact])
    assert asp.LinearSystem(2.0, stiffness=[1.0, 3.0], contacts=[contact]) == full
    assert full.dof == 2
    assert full.damping.tolist() == [[0.0, 0.0], [0.0, 0.0]]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: asp.LinearSystem(1.0, stiffness=np.eye(2)), "stiffness: has .* mass=.1.0, 1.0"),
        (lambda: asp.LinearSystem(1.0, force=[1.0, 2.0]), "force: has shape .* scalar mass"),
        (lambda: asp.LinearSystem(1.0, stiffness=[[1.0], [1.0, 2.0]]), "stiffness: .* rectangular"),
        (
            lambda: asp.LinearSystem([1.0], force=asp.Sine([1.0], frequency=1.0)),
            "force: must be constant: .* RigidBodies, and by a System",
        ),
        (
            lambda: asp.Contact(LINE, direction=[1.0], normal_force=1.0, velocity=lambda t: [t]),
            "velocity: must be constant: .* RigidBodies, and by a System",
        ),
    ],
)
def test_what_a_linear_system_does_not_take_is_told_with_who_does(make, words):
    with pytest.raises(asp.AsperityError, match=words):
        make()


def test_belt_velocity_enters_with_minus():
    belt = asp.MassOnBelt(1.0, stiffness=2.0, law=LAW, normal_force=3.0, belt_velocity=[0.4, 0.0])
    assert belt.contacts[0].velocity.tolist() == [-0.4, 0.0]
    np.testing.assert_allclose(belt.equilibrium, [0.75, 0.0])
    coupled = belt.replace(stiffness=[[2.0, 1.0], [0.0, 1.0]])
    np.testing.assert_allclose(coupled.stiffness @ coupled.equilibrium, [1.5, 0.0], atol=1e-15)


def test_equilibrium_of_the_paper():
    belt = asp.MassOnBelt(
        1.0,
        stiffness=1.0,
        law=asp.FrictionLaw(asp.Ellipse(30.0, 10.0, angle=np.deg2rad(30)), asp.Ellipse(3.0, 1.0)),
        normal_force=1.0,
        belt_velocity=[np.cos(np.deg2rad(50)), np.sin(np.deg2rad(50))],
    )
    np.testing.assert_allclose(belt.equilibrium, [20.201550, 2.675030], atol=1e-6)


class Block(asp.System):
    """A block on a line, written out."""

    dof = 1
    contacts = (asp.ContactLaw(LINE, normal_force=9.81),)

    def mass(self, q):
        return np.eye(1)

    def forces(self, t, q, u):
        return np.zeros(1)

    def direction(self, t, q, contact):
        return np.eye(1)


def test_custom_system_equals_the_linear_one():
    linear = asp.SlidingPoint(1.0, law=LINE)
    options = {"dt": 1e-3, "t_end": 0.5, "u0": [2.0]}
    custom, model = asp.simulate(Block(), **options), asp.simulate(linear, **options)
    np.testing.assert_array_equal(custom.phase, model.phase)
    np.testing.assert_allclose(custom.q, model.q, atol=1e-14)
    np.testing.assert_allclose(custom.force, model.force, atol=1e-11)


def test_unilateral_custom_system_falls_and_rests():
    class Falling(asp.System):
        dof = 2
        contacts = (asp.ContactLaw(LINE),)

        def mass(self, q):
            return np.eye(2)

        def forces(self, t, q, u):
            return np.array([0.0, -9.81])

        def direction(self, t, q, contact):
            return np.array([[1.0], [0.0]])

        def normal(self, t, q, contact):
            return np.array([0.0, 1.0])

        def gap(self, t, q, contact):
            return q[1]

    motion = asp.simulate(Falling(), dt=1e-3, t_end=2.0, q0=[0.0, 1.0], u0=[1.0, 0.0])
    impact = np.sqrt(2 / 9.81)
    opened = motion.t[1:][motion.phase[1:, 0] == asp.Phase.OPEN].max()
    assert opened == pytest.approx(impact, abs=2e-3)
    assert motion.phase[-1, 0] == asp.Phase.STICK
    np.testing.assert_allclose(motion.normal_force[-1, 0], 9.81, rtol=1e-9)
    # The impact takes μ times the normal percussion √(2g) and more than stops the sliding.
    assert motion.q[-1, 0] == pytest.approx(impact, abs=2e-3)


@pytest.mark.parametrize(
    ("methods", "message"),
    [
        ({"masses": lambda self, q: 1}, r"did you mean mass\(self, q\)"),
        ({"mass": lambda self, q: 1}, r"must define the method forces\(self, t, q, u\)"),
        ({"mass": lambda self, x: 1}, r"mass\(self, x\) must have the signature mass\(self, q\)"),
        (
            {"mass": lambda self, q: 1, "forces": lambda self, q, u: 1},
            r"must have the signature forces\(self, t, q, u\)",
        ),
        ({"mass": lambda self, q: 1, "force": lambda self, t, q, u: 1}, "did you mean forces"),
        ({"mass": 3.0}, r"must be a method mass\(self, q\)"),
        ({"mass": staticmethod(lambda q: 1)}, r"must be a method mass\(self, q\)"),
        (
            {
                "mass": lambda self, q: 1,
                "forces": lambda self, t, q, u: 1,
                "gaps": lambda self, t, q, contact: 0.0,
            },
            "did you mean gap",
        ),
    ],
)
def test_signatures_are_checked_when_the_class_is_defined(methods, message):
    with pytest.raises(TypeError, match=message):
        type("Faulty", (asp.System,), methods)


def test_exceptions_in_a_callback_come_back_with_their_traceback():
    class Failing(Block):
        def forces(self, t, q, u):
            if t > 0.5:
                raise ZeroDivisionError("in the user's code")
            return np.zeros(1)

    with pytest.raises(ZeroDivisionError, match="user's code") as caught:
        asp.simulate(Failing(), dt=0.1, t_end=1.0)
    assert "forces" in {entry.name for entry in caught.traceback}
    assert any("step 6" in note for note in caught.value.__notes__)


class Row(asp.System):
    """Blocks on a line that do not meet, written out as one block of velocities."""

    def __init__(self, count):
        self.dof = count
        self.calls = {"mass": 0, "direction": 0}
        self.contacts = [asp.ContactLaw(LINE, normal_force=1.0 + i) for i in range(count)]

    def mass(self, q):
        self.calls["mass"] += 1
        return np.diag(1.0 + np.arange(self.dof))

    def forces(self, t, q, u):
        return np.sin(t + np.arange(self.dof)) * (1.0 + np.arange(self.dof))

    def direction(self, t, q, contact):
        self.calls["direction"] += 1
        return np.eye(self.dof)[:, [contact]]


class RowInBlocks(Row):
    """The same, block by block."""

    @property
    def blocks(self):
        return [1] * self.dof

    def block_mass(self, q, block):
        self.calls["mass"] += 1
        return np.array([[1.0 + block]])

    def touched(self, contact):
        return [contact]

    def direction(self, t, q, contact):
        self.calls["direction"] += 1
        return np.eye(1)


class ConstantRow(RowInBlocks):
    """The same again, with what never changes."""

    constant_mass = True
    constant_contacts = True


def test_a_system_in_blocks_moves_as_the_same_in_one():
    runs = [
        asp.simulate(kind(7), dt=1e-2, t_end=3.0, u0=np.linspace(-1.0, 1.0, 7))
        for kind in (Row, RowInBlocks, ConstantRow)
    ]
    assert {1, 2} <= set(runs[0].phase[1:].ravel().tolist())
    for run in runs[1:]:
        np.testing.assert_array_equal(run.phase, runs[0].phase)
        np.testing.assert_allclose(run.q, runs[0].q, atol=1e-13)
        np.testing.assert_allclose(run.force, runs[0].force, atol=1e-12)


class Turning(asp.System):
    """A wheel with friction, its attitude as cosine and sine."""

    dof = 1
    coordinates = 2
    contacts = (asp.ContactLaw(LINE, normal_force=0.2),)

    def mass(self, q):
        return np.eye(1)

    def forces(self, t, q, u):
        return -q[1:]

    def direction(self, t, q, contact):
        return np.eye(1)

    def advance(self, q, u, dt):
        sine, cosine = np.sin(dt * u[0]), np.cos(dt * u[0])
        return np.array([cosine * q[0] - sine * q[1], sine * q[0] + cosine * q[1]])


class Angle(Turning):
    """The same with the angle as its coordinate."""

    coordinates = None
    advance = asp.System.advance

    def forces(self, t, q, u):
        return -np.sin(q)


def test_a_system_may_advance_its_own_coordinates():
    options = {"dt": 1e-2, "t_end": 8.0, "u0": [2.5]}
    run = asp.simulate(Turning(), q0=[np.cos(0.3), np.sin(0.3)], **options)
    angle = asp.simulate(Angle(), q0=[0.3], **options)
    np.testing.assert_allclose(run.q, np.hstack([np.cos(angle.q), np.sin(angle.q)]), atol=1e-12)
    np.testing.assert_allclose(run.u, angle.u, atol=1e-12)


class Thrown(asp.System):
    """A mass above a floor, with every method that a system may have but `advance`."""

    dof = 2
    blocks = (1, 1)
    contacts = (asp.ContactLaw(LINE),)

    def block_mass(self, q, block):
        return np.eye(1)

    def touched(self, contact):
        return [0, 1]

    def forces(self, t, q, u):
        return np.array([0.0, -9.81])

    def direction(self, t, q, contact):
        return np.array([[1.0], [0.0]])

    def velocity(self, t, q, contact):
        return np.zeros(1)

    def normal(self, t, q, contact):
        return np.array([0.0, 1.0])

    def gap(self, t, q, contact):
        return q[1]


class InOne(Thrown):
    """The same without blocks."""

    blocks = None
    block_mass, touched = asp.System.block_mass, asp.System.touched

    def mass(self, q):
        return np.eye(2)


class Advancing(Thrown):
    """The same, advanced by itself."""

    def advance(self, q, u, dt):
        return q + dt * u


FAULTS = {
    "raises": (ZeroDivisionError, "in the user's code"),
    "nan": (asp.ParameterError, "{}: must return finite numbers"),
    "shape": (asp.DimensionError, "{}: must return shape"),
    "none": (asp.ParameterError, "{}: must return numbers, returned None"),
    "words": (asp.ParameterError, "{}: must return numbers, returned nothing"),
}


VALUES = {"shape": np.zeros((3, 3)), "none": None, "words": "nothing"}


def spoiled(kind, method, fault):
    """Return a system of which one method fails from the beginning."""
    right = getattr(kind, method)

    def wrong(*arguments):
        if fault == "raises":
            raise ZeroDivisionError("in the user's code")
        if fault in VALUES:
            return VALUES[fault]
        return np.nan * np.asarray(right(*arguments))

    # The signature is checked when the class is defined.
    wrong.__signature__ = inspect.signature(right)
    return type("Spoiled", (kind,), {method: wrong})()


METHODS = [
    (InOne, "mass"),
    (Thrown, "block_mass"),
    (Thrown, "touched"),
    (Thrown, "forces"),
    (Thrown, "direction"),
    (Thrown, "velocity"),
    (Thrown, "normal"),
    (Thrown, "gap"),
]


# `integrate` refuses systems that advance themselves.
@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize(
    ("kind", "method", "run"),
    [
        *((kind, method, run) for kind, method in METHODS for run in ("simulate", "integrate")),
        (Advancing, "advance", "simulate"),
    ],
)
def test_what_fails_in_a_method_is_what_is_reported(kind, method, fault, run):
    system = spoiled(kind, method, fault)
    error, message = FAULTS[fault]
    if method == "touched" and fault != "raises":
        error, message = asp.ParameterError, "{}: must return numbers of blocks"
    options = {"dt": 0.1} if run == "simulate" else {}
    with pytest.raises(error, match=message.format(method)) as caught:
        getattr(asp, run)(system, t_end=1.0, q0=[0.0, 0.0], **options)
    if method == "touched":
        return
    # The part before is there, whether or not it has a sample.
    part = caught.value.trajectory
    assert part.q.shape[1:] == part.u.shape[1:] == (2,)
    assert part.slip.shape[1:] == (1, 1)
    assert f"{len(part)} sample" in repr(part)
    when = "after t = 0 s" if len(part) else "at the start"
    assert any(when in note for note in caught.value.__notes__)


def test_every_system_takes_another_law():
    rough, smooth = asp.FrictionLaw.isotropic(0.6), asp.FrictionLaw.isotropic(0.1)
    belt = {"stiffness": 1.0, "normal_force": 1.0, "belt_velocity": [0.1, 0.0]}
    for system, other in (
        (asp.SlidingPoint(1.0, law=rough), asp.SlidingPoint(1.0, law=smooth)),
        (asp.MassOnBelt(1.0, law=rough, **belt), asp.MassOnBelt(1.0, law=smooth, **belt)),
        (asp.SlidingDisk(rough), asp.SlidingDisk(smooth)),
    ):
        assert system.with_law(smooth) == other
    contacts = [asp.Contact(law, direction=np.eye(2), normal_force=1.0) for law in (rough, rough)]
    linear = asp.LinearSystem(1.0, contacts=contacts)
    assert [one.law for one in linear.with_law(smooth, contacts=1).contacts] == [rough, smooth]
    with pytest.raises(asp.ParameterError, match="contacts"):
        linear.with_law(smooth, contacts=2)
    with pytest.raises(asp.DimensionError, match="law: must have 2"):
        linear.with_law(asp.FrictionLaw.isotropic(0.1, dimension=1))
