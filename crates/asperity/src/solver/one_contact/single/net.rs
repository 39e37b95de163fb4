//! Starts of Newton's method for sliding with drilling.
//!
//! In space there is no boundary curve to walk along. But what sliding along a direction would leave of the slip can be
//! asked on a net of directions. Where the part of it across the directions vanishes within a cell of the net, by linear
//! interpolation, the contact may slide along one of that cell, and there Newton's method begins.

use asperity_set::{ConvexSet, Vector};

use super::{Single, V};

/// Pieces of every edge of an octahedron, whose faces are divided into triangles.
const PIECES: usize = 8;

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
    /// Visits percussions near which there may be a slip, one of each cell of the net that may hold one, until `ends`.
    ///
    /// With velocities `v = w/h` of directions `w` and half widths `h` of *D* the percussions of an ellipsoid along the axes
    /// are as evenly spread as the net, whatever the unit of drilling. Between the directions of a cell percussions and slip
    /// are interpolated: on edges and flats of *D* that is what hulls of their corners do. Cells in which the normal force
    /// would pull, or the slip be against the direction, count as well.
    pub(super) fn over_net(&self, ends: &mut dyn FnMut(V) -> bool) -> bool {
        let sizes = Vector::<3>::from_fn(|i, _| {
            let axis = Vector::<P>::from_fn(|j, _| f64::from(u8::from(i == j)));
            let direction = self.law.direction();
            0.5 * (direction.support(&axis) + direction.support(&-axis))
        });
        (0..if P == 3 { 8 } else { 0 }).any(|octant| self.over_face(octant, &sizes, ends))
    }

    /// The same over one face of the octahedron, between whose corners `i + j + k` = `PIECES`.
    fn over_face(
        &self,
        octant: usize,
        sizes: &Vector<3>,
        ends: &mut dyn FnMut(V) -> bool,
    ) -> bool {
        let sign = |axis: usize| if octant >> axis & 1 == 0 { 1.0 } else { -1.0 };
        let at = |i: usize, j: usize| {
            let corner = [i as f64, j as f64, (PIECES - i - j) as f64];
            let w = Vector::<3>::from_fn(|axis, _| sign(axis) * corner[axis]).normalize();
            self.sliding(&w, sizes)
        };
        let mut last: [Option<Sliding>; PIECES + 1] = std::array::from_fn(|j| at(0, j));
        for i in 1..=PIECES {
            let mut next = last;
            for j in 0..=PIECES - i {
                next[j] = at(i, j);
                let below = [last[j], last[j + 1], next[j]];
                let above = if j == 0 { [None; 3] } else { [last[j], next[j - 1], next[j]] };
                for cell in [below, above] {
                    let [Some(a), Some(b), Some(c)] = cell else { continue };
                    if self.between([a, b, c]).is_some_and(&mut *ends) {
                        return true;
                    }
                }
            }
            last = next;
        }
        false
    }

    /// Sliding along `w`, whose components are in units of the inverse half widths of *D*. With `P_N = −b_N/denominator` the
    /// product has no pole where the denominator vanishes, as in `plane/`.
    fn sliding(&self, w: &Vector<3>, sizes: &Vector<3>) -> Option<Sliding> {
        let (unit, denominator) =
            self.per_normal(&Vector::<P>::from_fn(|i, _| w[i] / sizes[i]))?;
        let percussion = unit * self.normal.prescribed().unwrap_or(-self.b[0]);
        let slip = self.tangent(&(self.b * denominator + self.g * percussion));
        let slip = Vector::<3>::from_fn(|i, _| slip[i] * sizes[i]);
        let across = slip - w * w.dot(&slip);
        Some(Sliding { direction: *w, percussion, denominator, across })
    }

    /// The percussions with which no slip is left across the directions of a cell, by interpolation; `None` without such.
    fn between(&self, corners: [Sliding; 3]) -> Option<V> {
        let [a, b, c] = corners.map(|corner| corner.across);
        let outwards: Vector<3> = corners.iter().map(|corner| corner.direction).sum();
        let weights = [b.cross(&c), c.cross(&a), a.cross(&b)].map(|area| area.dot(&outwards));
        let sum: f64 = weights.iter().sum();
        // The comparisons also turn away NaN.
        if !weights.iter().all(|weight| weight * sum >= 0.0) || !(sum.abs() > 0.0) {
            return None;
        }
        let (mut percussion, mut denominator) = (V::zeros(), 0.0);
        for (corner, weight) in corners.iter().zip(weights) {
            percussion += corner.percussion * (weight / sum);
            denominator += corner.denominator * (weight / sum);
        }
        let percussion = percussion / denominator;
        percussion.iter().all(|p| p.is_finite()).then_some(percussion)
    }
}
