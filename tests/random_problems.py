"""Problems of many contacts that several test files draw or put together."""

import asperity as asp
import numpy as np
from asperity import problems
from samples import CORNERED_LAWS, LINE_LAWS, PLANE_LAWS, SPACE_LAWS
from scipy.sparse import block_diag, csr_array

LAW = asp.FrictionLaw.isotropic(0.5)
LAWS = [*PLANE_LAWS, *CORNERED_LAWS, *LINE_LAWS, *SPACE_LAWS]
GRAVITY = np.array([0.0, 0.0, -9.81, 0.0, 0.0, 0.0])


def rotation(rng, tilt):
    """Frame (n, t₁, t₂) whose normal is at most `tilt` from e₃."""
    angle, turn = tilt * rng.random(), 2 * np.pi * rng.random()
    normal = np.array([np.sin(angle) * np.cos(turn), np.sin(angle) * np.sin(turn), np.cos(angle)])
    first = np.cross(normal, rng.normal(size=3))
    first /= np.linalg.norm(first)
    return np.array([normal, first, np.cross(normal, first)])


def rows_of_contact(frame, lever, p, unilateral):
    """Rows of Wᵀ for a body: relative velocity of its point, with the spin for p = 3."""
    arm = np.array([[0, lever[2], -lever[1]], [-lever[2], 0, lever[0]], [lever[1], -lever[0], 0]])
    point = np.hstack([frame, frame @ arm])
    spin = np.hstack([np.zeros(3), 0.05 * frame[0]])
    rows = [point[1], point[2], spin][:p]
    return np.array([point[0], *rows] if unilateral else rows)


def pile(rng, laws, contacts, per_pair, unilateral=0.8):
    """Bodies on the ground and on each other; every contact pushes its upper body upwards.

    `per_pair` contacts act between the same two bodies: from three on they cannot be told apart.
    Free velocities are those of bodies that fall and move, so that a solution exists.
    """
    bodies = -(-contacts // per_pair)
    mass = rng.uniform(0.5, 2.0, size=bodies)
    blocks = []
    for m in mass:
        root = rng.normal(size=(3, 3))
        inertia = 0.02 * m * (root @ root.T + 2 * np.eye(3))
        blocks.append(np.block([[m * np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), inertia]]))
    chosen, forces, rows = [], [], []
    for k in range(contacts):
        upper = k // per_pair
        lower = int(rng.integers(-1, upper)) if rng.random() < 0.5 else -1
        law = laws[int(rng.integers(len(laws)))]
        closed = bool(rng.random() < unilateral)
        frame = rotation(rng, tilt=0.3)
        chosen.append(law)
        forces.append(None if closed else float(rng.uniform(0.01, 0.1)))
        for body, sign in ((upper, 1.0), (lower, -1.0)):
            lever = rng.uniform(-0.3, 0.3, size=3) - sign * np.array([0.0, 0.0, 0.2])
            part = sign * rows_of_contact(frame, lever, law.dimension, closed)
            if sign > 0.0:
                block = np.zeros((len(part), 6 * bodies))
            if body >= 0:
                block[:, 6 * body : 6 * body + 6] += part
        rows.append(block)
    directions = csr_array(np.vstack(rows).T)
    velocity = np.tile(0.01 * GRAVITY, bodies) + 0.05 * rng.normal(size=6 * bodies)
    return asp.ContactProblem.from_bodies(
        block_diag([csr_array(block) for block in blocks], format="csr"),
        directions=directions,
        free_velocity=directions.T @ velocity,
        laws=chosen,
        normal_force=forces,
    )


def any_problem(rng):
    """Walls, stacks, arches, columns and piles of spheres, feet, chains, and piles of all laws."""
    mu, push = rng.uniform(0.1, 0.8), rng.uniform(0.0, 3.0)
    law = asp.FrictionLaw.isotropic(mu)
    if rng.random() < 0.3:
        turned = asp.Ellipse(mu, 0.5 * mu, angle=rng.uniform(0.0, 3.0))
        law = asp.FrictionLaw(turned, asp.Ellipse(0.5, 1.0))
    few, speed = int(rng.integers(2, 7)), rng.choice([0.0, 0.1, 0.3])
    match rng.integers(9):
        case 0:
            return problems.wall(few, columns=int(rng.integers(1, 5)), push=push, law=law)
        case 1:
            return problems.stack(few, push=push, law=law)
        case 2:
            return problems.arch(few + 2, law=asp.FrictionLaw.isotropic(0.4 + mu))
        case 3:
            return problems.columns(few, height=int(rng.integers(2, 7)), law=law, seed=few)
        case 4:
            return problems.pile(int(rng.integers(2, 5)), law=law, speed=speed, seed=few)
        case 5:
            return problems.table(2 * few, push=push, law=law)
        case 6:
            return chain(10.0 ** rng.uniform(-2.0, 2.0, size=few), -1e-5, rng)
        case _:
            return pile(rng, LAWS, int(rng.integers(3, 60)), per_pair=int(rng.integers(1, 5)))


def chain(masses, closing, rng, law=LAW):
    """Return particles of these masses in a row between two walls, one of which comes nearer."""
    count = len(masses)
    directions = np.zeros((3 * count, 3 * (count + 1)))
    for body in range(count):
        own = slice(3 * body, 3 * body + 3)
        directions[own, own] = np.eye(3)
        directions[own, 3 * body + 3 : 3 * body + 6] = -np.eye(3)
    velocity = np.zeros((count, 3))
    velocity[:, 0], velocity[:, 1] = rng.normal(size=count), 0.1
    free = directions.T @ velocity.ravel()
    free[-3] -= closing
    return asp.ContactProblem.from_bodies(
        np.diag(np.repeat(masses, 3)), directions=directions, free_velocity=free, laws=law
    )


def side_by_side(parts):
    """Return one problem of several: bodies where all parts have them, else their operators."""
    free = np.concatenate([part.free_velocity for part in parts])
    laws = [law for part in parts for law in part.laws]
    options = {
        "free_velocity": free,
        "laws": laws,
        "normal_force": [force for part in parts for force in part.normal_force],
    }
    if all(part.mass is not None for part in parts):
        mass = block_diag([part.mass for part in parts], format="csr")
        directions = block_diag([part.directions for part in parts], format="csr")
        return asp.ContactProblem.from_bodies(mass, directions=directions, **options)
    operators = [csr_array(part.delassus) for part in parts]
    return asp.ContactProblem(block_diag(operators, format="csr"), **options)


def shuffled(problem, order):
    """Return a problem with its contacts in another order, and the rows in that order."""
    taken = [problem.row_slices[i] for i in order]
    rows = np.concatenate([np.arange(each.start, each.stop) for each in taken])
    operator = problem.delassus.tocsr()[rows][:, rows]
    force = [problem.normal_force[i] for i in order]
    laws = [problem.laws[i] for i in order]
    free = problem.free_velocity[rows]
    shuffled = asp.ContactProblem(operator, free_velocity=free, laws=laws, normal_force=force)
    return shuffled, rows
