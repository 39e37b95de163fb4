"""Models of a patch: the wrench −λ over the twist, its derivatives, and the sets C and D."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

import numpy as np

from asperity._base import arrays
from asperity._base.arrays import Array
from asperity._base.storage.data import Kinds
from asperity._base.value import OptionalArray, Record, field, unchecked
from asperity.identify.models.coordinates import Coordinate, Scale
from asperity.law import FrictionLaw
from asperity.sets import (
    Ball,
    CoulombContensou,
    Ellipse,
    Ellipsoid,
    MinkowskiSum,
    StarSet,
)
from asperity.sets.shapes.reservoirs import Pressure

if TYPE_CHECKING:
    from asperity.identify.evidence.wrenches.pairs import Pairs

Frame = Literal["body", "ground"]
Friction = Literal["isotropic", "ellipse"]

SPOT = 1e-3
"""Radius of the spots of known points over ℓ: it only matters where a point stands still."""
# Entries of a lower triangular matrix, row by row; those of the diagonal are logarithms.
_ROWS, _COLUMNS = np.tril_indices(3)
_DIAGONAL = _ROWS == _COLUMNS
# Below this, series replace quotients that lose digits.
_SMALL = 1e-4
# Eigenvalues of second moments are kept off zero by this share of the largest.
_LEAST_SHARE = 1e-3


class Reported(NamedTuple):
    """A parameter that is reported.

    Attributes:
        name: of the parameter.
        scale: how it follows from `at`.
        at: its value on the scale in which its errors are nearly symmetric.
        angle_of: coordinates that vanish together where there is no anisotropy to be told.
        is_length: whether it is a length over ℓ.
    """

    name: str
    scale: Scale
    at: float
    angle_of: tuple[int, ...] = ()
    is_length: bool = False


class PatchModel(Record):
    """A family of laws of a patch with coordinates p."""

    if TYPE_CHECKING:

        @property
        def coordinates(self) -> tuple[Coordinate, ...]:
            """Their names and scales."""

        @property
        def frame(self) -> Frame:
            """Whether the sets keep their axes in the body or in the ground."""

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.coordinates)

    @property
    def words(self) -> str:
        """The model in words."""
        raise NotImplementedError

    def both(self, p: Array, pairs: Pairs) -> tuple[Array, Array]:
        """Return −λ at the twists, ``(n, 3)``, and its derivatives by p, ``(n, 3, k)``."""
        raise NotImplementedError

    @property
    def spot(self) -> float:
        """Radius over ℓ of the spots that stand for support points; 0 if there are none."""
        return 0.0

    def far(self, p: Array, radii: float, light: float) -> list[int]:
        """Return the support points that are no places of the patch."""
        return []

    def reservoir(self, p: Array) -> StarSet:
        """Return C in the axes of the law's frame, for bodies that have the angle 0."""
        raise NotImplementedError

    def law(self, p: Array) -> FrictionLaw:
        """Return the law."""
        return FrictionLaw.associated(self.reservoir(p))

    def reported(self, p: Array) -> list[Reported]:
        """Return the parameters that have a meaning."""
        raise NotImplementedError


def _entries(name: str) -> tuple[Coordinate, ...]:
    """Return the coordinates of a lower triangular matrix."""
    return tuple(
        Coordinate(f"{name}.entry_{i + 1}{j + 1}", Scale.LOG if i == j else Scale.PLAIN)
        for i, j in zip(_ROWS, _COLUMNS, strict=True)
    )


def _half_logarithm(name: str) -> tuple[Coordinate, ...]:
    """Return the coordinates of an ellipse: half the logarithm of its ratio, times the axis."""
    return tuple(Coordinate(f"{name}.{one}", Scale.PLAIN) for one in ("cos", "sin"))


class EllipsoidPatch(PatchModel):
    """C is an ellipsoid A·ball of R³ with a lower triangular A; the law is associated.

    Args:
        frame: whether C keeps its axes in the body or in the ground.
    """

    _: KW_ONLY
    frame: Frame = "body"
    coordinates = _entries("reservoir")

    @property
    def words(self) -> str:
        """The model in words."""
        return "an ellipsoid"

    def start(self, pairs: Pairs) -> Array:
        """Return the ellipsoid of the second moments of the wrenches."""
        wrench = pairs.wrench if self.frame == "body" else pairs.to_ground(pairs.wrench)
        moments = 3.0 * wrench.T @ wrench / len(wrench)
        moments += _LEAST_SHARE * np.trace(moments) * np.eye(3)
        entries = np.asarray(np.linalg.cholesky(moments)[_ROWS, _COLUMNS], dtype=np.float64)
        entries[_DIAGONAL] = np.log(entries[_DIAGONAL])
        return entries

    def both(self, p: Array, pairs: Pairs) -> tuple[Array, Array]:
        """Return −λ and its derivatives."""
        A, turned = _triangular(p), self.frame == "ground"
        V = pairs.to_ground(pairs.along) if turned else pairs.along
        u = V @ A
        sizes = np.linalg.norm(u, axis=1)
        g = u / sizes[:, None]
        f = g @ A.T
        # df = dA g + A (1 − g gᵀ) dAᵀV/‖u‖ for the entry (row, column) of A.
        by = (A.T[_COLUMNS].T[None] - f[:, :, None] * g[:, None, _COLUMNS]) * (
            V[:, None, _ROWS] / sizes[:, None, None]
        )
        by[:, _ROWS, np.arange(6)] += g[:, _COLUMNS]
        by[:, :, _DIAGONAL] *= np.exp(p[_DIAGONAL])
        if turned:
            return pairs.to_body(f), np.moveaxis(pairs.to_body(np.moveaxis(by, 1, 2)), 2, 1)
        return f, by

    def gauge(self, p: Array, z: Array) -> tuple[Array, Array]:
        """Return k_C and its gradient."""
        inverse = np.linalg.inv(_triangular(p))
        u = z @ inverse.T
        sizes = np.linalg.norm(u, axis=1)
        return sizes, (u @ inverse) / sizes[:, None]

    def reservoir(self, p: Array) -> StarSet:
        """Return the ellipsoid."""
        axes, lengths, _ = np.linalg.svd(_triangular(p))
        return Ellipsoid(lengths, axes=axes)

    def reported(self, p: Array) -> list[Reported]:
        """Return the parameters that have a meaning."""
        A = _triangular(p)
        extents, tilts = _extents(A)
        names = ("force_1", "force_2", "moment")
        found = [
            Reported(f"reservoir.{name}", Scale.LOG, math.log(one))
            for name, one in zip(names, extents, strict=True)
        ]
        # The zero-moment point is the place of the resultant while the patch slides.
        return found + _tilts("reservoir", tilts)


class PointsPatch(PatchModel):
    """C is the sum of the sets of support points, or the one of a round area; associated.

    The force of a point at r = (x, y) with the load N on a spot of radius ϱ has the support
    function μN √(‖B(v + ω × r)‖² + (ϱω)²), B = exp of a symmetric matrix without trace: the image
    of a ball. The radius ϱ is small, it makes the set of a point one with interior points. A
    round area has instead the support function of `CoulombContensou`, with a free radius.

    Args:
        count: number K of points.
        radius: ϱ over ℓ; None for a round area, whose radius is a coordinate.
        friction: isotropic (B = 1), or with ellipses, which all points have in common.
        frame: whether the ellipses keep their axes in the body or in the ground.
        places: of the points over ℓ, ``(K, 2)``; None if they are coordinates.
        loads: of the points, ``(K,)``; None if the μN are coordinates.
        known: whether the pairs hold places and loads.
        pressure: of a round area.
    """

    count: int
    _: KW_ONLY
    radius: float | None = None
    friction: Friction = "isotropic"
    frame: Frame = "body"
    places: OptionalArray = field(default=None)
    loads: OptionalArray = field(default=None)
    known: bool = False
    pressure: Pressure = "hertz"
    coordinates: tuple[Coordinate, ...] = field(init=False)
    _parts: tuple[slice, slice, slice, slice] = field(init=False)
    _unit: FrictionLaw | None = field(init=False)

    def _complete(self, given: dict[str, Any]) -> None:
        for name, columns in (("places", (2,)), ("loads", ())):
            if given[name] is not None:
                given[name] = arrays.array(given[name], name, (given["count"], *columns))

    def _derive(self) -> None:
        count, radius, known = self.count, self.radius, self.known
        points = range(1, count + 1)
        loads_of = [f"point_{i}.load" for i in points]
        places_of = [f"point_{i}.x{axis}" for i in points for axis in (1, 2)]
        if radius is None:
            loads_of, places_of = ["mu"], ["centre.1", "centre.2"]
        names = (
            ["mu"] if self.loads is not None or known else loads_of,
            [] if self.places is not None or known else places_of,
            ["radius"] if radius is None else [],
        )
        scales = (Scale.LOG, Scale.PLAIN, Scale.LOG)
        listed = [
            *(tuple(Coordinate(n, s) for n in own) for own, s in zip(names, scales, strict=True)),
            _half_logarithm("friction") if self.friction == "ellipse" else (),
        ]
        ends = np.cumsum([len(own) for own in listed]).tolist()
        parts = tuple(slice(a, b) for a, b in zip([0, *ends], ends, strict=False))
        unit = None
        if radius is None:
            unit = FrictionLaw.associated(CoulombContensou(1.0, pressure=self.pressure))
        self._keep(coordinates=sum(listed, ()), _parts=parts, _unit=unit)

    @property
    def words(self) -> str:
        """The model in words."""
        if self.radius is None:
            kind = f"a round area of {self.pressure} pressure"
        else:
            kind = f"{self.count} support points"
        if self.friction == "isotropic":
            return f"{kind} with isotropic friction"
        return f"{kind} with elliptic friction in the axes of the {self.frame}"

    @property
    def spot(self) -> float:
        """Radius over ℓ of the spots that stand for support points; 0 if there are none."""
        return self.radius or 0.0

    def _loads(self, p: Array, pairs: Pairs | None) -> Array:
        """Return μN of the points, ``(1 or n, K)``."""
        part = np.exp(p[self._parts[0]])[None]
        loads = pairs.loads if self.known and pairs is not None else self.loads
        return part if loads is None else part * np.atleast_2d(loads)

    def _places(self, p: Array, pairs: Pairs | None) -> Array:
        """Return the places of the points over ℓ, ``(1 or n, K, 2)``."""
        if self.known and pairs is not None and pairs.places is not None:
            return pairs.places
        places = p[self._parts[1]].reshape(-1, 2) if self.places is None else self.places
        return places[None]

    def _spot(self, p: Array) -> float:
        return float(np.exp(p[self._parts[2]][0])) if self.radius is None else self.radius

    def start(self, loads: Array, places: Array, radius: float) -> Array:
        """Return coordinates of isotropic friction."""
        p = np.zeros(self.size)
        mu = self._parts[0]
        if mu.stop - mu.start == self.count and self.loads is None and not self.known:
            p[mu] = np.log(loads)
        elif self.loads is not None:
            p[mu] = math.log(float(loads.sum() / self.loads.sum()))
        else:
            p[mu] = math.log(float(loads.sum()))
        p[self._parts[1]] = places.ravel()[: self._parts[1].stop - self._parts[1].start]
        p[self._parts[2]] = math.log(radius)
        return p

    def both(self, p: Array, pairs: Pairs) -> tuple[Array, Array]:
        """Return −λ and its derivatives."""
        V, weight, places = pairs.along, self._loads(p, pairs), self._places(p, pairs)
        spot, spin = self._spot(p), V[:, None, 2]
        x, y = places[..., 0], places[..., 1]
        v = np.stack([V[:, None, 0] - y * spin, V[:, None, 1] + x * spin], axis=-1)
        turned = self.frame == "ground" and self.friction == "ellipse"
        if turned:
            v = pairs.to_ground(v)
        B, dB = _stretch(p[self._parts[3]]) if self.friction == "ellipse" else (np.eye(2), None)
        u = np.concatenate([v @ B, np.broadcast_to(spot * spin, v.shape[:2])[..., None]], axis=-1)
        g, H = self._unit_set(u)

        def back(force: Array) -> Array:
            """Return weighted forces of the points in the body's axes."""
            plane = weight[..., None] * force
            return pairs.to_body(plane) if turned else plane

        def wrench(force: Array, spinning: Array) -> Array:
            moment = x * force[..., 1] - y * force[..., 0] + weight * spot * spinning
            return np.concatenate([force, moment[..., None]], axis=-1)

        f = back(g[..., :2] @ B)
        of_points = wrench(f, g[..., 2])
        total = of_points.sum(axis=1)
        by = np.empty((len(V), 3, self.size))
        loads, at, radius, ellipse = self._parts
        per_point = np.swapaxes(of_points, 1, 2)
        by[:, :, loads] = per_point if loads.stop - loads.start == self.count else total[:, :, None]
        if at.stop > at.start:
            for axis, motion in ((0, (0.0, 1.0)), (1, (-1.0, 0.0))):
                # Moving a point adds ω × δr to its velocity, and δr × f to the moment.
                dv = np.broadcast_to(np.array(motion) * spin[..., None], v.shape)
                dv = pairs.to_ground(dv) if turned else dv
                du = dv @ B
                dg = np.einsum("nkij,nkj->nki", H[..., :2], du)
                moved = wrench(back(dg[..., :2] @ B), dg[..., 2])
                moved[..., 2] += f[..., 1] if axis == 0 else -f[..., 0]
                by[:, :, at.start + axis : at.stop : 2] = np.swapaxes(moved, 1, 2)
        if radius.stop > radius.start:
            dg = H[..., 2] * (spot * spin)[..., None]
            grown = wrench(back(dg[..., :2] @ B), dg[..., 2] + g[..., 2])
            by[:, :, radius.start] = grown.sum(axis=1)
        for k in range(ellipse.stop - ellipse.start):
            assert dB is not None
            dg = np.einsum("nkij,nkj->nki", H[..., :2], v @ dB[k])
            stretched = back(g[..., :2] @ dB[k] + dg[..., :2] @ B)
            by[:, :, ellipse.start + k] = wrench(stretched, dg[..., 2]).sum(axis=1)
        return total, by

    def _unit_set(self, u: Array) -> tuple[Array, Array]:
        """Return gradient and Hessian of the support function of the ball, or of an area."""
        if self._unit is not None:
            return -self._unit.force(u), -self._unit.jacobian(u)
        sizes = np.maximum(np.linalg.norm(u, axis=-1), np.finfo(float).tiny)
        g = u / sizes[..., None]
        H = (np.eye(3) - g[..., :, None] * g[..., None, :]) / sizes[..., None, None]
        return g, H

    def gauge(self, p: Array, z: Array) -> tuple[Array, Array]:
        """Return k_C and its gradient."""
        found = self.reservoir(p)
        return found.gauge(z), found.gauge_gradient(z)

    def reservoir(self, p: Array) -> StarSet:
        """Return the sum of the sets of the points."""
        B = _stretch(p[self._parts[3]])[0] if self.friction == "ellipse" else np.eye(2)
        unit: StarSet = Ball(1.0)
        if self._unit is not None:
            unit = self._unit.reservoir
        maps = []
        spot = self._spot(p)
        for load, (x, y) in zip(self._loads(p, None)[0], self._places(p, None)[0], strict=True):
            image = np.zeros((3, 3))
            image[:2, :2], image[2, :2], image[2, 2] = B, np.array([-y, x]) @ B, spot
            maps.append(unit.mapped(load * image))
        return maps[0] if len(maps) == 1 else MinkowskiSum(maps)

    def reported(self, p: Array) -> list[Reported]:
        """Return the parameters that have a meaning."""
        found = []
        if self.loads is not None or self.known or self.radius is None:
            found.append(Reported("mu", Scale.LOG, float(p[0])))
        else:
            whole = float(np.logaddexp.reduce(p[self._parts[0]]))
            found.append(Reported("load", Scale.LOG, whole))
        if self._parts[1].stop > self._parts[1].start:
            loads, places = self._loads(p, None)[0], self._places(p, None)[0]
            for axis, at in enumerate(loads @ places / loads.sum(), 1):
                found.append(Reported(f"centre.{axis}", Scale.PLAIN, float(at), is_length=True))
        if self.radius is None:
            at = float(p[self._parts[2]][0])
            found.append(Reported("radius", Scale.LOG, at, is_length=True))
        found += _ellipse_reported(p, self._parts[3], "friction")
        if self.radius is not None and not self.known and self.count > 1:
            places = self._places(p, None)[0]
            for i, place in enumerate(places, 1):
                if self.loads is None:
                    load = float(p[self._parts[0]][i - 1])
                    found.append(Reported(f"point_{i}.load", Scale.LOG, load))
                if self.places is None:
                    found += [
                        Reported(f"point_{i}.x{axis}", Scale.PLAIN, float(at), is_length=True)
                        for axis, at in enumerate(place, 1)
                    ]
        return found

    def far(self, p: Array, radii: float, light: float) -> list[int]:
        """Return the points that are no places of the patch.

        They are farther from the centre than so many times the radius of half of the load, or
        carry a smaller share of the load.
        """
        if self.places is not None or self.radius is None or self.count == 1:
            return []
        loads, places = self._loads(p, None)[0], self._places(p, None)[0]
        shares = loads / loads.sum()
        # Half of the load is within this distance.
        away = np.linalg.norm(places - shares @ places, axis=1)
        order = np.argsort(away)
        half = away[order][np.searchsorted(np.cumsum(shares[order]), 0.5)]
        outside = away > radii * max(half, np.finfo(float).tiny)
        return [int(i) for i in np.flatnonzero(outside | (shares < light))]

    def sorted(self, p: Array) -> Array:
        """Return the coordinates with free points in the order of their angle about the centre."""
        if self.places is not None or self.known or self.count == 1:
            return p
        loads, places = self._loads(p, None)[0], self._places(p, None)[0]
        away = places - loads @ places / loads.sum()
        order = np.argsort(np.arctan2(away[:, 1], away[:, 0]), kind="stable")
        result = p.copy()
        if self.loads is None:
            result[self._parts[0]] = p[self._parts[0]][order]
            result[self._parts[1]] = places[order].ravel()
        return result

    def law(self, p: Array) -> FrictionLaw:
        """Return the law; of known points that of one in the plane, per unit of its load."""
        if not self.known:
            return super().law(p)
        mu = float(np.exp(p[0]))
        if self.friction == "isotropic":
            return FrictionLaw.isotropic(mu)
        return FrictionLaw.associated(_ellipse(mu, p[self._parts[3]]))


class ExtendedPatch(PatchModel):
    """The extended law of a model of C and an ellipsoid D of R³.

    Args:
        of: the model of C.
    """

    of: Annotated[EllipsoidPatch | PointsPatch, unchecked]
    coordinates: tuple[Coordinate, ...] = field(init=False)
    frame: Frame = field(init=False)

    def _derive(self) -> None:
        coordinates = *self.of.coordinates, *_entries("direction")[1:]
        self._keep(coordinates=coordinates, frame=self.of.frame)

    @property
    def spot(self) -> float:
        """Radius over ℓ of the spots that stand for support points; 0 if there are none."""
        return self.of.spot

    def far(self, p: Array, radii: float, light: float) -> list[int]:
        """Return the support points that are no places of the patch."""
        return self.of.far(p[: self.of.size], radii, light)

    @property
    def words(self) -> str:
        """The model in words."""
        return f"{self.of.words}, with an ellipsoid for D"

    def start(self, p: Array, ellipsoid: Array) -> Array:
        """Return the coordinates where D is an ellipsoid of given coordinates."""
        entries = ellipsoid.copy()
        entries[_DIAGONAL] -= ellipsoid[0]
        # An ellipsoid of wrenches that belong to no law may be as flat as numbers can say.
        entries[~_DIAGONAL] *= math.exp(-max(ellipsoid[0], -700.0))
        return np.concatenate([p, entries[1:]])

    def both(self, p: Array, pairs: Pairs) -> tuple[Array, Array]:
        """Return −λ and its derivatives."""
        turned = self.frame == "ground"
        V = pairs.to_ground(pairs.along) if turned else pairs.along
        own, entries = p[: self.of.size], np.concatenate([[0.0], p[self.of.size :]])
        Q = _triangular(entries)
        u = V @ Q
        z = u @ Q.T
        k, normal = self.of.gauge(own, z)
        f = z / k[:, None]
        # k_C(z) = max n·z/h_C(n): by the envelope theorem only h_C depends on C's coordinates.
        straight = pairs.at(normal).replace(angle=None)
        grown = np.einsum("nj,njk->nk", normal, self.of.both(own, straight)[1])
        by = np.empty((len(V), 3, self.size))
        by[:, :, : self.of.size] = f[:, :, None] * grown[:, None, :]
        # dz = dQ Qᵀ V + Q dQᵀ V.
        dz = Q.T[_COLUMNS].T[None] * V[:, None, _ROWS]
        dz[:, _ROWS, np.arange(6)] += u[:, _COLUMNS]
        dz[:, :, _DIAGONAL] *= np.exp(entries[_DIAGONAL])
        along = np.einsum("nj,njk->nk", normal, dz)
        by[:, :, self.of.size :] = ((dz - f[:, :, None] * along[:, None, :]) / k[:, None, None])[
            :, :, 1:
        ]
        if turned:
            f = pairs.to_body(f)
            by = np.moveaxis(pairs.to_body(np.moveaxis(by, 1, 2)), 2, 1)
        return f, by

    def reservoir(self, p: Array) -> StarSet:
        """Return C."""
        return self.of.reservoir(p[: self.of.size])

    def direction(self, p: Array) -> StarSet:
        """Return D, of any scale."""
        axes, lengths, _ = np.linalg.svd(_triangular(np.concatenate([[0.0], p[self.of.size :]])))
        return Ellipsoid(lengths, axes=axes)

    def law(self, p: Array) -> FrictionLaw:
        """Return the extended law."""
        return FrictionLaw(self.reservoir(p), self.direction(p))

    def reported(self, p: Array) -> list[Reported]:
        """Return the parameters that have a meaning."""
        A = _triangular(np.concatenate([[0.0], p[self.of.size :]]))
        extents, tilts = _extents(A)
        found = self.of.reported(p[: self.of.size])
        for name, one in zip(("force_2", "moment"), extents[1:], strict=True):
            found.append(Reported(f"direction.{name}_ratio", Scale.LOG, math.log(one / extents[0])))
        return found + _tilts("direction", tilts)


class ExtendedPoints(PatchModel):
    """Known support points, each with the extended law of two ellipses of the plane.

    Args:
        frame: whether the ellipses keep their axes in the body or in the ground.
    """

    _: KW_ONLY
    frame: Frame = "ground"
    coordinates = (
        Coordinate("mu", Scale.LOG),
        *_half_logarithm("friction"),
        *_half_logarithm("direction"),
    )

    @property
    def words(self) -> str:
        """The model in words."""
        return f"ellipses for C and D of each point in the axes of the {self.frame}"

    def both(self, p: Array, pairs: Pairs) -> tuple[Array, Array]:
        """Return −λ and its derivatives."""
        assert pairs.places is not None
        assert pairs.loads is not None
        turned = self.frame == "ground"
        V, x, y = pairs.along, pairs.places[..., 0], pairs.places[..., 1]
        spin = V[:, None, 2]
        v = np.stack([V[:, None, 0] - y * spin, V[:, None, 1] + x * spin], axis=-1)
        v = pairs.to_ground(v) if turned else v
        weight = (np.exp(p[0]) * pairs.loads)[..., None]
        # D = exp(T)·disk has the point D²v; C = exp(S)·disk the gauge ‖exp(−S) z‖.
        E, dE = _stretch(2.0 * p[3:])
        M, dM = _stretch(-2.0 * p[1:3])
        z = v @ E
        s = np.sqrt(np.maximum(np.einsum("nki,ij,nkj->nk", z, M, z), np.finfo(float).tiny))

        def wrench(force: Array) -> Array:
            force = pairs.to_body(weight * force) if turned else weight * force
            moment = x * force[..., 1] - y * force[..., 0]
            return np.concatenate([force, moment[..., None]], axis=-1).sum(axis=1)

        f = z / s[..., None]
        total = wrench(f)
        columns = [total]
        for one in dM:
            quadratic = -2.0 * np.einsum("nki,ij,nkj->nk", f, one, f)
            columns.append(wrench(-0.5 * f * quadratic[..., None]))
        for one in dE:
            dz = 2.0 * (v @ one) / s[..., None]
            columns.append(wrench(dz - f * np.einsum("nki,ij,nkj->nk", f, M, dz)[..., None]))
        return total, np.stack(columns, axis=-1)

    def reported(self, p: Array) -> list[Reported]:
        """Return the parameters that have a meaning."""
        return [
            Reported("mu", Scale.LOG, float(p[0])),
            *_ellipse_reported(p, slice(1, 3), "friction"),
            *_ellipse_reported(p, slice(3, 5), "direction"),
        ]

    def law(self, p: Array) -> FrictionLaw:
        """Return the law of one point, per unit of its load."""
        return FrictionLaw(_ellipse(math.exp(p[0]), p[1:3]), _ellipse(1.0, p[3:]))


class OffsetPatch(PatchModel):
    """Wrenches of a law about another point of the body; its place over ℓ are two coordinates.

    Args:
        of: the model of the law.
    """

    of: PatchModel
    coordinates: tuple[Coordinate, ...] = field(init=False)
    frame: Frame = field(init=False)

    def _derive(self) -> None:
        places = (Coordinate(f"point.x{axis}", Scale.PLAIN) for axis in (1, 2))
        self._keep(coordinates=(*self.of.coordinates, *places), frame=self.of.frame)

    def both(self, p: Array, pairs: Pairs) -> tuple[Array, Array]:
        """Return −λ and its derivatives."""
        f, own = self.of.both(p[:-2], pairs)
        x, y = p[-2:]
        by = np.zeros((len(f), 3, self.size))
        by[:, :, :-2] = own
        by[:, 2, :-2] -= x * own[:, 1] - y * own[:, 0]
        by[:, 2, -2:] = np.stack([-f[:, 1], f[:, 0]], axis=-1)
        total = f.copy()
        total[:, 2] -= x * f[:, 1] - y * f[:, 0]
        return total, by


def _triangular(entries: Array) -> Array:
    result = np.zeros((3, 3))
    result[_ROWS, _COLUMNS] = np.where(_DIAGONAL, np.exp(np.minimum(entries, 700.0)), entries)
    return result


def _extents(A: Array) -> tuple[Array, Array]:
    """Return the support function of A·ball along the axes, and its three correlations."""
    C = A @ A.T
    extents: Array = np.sqrt(np.diag(C))
    R = C / np.outer(extents, extents)
    return extents, R[[0, 0, 1], [1, 2, 2]]


def _tilts(part: str, tilts: Array) -> list[Reported]:
    pairs = zip(("12", "13", "23"), tilts, strict=True)
    return [Reported(f"{part}.tilt_{name}", Scale.PLAIN, one) for name, one in pairs]


def _stretch(q: Array) -> tuple[Array, tuple[Array, Array]]:
    """Return exp S for S = [[q₁, q₂], [q₂, −q₁]], and its derivatives by q."""
    r = float(np.hypot(*q))
    S = np.array([[q[0], q[1]], [q[1], -q[0]]])
    units = (np.array([[1.0, 0.0], [0.0, -1.0]]), np.array([[0.0, 1.0], [1.0, 0.0]]))
    # A step of a search may go far: beyond the range of numbers is infinite, and is refused there.
    whole = float(np.cosh(r))
    quotient = float(np.sinh(r)) / r if r > _SMALL else 1.0 + r * r / 6.0
    slope = (whole - quotient) / (r * r) if r > _SMALL else 1.0 / 3.0
    B = whole * np.eye(2) + quotient * S
    first, second = (
        quotient * one * np.eye(2) + slope * one * S + quotient * unit
        for one, unit in zip(q, units, strict=True)
    )
    return B, (first, second)


def _ellipse(mean: float, q: Array) -> StarSet:
    r = float(np.hypot(*q))
    return Ellipse(mean * math.exp(r), mean * math.exp(-r), angle=0.5 * math.atan2(q[1], q[0]))


def _ellipse_reported(p: Array, part: slice, name: str) -> list[Reported]:
    if part.stop == part.start:
        return []
    q, at = p[part], tuple(range(part.start, part.stop))
    return [
        Reported(f"{name}.ratio", Scale.LOG, 2.0 * float(np.hypot(*q)), at),
        Reported(f"{name}.angle", Scale.ANGLE, 0.5 * math.atan2(q[1], q[0]), at),
    ]


PATCH_KINDS: Kinds = {
    one.__name__: one for one in (EllipsoidPatch, PointsPatch, ExtendedPatch, ExtendedPoints)
}
"""Models as data in files."""
