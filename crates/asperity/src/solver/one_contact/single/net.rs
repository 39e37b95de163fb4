//! Starts of Newton's method for sliding with drilling.
//!
//! In space there is no boundary curve to walk along. But what sliding along a direction would leave of the slip can be
//! asked on a net of directions. Where the part of it across the directions vanishes within a cell of the net, by linear
//! interpolation, the contact may slide along one of that cell, and there Newton's method begins.

use asperity_set::{ConvexSet, Matrix, Vector};

use super::{ITERATIONS, Single, V};

/// How often the faces of an octahedron are divided into four, and how often cells that may hold a slip are: beside cusps of
/// *C* Newton's method needs a near start.
const DIVISIONS: usize = 3;
const DEEPEST: usize = 7;

/// Sliding along one direction of the net: percussions and what is left of the slip, both times the denominator.
#[derive(Clone, Copy)]
struct Sliding {
    direction: Vector<3>,
    percussion: V,
    denominator: f64,
    /// The part across the direction of the slip that these percussions leave, in units of the half widths of *D*.
    across: Vector<3>,
}

impl<const P: usize> Single<'_, P> {
    /// Visits slip velocities and their percussions near which there may be a slip, one of each cell of the net that may hold
    /// one, until `ends`.
    ///
    /// With velocities `v = w/h` of directions `w` and half widths `h` of *D* the percussions of an ellipsoid along the axes
    /// are as evenly spread as the net, whatever the unit of drilling. Between the directions of a cell percussions and slip
    /// are interpolated: on edges and flats of *D* that is what hulls of their corners do. Cells in which the normal force
    /// would pull, or the slip be against the direction, count as well.
    pub(super) fn over_net(&self, ends: &mut dyn FnMut(Vector<P>, V) -> bool) -> bool {
        let sizes = Vector::<3>::from_fn(|i, _| {
            let axis = Vector::<P>::from_fn(|j, _| f64::from(u8::from(i == j)));
            let direction = self.law.direction();
            0.5 * (direction.support(&axis) + direction.support(&-axis))
        });
        let corner = |octant: usize, axis: usize| {
            let sign = if octant >> axis & 1 == 0 { 1.0 } else { -1.0 };
            self.sliding(&Vector::<3>::from_fn(|i, _| if i == axis { sign } else { 0.0 }), &sizes)
        };
        P == 3
            && (0..8).any(|octant| {
                let face = [0, 1, 2].map(|axis| corner(octant, axis));
                self.over_cell(face, &sizes, 0, ends)
            })
    }

    /// The same over a cell, divided so often.
    fn over_cell(
        &self,
        cell: [Option<Sliding>; 3],
        sizes: &Vector<3>,
        divided: usize,
        ends: &mut dyn FnMut(Vector<P>, V) -> bool,
    ) -> bool {
        let [Some(a), Some(b), Some(c)] = cell else { return false };
        let (weights, percussion) = self.between([a, b, c]);
        // The comparisons also turn away NaN.
        let above = |least: f64| weights.iter().all(|weight| *weight >= least);
        if above(0.0) && percussion.iter().all(|p| p.is_finite()) {
            let [u, v, w] = weights;
            let direction = a.direction * u + b.direction * v + c.direction * w;
            if ends(Vector::from_fn(|i, _| direction[i] / sizes[i]), percussion) {
                return true;
            }
        }
        // Slips that vary strongly may vanish in the next cell.
        if divided == DEEPEST || divided >= DIVISIONS && !above(-0.5) {
            return false;
        }
        let middle =
            |a: Sliding, b: Sliding| self.sliding(&(a.direction + b.direction).normalize(), sizes);
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        let [a, b, c] = cell;
        [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            .into_iter()
            .any(|cell| self.over_cell(cell, sizes, divided + 1, ends))
    }

    /// Sliding along `w`, whose components are in units of the inverse half widths of *D*.
    fn sliding(&self, w: &Vector<3>, sizes: &Vector<3>) -> Option<Sliding> {
        let (percussion, denominator, slip) =
            self.slip_along(&Vector::<P>::from_fn(|i, _| w[i] / sizes[i]))?;
        let slip = Vector::<3>::from_fn(|i, _| slip[i] * sizes[i]);
        let across = slip - w * w.dot(&slip);
        Some(Sliding { direction: *w, percussion, denominator, across })
    }

    /// Percussions of sliding along `v` times the denominator `G_N·` of the normal one, this denominator, and the slip that
    /// they leave times the denominator: with `P_N = −b_N/denominator` there is no pole where it vanishes, as in `plane/`.
    fn slip_along(&self, v: &Vector<P>) -> Option<(V, f64, Vector<P>)> {
        let (unit, denominator) = self.per_normal(v)?;
        let percussion = unit * self.normal.prescribed().unwrap_or(-self.b[0]);
        let slip = self.tangent(&(self.b * denominator + self.g * percussion));
        Some((percussion, denominator, slip))
    }

    /// Newton's method for the slip velocity that the friction of sliding along it leaves, with differences.
    ///
    /// Beside cusps of *C* and on slender *D* the natural map has no derivative to speak of; along bdry *D* the
    /// percussions depend on the normal the less the sharper these are.
    pub(super) fn along_slips(&self, start: &Vector<P>) -> Option<V> {
        let off = |v: &Vector<P>| Some(self.slip_along(v)?.2 - v);
        let normal = start.try_normalize(0.0)?;
        let mut velocity = normal * self.slip_along(&normal)?.2.norm();
        'newton: for _ in 0..ITERATIONS {
            let (here, size) = (off(&velocity)?, velocity.norm());
            let mut jacobian = Matrix::<P>::zeros();
            for k in 0..P {
                let mut beside = velocity;
                beside[k] += 1e-7 * size;
                jacobian.set_column(k, &((off(&beside)? - here) / (1e-7 * size)));
            }
            let mut step = -(jacobian.try_inverse()? * here);
            let least = 1e-4 * step.norm();
            while !(off(&(velocity + step))?.norm() < here.norm()) {
                step *= 0.5;
                // Rounding ends the descent; the comparison also turns away NaN.
                if !(step.norm() > least) {
                    break 'newton;
                }
            }
            velocity += step;
        }
        let (percussion, denominator, slip) = self.slip_along(&velocity)?;
        let near = (slip - velocity).norm() < 1e-6 * velocity.norm();
        (denominator > 0.0 && near).then(|| percussion / denominator)
    }

    /// The percussions with which no slip is left across the directions of a cell, by interpolation with these weights,
    /// of which some are negative where the place is outside of the cell.
    fn between(&self, corners: [Sliding; 3]) -> ([f64; 3], V) {
        let [a, b, c] = corners.map(|corner| corner.across);
        let outwards: Vector<3> = corners.iter().map(|corner| corner.direction).sum();
        let weights = [b.cross(&c), c.cross(&a), a.cross(&b)].map(|area| area.dot(&outwards));
        let weights = weights.map(|weight| weight / weights.iter().sum::<f64>());
        let (mut percussion, mut denominator) = (V::zeros(), 0.0);
        for (corner, weight) in corners.iter().zip(weights) {
            percussion += corner.percussion * weight;
            denominator += corner.denominator * weight;
        }
        (weights, percussion / denominator)
    }
}
