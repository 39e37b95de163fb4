"""Every public function, class and method that takes numbers, with arguments that are valid."""

import enum
import inspect
import math
import re
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import asperity as asp
import mujoco as mj
import numpy as np
import scipy.sparse
import virtual_strokes
from asperity import identify, mechanisms, mujoco, plot, predict, problems, track
from asperity.contact import files, grading
from asperity.system import FiniteElementModel
from filmed import RUN, SMALL
from matplotlib.figure import Figure
from samples import public_of
from test_values import CYCLE, VALUES

MODULES = (
    asp,
    identify,
    track,
    problems,
    problems.scenes,
    mechanisms,
    mujoco,
    plot,
    predict,
    grading,
    files,
)
_NUMBERS = re.compile(
    r"\bfloat\b|\bint\b|\bArrayLike\b|\bArray\b|\bNDArray\b|\bTimeFunction\b|\bVector[23]?\b"
    r"|\bChanging[123]\b|\bAnyArray(OrNone)?\b|\bPositive\b|\bNonNegative\b|\bNumber\b|\bFraction\b"
    r"|\bIndex\b|\bCount\b|\b_Length\b|\bVector\b|\bOptionalArray\b"
)

LAW = asp.FrictionLaw(asp.Ellipse(0.6, 0.2, angle=0.5), asp.Ellipse(3.0, 1.0))
LINE_LAW = asp.FrictionLaw.isotropic(0.3, dimension=1)
DISK = asp.Disk(0.5)
BELT = asp.MassOnBelt(1.0, stiffness=1.0, law=LAW, normal_force=1.0, belt_velocity=[0.1, 0.2])
PROBLEM = asp.ContactProblem(np.eye(3), free_velocity=[-1.0, 0.2, 3.0], laws=LAW)
PHI = np.arange(24) * np.pi / 12
UNIT = np.stack([np.cos(PHI), np.sin(PHI)], axis=-1)
PLANE = asp.Plane()
BALL = asp.Body.ball(1.0, radius=0.1, position=(0.0, 0.0, 0.1))
BODIES = asp.RigidBodies([BALL], pairs=[asp.SpherePlane(0, radius=0.1, plane=PLANE, law=LAW)])
MACHINE = identify.VirtualTribometer(
    LAW, normal_force=9.3, turns=2, turn_rate=0.5, sample_rate=250.0, no_load_time=1.0
)
RAW = MACHINE.record()
DATA = identify.process(RAW)
FIT = identify.fit_law(DATA)
STROKES = virtual_strokes.processed(virtual_strokes.records(1, compliance=1e-6, cycles=4))
TWISTS = np.random.default_rng(0).normal(size=(60, 3))
WRENCHES = -asp.FrictionLaw.associated(asp.CoulombContensou(0.3)).force(TWISTS)
PATCH = identify.fit_patch(WRENCHES, TWISTS)
TRIANGLE = 0.1 * UNIT[::8]
PUSHES = np.hstack([np.zeros_like(TWISTS), 0.01 * TWISTS, WRENCHES])
CAMERA = track.VirtualCamera(RUN.slice(0.0, 0.1), **SMALL)
FILM = track.track_mark(CAMERA.frames(), fps=CAMERA.fps, scene=CAMERA.view, mark=CAMERA.mark)
SLIDING = asp.SlidingPoint(1.0, law=asp.FrictionLaw.isotropic(0.4))
PATHS = [asp.simulate(SLIDING, dt=0.01, t_end=0.4, u0=[speed, 0.2]) for speed in (1.0, 1.2, 1.4)]
ROUND = {"reservoir": "circle", "direction": "circle"}
LAUNCH = identify.Launch(
    place=(0.0, 0.0), place_error=1e-4, speed=1.2, speed_error=0.5, time=0.0, time_error=0.1
)
PATH_FIT = identify.fit_paths(
    PATHS, system=SLIDING, position_error=1e-4, length_error=0.01, **ROUND
)
RUNS = [
    identify.process(
        identify.VirtualTribometer.perfect(
            asp.FrictionLaw.isotropic(0.3),
            normal_force=load,
            turns=3,
            turn_rate=load / 10.0,
            sample_rate=200.0,
            radius=0.05,
        ).record()
    )
    for load in (5.0, 8.0, 12.0)
]
STICK_SLIP = mechanisms.stribeck_block()
DIAGRAM = next(one for one in VALUES if isinstance(one, asp.BifurcationDiagram))
RUN_OF_BODIES = asp.simulate(BODIES, dt=0.01, t_end=0.1)
FRAME = np.full((60, 80, 3), 120, dtype=np.uint8)
FRAME[20:40, 30:50] = 200, 30, 30
FOLDER = tempfile.TemporaryDirectory()
MATRIX = Path(FOLDER.name) / "one.mtx"
MATRIX.write_text("1 1 2.0\n2 2 3.0\n")
SCENARIO, _ = predict.write_example("sliding point", Path(FOLDER.name) / "scenario")
# As few laws as the confidence allows: every process of the tests draws them.
SCENARIO.write_text(re.sub("samples = [0-9]+", "samples = 40", SCENARIO.read_text()))
LAW_FILE = FIT.save_law(Path(FOLDER.name) / "law.toml")
PREDICTION = predict.simulate_scenario(SCENARIO, law=LAW_FILE, bands=True)
LAW_SHEET = predict.describe_law(LAW_FILE)
STABILITY_SHEET = predict.describe_stability(LAW_FILE)
SQUEAL = predict.write_example("squeal", Path(FOLDER.name) / "squeal")[0]
SQUEAL.write_text(SQUEAL.read_text().replace("certify = true", "certify = false"))
SQUEAL_SHEET = predict.describe_squeal(SQUEAL)
TABLE = Path(FOLDER.name) / "run.csv"
TABLE.write_text(
    "time,angle,tangential,radial,normal\n"
    + "".join(
        f"{t / 100.0},{t / 20.0},{math.cos(t)},{math.sin(t)},{9.0 + 0.1 * math.sin(t)}\n"
        for t in range(400)
    )
)
PROBLEMS = [
    PROBLEM.replace(tangential_restitution=0.1, initial_velocity=[-1.0, 0.2, 3.0]),
    asp.ContactProblem.from_bodies(
        np.eye(3), directions=np.eye(3), free_velocity=[-1.0, 0.2, 3.0], laws=LAW
    ),
    asp.ContactProblem(np.eye(2), free_velocity=[0.2, 3.0], laws=LAW, normal_force=1.0),
]


def _drawn(mu, rng):
    return mu + rng.normal()


MESH = {
    "coordinates": np.arange(6).reshape(2, 3),
    "positions": [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
    "rate": [0.0, 0.0, 3.0],
    "centre": [0.1, 0.2, 0.0],
}
SPARSE = asp.LinearSystem(
    scipy.sparse.identity(6),
    stiffness=scipy.sparse.diags_array([4.0, 5.0, 6.0, 7.0, 8.0, 9.0]),
    force=[0.0, 0.0, -1.0, 0.0, 0.0, -2.0],
    contacts=asp.MeshContacts.on_disc(LAW, **MESH),
)
REDUCED = asp.reduce(SPARSE, band=(0.0, 5.0))
CALCULIX = FiniteElementModel(
    mass=scipy.sparse.identity(3, format="csc"),
    stiffness=scipy.sparse.identity(3, format="csc"),
    nodes=np.array([4, 4, 4]),
    directions=np.arange(3),
    places={4: (0.0, 1.0, 2.0)},
    node_sets={"ALL": (4,)},
    findings=(),
)
BALL_MODEL = mj.MjModel.from_xml_string(
    '<mujoco><worldbody><body><freejoint/><geom size="1"/></body></worldbody></mujoco>'
)
BALL_DATA = mj.MjData(BALL_MODEL)
OBJECTS = [
    asp.ContactStepper([LAW]),
    mujoco.Scene(BALL_MODEL),
    mujoco.PairLaw(
        asp.FrictionLaw.associated(asp.Ellipsoid((0.4, 0.3, 0.2))),
        axis=(0.0, 1.0, 0.0),
        patch_radius=0.01,
        normal_restitution=0.5,
    ),
    SPARSE,
    REDUCED,
    asp.stability(SPARSE, near=3.0, count=2),
    CALCULIX,
    *PROBLEMS,
    BODIES,
    *VALUES,
    CYCLE,
    MACHINE,
    RAW,
    RAW.calibration,
    *RAW.recordings,
    DATA,
    DATA.averaged(),
    *DATA.turn_averages().values(),
    FIT,
    FIT.parameters["mu"] if "mu" in FIT.parameters else next(iter(FIT.parameters.values())),
    FIT.associativity,
    FIT.identified_law,
    identify.compare_laws(FIT, FIT),
    LAUNCH,
    PATH_FIT,
    PATCH,
    identify.Processing(),
    identify.CircleReservoir(),
    identify.FourierReservoir(3),
    identify.FourierDirection(4),
    identify.SuperellipseReservoir(2.0),
    identify.SuperellipseDirection(2.0),
    identify.MeasuredSets(PHI, 0.3 * UNIT),
    identify.load_dependence(RUNS),
    CAMERA,
    FILM,
    FILM.path(),
    CAMERA.view,
    CAMERA.mark,
    track.fit_circle(UNIT),
    problems.scenes.stack(2),
    mechanisms.FollowerPendulum(0.5),
    mechanisms.FrictionalImpactOscillator(0.5),
    LAW_SHEET,
    PREDICTION.bands.region,
]
"""Of several of one class the first is taken."""


ARGUMENTS = {
    # methods of sets, cones, laws
    "boundary": {"n": 8},
    "contains": {"x": [0.1, 0.1], "tolerance": 1e-9},
    "fenchel_gap": {"x": [0.1, 0.1], "y": [1.0, 0.0]},
    "gauge": {"x": [0.1, 0.1]},
    "gauge_gradient": {"x": [0.1, 0.1]},
    "indicator": {"x": [0.1, 0.1]},
    "mapped": {"matrix": np.eye(2)},
    "preimage": {"matrix": np.eye(2)},
    "normal_cone": {"x": [0.1, 0.1]},
    "tangent_cone": {"x": [0.1, 0.1]},
    "project": {"z": [1.0, 1.0]},
    "radius": {"theta": [0.1, 0.2]},
    "rotated": {"angle": 0.1},
    "scaled": {"factor": 2.0},
    "support": {"y": [1.0, 0.1]},
    "support_hessian": {"y": [1.0, 0.1]},
    "support_point": {"y": [1.0, 0.1]},
    "axis_angle": {"axis": [0.0, 0.0, 1.0], "angle": 0.3},
    "LinearSystem.with_law": {"law": LAW, "contacts": 0},
    "SparseLinearSystem.with_law": {"law": LAW},
    "MeshContacts.on_disc": {"law": LAW, **MESH},
    "FiniteElementModel.coordinates": {"nodes": "ALL"},
    "FiniteElementModel.positions": {"nodes": "ALL"},
    "PointPlane.cylinder": {
        "body": 0,
        "radius": 0.1,
        "height": 0.2,
        "plane": asp.Plane(),
        "law": LAW,
        "points": 12,
        "normal_restitution": 0.1,
        "tangential_restitution": 0.1,
    },
    "RigidBodies.with_law": {"law": LAW, "pairs": 0},
    "SlidingDisk.with_law": {"law": LAW, "pairs": None},
    "System.with_law": {"law": LINE_LAW, "contacts": 0},
    "mechanisms.FollowerPendulum.with_law": {"law": LINE_LAW, "contacts": 0},
    "mechanisms.FrictionalImpactOscillator.with_law": {"law": LINE_LAW, "contacts": 0},
    "predict.Belt": {"mass": 1.0, "stiffness": 2.0, "speed": 1.0, "normal_force": 1.0},
    "Cone.contains": {"y": [1.0, 0.1]},
    "predict.LawSheet.coefficients": {"step_deg": 30.0},
    "predict.Region.contains": {"x": [0.1, 0.1]},
    "predict.Region.outline": {"points": 8},
    "Cone.distance": {"y": [1.0, 0.1]},
    "Cone.project": {"y": [1.0, 0.1]},
    "Ellipse.from_intercepts": {"n1": 2.0, "n2": 1.0, "nu": 0.1},
    "star_shape": {"vertices": UNIT},
    "deflection": {"phi": PHI},
    "resistance": {"phi": PHI},
    "trace_criterion": {"phi": PHI},
    "force": {"slip": UNIT, "normal_force": 1.0},
    "dissipation": {"slip": UNIT, "normal_force": 1.0},
    "jacobian": {"slip": UNIT, "normal_force": 1.0},
    "slip_direction": {"force": 0.1 * UNIT, "normal_force": 1.0},
    "FrictionLaw.asperity": {"mu": 0.3, "beta": (0.2, 0.3), "weights": (0.5, 0.5)},
    "FrictionLaw.from_flow_rule": {"f": lambda phi: 0.3 * np.stack([np.cos(phi), np.sin(phi)], -1)},
    "FrictionLaw.from_samples": {"phi": PHI, "force": 0.3 * UNIT},
    "FrictionLaw.isotropic": {"mu": 0.3},
    "FrictionLaw.tensor": {"second_order": 0.3 * np.eye(2), "fourth_order": np.zeros((2, 2, 2, 2))},
    "Stribeck.__call__": {"speed": [0.1, 0.2]},
    # contact problems
    "ContactProblem.from_bodies": {
        "mass": np.eye(3),
        "directions": np.eye(3),
        "free_velocity": [-1.0, 0.2, 3.0],
        "laws": LAW,
        "bilateral": [[0.5], [1.0], [2.0]],
        "bilateral_velocity": [0.3],
    },
    "ContactStepper": {"laws": [LAW]},
    "ContactStepper.certificate": {},
    "ContactStepper.contact_problem": {},
    "ContactStepper.forget": {},
    "ContactStepper.solve": {
        "delassus": np.eye(4),
        "free_velocity": [0.4, -1.0, 0.2, 3.0],
        "items": [asp.ContactStepper.DRY_FRICTION, 0],
        "bounds": [0.1, 0.0],
        "keys": [3, 1],
    },
    "bilateral_percussion": {"percussion": [1.0, 0.0, 0.1]},
    "certificate": {"percussion": [1.0, 0.0, 0.1]},
    "natural_map": {"percussion": [1.0, 0.0, 0.1]},
    "contact.grading.natural_map": {"problem": PROBLEM, "percussion": [1.0, 0.0, 0.1]},
    "residual": {"percussion": [1.0, 0.0, 0.1]},
    "solutions": {"contact": 0},
    "solve": {},
    # systems and motions
    "Body.ball": {"mass": 1.0, "radius": 0.1},
    "Body.box": {"mass": 1.0, "half_sizes": (0.1, 0.2, 0.3)},
    "Body.cylinder": {"mass": 1.0, "radius": 0.1, "height": 0.2},
    "PlanarBody.box": {"mass": 1.0, "half_sizes": (0.1, 0.2)},
    "PlanarBody.disk": {"mass": 1.0, "radius": 0.1},
    "Signal.__call__": {"t": 0.5},
    "Signal.derivative": {"t": 0.5},
    "Signal.integral": {"start": 0.0, "end": 1.0},
    "Signal.breaks": {"start": 0.0, "end": 1.0},
    "Sine.__call__": {"t": 0.5},
    "Sine.derivative": {"t": 0.5},
    "Sine.integral": {"start": 0.0, "end": 1.0},
    "Sine.breaks": {"start": 0.0, "end": 1.0},
    "RigidBodies.angular_momentum": {"trajectory": RUN_OF_BODIES},
    "simulate": {
        "system": BELT,
        "dt": 0.1,
        "t_end": 1.0,
        "q0": [0.0, 0.0],
        "u0": [0.0, 0.0],
        "implicit": 0.5,
    },
    "integrate": {"system": BELT, "t_end": 1.0, "q0": [0.0, 0.0], "u0": [0.0, 0.0]},
    "limit_cycle": {"system": STICK_SLIP},
    "simulate_many": {
        "systems": BELT,
        "dt": 0.1,
        "t_end": 1.0,
        "q0": [0.0, 0.0],
        "u0": [[0.0, 0.0], [0.1, 0.0]],
    },
    "integrate_many": {"systems": BELT, "t_end": 1.0, "q0": [0.0, 0.0], "u0": [0.0, 0.0]},
    "limit_cycle_many": {"systems": STICK_SLIP},
    "Ensemble.repeat": {"index": 0},
    "Ensemble.system": {"index": 0},
    "CycleEnsemble.cycle": {"index": 0},
    "CycleEnsemble.system": {"index": 0},
    "MemberFailure": {"index": (0,), "time": 0.1, "error": ValueError("no")},
    "bifurcation_diagram": {
        "family": mechanisms.stribeck_block,
        "parameter": "belt_velocity",
        "values": [0.5, 0.6],
        "cycles": False,
    },
    "read_matrices": {"mass": MATRIX, "stiffness": MATRIX, "dof": [[5, 1], [5, 2]]},
    "equilibrium": {"system": mechanisms.mode_coupling(0.3), "closed": [0]},
    "stability": {"system": BELT},
    "reduce": {"system": SPARSE, "band": (0.0, 5.0), "accuracy": 0.1},
    "squeal_map": {
        "system": SPARSE,
        "parameters": {"friction": [0.5, 1.0]},
        "band": (0.0, 5.0),
        "accuracy": 0.1,
    },
    "LinearSystem.varied": {"friction": 0.5, "phi": 0.0, "speed": 2.0},
    "ComplexModes.save_vtk": {
        "path": f"{FOLDER.name}/modes.vtk",
        "coordinates": np.arange(6).reshape(2, 3),
        "positions": np.zeros((2, 3)),
        "cells": [[0], [1]],
    },
    "ReducedSystem.expand": {"y": np.zeros(REDUCED.dof)},
    "growth_chart": {"system": BELT, "phi": PHI, "zeta": [0.0, 0.1]},
    "compare_path": {"run": RUN, "measured": RUN},
    "ellipses_can_be_unstable": {"n1": 2.0, "n2": 1.0, "nu": 0.1, "p1": 1.0, "p2": 2.0},
    "slice": {"t0": 0.0, "t1": 0.1},
    "LimitCycle.phases": {"contact": 0},
    "LimitCycle.share": {"contact": 0, "phase": asp.Phase.STICK},
    # sweeps
    "sweep": {
        "function": _drawn,
        "grid": {"mu": [0.2, 0.3]},
        "executor": ThreadPoolExecutor(1),
        "seed": 1,
        "chunk": 1,
    },
    # identification
    "identify.read_csv": {"paths": TABLE},
    "identify.load": {"paths": TABLE},
    "identify.inspect_file": {"path": TABLE},
    "identify.Column": {"name": "t", "low": 0.0, "high": 1.0},
    "identify.Inspection": {"path": "run.csv", "columns": (), "sections": {}},
    "identify.average_turns": {"phi": DATA.phi, "values": DATA.phi, "turn": DATA.turn},
    "identify.fit_law": {"data": DATA},
    "identify.fit_paths": {
        "paths": PATHS,
        "system": SLIDING,
        "launch": LAUNCH,
        "position_error": 1e-4,
        "length_error": 0.01,
        "dt": 0.01,
        **ROUND,
    },
    "identify.fit_patch": {
        "wrench": WRENCHES,
        "twist": TWISTS,
        "reservoir": "supports",
        "points": 3,
        "places": TRIANGLE,
        "loads": np.ones(3),
        "frame": "ground",
        "friction": "ellipse",
        "angle": np.zeros(60),
    },
    "identify.compare_patches": {
        "wrench": WRENCHES,
        "twist": TWISTS,
        "models": {"ellipsoid": {}},
    },
    "identify.fit_supports": {"pushes": PUSHES, "points": TRIANGLE, "weight": 10.0},
    "identify.PatchFit.wrench": {"twist": TWISTS, "angle": np.zeros(60)},
    "identify.process": {"raw": RAW},
    "identify.low_pass": {"values": np.arange(100.0), "sample_rate": 100.0, "cut_off": 5.0},
    "identify.load_dependence": {"data": RUNS},
    "identify.friction_coefficient": {"data": DATA},
    "identify.breakaway": {"data": STROKES},
    "identify.fit_stribeck": {
        "speeds": np.geomspace(0.01, 1.0, 8),
        "coefficients": 0.3 + 0.1 * np.exp(-np.geomspace(0.1, 10.0, 8)),
    },
    "identify.speed_dependence": {"data": RUNS},
    "perturbed": {},
    "averaged": {},
    "identify.ProcessedData.axes": {"first": 0, "past": 10},
    "full_bins": {"most": 36},
    "turn_averages": {},
    "identify.Fit.bands": {"phi": PHI},
    "identify.Fit.forces": {"phi": PHI},
    "identify.Fit.radius_band": {"theta": PHI},
    "identify.compare_laws": {"first": FIT, "second": FIT, "confidence": 0.9},
    "identify.IdentifiedLaw.law_of": {"values": FIT.identified_law.values},
    "identify.IdentifiedLaw.moved": {"steps": np.zeros(len(FIT.identified_law.values))},
    "identify.IdentifiedLaw.sample": {"n": 2, "seed": 1},
    "identify.IdentifiedLaw.sample_values": {"n": 2, "seed": 1},
    "identify.Estimate.covers": {"truth": 1.0},
    "identify.VirtualTribometer.perfect": {"law": LAW, "normal_force": 10.0},
    # tracking
    "track.PlaneView.from_camera": {
        "position": (0.0, -1.0, 1.0),
        "target": (0.0, 0.0),
        "focal_length": 800.0,
        "size": (640, 480),
    },
    "track.PlaneView.from_points": {"pixels": 100.0 * UNIT[::6], "plane": UNIT[::6]},
    "track.PlaneView.from_scale": {"metres_per_pixel": 1e-3},
    "track.PlaneView.mismatch": {"pixels": 100.0 * UNIT, "plane": UNIT},
    "track.PlaneView.pixel_size": {"pixel": [1.0, 2.0]},
    "track.PlaneView.to_pixels": {"points": UNIT},
    "track.PlaneView.to_plane": {"pixels": UNIT},
    "track.Track.path": {},
    "track.VirtualCamera.config": {},
    "track.VirtualCamera.write": {"folder": FOLDER.name},
    "track.track_mark": {"frames": [FRAME] * 3, "fps": 250.0, "scene": CAMERA.view},
    "track.write_video": {"frames": [FRAME], "path": f"{FOLDER.name}/film.mp4"},
    "track.fit_circle": {"points": UNIT},
    # problems and mechanisms
    "problems.Scene.free_motion": {},
    "problems.Scene.problem": {"law": LAW},
    "problems.Scene.pushed": {"body": 0, "push": 1.0},
    "problems.arch": {"blocks": 3},
    "problems.columns": {"n_columns": 2, "height": 2},
    "problems.pile": {"layers": 2},
    "problems.sliders": {"n": 2},
    "problems.stack": {"boxes": 2},
    "problems.table": {"feet": 3},
    "problems.wall": {"rows": 2, "columns": 2},
    "problems.scenes.arch": {"blocks": 3},
    "problems.scenes.columns": {"n_columns": 2, "height": 2},
    "problems.scenes.pile": {"layers": 2},
    "problems.scenes.stack": {"boxes": 2},
    "problems.scenes.table": {"feet": 3},
    "problems.scenes.wall": {"rows": 2, "columns": 2},
    "mujoco.Scene": {"model": BALL_MODEL, "tolerance": 1e-9, "normal_restitution": 0.5},
    # Beyond the times of the calls before, which advance the data.
    "mujoco.Scene.simulate": {"data": BALL_DATA, "t_end": 0.004},
    "mechanisms.mode_coupling": {"mu": 0.5},
    "mechanisms.painleve_rod": {},
    "mechanisms.stribeck_block": {},
    # plots
    "plot.save_figure": {"figure": Figure(), "path": f"{FOLDER.name}/empty.png"},
    "plot.plot_bifurcation": {"diagram": DIAGRAM},
    "plot.plot_cones": {"set": DISK, "x": [0.5, 0.0]},
    "plot.plot_bodies": {"run": RUN_OF_BODIES, "system": BODIES, "at": [0.0, 0.1]},
    "plot.plot_forces_in_reservoir": {"law": LAW, "run": RUN},
    "plot.plot_history": {"run": RUN},
    "plot.plot_gauge": {"set": DISK},
    "plot.plot_growth_chart": {"x": [0.0, 1.0], "y": [0.0, 1.0], "growth": np.eye(2)},
    "plot.plot_law": {"law": LAW},
    "plot.plot_path": {"run": RUN},
    "plot.plot_phase_portrait": {"run": RUN},
    "plot.plot_projection": {"set": DISK, "z": [1.0, 0.0]},
    "plot.plot_root_locus": {"eigenvalues": [[1.0, 2.0], [1.0, 3.0]], "values": [0.0, 1.0]},
    "plot.plot_track": {"track": FILM},
    "plot.save_animation": {
        "run": RUN_OF_BODIES,
        "path": f"{FOLDER.name}/ball.gif",
        "system": BODIES,
        "size": (2.0, 2.0),
    },
}
"""By the key of the callable, or by the name of a method for all classes that have it."""


@dataclass(frozen=True)
class Call:
    """A call with valid arguments, of which there may be several variants."""

    function: object
    variants: tuple

    def arguments(self, name=None):
        """Valid arguments, among which there is that of the name if there can be."""
        given = (one for one in self.variants if name is None or one.get(name) is not None)
        return next(given, self.variants[0])

    @property
    def numbers(self):
        """Names of the parameters that take numbers."""
        parameters = inspect.signature(self.function).parameters.values()
        return [
            one.name
            for one in parameters
            if _NUMBERS.search(str(one.annotation))
            and not any(word in str(one.annotation) for word in ("Callable", "Mapping"))
        ]


RESULTS = {
    "FiniteElementModel",
    "Projection",
    "SceneContact",
    "SceneProblem",
    "SceneRun",
    "SceneStep",
    "ReducedSystem",
    "SquealMap",
    "ComplexModes",
    "Certificate",
    "ContactSolution",
    "Island",
    "LocalSolution",
    "Stage",
    "StepSolution",
    "Equilibrium",
    "Event",
    "Infeasibility",
    "State",
    "LimitCycle",
    "BifurcationDiagram",
    "Motion",
    "Trajectory",
    "PathComparison",
    "Percussions",
    "SweepStatus",
    "Associativity",
    "Bands",
    "PredictionBands",
    "Candidate",
    "Comparison",
    "ConvexDirection",
    "Estimate",
    "Fit",
    "FittedPath",
    "PathFit",
    "CurveDifference",
    "LawComparison",
    "PatchFit",
    "SupportsFit",
    "Track",
    "TrackConfig",
    "Region",
}
"""What the library makes itself, and may make with NaN where something is not known."""

SYSTEMS = {"System", "FollowerPendulum", "FrictionalImpactOscillator"}
"""Systems, whose methods answer the integrators."""
ANSWERS = {
    "advance",
    "block_mass",
    "constraint",
    "constraint_rows",
    "direction",
    "forces",
    "gap",
    "mass",
    "normal",
    "touched",
    "velocity",
}
MODELS = {
    f"{name}{kind}"
    for name in ("Circle", "Fourier", "Superellipse")
    for kind in ("Reservoir", "Direction")
}
"""Models of sets, whose methods answer the fit."""


def public():
    """Yield key, name of the class and object of all that is public and takes numbers."""
    seen = set()
    for module in MODULES:
        prefix = module.__name__.removeprefix("asperity").lstrip(".")
        for name, kind in public_of(module).items():
            if not inspect.isclass(kind) and not inspect.isfunction(kind):
                continue
            if not kind.__module__.startswith("asperity"):
                continue
            if inspect.isclass(kind) and issubclass(kind, BaseException | enum.Enum):
                continue
            key = f"{prefix}.{name}".lstrip(".")
            members = [(key, "", kind)]
            if inspect.isclass(kind):
                members += [
                    (f"{key}.{method}", name, member)
                    for method, member in _methods(kind)
                    if not method.startswith("_") or method == "__call__"
                ]
            for key, owner, member in members:
                method = key.rpartition(".")[2]
                if not owner and name in RESULTS:
                    continue
                if (owner in SYSTEMS and method in ANSWERS) or owner in MODELS:
                    continue
                original = getattr(member, "__func__", member)
                if original not in seen and Call(member, ()).numbers:
                    seen.add(original)
                    yield key, kind, member


def _methods(kind):
    """Yield functions and class methods of a class, not properties."""
    for name in dir(kind):
        member = getattr(kind, name)
        if inspect.isfunction(member) or inspect.ismethod(member):
            yield name, member


def calls():
    """Return a valid call for every key, None where none is known."""
    return {key: _call(key, kind, member) for key, kind, member in public()}


def _call(key, kind, member):
    arguments = ARGUMENTS.get(key)
    if member is kind:
        own = (dict(one._parameters) for one in OBJECTS if type(one) is kind)
        variants = (arguments,) if arguments is not None else tuple(own)
    else:
        arguments = ARGUMENTS.get(key.rpartition(".")[2]) if arguments is None else arguments
        variants = () if arguments is None else (arguments,)
        if not inspect.ismethod(member) and inspect.isclass(kind):
            of = next((one for one in OBJECTS if isinstance(one, kind)), None)
            member = getattr(of, member.__name__, None)
    return Call(member, variants) if variants and member is not None else None
