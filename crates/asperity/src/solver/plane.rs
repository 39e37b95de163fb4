//! One contact in the plane: all solutions by walking along bdry *D*, and a fast path to one of them.
//!
//! In slip `−P_T = P_N x` with `x = z/k_C(z)` on bdry *C* and `z` on bdry *D*. The normal row gives
//! `P_N = −b_N/den(x)`, and multiplied by `den` the slip velocity is `v(x) = c₀ − A x`: the equation
//! `F = n × v = 0` with `n·v/den > 0` has no pole. See `law/table.rs` for the table that is walked.

use asperity_set::{Arc, BoundaryPoint, ConvexSet, Matrix, StarSet, Vector};

use super::local::{Local, LocalSolution, Selection, Shape};
use crate::contact::{ContactState, Phase};
use crate::law::{COARSE, Cell, FINE_PER_COARSE, Node, WalkTable};

type V = Vector<2>;

#[inline]
fn cross(a: &V, b: &V) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The slip equation of one contact.
struct Slip<'a, 'b> {
    local: &'a Local<'b, 2>,
    c0: V,
    a: Matrix<2>,
    sign: f64,
    norm_c: f64,
    norm_a: f64,
    /// `|F|` below this value is rounding.
    rounding: f64,
    /// Square of a radius of curvature that is not extreme.
    mild_bend: f64,
}

impl<'a, 'b> Slip<'a, 'b> {
    fn new(local: &'a Local<'b, 2>, table: &WalkTable) -> Self {
        let (c0, a) = local.affine();
        // Sums of magnitudes bound the norms and need no roots.
        let norm_c = c0.x.abs() + c0.y.abs();
        let norm_a = a.m11.abs() + a.m12.abs() + a.m21.abs() + a.m22.abs();
        let rounding = 8.0 * f64::EPSILON * (norm_c + norm_a * table.largest_radius);
        let mild_bend = (10.0 * table.largest_radius).powi(2);
        Self { local, c0, a, sign: local.sign(), norm_c, norm_a, rounding, mild_bend }
    }

    #[inline]
    fn velocity(&self, x: &V) -> V {
        self.c0 - self.a * x
    }

    fn on_reservoir(&self, point: &BoundaryPoint) -> V {
        point.position / self.local.law.reservoir().gauge(&point.position)
    }

    fn value(&self, point: &BoundaryPoint) -> f64 {
        cross(&point.normal, &self.velocity(&self.on_reservoir(point)))
    }

    /// How far `F` and `n·v` may stray from their chords over a cell.
    #[inline]
    fn stray(&self, cell: &Cell) -> f64 {
        self.norm_c * cell.normal + self.norm_a * cell.product
    }

    /// Whether `F` or `n·v` rules out a solution between two nodes.
    fn excluded_between(&self, first: &Node, last: &Node, stray: f64) -> bool {
        let [(f, along_f), (g, along_g)] = [first, last].map(|node| {
            let v = self.velocity(&node.x);
            (cross(&node.point.normal, &v), self.sign * node.point.normal.dot(&v))
        });
        let no_root = (f >= 0.0) == (g >= 0.0) && f.abs().min(g.abs()) > stray;
        no_root || along_f.max(along_g) < -stray
    }

    /// The slip solution at a root, if it is one: `v` along `n` and the normal force positive.
    fn admit(&self, point: &BoundaryPoint, degenerate: bool) -> Option<LocalSolution<2>> {
        let x = self.on_reservoir(point);
        let v = self.velocity(&x);
        self.admit_root(&point.normal, &x, &v, degenerate)
    }

    #[inline]
    fn admit_root(&self, n: &V, x: &V, v: &V, degenerate: bool) -> Option<LocalSolution<2>> {
        let outward = self.sign * n.dot(v) > 0.0;
        let pressed = self.sign * self.local.denominator(x) > 0.0;
        (outward && pressed).then(|| self.local.slip(x, v, degenerate))
    }
}

/// All solutions, in the order open, stick, slips counter-clockwise along bdry *D*.
pub(super) fn solutions(local: &Local<'_, 2>, out: &mut Vec<LocalSolution<2>>) {
    out.clear();
    if local.prescribed == Some(0.0) {
        out.push(local.open());
        return;
    }
    if local.prescribed.is_none() && local.b_n >= 0.0 {
        out.push(local.open());
    }
    out.extend(local.stick().solution);
    if local.prescribed.is_none() && local.b_n == 0.0 {
        return;
    }
    let table = local.law.table();
    let slip = Slip::new(local, table);
    let scan = Scan::new(&slip, table);
    for i in 0..COARSE {
        if scan.excluded(&slip, table, i) {
            continue;
        }
        for j in i * FINE_PER_COARSE..(i + 1) * FINE_PER_COARSE {
            let (first, last) = (&table.nodes[j], &table.nodes[j + 1]);
            let stray = slip.stray(&table.fine[j]);
            if !slip.excluded_between(first, last, stray) {
                search(&slip, &Arc { start: first.point, end: last.point }, stray, 0, out);
            }
        }
    }
    merge(local, out);
}

/// All roots of `F` on an arc from whose chord it strays by at most `stray`.
fn search(
    slip: &Slip<'_, '_>,
    arc: &Arc,
    stray: f64,
    depth: usize,
    out: &mut Vec<LocalSolution<2>>,
) {
    let direction = slip.local.law.direction();
    let ends = [&arc.start, &arc.end].map(|point| slip.value(point));
    let smallest = ends[0].abs().min(ends[1].abs());
    if (ends[0] >= 0.0) != (ends[1] >= 0.0) {
        let root = arc.root(direction, slip.rounding, |point| slip.value(point));
        out.extend(slip.admit(&root, false));
        return;
    }
    let wrong = |p: &BoundaryPoint| {
        slip.sign * p.normal.dot(&slip.velocity(&slip.on_reservoir(p))) < -stray
    };
    if smallest > stray || (wrong(&arc.start) && wrong(&arc.end)) {
        return;
    }
    let middle = arc.middle(direction);
    let flat = slip.value(&middle).abs().max(ends[0].abs()).max(ends[1].abs()) <= slip.rounding;
    if flat || depth == 24 {
        // A continuum of solutions is represented by its ends, a double root by itself.
        let ends = [arc.start, arc.end];
        out.extend(ends.iter().take(if flat { 2 } else { 1 }).filter_map(|p| slip.admit(p, true)));
        return;
    }
    // The distance to the chord falls with the square of the length.
    let halves = [Arc { start: arc.start, end: middle }, Arc { start: middle, end: arc.end }];
    for half in &halves {
        search(slip, half, 0.3 * stray, depth + 1, out);
    }
}

/// Removes slip solutions that are stick on the boundary of *C*, and neighbours that are one root.
fn merge(local: &Local<'_, 2>, out: &mut Vec<LocalSolution<2>>) {
    let sticks = out.iter().any(|s| s.phase == Phase::Stick);
    let scale = local.b_t.norm();
    out.retain(|s| s.phase != Phase::Slip || !sticks || s.slip.norm() > 1e-12 * scale);
    let first = out.iter().position(|s| s.phase == Phase::Slip).unwrap_or(out.len());
    let mut kept = first;
    for i in first..out.len() {
        let candidate = out[i];
        match out[first..kept].iter().position(|s| same_root(s, &candidate, scale)) {
            // A root at the end of a cell is seen from the next cell as a double root.
            Some(place) if out[first + place].degenerate => out[first + place] = candidate,
            Some(_) => {}
            None => {
                out[kept] = candidate;
                kept += 1;
            }
        }
    }
    out.truncate(kept);
}

/// Whether two slip solutions are one; double roots are located to the size of the last bisection.
fn same_root(a: &LocalSolution<2>, b: &LocalSolution<2>, scale: f64) -> bool {
    let tolerance = if a.degenerate || b.degenerate { 1e-7 } else { 1e-12 };
    (a.tangent - b.tangent).norm() <= tolerance * a.tangent.norm()
        && (a.slip - b.slip).norm() <= tolerance * scale
}

/// `F` and `n·v` at all coarse nodes.
struct Scan {
    value: [f64; COARSE],
    along: [f64; COARSE],
}

impl Scan {
    fn new(slip: &Slip<'_, '_>, table: &WalkTable) -> Self {
        let (c0, a) = (&slip.c0, &slip.a);
        let ([n0, n1], [[n0x0, n0x1], [n1x0, n1x1]]) = (&table.columns.n, &table.columns.nx);
        let (mut value, mut along) = ([0.0; COARSE], [0.0; COARSE]);
        for i in 0..COARSE {
            let v0 = a.m11 * n0x0[i] + a.m12 * n0x1[i];
            let v1 = a.m21 * n1x0[i] + a.m22 * n1x1[i];
            along[i] = slip.sign * (c0.x * n0[i] + c0.y * n1[i] - v0 - v1);
            let w0 = a.m21 * n0x0[i] + a.m22 * n0x1[i];
            let w1 = a.m11 * n1x0[i] + a.m12 * n1x1[i];
            value[i] = c0.y * n0[i] - c0.x * n1[i] - w0 + w1;
        }
        Self { value, along }
    }

    /// Whether cell `i` certainly holds no solution.
    #[inline]
    fn excluded(&self, slip: &Slip<'_, '_>, table: &WalkTable, i: usize) -> bool {
        let next = (i + 1) % COARSE;
        let stray = slip.stray(&table.coarse[i]);
        let (f, g) = (self.value[i], self.value[next]);
        let no_root = (f >= 0.0) == (g >= 0.0) && f.abs().min(g.abs()) > stray;
        no_root || self.along[i].max(self.along[next]) < -stray
    }

    /// Whether exactly one cell is left, and that with a change of sign.
    fn has_one_root(&self, slip: &Slip<'_, '_>, table: &WalkTable) -> bool {
        let mut open = (0..COARSE).filter(|&i| !self.excluded(slip, table, i));
        let Some(cell) = open.next() else { return false };
        let changes = (self.value[cell] >= 0.0) != (self.value[(cell + 1) % COARSE] >= 0.0);
        // One change of sign may still be three roots unless F is monotone within its bound there.
        changes && open.next().is_none() && self.monotone(slip, table, cell)
    }

    /// Whether `F` changes more over the cell than its derivative's sign allows for further roots:
    /// checked on the fine nodes.
    fn monotone(&self, slip: &Slip<'_, '_>, table: &WalkTable, cell: usize) -> bool {
        let range = cell * FINE_PER_COARSE..(cell + 1) * FINE_PER_COARSE;
        let value = |j: usize| {
            let node = &table.nodes[j];
            cross(&node.point.normal, &slip.velocity(&node.x))
        };
        let mut changes = 0;
        for j in range {
            let (f, g) = (value(j), value(j + 1));
            if (f >= 0.0) != (g >= 0.0) {
                changes += 1;
            } else if f.abs().min(g.abs()) <= slip.stray(&table.fine[j]) {
                return false;
            }
        }
        changes == 1
    }
}

/// The solution that continues `state`, by the fast path where uniqueness is certain.
#[inline(always)]
pub(super) fn solve(
    local: &Local<'_, 2>,
    state: &ContactState,
    guess: impl Fn() -> V,
    buffer: &mut Vec<LocalSolution<2>>,
) -> Option<Selection<2>> {
    match fast(local, guess) {
        Some(solution) => Some(Selection { solution, ambiguous: false }),
        None => select_among_all(*local, state, buffer),
    }
}

#[cold]
#[inline(never)]
fn select_among_all(
    local: Local<'_, 2>,
    state: &ContactState,
    buffer: &mut Vec<LocalSolution<2>>,
) -> Option<Selection<2>> {
    solutions(&local, buffer);
    let solution = local.select(buffer, state)?;
    let continuum = buffer.iter().any(|s| s.degenerate && s.phase == Phase::Slip);
    Some(Selection { solution, ambiguous: buffer.len() > 1 || continuum })
}

/// The solution, if it is found quickly and certainly the only one.
#[inline(always)]
fn fast(local: &Local<'_, 2>, guess: impl Fn() -> V) -> Option<LocalSolution<2>> {
    if local.prescribed == Some(0.0) {
        return Some(local.open());
    }
    let table = local.law.table();
    if local.prescribed.is_none() {
        let pressed = local.block.g_nn > local.block.g_nt.norm() * table.largest_radius;
        if !pressed {
            return None;
        }
        if local.b_n >= 0.0 {
            return Some(local.open());
        }
    }
    let stick = local.stick();
    let shape = match local.prescribed {
        Some(_) => local.block.shape,
        None => Shape::new(&local.affine().1, table.smallest_sine),
    };
    let certain = match shape {
        Shape::Monotone => true,
        Shape::Scalar => !table.may_be_ambiguous(&stick.load, stick.gauge),
        Shape::General => false,
    };
    if let Some(solution) = stick.solution {
        if solution.degenerate || stick.gauge >= 1.0 - 1e-12 {
            return None;
        }
        if certain {
            return Some(solution);
        }
        let slip = Slip::new(local, table);
        let scan = Scan::new(&slip, table);
        return (0..COARSE).all(|i| scan.excluded(&slip, table, i)).then_some(solution);
    }
    let slip = Slip::new(local, table);
    let mut found = newton(&slip, &guess());
    if found.is_none() {
        // Where the last direction is far off, the normal below the load is a good start.
        found = newton(&slip, &local.law.direction().gauge_jet(&stick.load).1);
    }
    let solution = found?;
    (certain || Scan::new(&slip, table).has_one_root(&slip, table)).then_some(solution)
}

/// Newton's method for `F = 0` in the angle of the normal, from the last slip direction.
///
/// `dF/dφ = −n·v − n × (A x')`, `x' = (z' − x (∇k_C·z'))/k_C`, `z' = ∇²h_D n⊥`.
fn newton(slip: &Slip<'_, '_>, guess: &V) -> Option<LocalSolution<2>> {
    let law = slip.local.law;
    let mut n = guess.try_normalize(0.0)?;
    for _ in 0..10 {
        let turn = V::new(-n.y, n.x);
        let (z, dz) = law.direction().support_derivative(&n, &turn);
        let (gauge, gradient) = law.reservoir().gauge_jet(&z);
        let reciprocal = 1.0 / gauge;
        let x = z * reciprocal;
        let v = slip.velocity(&x);
        let value = cross(&n, &v);
        if value.abs() <= slip.rounding {
            return slip.admit_root(&n, &x, &v, false);
        }
        let dx = (dz - x * gradient.dot(&dz)) * reciprocal;
        let dv = slip.a * dx;
        let step = value / (n.dot(&v) + cross(&n, &dv));
        // What is left after the last step is its square, unless the boundary is nearly flat here.
        if step.abs() < 1e-8 && dx.norm_squared() < slip.mild_bend {
            return slip.admit_root(&n, &(x + dx * step), &(v - dv * step), false);
        }
        // The comparison also turns away NaN from flats, where the Hessian is infinite.
        if !(step.abs() < 0.3) {
            return None;
        }
        n = (n + turn * step) * (1.0 / (1.0 + step * step).sqrt());
    }
    None
}
