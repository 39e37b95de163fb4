"""Friction laws of contact patches from measured wrenches and twists."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity.errors import DimensionError, ParameterError
from asperity.identify.estimator.comparison import Comparison
from asperity.identify.estimator.covariance import level_of
from asperity.identify.estimator.loss import Loss, LossName
from asperity.identify.evidence.wrenches.pairs import Pairs, in_ground
from asperity.identify.evidence.wrenches.result import BlockFit, PatchFit, SupportsFit
from asperity.identify.evidence.wrenches.solving import Labels, fitted, starts_of
from asperity.identify.models.patches import (
    SPOT,
    EllipsoidPatch,
    ExtendedPatch,
    ExtendedPoints,
    Frame,
    Friction,
    PatchModel,
    PointsPatch,
)
from asperity.sets.shapes.reservoirs import Pressure

PatchReservoir = Literal["ellipsoid", "contensou", "supports"]

AnyFit = TypeVar("AnyFit", bound=BlockFit)

# Parts that are left out in turn, and from how many logs on these are the parts.
_FOLDS, _FEWEST_LOGS = 5, 3


def fit_patch(
    wrench: ArrayLike,
    twist: ArrayLike,
    *,
    reservoir: PatchReservoir = "ellipsoid",
    direction: Literal["ellipsoid"] | None = None,
    points: int = 5,
    places: ArrayLike | None = None,
    loads: ArrayLike | None = None,
    friction: Friction = "isotropic",
    pressure: Pressure = "hertz",
    point_radius: float = 0.01,
    frame: Frame = "body",
    angle: ArrayLike | None = None,
    normal_force: float = 1.0,
    length: float = 1.0,
    loss: LossName = "soft_l1",
    blocks: int | ArrayLike = 20,
    confidence: float | None = 0.95,
) -> PatchFit:
    """Fit the law of a whole contact patch to pairs of wrench and twist.

    The wrench is that on the ground, −λ, so that its power with the twist is positive. Samples of
    one push are not independent of each other: confidence intervals come from the scatter of
    blocks of neighbouring pairs, which are in the order of recording.

    Args:
        wrench: (F₁, F₂, τ) in N and N m about a point of the body, in the body's axes; shape
            ``(n, 3)``.
        twist: (v₁, v₂, ω) of the same point, of any scale, shape ``(n, 3)``.
        reservoir: of C: ``"ellipsoid"``, six parameters; ``"contensou"``, a round area in which
            every point obeys Coulomb's law, with its radius and its centre; ``"supports"``, support
            points with the Minkowski sum of their sets.
        direction: None for the associated law D = C; ``"ellipsoid"`` for an ellipsoid D.
        points: how many support points.
        places: where they are, in the unit of ``length``, ``(K, 2)``; by default they are fitted.
        loads: of the points, ``(K,)``, of which the shares of their sum matter: ``normal_force``
            is the whole load. By default μN of each point is fitted, with ``loads`` one μ.
        friction: at the support points, or in the round area: ``"isotropic"`` or ``"ellipse"``,
            with the same ellipse everywhere.
        pressure: of the round area, as for `CoulombContensou`.
        point_radius: radius of the spots of support points over ``length``: the torque of a spot
            that turns keeps its set from being flat.
        frame: ``"ground"`` if the law, or the ellipses of its friction, turn with the ground and
            not with the body; takes ``angle``.
        angle: of the body's axes from those of the ground in rad, ``(n,)``.
        normal_force: in N; the law is per unit of it.
        length: ℓ in m, by which torques are divided and ω is multiplied; 1 if they are already.
        loss: of the components, ``"soft_l1"``, ``"huber"`` or ``"cauchy"``, which bound the weight
            of outliers, or ``"linear"``: least squares.
        blocks: number of blocks of pairs, or the number of the block of each pair, ``(n,)``.
        confidence: level of the confidence intervals; None for none.

    Raises:
        FitError: if there are too few pairs, or wrenches have the other sign.
        ParameterError: if arguments do not belong together.

    >>> import numpy as np
    >>> import asperity as asp
    >>> from asperity.identify import fit_patch
    >>> truth = asp.FrictionLaw.associated(asp.CoulombContensou(0.3))
    >>> random = np.random.default_rng(0)
    >>> twist = random.normal(size=(200, 3))
    >>> wrench = -truth.force(twist) + 0.005 * random.normal(size=(200, 3))
    >>> fit = fit_patch(wrench, twist, reservoir="contensou")
    >>> fit.parameters["mu"].covers(0.3), fit.parameters["radius"].covers(1.0)
    (True, True)
    >>> bool(np.abs(fit.law.force(twist) - truth.force(twist)).max() < 0.01)
    True
    """
    forces = arrays.array(wrench, "wrench", (None, 3)).copy()
    motions = arrays.array(twist, "twist", (len(forces), 3)).copy()
    lever, normal = arrays.positive(length, "length"), arrays.positive(normal_force, "normal_force")
    forces[:, 2] /= lever
    motions[:, 2] *= lever
    frame = arrays.choice(frame, "frame", ("body", "ground"))
    turned = None if angle is None else arrays.array(angle, "angle", (len(forces),))
    if frame == "ground" and turned is None:
        raise ParameterError("angle", 'must be given with frame="ground"')
    shares = None if loads is None else _positive(loads, "loads")
    if shares is not None:
        # The largest is divided out first, so that the sum stays within the range of numbers.
        shares = shares / shares.max()
        shares = shares / shares.sum()
    model = _model(
        reservoir,
        direction,
        points=points,
        places=None if places is None else arrays.array(places, "places", (None, 2)) / lever,
        loads=shares,
        friction=friction,
        pressure=pressure,
        point_radius=point_radius,
        frame=frame,
    )
    pairs = Pairs(forces / normal, motions, angle=turned)
    labels = _labels(blocks, len(pairs))
    level = level_of(confidence)
    return _solved(
        PatchFit, pairs, model, loss, labels=labels, folds=_folds(labels), length=lever, level=level
    )


def _solved(
    kind: type[AnyFit],
    pairs: Pairs,
    model: PatchModel,
    loss: LossName,
    *,
    labels: Labels,
    folds: Labels,
    length: float,
    level: float | None,
    scale: float | None = None,
) -> AnyFit:
    measure = Loss(loss, components=1)
    pairs.check(model.size)
    starts = starts_of(model, pairs, loss, scale)
    if isinstance(model, PointsPatch) and model.known and model.friction == "ellipse":
        starts = [starts[0] + [0.0, *off] for off in ((0.0, 0.0), (0.1, 0.0), (0.0, 0.1))]
    found = fitted(model, pairs, starts, loss, scale)
    if isinstance(model, PointsPatch):
        found = found.replace(p=model.sorted(found.p))
    return kind(
        pairs,
        model=model,
        found=found,
        loss=measure.replace(scale=found.scale or 1.0),
        blocks=labels,
        folds=folds,
        length=length,
        confidence=level,
    )


def _model(
    reservoir: Any,
    direction: Any,
    *,
    points: Any,
    places: Array | None,
    loads: Array | None,
    friction: Any,
    pressure: Any,
    point_radius: Any,
    frame: Frame,
) -> PatchModel:
    """Return the model that the arguments of `fit_patch` name."""
    arrays.choice(reservoir, "reservoir", ("ellipsoid", "contensou", "supports"))
    arrays.choice(friction, "friction", ("isotropic", "ellipse"))
    arrays.choice(pressure, "pressure", ("hertz", "uniform"))
    count, spot = arrays.count(points, "points"), arrays.positive(point_radius, "point_radius")
    if direction is not None:
        arrays.choice(direction, "direction", ("ellipsoid",))
    if reservoir != "supports":
        for name, given in (("places", places), ("loads", loads)):
            if given is not None:
                raise ParameterError(name, 'are those of reservoir="supports"')
    for one in (places, loads):
        count = count if one is None else len(one)
    if places is not None and loads is not None and len(places) != len(loads):
        raise DimensionError("loads", f"must be {len(places)} numbers, got {len(loads)}")
    of: EllipsoidPatch | PointsPatch
    match reservoir:
        case "ellipsoid":
            if friction != "isotropic":
                raise ParameterError("friction", "is no matter of an ellipsoid: leave it out")
            of = EllipsoidPatch(frame=frame)
        case "contensou":
            of = PointsPatch(1, radius=None, friction=friction, frame=frame, pressure=pressure)
        case _:
            if count < 2 and places is None:
                raise ParameterError("points", f"must be 2 or more, got {count}")
            of = PointsPatch(
                count, radius=spot, friction=friction, frame=frame, places=places, loads=loads
            )
    if direction is None:
        return of
    if frame == "ground" and reservoir != "ellipsoid":
        raise ParameterError(
            "direction",
            'must be None with frame="ground": C would have places of the body and D axes of the '
            "ground, which no one law has",
        )
    return ExtendedPatch(of)


def compare_patches(
    wrench: ArrayLike,
    twist: ArrayLike,
    *,
    models: Mapping[str, Mapping[str, Any]] | None = None,
    **options: Any,
) -> Comparison:
    """Compare models of a patch by BIC, and by parts of the pairs that are left out in turn.

    Args:
        wrench: as for `fit_patch`.
        twist: likewise.
        models: options of `fit_patch` that choose a model, by the name it shall have; by default
            ellipsoids, associated and extended, a round area, and 3 and 5 support points.
        options: of `fit_patch` that all models have in common; ``angle``, ``normal_force``,
            ``length``, ``loss``, ``blocks`` and ``confidence`` can be given here only.

    Raises:
        ParameterError: if a model has an option that does not choose it.

    >>> import numpy as np
    >>> import asperity as asp
    >>> from asperity.identify import compare_patches
    >>> law = asp.FrictionLaw.associated(asp.CoulombContensou(0.3))
    >>> twist = np.random.default_rng(0).normal(size=(200, 3))
    >>> found = compare_patches(
    ...     -law.force(twist),
    ...     twist,
    ...     models={"ellipsoid": {}, "round area": {"reservoir": "contensou"}},
    ... )
    >>> found.best.name
    'round area'
    """
    if models is None:
        return fit_patch(wrench, twist, **options).comparison
    for name, one in models.items():
        _check_options(name, one)
    fits = {name: fit_patch(wrench, twist, **{**options, **one}) for name, one in models.items()}
    if not fits:
        raise ParameterError("models", "must name at least one model")
    return next(iter(fits.values())).compare({name: fit.model for name, fit in fits.items()})


# Options of `fit_patch` that choose a model, and those that say what is compared and how.
_CHOOSING = (
    "reservoir",
    "direction",
    "points",
    "places",
    "loads",
    "friction",
    "pressure",
    "point_radius",
    "frame",
)
_COMMON = ("angle", "normal_force", "length", "loss", "blocks", "confidence")


def _check_options(name: str, options: Any) -> None:
    """Refuse options of one model by which it would be fitted to other pairs than the rest."""
    if not isinstance(options, Mapping):
        raise ParameterError("models", f"{name!r} must be options of a model, got {options!r}")
    for key in options:
        if key in _COMMON:
            raise ParameterError(
                "models",
                f"{key!r} of {name!r} is for all models: give it to compare_patches itself",
            )
        if key not in _CHOOSING:
            raise ParameterError(
                "models",
                f"{key!r} of {name!r} is no option: those of a model are {', '.join(_CHOOSING)}",
            )


def fit_supports(
    pushes: ArrayLike | Sequence[ArrayLike],
    points: ArrayLike | Sequence[ArrayLike],
    *,
    weight: float | None = None,
    loads: ArrayLike | None = None,
    friction: Friction = "isotropic",
    direction: Literal["ellipse"] | None = None,
    frame: Frame = "ground",
    length: float | None = None,
    loss: LossName = "soft_l1",
    scale: float | None = None,
    blocks: int | ArrayLike = 20,
    confidence: float | None = 0.95,
) -> SupportsFit:
    """Fit the friction law of a body's support points to quasi-static pushes of it.

    The points are known, and so are their normal forces: of three points by statics, from the
    weight. Pushes are slow, so that the applied wrench is minus the friction on the body.

    Comparisons leave out whole logs in turn where there are three or more, so that a law is asked
    for what it says of another day or of other points; else five parts of whole blocks.

    Args:
        pushes: pose of the centre of mass (x, y in m, angle in rad) in the middle of the push, its
            displacement (Δx, Δy, Δangle), and the applied force and torque about the centre of
            mass (F_x, F_y in N, τ in N m), in the ground's axes; shape ``(n, 9)``, further columns
            are left aside. Or a sequence of such arrays, one of each log.
        points: where the support points are from the centre of mass, in m and in the body's axes,
            ``(K, 2)``; or a sequence of such arrays, one of each log.
        weight: in N, which gives the normal forces of three points.
        loads: of the points in N, ``(K,)``, instead.
        friction: ``"isotropic"`` or ``"ellipse"``.
        direction: None for the associated law D = C; ``"ellipse"`` for ellipses C and D.
        frame: whether the axes of the ellipses are those of the ``"ground"`` or of the ``"body"``.
        length: ℓ in m by which torques are divided, so that they weigh as much as forces; by
            default the root mean square distance of the points from the centre of mass.
        loss: as for `fit_patch`.
        scale: of a robust loss in N; by default it is that of the residuals.
        blocks: as for `fit_patch`; the pushes are those of all logs in turn. Blocks that hold
            pushes of several logs are left out as a whole, and then logs are not.
        confidence: level of the confidence intervals; None for none.

    Raises:
        FitError: if there are too few pushes, or the applied forces have the other sign.
        ParameterError: if arguments do not belong together.

    >>> import numpy as np
    >>> from asperity.identify import fit_supports
    >>> random = np.random.default_rng(0)
    >>> points = np.array([[0.05, 0.0], [-0.03, 0.04], [-0.03, -0.04]])
    >>> move = random.normal(size=(100, 3)) * [0.01, 0.01, 0.2]
    >>> velocity = move[:, None, :2] + move[:, None, 2:] * points[:, ::-1] * [-1.0, 1.0]
    >>> along = velocity / np.linalg.norm(velocity, axis=-1, keepdims=True)
    >>> force = 0.3 * along * np.array([[6.0], [5.0], [5.0]])  # 16 N on three points
    >>> torque = points[:, 0] * force[..., 1] - points[:, 1] * force[..., 0]
    >>> pushes = np.column_stack([np.zeros((100, 3)), move, force.sum(1), torque.sum(1)])
    >>> fit = fit_supports(pushes, points, weight=16.0)
    >>> round(fit.parameters["mu"].value, 3)
    0.3
    """
    logs, at = _logs(pushes, points)
    known = None if loads is None else _positive(loads, "loads")
    heavy = None if weight is None else arrays.positive(weight, "weight")
    if (known is None) == (heavy is None):
        raise ParameterError("weight", "must be given, or loads instead")
    arrays.choice(friction, "friction", ("isotropic", "ellipse"))
    frame = arrays.choice(frame, "frame", ("body", "ground"))
    if direction is not None:
        arrays.choice(direction, "direction", ("ellipse",))
    normal = [_statics(one, heavy) if known is None else known for one in at]
    count = len(at[0])
    for one, force in zip(at, normal, strict=True):
        if len(one) != count:
            raise DimensionError("points", f"must be {count} in every log, got {len(one)}")
        if len(force) != count:
            raise DimensionError("loads", f"must be {count} numbers, got {len(force)}")
    spread = float(np.sqrt(np.mean([(one**2).sum(axis=1).mean() for one in at])))
    if length is None and not spread > 0.0:
        raise ParameterError("length", "must be given: all points are at the centre of mass")
    lever = spread if length is None else arrays.positive(length, "length")
    rows = np.concatenate(logs)
    turned = rows[:, 2]
    motion, force = in_ground(rows[:, 3:6], -turned), in_ground(rows[:, 6:9], -turned)
    motion[:, 2] *= lever
    force[:, 2] /= lever
    pairs = Pairs(
        force,
        motion,
        angle=turned,
        places=np.concatenate(
            [
                np.broadcast_to(one / lever, (len(log), count, 2))
                for one, log in zip(at, logs, strict=True)
            ]
        ),
        loads=np.concatenate(
            [np.broadcast_to(one, (len(log), count)) for one, log in zip(normal, logs, strict=True)]
        ),
    )
    model: PatchModel
    if direction is None:
        model = PointsPatch(count, radius=SPOT, known=True, friction=friction, frame=frame)
    else:
        model = ExtendedPoints(frame=frame)
    labels = _labels(blocks, len(pairs))
    level = level_of(confidence)
    folds = np.repeat(np.arange(len(logs)), [len(log) for log in logs])
    if len(logs) < _FEWEST_LOGS or (np.ndim(blocks) and _straddles(labels, folds)):
        folds = _folds(labels)
    return _solved(
        SupportsFit,
        pairs,
        model,
        loss,
        labels=labels,
        folds=folds,
        length=lever,
        level=level,
        scale=None if scale is None else arrays.positive(scale, "scale"),
    )


# Columns of a push that are needed.
_COLUMNS = 9


def _logs(pushes: Any, points: Any) -> tuple[list[Array], list[Array]]:
    if np.ndim(pushes) == 2 if isinstance(pushes, np.ndarray) else _is_table(pushes):
        pushes, points = [pushes], [points]
    logs = []
    for one in arrays.several(pushes, "pushes"):
        log = arrays.array(one, "pushes", (None, None))
        if log.shape[1] < _COLUMNS:
            raise DimensionError("pushes", f"must have 9 columns or more, got {log.shape[1]}")
        logs.append(log)
    listed = arrays.several(points, "points")
    if len(listed) != len(logs):
        raise DimensionError("points", f"must be those of {len(logs)} logs, got {len(listed)}")
    return logs, [arrays.array(one, "points", (None, 2)) for one in listed]


def _is_table(pushes: Any) -> bool:
    """Return whether it is one array written as lists."""
    try:
        return np.ndim(pushes[0]) == 1
    except (TypeError, IndexError, KeyError, ValueError):
        return False


def _statics(points: Array, weight: float | None) -> Array:
    """Return the normal forces of three points, which balance the weight."""
    if weight is None or len(points) != 3:
        raise ParameterError(
            "loads", f"must be given: statics do not tell those of {len(points)} points"
        )
    try:
        loads = np.linalg.solve(np.vstack([points.T, np.ones(3)]), [0.0, 0.0, weight])
    except np.linalg.LinAlgError:
        raise ParameterError("points", "must not lie on a line") from None
    if loads.min() <= 0.0:
        raise ParameterError("points", "must have the centre of mass among them, at (0, 0)")
    return np.asarray(loads, dtype=np.float64)


def _positive(values: Any, name: str) -> Array:
    numbers = arrays.array(values, name, (None,))
    if not numbers.size or numbers.min() <= 0.0:
        raise ParameterError(name, f"must be positive, got {numbers.tolist()}")
    return numbers


def _folds(labels: Labels) -> Labels:
    """Return parts of whole blocks in the order in which they begin, of nearly equal size.

    Pairs of one block are not independent: it must not be on both sides when a part is left out.
    """
    first, sizes = np.unique(labels, return_index=True, return_counts=True)[1:]
    order = np.argsort(first)
    middle = np.empty(len(order))
    middle[order] = np.cumsum(sizes[order]) - 0.5 * sizes[order]
    parts = np.floor(middle * _FOLDS / len(labels))
    # A block that is larger than a part leaves gaps.
    return np.unique(parts[labels], return_inverse=True)[1]


def _straddles(labels: Labels, parts: Labels) -> bool:
    """Return whether a block lies in several parts."""
    pairs = np.unique(np.stack([labels, parts]), axis=1)
    return pairs.shape[1] > len(np.unique(labels))


def _labels(blocks: Any, count: int) -> Labels:
    """Return the block of every pair."""
    given = arrays.array(blocks, "blocks")
    if given.ndim:
        labels = np.unique(arrays.array(blocks, "blocks", (count,)), return_inverse=True)[1]
        if labels.max() < 1:
            raise ParameterError("blocks", "must be two or more")
        return labels
    number = arrays.count(blocks, "blocks", least=2)
    if number > count:
        raise ParameterError("blocks", f"must be {count} or fewer, as many as there are pairs")
    return np.arange(count) * number // count
