"""Virtual reciprocating tribometers: a massless pin on a spring under a moving stage."""

import numpy as np
from asperity.identify import RawData, Recording, process


def records(
    n, *, seed=0, cycles=8, rate=10_000.0, ratio=None, compliance=None, noise=0.005, scatter=0.01,
    load=10.0, zero=0.0, sine=False, kinetic=None, reach=None,
):  # fmt: skip
    """Return n records as a dict of arrays over (samples, records), with what is true of them.

    The force follows the stage while the pin sticks, up to the static force of the stroke, which is
    normal about its mean; then it is kinetic until the stage turns back.
    """
    random = np.random.default_rng(seed)
    c = 10.0 ** random.uniform(-7.0, -5.0, n) if compliance is None else np.full(n, compliance)
    mu = random.uniform(0.2, 0.4, n) if kinetic is None else np.broadcast_to(kinetic, n)
    ratio = random.uniform(1.0, 1.5, n) if ratio is None else np.full(n, ratio)
    half, period = 1e-3 * random.uniform(0.1, 0.2, n), 0.5
    half = half if reach is None else np.full(n, reach)
    speed = 4.0 * half / period
    steps = int(cycles * period * rate)
    cycle = np.arange(steps)[:, None] / rate / period + random.uniform(0.0, 1.0, n)
    if sine:
        place = half * np.sin(2.0 * np.pi * cycle)
        velocity = 2.0 * np.pi / period * half * np.cos(2.0 * np.pi * cycle)
    else:
        place = half * (1.0 - 4.0 * np.abs(cycle % 1.0 - 0.5))
        velocity = np.where(cycle % 1.0 < 0.5, speed, -speed)
    force, now, slips = np.zeros((steps, n)), np.zeros(n), np.zeros(n)
    most = ratio * mu * load * (1.0 + scatter * random.normal(size=n))
    for step in range(1, steps):
        moved = place[step] - place[step - 1]
        way = np.sign(moved)
        turned = way != slips
        sticks = now + moved / c
        breaks = turned & (np.abs(sticks) > most)
        slips = np.where(breaks, way, np.where(turned, 0.0, slips))
        fresh = ratio * mu * load * (1.0 + scatter * random.normal(size=n))
        most = np.where(breaks, fresh, most)
        now = np.where(slips != 0.0, slips * mu * load, sticks)
        force[step] = now
    force += zero + noise * load * mu * random.normal(size=force.shape)
    return {
        "time": np.arange(steps) / rate,
        "force": force,
        "place": place,
        "velocity": velocity,
        "compliance": c,
        "kinetic": mu,
        "static": mu * ratio,
        "load": load,
    }


def recording(given, at=0):
    """Return one of the records as a run of one channel."""
    still = np.zeros(given["time"].size)
    return Recording(
        given["time"],
        angle=still,
        readings=np.stack([given["force"][:, at], still, still + given["load"]], axis=-1),
        velocity=np.stack([given["velocity"][:, at], still], axis=-1),
    )


def processed(given, at=0):
    """Return one of the records as processed data of one channel."""
    run = recording(given, at)
    return process(RawData([run], normal_load=given["load"], one_channel=True))


def star(given, *, first=0.0):
    """Return a run of two channels, in which the records are strokes along n lines in turn."""
    n = given["kinetic"].size
    way = first + np.arange(n) * np.pi / n
    e = np.stack([np.cos(way), np.sin(way)])
    force, velocity = ((given[k].T[:, :, None] * e.T[:, None]) for k in ("force", "velocity"))
    size = n * given["time"].size
    time = np.arange(size) * given["time"][1]
    normal = np.full((size, 1), given["load"])
    readings = np.concatenate([force.reshape(-1, 2), normal], axis=1)
    return Recording(time, angle=0.0 * time, readings=readings, velocity=velocity.reshape(-1, 2))
