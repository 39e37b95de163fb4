"""Random systems with stops, redundant feet and hinges: integrators end and agree to O(Δt).

Neither knows of the other: events located to rounding on one side, Moreau's steps on the other
one. Where a motion has several continuations both may mark it, and it is not compared.
"""

import json
import os
import subprocess
import sys
import time
from collections import Counter

import asperity as asp
import numpy as np
import pytest
from asperity.contact.grading import proves_no_solution

T_END = 0.4
STEPS = (4e-3, 2e-3, 1e-3)
# For motions with flights shorter than these steps.
FINER = (1e-4, 1e-5)
# Events of a run that is left out: contacts that bounce too often to be compared.
EVENTS = 400
# Processor time that a run may take.
SECONDS = 5.0


def law(rng, p):
    mu = rng.uniform(0.1, 1.2)
    if p == 1:
        return asp.FrictionLaw.isotropic(mu, dimension=1)
    if rng.random() < 0.5:
        return asp.FrictionLaw.isotropic(mu)
    reservoir = asp.Ellipse(mu, mu * rng.uniform(0.3, 1.0), angle=rng.uniform(0.0, np.pi))
    if rng.random() < 0.5:
        return asp.FrictionLaw.associated(reservoir)
    direction = asp.Superellipse(1.0, rng.uniform(0.3, 1.0), rng.uniform(1.2, 6.0))
    return asp.FrictionLaw(reservoir, direction.rotated(rng.uniform(0.0, np.pi)))


def contact(rng, n, p, kind):
    """A stop, a contact pressed on a belt, or a hinge, which sees one direction of motion only."""
    along, across = rng.normal(size=(n, p)), rng.normal(size=n)
    if kind == "belt":
        return asp.Contact(
            law(rng, p),
            direction=along,
            normal_force=rng.uniform(0.5, 3.0),
            velocity=rng.normal(size=p),
        )
    if kind == "hinge":
        seen = rng.normal(size=n)
        along, across = np.outer(seen, rng.normal(size=p)), seen * rng.choice([-1.0, 1.0])
    gap = 0.0 if rng.random() < 0.5 else rng.uniform(0.0, 0.2)
    restitution = rng.choice([0.0, 0.0, 0.3, 0.8])
    return asp.Contact(
        law(rng, p), direction=along, normal=across, gap=gap, normal_restitution=restitution
    )


def feet(rng, n, p):
    """Feet of one body, more of them than it needs: their rows depend on each other."""
    along, across = rng.normal(size=(n, p)), rng.normal(size=n)
    shared, out = law(rng, p), []
    lean = rng.normal(size=n)
    for place in np.linspace(-1.0, 1.0, rng.integers(2, 5)):
        turn = place if rng.random() < 0.7 else 0.0
        out.append(asp.Contact(shared, direction=along, normal=across + turn * lean))
    return out


def random_system(seed):
    """A system with its initial state; half of them rest."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 5))
    p = int(rng.choice([1, 2]))
    kinds = list(rng.choice(["stop", "belt", "hinge"], size=rng.integers(1, 3)))
    contacts = [contact(rng, n, p, kind) for kind in kinds]
    if rng.random() < 0.4:
        contacts += feet(rng, n, p)
    root = rng.normal(size=(n, n))
    spring = rng.normal(size=(n, n)) if rng.random() < 0.5 else np.zeros((n, n))
    system = asp.LinearSystem(
        root @ root.T + 0.5 * np.eye(n),
        stiffness=spring @ spring.T * 5.0,
        damping=0.1 * spring @ spring.T,
        force=3.0 * rng.normal(size=n),
        contacts=contacts,
    )
    u0 = np.zeros(n) if rng.random() < 0.5 else rng.normal(size=n)
    return system, np.zeros(n), u0


def run(call):
    """What a run returned, how it ended if it did not, and a message.

    "no solution", with a proof that the checker holds up; "events", as many as are allowed;
    "unsolved", a contact problem without a solution that was found; "false", a proof that is none;
    "failed", all other errors; "late", more than `SECONDS` of processor time.
    """
    started = time.process_time()
    found, ended, message, raised = None, "", "", None
    try:
        found = call()
    except asp.AsperityError as error:
        raised, message = error, str(error)
    seconds = time.process_time() - started
    if seconds > SECONDS:
        ended, message = "late", f"{seconds:.1f} s: {message}"
    elif isinstance(raised, asp.NoSolutionError):
        proven = raised.infeasibility is not None
        holds = proven and proves_no_solution(raised.problem, raised.infeasibility)
        ended = "no solution" if holds else "false" if proven else "unsolved"
    elif raised is not None:
        unsolved = isinstance(raised, asp.ConvergenceError) and raised.residual is not None
        unsolved = unsolved or "were not found" in message or "without bound" in message
        ended = "events" if "max_events" in message else "unsolved" if unsolved else "failed"
    return found, ended, message


def compare(seed):
    """How the runs of a system ended, and a message.

    As in `run`, if one of them did so; else "agrees", "ambiguous", "apart".
    """
    system, q0, u0 = random_system(seed)
    start = {"t_end": T_END, "q0": q0, "u0": u0}
    motion, ended, message = run(lambda: asp.integrate(system, max_events=EVENTS, **start))
    if ended:
        return ended, f"integrate: {message}"
    off, marked = [], motion.ambiguous_events
    size = max(1.0, np.abs(motion.u).max())
    for dt in (*STEPS, *FINER):
        steps, ended, message = run(lambda dt=dt: asp.simulate(system, dt=dt, **start))
        if ended:
            return ended, f"simulate at {dt}: {message}"
        off.append(np.abs(steps.q[-1] - motion.q[-1]).max())
        marked += steps.ambiguous_steps
        if dt <= STEPS[-1] and (off[-1] <= 2.0 * dt * size or off[-1] <= 0.35 * off[0]):
            return "agrees", ""
        if dt <= STEPS[-1] and marked:
            return "ambiguous", ""
    return "apart", f"{off} at {size:.2g} m/s"


def walk(seeds):
    """Outcomes of all runs, and what there is to be told of those that do not agree."""
    outcomes, told = Counter(), []
    for seed in seeds:
        outcome, message = compare(seed)
        outcomes[outcome] += 1
        if outcome not in EXPECTED:
            told.append((seed, outcome, message))
    return outcomes, told


# Contacts that see one direction of the motion only and bounce may ask for velocities that
# contradict each other: such runs end with a proof.
EXPECTED = ("agrees", "ambiguous", "events", "no solution")
# What else happens among the first 10,000 systems. Such a run ends with an error that says so, but
# it should not end; integrators that stay apart should mark a choice. Whoever mends one takes it
# out.
KNOWN = {
    # Several contacts have a second solution together only, which is not marked: 4041 rests in a
    # corner or slips out of it (found by linear programs over all that its two contacts can do),
    # 5900 jams between a hinge and a stop or slips on. 9835 has two impacts within 3e-7 s, which
    # every step takes for one. 3622 meets four feet at once, which steps do one by one. 9850 and
    # 893 are not looked into.
    "apart": {893, 3622, 4041, 5900, 9835, 9850},
    # 8660: sectors of slip are halved down to 1e-6. 6023 and 8277: steps of `integrate` fail
    # however short they are. 7437 is not looked into.
    "unsolved": {6023, 7437, 8277, 8660},
    # 5263: two hinges, 6051, 8502 and 8700: feet that repeat each other: `simulate` goes on and
    # marks its steps as ambiguous. 3033: steps of `integrate` fail however short they are.
    # 658, 7706: time hardly passes, a slip that no percussion stops.
    "failed": {658, 3033, 5263, 6051, 7706, 8502, 8700},
    # These two may fail after 5 s.
    "late": {3033, 8277},
}


def check(told):
    unexpected = [case for case in told if case[0] not in KNOWN.get(case[1], ())]
    assert unexpected == []


def test_random_systems_agree():
    _, told = walk(range(60))
    check(told)


# Hinges alone, beside a belt, stops and feet, whose forces grew to 10¹⁰ N and more.
@pytest.mark.parametrize("seed", [2334, 3328, 3729, 5362, 5541, 6005, 9962])
def test_hinges_carry_no_forces_that_cancel(seed):
    outcome, message = compare(seed)
    assert outcome in ("agrees", "ambiguous"), message


# Belts that rub on a body which slides on stops: more friction speeds it up.
@pytest.mark.parametrize("seed", [1454, 3892, 7937])
def test_belts_with_a_negative_mobility_find_their_force(seed):
    outcome, message = compare(seed)
    assert outcome == "agrees", message


# Hinges with restitution: alone in their impact (of 3234, 5777, 7468 and 7726 three rows see two
# directions of motion), beside other contacts, two hinges, a hinge with a belt and feet; 3272 with
# percussions of 10¹³ N s that all but balance, 6434, 9334 and 9932 with blurred vectors.
@pytest.mark.parametrize(
    "seed",
    [66, 113, 117, 332, 3234, 5777, 7468, 7726, 14, 137, 172, 444, 1080, 3272, 6434, 9334, 9932],
)
def test_runs_without_a_solution_end_with_a_proof(seed):
    assert compare(seed)[0] == "no solution"
    system, q0, u0 = random_system(seed)
    with pytest.raises(asp.NoSolutionError) as caught:
        asp.simulate(system, dt=1e-3, t_end=T_END, q0=q0, u0=u0)
    error = caught.value
    assert error.infeasibility.kind == "cases"
    assert proves_no_solution(error.problem, error.infeasibility)
    # The problem is that of the step: its own solve finds the same.
    assert error.problem.solve(on_failure="record").status is asp.Status.NO_SOLUTION


CHUNK = 100


@pytest.mark.long
def test_many_random_systems_agree_and_end():
    """In processes of their own, so that a run without end is told, not waited for."""
    script = (
        "import json, sys\n"
        "from test_random_systems import compare\n"
        "for seed in range(int(sys.argv[1]), int(sys.argv[2])):\n"
        "    print('begin', seed, flush=True)\n"
        "    print(json.dumps([seed, *compare(seed)]), flush=True)\n"
    )
    folders = [os.path.dirname(__file__), *sys.path]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, folders))}
    outcomes, told = Counter(), []
    for first in range(0, 10_000, CHUNK):
        command = [sys.executable, "-c", script, str(first), str(first + CHUNK)]
        # Four runs of each system, on a machine that may do other things meanwhile.
        limit = 4.0 * CHUNK * SECONDS
        try:
            done = subprocess.run(
                command, env=environment, capture_output=True, text=True, timeout=limit, check=True
            )
        except subprocess.TimeoutExpired as expired:
            outcomes["late"] += 1
            told.append((first, "late", str((expired.stdout or b"")[-100:])))
            continue
        for entry in done.stdout.splitlines():
            if entry.startswith("begin"):
                continue
            seed, outcome, message = json.loads(entry)
            outcomes[outcome] += 1
            if outcome not in EXPECTED:
                told.append((seed, outcome, message))
    print(outcomes, *told, sep="\n")
    assert sum(outcomes.values()) == 10_000
    check(told)
