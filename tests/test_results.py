"""What all results have in common: summaries, pictures, tables, files."""

import math
import re
import warnings
from xml.etree import ElementTree

import asperity as asp
import matplotlib.pyplot as plt
import numpy as np
import pytest
from asperity import mechanisms
from asperity._base.result import Result, TableResult
from asperity._base.storage.result_file import SavedResult
from public_calls import (
    CYCLE,
    DIAGRAM,
    FILM,
    FIT,
    LAW_SHEET,
    PATCH,
    PATH_FIT,
    PREDICTION,
    PROBLEM,
    PUSHES,
    SPARSE,
    SQUEAL_SHEET,
    STABILITY_SHEET,
    TRIANGLE,
)
from samples import ALL_SETS, LAWS, PLANE_LAWS, identify, public_of
from scipy import sparse

pandas = pytest.importorskip("pandas")
xarray = pytest.importorskip("xarray")

LAW = PLANE_LAWS[3]
POINT = asp.SlidingPoint(1.0, law=LAW)
BELT = asp.MassOnBelt(1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=[0.1, 0.2])
HALF = (0.1, 0.1, 0.1)


def boxes(**options):
    """Return a run of two boxes on a plane."""
    bodies = [
        asp.Body.box(
            1.0, half_sizes=HALF, position=(0.3 * k, 0.0, 0.1), velocity=(0.5, 0.0, 0.0), name=name
        )
        for k, name in enumerate(("left", "right"))
    ]
    pairs = [
        asp.BoxPlane(0, half_sizes=HALF, plane=asp.Plane(), law=asp.FrictionLaw.isotropic(0.3)),
        asp.BoxPlane(1, half_sizes=HALF, plane=asp.Plane(), law=LAW, name="foot"),
    ]
    return asp.simulate(asp.RigidBodies(bodies, pairs=pairs), dt=1e-3, t_end=0.02, **options)


RUN = boxes()
MOTION = asp.integrate(POINT, t_end=1.0, u0=[1.0, 0.2])
RESULTS = [
    RUN,
    asp.simulate(
        asp.LinearSystem(np.eye(2), stiffness=np.eye(2)), dt=0.1, t_end=1.0, q0=[1.0, 0.0]
    ),
    asp.simulate(asp.SlidingDisk(LAW, velocity=(1.0, 0.0)), dt=1e-3, t_end=0.02),
    MOTION,
    CYCLE,
    asp.simulate_many(BELT, dt=0.1, t_end=1.0, u0=[[0.0, 0.0], [0.1, 0.0]], keep=5),
    asp.limit_cycle_many(mechanisms.stribeck_block()),
    DIAGRAM,
    asp.stability(BELT),
    asp.stability(BELT, near=1.0, count=2),
    asp.equilibrium(BELT),
    asp.squeal_map(SPARSE, parameters={"friction": [0.5, 1.0]}, band=(0.0, 5.0)),
    asp.system.FiniteElementModel(
        sparse.identity(3, format="csc"),
        sparse.identity(3, format="csc"),
        np.array([4, 4, 4]),
        np.arange(3),
        {4: (0.0, 0.0, 0.1)},
        {"CONTACT": (4,)},
        ("Its damping is not in the files.",),
    ),
    asp.critical_directions(asp.FrictionLaw(asp.Ellipse(3.0, 1.0, angle=0.5), asp.Ellipse(3, 1))),
    asp.critical_rotation(asp.Ellipse(3.0, 1.0), asp.Ellipse(3.0, 1.0)),
    asp.critical_rotation(asp.Disk(1.0), asp.Ellipse(3.0, 1.0)),
    asp.growth_chart(BELT, phi=np.linspace(0.0, 1.0, 5), zeta=[0.0, 0.5]),
    asp.growth_chart(BELT, phi=0.1),
    PROBLEM.solve(),
    asp.compare_path(RUN, RUN),
    FIT,
    asp.identify.compare_laws(FIT, FIT),
    PATH_FIT,
    PATCH,
    PATCH.compare({"ellipsoid": PATCH.model}),
    asp.identify.fit_supports(PUSHES, TRIANGLE, weight=10.0),
    FILM,
    FILM.path(),
    PREDICTION,
    LAW_SHEET,
    STABILITY_SHEET,
    SQUEAL_SHEET,
    asp.sweeps.SweepStatus(points=100, done=40, failed=1, seconds_left=200.0, idle=3.0),
    asp.sweeps.SweepStatus(points=100, done=0, failed=0, seconds_left=float("nan"), idle=3.0),
]
TABLES = [result for result in RESULTS if isinstance(result, TableResult)]
SAVED = [result for result in RESULTS if hasattr(result, "save")]


def named(result):
    return type(result).__name__


def public_results():
    modules = (asp, asp.identify, asp.track, asp.mechanisms, asp.predict, asp.problems)
    names = (one for module in modules for one in public_of(module).values())
    return {one for one in names if isinstance(one, type) and issubclass(one, Result)}


def test_every_public_result_is_tested():
    assert public_results() == {type(result) for result in RESULTS}


@pytest.mark.parametrize("result", RESULTS, ids=named)
def test_summaries_are_sentences_and_representations_one_line(result):
    text = result.summary()
    assert text[0].isupper() or text[0].isdigit()
    assert text.endswith(".")
    assert not re.search(r"\bnan\b|\binf\b|None|np\.float|array\(", text)
    line = repr(result)
    assert line.startswith(f"<{named(result)}: ") or named(result) in ("Equilibrium",)
    assert "\n" not in line


@pytest.mark.parametrize("result", RESULTS, ids=named)
def test_notebooks_show_results_without_a_display(result):
    before = plt.get_fignums()
    page = ElementTree.fromstring(
        result._repr_html_().replace("<br>", "<br/>").replace('%">', '%"/>')
    )
    assert page.tag == "div"
    assert page.find("p").text
    assert plt.get_fignums() == before


def test_pictures_are_drawn_where_there_is_something_to_draw():
    drawn = [named(result) for result in RESULTS if "<img" in result._repr_html_()]
    for kind in ("Trajectory", "Motion", "LimitCycle", "BifurcationDiagram", "Fit", "Track"):
        assert kind in drawn


@pytest.mark.parametrize("value", [*ALL_SETS, *LAWS], ids=identify)
def test_notebooks_show_sets_and_laws_of_the_plane(value):
    picture = value._repr_svg_()
    assert (picture is not None) == (value.dimension == 2)
    if picture is not None:
        assert ElementTree.fromstring(picture).tag.endswith("svg")


@pytest.mark.parametrize("result", TABLES, ids=named)
def test_all_tables_are_one(result, tmp_path):
    """The file, the data frame and the arrays hold the same numbers under the same names."""
    frame, dataset = result.to_pandas(), result.to_xarray()
    result.to_csv(tmp_path / "table.csv")
    with (tmp_path / "table.csv").open() as file:
        header = file.readline()
    assert len(set(frame.columns)) == frame.shape[1]
    read = pandas.read_csv(tmp_path / "table.csv", keep_default_na=True)
    assert list(read.columns) == [frame.index.name, *frame.columns], header
    for name in frame.columns:
        assert not re.search(r"\d_\d|\[SI\]\]", name)
        if len(frame) and frame[name].dtype.kind == "f":
            np.testing.assert_allclose(read[name], frame[name], rtol=1e-9)
    assert len(dataset[next(iter(dataset.dims))]) == len(frame)
    for series in dataset.data_vars.values():
        assert series.attrs["long_name"]


@pytest.mark.parametrize("result", TABLES, ids=named)
def test_arrays_open_again_from_netcdf(result, tmp_path):
    dataset = result.to_xarray()
    dataset.to_netcdf(tmp_path / "result.nc")
    with xarray.open_dataset(tmp_path / "result.nc") as read:
        for name, series in dataset.data_vars.items():
            np.testing.assert_array_equal(read[name].values, series.values)
            assert read[name].attrs.get("units") == series.attrs.get("units")
        for name in dataset.coords:
            np.testing.assert_array_equal(read[name].values, dataset[name].values)


def test_a_run_of_named_boxes_has_names_and_units(tmp_path):
    RUN.to_xarray().to_netcdf(tmp_path / "run.nc")
    with xarray.open_dataset(tmp_path / "run.nc") as read:
        height = read.q.sel(coordinate="left z")
        assert float(height[0]) == 0.1
        assert str(height.coordinate_unit.values) == "m"
        assert read.u.sel(velocity="right omega3").velocity_unit == "rad/s"
        assert read.force.attrs == {"units": "N", "long_name": "friction force on the body"}
        assert read.t.attrs["units"] == "s"
        assert read.contact.values[[0, 15]].tolist() == ["left on plane corner 0", "foot corner 7"]
        assert read.phase.attrs["flag_meanings"] == "none open stick slip"
    assert "foot corner 7 force 1 [N]" in RUN.to_pandas().columns
    assert RUN.coordinate_names[2:4] == ("left z", "left qw")
    assert RUN.coordinate_units[2:4] == ("m", "-")


def test_a_diagram_plots_in_two_lines():
    frame = DIAGRAM.to_pandas()
    ax = frame.plot(y=["x1 cycle minimum [m]", "x1 cycle maximum [m]"])
    assert ax.get_xlabel() == "speed"
    plt.close("all")


@pytest.mark.parametrize("result", SAVED, ids=named)
def test_saving_and_loading_is_the_identity(result, tmp_path):
    path = tmp_path / "result.npz"
    result.save(path)
    read = type(result).load(path)
    assert read == result
    assert read.to_pandas().equals(result.to_pandas())
    with np.load(path, allow_pickle=False) as file:
        assert all(array.dtype != object for array in file.values())


@pytest.mark.parametrize("run", [r for r in RESULTS if isinstance(r, asp.runs.run.Run)], ids=named)
def test_a_loaded_run_is_repeated_to_the_bit(run, tmp_path):
    run.save(tmp_path / "run.npz")
    read = type(run).load(tmp_path / "run.npz")
    assert read.origin == run.origin
    assert read.labels == run.labels
    again = read.repeat()
    for name in ("t", "q", "u", "force"):
        np.testing.assert_array_equal(getattr(again, name), getattr(run, name))
    assert again == run
    assert read.slice(0.0, 0.01).repeat() == run


def test_a_continued_run_is_repeated_from_where_it_began(tmp_path):
    first = boxes()
    second = asp.simulate(
        first.system, dt=1e-3, t_end=0.03, start=first, solver=asp.Exact(), sample_every=3e-3
    )
    second.save(tmp_path / "run.npz")
    read = asp.Trajectory.load(tmp_path / "run.npz")
    assert read.options.solver == asp.Exact()
    assert read.repeat() == second


def test_a_run_is_repeated_with_another_system():
    other = POINT.replace(mass=2.0)
    assert MOTION.repeat(system=other) == asp.integrate(other, t_end=1.0, u0=[1.0, 0.2])


def test_signals_are_saved_with_the_run(tmp_path):
    shaken = asp.Plane(
        motion=asp.PlaneMotion(displacement=asp.Sine([1e-4, 0.0, 0.0], frequency=50.0))
    )
    loads = asp.Signal([0.0, 0.5, 1.0], np.eye(3), interpolation="cubic")
    system = asp.RigidBodies(
        [asp.Body.ball(1.0, radius=0.1, position=(0.0, 0.0, 0.1), force=loads)],
        pairs=[
            asp.SpherePlane(
                0, radius=0.1, plane=shaken, law=LAW, frame=asp.BodyAxis((1.0, 0.0, 0.0))
            )
        ],
        springs=[
            asp.Spring(
                0,
                point=(0.0, 0.0, 0.0),
                stiffness=2.0,
                length=asp.Sine(0.1, frequency=1.0, offset=0.2),
            )
        ],
    )
    run = asp.simulate(system, dt=1e-3, t_end=0.02)
    run.save(tmp_path / "run.npz")
    read = asp.Trajectory.load(tmp_path / "run.npz")
    assert read.system == system
    assert read.repeat() == run


def test_a_system_that_is_no_data_is_left_out_and_the_file_says_why(tmp_path):
    class Own(asp.System):
        dof = 1

        def mass(self, q):
            return np.eye(1)

        def forces(self, t, q, u):
            return -q

    pushed = asp.RigidBodies(
        [asp.Body.ball(1.0, radius=0.1, force=lambda t: (t, 0.0, 0.0), name="ball")]
    )
    for system, words in ((pushed, "bodies[0].force is a function"), (Own(), "of the class Own")):
        run = asp.simulate(system, dt=0.1, t_end=1.0, q0=None if system is pushed else [1.0])
        with pytest.warns(UserWarning, match=re.escape(words)):
            run.save(tmp_path / "run.npz")
        read = asp.Trajectory.load(tmp_path / "run.npz")
        assert read == run
        assert read.system is None
        assert words in read.summary()
        with pytest.raises(asp.ParameterError, match=re.escape(words)) as caught:
            read.repeat()
        assert caught.value.argument == "system"
        assert read.repeat(system=system) == run
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            read.save(tmp_path / "again.npz")
        assert words in asp.Trajectory.load(tmp_path / "again.npz").origin.note


@pytest.mark.parametrize("name", ["", " ", "a\nb", "tab\t", "blank ", "\x00", 3, b"bytes"])
def test_names_stand_on_one_line(name):
    makers = (
        lambda: asp.Body.ball(1.0, radius=0.1, name=name),
        lambda: asp.PlanarBody(1.0, inertia=0.1, name=name),
        lambda: asp.SpherePlane(0, radius=0.1, plane=asp.Plane(), law=LAW, name=name),
        lambda: asp.Contact(LAW, direction=np.eye(2), normal_force=1.0, name=name),
        lambda: asp.ContactLaw(LAW, name=name),
    )
    for make in makers:
        with pytest.raises(asp.ParameterError) as caught:
            make()
        assert caught.value.argument == "name"
    with pytest.raises(asp.ParameterError) as caught:
        asp.LinearSystem(1.0, coordinate_names=[name])
    assert caught.value.argument == "coordinate_names"


def test_names_are_unique():
    ball = asp.Body.ball(1.0, radius=0.1, name="Kugel ⌀ 0,1")
    touching = asp.SpherePlane(0, radius=0.1, plane=asp.Plane(), law=LAW, name="Fuß, links")
    with pytest.raises(asp.ParameterError, match="'Kugel ⌀ 0,1' is given twice"):
        asp.RigidBodies([ball, ball])
    with pytest.raises(asp.ParameterError, match="'Fuß, links' is given twice"):
        asp.RigidBodies([ball], pairs=[touching, touching])
    with pytest.raises(asp.ParameterError, match="coordinate_names"):
        asp.LinearSystem(np.eye(2), coordinate_names=["x", "x"])
    contact = asp.Contact(LAW, direction=np.eye(2), normal_force=1.0, name="pad")
    with pytest.raises(asp.ParameterError, match="'pad' is given twice"):
        asp.LinearSystem(np.eye(2), contacts=[contact, contact])


def test_strange_names_come_back_from_all_tables(tmp_path):
    """Commas, quotes and letters of other alphabets are allowed in names."""
    ball = asp.Body.ball(1.0, radius=0.1, position=(0.0, 0.0, 0.1), name='Kugel "⌀", links')
    system = asp.RigidBodies(
        [ball], pairs=[asp.SpherePlane(0, radius=0.1, plane=asp.Plane(), law=LAW)]
    )
    run = asp.simulate(system, dt=0.01, t_end=0.1)
    run.to_csv(tmp_path / "run.csv")
    read = pandas.read_csv(tmp_path / "run.csv")
    assert read.columns[1] == 'Kugel "⌀", links x [m]'
    run.to_xarray().to_netcdf(tmp_path / "run.nc")
    with xarray.open_dataset(tmp_path / "run.nc") as dataset:
        assert dataset.coordinate.values.tolist() == list(run.coordinate_names)
    run.save(tmp_path / "run.npz")
    assert asp.Trajectory.load(tmp_path / "run.npz").labels == run.labels


@pytest.mark.parametrize(
    ("names", "units"),
    [
        (("x", "x_dot"), None),
        (("t", "x"), ("s", "m")),
        (("iterations", "residual"), ("-", "-")),
        (("contact 0 normal force", "contact 0 slip 1"), ("N", "m/s")),
    ],
)
def test_names_hide_no_column(names, units, tmp_path):
    """Coordinates may be called what a velocity or a force is called."""
    contact = asp.Contact(LAW, direction=np.eye(2), normal_force=1.0)
    system = asp.LinearSystem(
        np.eye(2), stiffness=np.eye(2), contacts=[contact], coordinate_names=names,
        coordinate_units=units,
    )  # fmt: skip
    for run in (
        asp.simulate(system, dt=0.1, t_end=0.5, q0=[0.1, 0.2], u0=[1.0, 0.5]),
        asp.integrate(system, t_end=0.5, q0=[0.1, 0.2], u0=[1.0, 0.5]),
    ):
        frame = run.to_pandas()
        series = run.to_xarray().data_vars.values()
        assert frame.shape[1] == sum(math.prod(one.shape[1:]) for one in series)
        assert frame.index.name == "t [s]"
        unit = run.velocity_units[0]
        title = f"{names[0]}_dot [{unit}]"
        words = f"u {title}" if f"u {title}" in frame else title
        np.testing.assert_array_equal(frame[words], run.u[:, 0])
        np.testing.assert_array_equal(frame["contact 0 normal force [N]"], run.normal_force[:, 0])
        run.to_csv(tmp_path / "run.csv")
        assert pandas.read_csv(tmp_path / "run.csv").shape[1] == 1 + frame.shape[1]


def test_unnamed_parts_have_names_of_their_own():
    balls = [asp.Body.ball(1.0, radius=0.1, position=(k, 0.0, 0.1)) for k in (0.0, 1.0)]
    pairs = [
        asp.SpherePlane(0, radius=0.1, plane=asp.Plane(), law=LAW),
        asp.PointPlane(0, point=(0.0, 0.0, -0.1), plane=asp.Plane(), law=LAW),
        asp.SphereSphere(0, radius=0.1, other=1, other_radius=0.1, law=LAW),
        asp.PointPlane(1, point=(0.0, 0.0, 0.0), plane=asp.Plane(body=0), law=LAW),
    ]
    assert asp.RigidBodies(balls, pairs=pairs).labels.contacts == (
        "body 0 on plane 0",
        "body 0 on plane 1",
        "body 0 on body 1",
        "body 1 on body 0",
    )


def test_systems_of_the_user_have_names():
    class Own(asp.System):
        dof = 1
        contacts = (
            asp.ContactLaw(
                asp.FrictionLaw.isotropic(0.3, dimension=1), normal_force=1.0, name="slider"
            ),
        )
        coordinate_names = ("stroke",)
        coordinate_units = ("m",)

        def mass(self, q):
            return np.eye(1)

        def forces(self, t, q, u):
            return -q

        def direction(self, t, q, contact):
            return np.eye(1)

    run = asp.simulate(Own(), dt=0.1, t_end=1.0, q0=[1.0])
    assert list(run.to_pandas().columns[:3]) == [
        "stroke [m]",
        "stroke_dot [m/s]",
        "slider slip 1 [m/s]",
    ]


def test_errors_call_contacts_by_their_names():
    with pytest.raises(asp.ConvergenceError) as caught:
        boxes(tolerance=1e-300)
    name = caught.value.trajectory.contact_names[caught.value.contact]
    assert f"contact {caught.value.contact}, {name!r}" in str(caught.value)


def test_long_runs_show_in_no_time():
    """A picture has pixels, however many samples there are."""
    n = 100_001
    t = np.linspace(0.0, 1.0, n)
    q = np.stack([np.cos(900.0 * t), np.sin(900.0 * t)], axis=-1)
    none = np.zeros((n, 0, 2))
    run = asp.Motion(
        t, q, q, none, none, none[..., 0], none[..., 0], events=(), status="finished", steps=n,
        rejected_steps=0,
    )  # fmt: skip
    assert len(run._repr_html_()) < 500_000
    assert "100001 samples" in run.summary()


def test_many_parts_show_in_no_time():
    """A picture has the first of them, a summary says that there are more."""
    contacts = [
        asp.Contact(asp.FrictionLaw.isotropic(0.3), direction=np.eye(2), normal_force=0.01)
        for _ in range(500)
    ]
    run = asp.simulate(
        asp.LinearSystem(np.eye(2), contacts=contacts), dt=0.1, t_end=0.2, solver=asp.ProxJacobi(),
        on_failure="record",
    )  # fmt: skip
    assert len(run._repr_html_()) < 500_000
    assert "the other 492 contacts" in run.summary()


def test_runs_without_samples_have_all_of_it(tmp_path):
    none = np.zeros((0, 1, 1))
    empty = asp.Motion(
        [], none[..., 0], none[..., 0], none, none, none[..., 0], none[..., 0], events=(),
        status="failed", steps=0, rejected_steps=0,
    )  # fmt: skip
    assert "before the first sample" in empty.summary()
    assert empty._repr_html_()
    empty.save(tmp_path / "run.npz")
    assert asp.Motion.load(tmp_path / "run.npz") == empty
    assert empty.to_pandas().shape == (0, 6)
    assert empty.to_xarray().sizes["t"] == 0


def test_descriptions_that_are_wrong_are_refused_by_their_place(tmp_path):
    path = tmp_path / "run.npz"
    RUN.save(path)
    with np.load(path) as file:
        fields = dict(file)
    content = str(fields["content"])
    for text, argument in (
        (content.replace('"mass"', '"mas"', 1), "origin.system.bodies[0].mas"),
        (content.replace('"Body"', '"Bodi"', 1), "origin.system.bodies[0].type"),
        (content.replace('"dt": 0.001', '"dt": -1', 1), "dt"),
        (content.replace("left x", "left y", 1), "labels.coordinates"),
        (content[:-1], "content"),
        ("[" * 100_000, "content"),
        ("3", "content"),
        (3, "content"),
    ):
        np.savez(path, **{**fields, "content": text})
        with pytest.raises(asp.ParameterError) as caught:
            asp.Trajectory.load(path)
        assert caught.value.argument == argument
        assert str(path) in str(caught.value)


ARCHIVED = [one for one in SAVED if isinstance(one, SavedResult)]


@pytest.mark.parametrize("result", ARCHIVED, ids=named)
def test_damaged_results_are_refused(result, tmp_path):
    path = tmp_path / "result.npz"
    result.save(path)
    with np.load(path) as file:
        fields = dict(file)
    arrays = fields.keys() - {"format", "version", "content"}
    content = str(fields["content"])
    for change in (
        {"content": None},
        {"format": 99},
        {"format": "one"},
        {"content": "{}"},
        {"content": content.replace(named(result), "Body", 1)},
        {"more": np.zeros(3)},
        *({array: None} for array in arrays),
    ):
        kept = {key: value for key, value in {**fields, **change}.items() if value is not None}
        np.savez(path, **kept)
        with pytest.raises(asp.ParameterError, match=re.escape(str(path))) as caught:
            type(result).load(path)
        assert caught.value.argument == next(iter(change))


def test_a_loaded_fit_is_the_same_to_the_bit(tmp_path):
    campaign = asp.identify.VirtualTribometer(LAW, normal_force=10.0, turns=4, sample_rate=200.0)
    measured = asp.identify.process(campaign.record(), grid_angle=0.2)
    phi, rng = np.linspace(0.0, 4.0 * np.pi, 60, endpoint=False), np.random.default_rng(0)
    few = (
        phi,
        -LAW.force(np.stack([np.cos(phi), np.sin(phi)], axis=-1))
        + rng.normal(scale=1e-3, size=(60, 2)),
    )
    turn = np.repeat([0, 1], 30).astype(np.int16)
    fourier = asp.identify.FourierReservoir(2, odd=False)
    for data, options in (
        (measured, {"loss": "huber"}),
        (measured, {"reservoir": fourier, "direction": "best", "confidence": 0.9}),
        ((*few, turn), {"reservoir": "circle", "direction": "ellipse", "joint": False}),
        (few, {"reservoir": "ellipse", "direction": "circle", "confidence": None}),
    ):
        fit = asp.identify.fit_law(data, **options)
        fit.save(tmp_path / "fit.npz")
        read = asp.identify.Fit.load(tmp_path / "fit.npz")
        assert read == fit
        assert read.summary() == fit.summary()
        assert read.identified_law == fit.identified_law
        for mine, other in zip(fit.means, read.means, strict=True):
            assert np.array_equal(mine, other)
        assert np.array_equal(read.residuals, fit.residuals)
        assert read.to_pandas().equals(fit.to_pandas())
        assert read.missing.keys() == fit.missing.keys()
        assert read.comparison == fit.comparison


def test_what_a_fit_cannot_be_saved_with_is_named(tmp_path):
    class Own:
        phi, force, normal_force, turn = FIT.data.phi, FIT.data.force, FIT.data.normal_force, None

    Own.turn = FIT.data.turn
    fit = asp.identify.fit_law(Own(), reservoir="circle", direction="circle")
    with pytest.raises(asp.ParameterError, match=r"data: .*the class Own"):
        fit.save(tmp_path / "fit.npz")
    assert not list(tmp_path.iterdir())


def test_files_of_other_results_are_called_so(tmp_path):
    for made in (RUN, MOTION, *ARCHIVED):
        made.save(tmp_path / "result.npz")
        for wanted in {type(one) for one in (RUN, MOTION, *ARCHIVED)} - {type(made)}:
            with pytest.raises(asp.ParameterError, match=rf"must be .*{wanted.__name__}"):
                wanted.load(tmp_path / "result.npz")


def test_a_run_whose_system_is_nested_too_deeply_is_saved_without_it(tmp_path):
    one = asp.Ellipse(0.5, 0.3)
    for depth in range(1, 60):
        one = one | asp.Disk(0.1) if depth % 2 else one & asp.Disk(0.6)
        if depth < 44:
            continue
        point = asp.SlidingPoint(1.0, law=asp.FrictionLaw.collinear(one))
        run = asp.simulate(point, dt=0.1, t_end=0.1, u0=[1.0, 0.0])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            run.save(tmp_path / "run.npz")
        read = asp.Trajectory.load(tmp_path / "run.npz")
        assert read == run
        if read.system is None:
            assert "must not be nested" in read.summary()
        else:
            assert read.repeat() == run
    assert read.system is None


def test_a_slice_does_not_end_where_its_run_does_not():
    for run in (RUN, MOTION):
        words = run.slice(0.0, 0.0).summary()
        assert words.startswith("The run went on to its end. It has 1 sample")
        assert "up to t = 0 s." in words


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("q", lambda values: values + 1j),
        ("t", lambda values: values.astype(str)),
        ("phase", lambda values: values + 0.5),
        ("phase", lambda values: np.where(values > 9, values, np.inf)),
        ("phase", lambda values: values.astype(int) + 256),
        ("iterations", lambda values: values + np.nan),
    ],
)
def test_runs_hold_numbers_of_their_kind(name, change):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(asp.ParameterError, match=f"{name}: must hold"):
            RUN.replace(**{name: change(getattr(RUN, name))})


def test_multipliers_of_a_cycle_are_a_list():
    with pytest.raises(asp.DimensionError, match="multipliers"):
        CYCLE.replace(multipliers=[[0.5]])


@pytest.mark.parametrize("library", ["pandas", "xarray"])
def test_missing_libraries_are_named_with_their_extra(library, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ImportError, match=rf"asperity\[{library}\]"):
        getattr(RUN, f"to_{library}")()
