"""Random sets and laws of every kind that a file can hold."""

import asperity as asp
import numpy as np

TURN = 2.0 * np.pi
# Laws of combined sets take long to make: a part of a second.
COMBINED = 0.06


def size(rng):
    """Sizes over many powers of ten, sometimes of few digits."""
    exact = 10.0 ** rng.uniform(-1.0, 1.0)
    return float(exact if rng.random() < 0.8 else f"{exact:.1g}")


def angle(rng):
    return float(rng.choice([0.0, -0.0, rng.uniform(-4.0, 4.0)]))


def curve_angles(rng, n):
    steps = rng.uniform(0.5, 1.0, n)
    return rng.uniform(-3.0, 3.0) + TURN * np.cumsum(steps) / steps.sum()


def support_curve(rng):
    phi = curve_angles(rng, rng.integers(8, 40))
    wave = 1.0 + 0.2 * rng.random() * np.cos(phi) + 0.05 * rng.random() * np.cos(2.0 * phi)
    return asp.SupportCurve(phi, size(rng) * wave)


def polar_curve(rng):
    theta = curve_angles(rng, rng.integers(8, 40))
    return asp.PolarCurve(theta, size(rng) * (1.0 + 0.3 * rng.random(theta.size)))


def polygon(rng):
    n = rng.integers(3, 9)
    theta = np.arange(n) * TURN / n + rng.uniform(-0.3, 0.3, n)
    radius = size(rng) * rng.uniform(0.7, 1.0, n)
    return asp.Polygon(radius[:, None] * np.stack([np.cos(theta), np.sin(theta)], axis=-1))


def convex_plane(rng, deep=True):
    a, b = size(rng), size(rng)
    simple = [
        lambda: asp.Disk(a),
        lambda: asp.Ball(a, dimension=2),
        lambda: asp.Ellipse(a, b, angle=angle(rng)),
        lambda: asp.Ellipsoid([a, b]),
        lambda: asp.Rectangle(a, b, angle=angle(rng)),
        lambda: asp.Box([a, b]),
        lambda: asp.Box(lower=[-a, -b], upper=[b, a]),
        lambda: asp.CappedRectangle(a, b, cap=size(rng), angle=angle(rng)),
        lambda: asp.Superellipse(a, b, rng.uniform(1.0, 6.0), angle=angle(rng)),
        lambda: asp.WedgeAsperity(
            0.3 + 0.3 * rng.random(), beta=0.5 * rng.random(), angle=angle(rng)
        ),
        lambda: support_curve(rng),
    ]
    if not deep or rng.random() > COMBINED:
        return simple[rng.integers(len(simple))]()
    first, second = convex_plane(rng), convex_plane(rng, deep=False)
    matrix = np.eye(2) + 0.3 * rng.normal(size=(2, 2))
    return [first & second, first + second, asp.sets.Mapped(first, matrix)][rng.integers(3)]


def star_plane(rng):
    stars = [
        lambda: convex_plane(rng),
        lambda: polar_curve(rng),
        lambda: polygon(rng),
        lambda: asp.Superellipse(size(rng), size(rng), rng.uniform(0.3, 1.0), angle=angle(rng)),
        lambda: asp.WedgeAsperity(1.2, beta=rng.uniform(0.5, 0.6), angle=angle(rng)),
        lambda: convex_plane(rng) | star_plane(rng),
        lambda: star_plane(rng) & convex_plane(rng, deep=False),
    ]
    return stars[rng.integers(5 if rng.random() > COMBINED else len(stars))]()


def line(rng):
    return [
        lambda: asp.Interval(-size(rng), size(rng)),
        lambda: asp.Box([size(rng)]),
        lambda: asp.Ball(size(rng), dimension=1),
    ][rng.integers(3)]()


def axes(rng):
    return np.linalg.qr(rng.normal(size=(3, 3)))[0]


def space(rng):
    simple = [
        lambda: asp.Ball(size(rng)),
        lambda: asp.Box([size(rng), size(rng), size(rng)]),
        lambda: asp.Ellipsoid([size(rng), size(rng), size(rng)]),
        lambda: asp.Ellipsoid([size(rng), size(rng), size(rng)], axes=axes(rng)),
        lambda: asp.Superellipsoid(
            [size(rng), size(rng), size(rng)], exponent=rng.uniform(1.0, 6.0)
        ),
        lambda: asp.CoulombContensou(size(rng), pressure=str(rng.choice(["hertz", "uniform"]))),
        lambda: asp.sets.Mapped(asp.Ball(1.0), np.eye(3) + 0.2 * rng.normal(size=(3, 3))),
    ]
    return simple[rng.integers(len(simple))]()


def rate(rng):
    if rng.random() < 0.7:
        return None
    return asp.Stribeck(
        size(rng),
        ratio=rng.random(),
        shape=str(rng.choice(["exponential", "hyperbolic"])),
        exponent=rng.uniform(0.5, 2.0),
        viscous=rng.choice([0.0, rng.random()]),
    )


def report(rng):
    if rng.random() < 0.9:
        return None
    if rng.random() < 0.3:
        mu, angle = rng.uniform(0.1, 1.0, 2), rng.uniform(-3.0, 3.0)
        return asp.FrictionLaw.like("exudyn", dryFriction=mu, dryFrictionAngle=angle).report
    order = None if rng.random() < 0.5 else int(rng.integers(1, 9))
    numbers = rng.random(5)
    return asp.law.FlowReport(
        *numbers[:4], misfit=numbers[4], samples=int(rng.integers(1, 99)), order=order
    )


def random_law(rng):
    """A law of any sets and any dimension; with a rate factor or a report at times."""
    if rng.random() < 0.8:
        reservoir, direction = star_plane(rng), convex_plane(rng)
    else:
        kind = [line, space][rng.integers(2)]
        reservoir, direction = kind(rng), kind(rng)
    if rng.random() < 0.2 and reservoir.dimension != 2:
        direction = reservoir
    return asp.FrictionLaw(reservoir, direction, rate=rate(rng), report=report(rng))
