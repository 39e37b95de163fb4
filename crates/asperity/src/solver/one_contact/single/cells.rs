//! Search over the cells of a sphere of slip directions, for sliding with drilling.
//!
//! In space there is no boundary curve to walk along. But what sliding along a direction would leave of the slip can be
//! asked on a net of directions. Where the part of it across the directions vanishes within a cell of the net, by linear
//! interpolation, the contact may slide along one of that cell, and there Newton's method begins.

use std::collections::HashMap;
use std::sync::LazyLock;

use asperity_set::{ConvexSet, Vector};

use super::{Evaluations, Single, V};

/// How often the faces of an icosahedron are divided into four, for a first net and for one that is asked when all else has
/// failed. Of 4,000 contacts near percussions with which they would slip along an edge of a box, friction pressing them in or
/// lifting them off as strongly as the normal force, other means leave 23 unsolved. Of these 21 are solved with one
/// division, 22 with two, 23 with three.
const DIVISIONS: [usize; 2] = [1, 3];
/// Directions of the finest net.
const MOST: usize = 642;

/// Made once in a process. The first directions of a net are those of the coarser one.
static NETS: LazyLock<[Net; 2]> = LazyLock::new(|| DIVISIONS.map(Net::new));

/// Directions all around, and the triangles between them.
struct Net {
    directions: Vec<Vector<3>>,
    cells: Vec<[usize; 3]>,
}

impl Net {
    fn new(divisions: usize) -> Self {
        let mut net = Self::icosahedron();
        for _ in 0..divisions {
            net.divide();
        }
        net
    }

    /// Twenty triangles of neighbours among the twelve corners.
    fn icosahedron() -> Self {
        let golden = 0.5 * (1.0 + 5_f64.sqrt());
        let corner = |k: usize| {
            let (short, long) = ([1.0, -1.0][k & 1], [golden, -golden][k >> 1 & 1]);
            let mut corner = Vector::<3>::zeros();
            (corner[k / 4], corner[(k / 4 + 1) % 3]) = (short, long);
            corner
        };
        let corners: Vec<_> = (0..12).map(corner).collect();
        let near = |a: usize, b: usize| (corners[a] - corners[b]).norm() < 2.1;
        let mut cells = Vec::new();
        for a in 0..12 {
            for b in (a + 1..12).filter(|&b| near(a, b)) {
                cells.extend((b + 1..12).filter(|&c| near(a, c) && near(b, c)).map(|c| [a, b, c]));
            }
        }
        Self { directions: corners.iter().map(|corner| corner.normalize()).collect(), cells }
    }

    /// Divides every triangle into four at the middles of its sides.
    fn divide(&mut self) {
        let mut middles = HashMap::new();
        let mut middle = |a: usize, b: usize, directions: &mut Vec<Vector<3>>| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                directions.push((directions[a] + directions[b]).normalize());
                directions.len() - 1
            })
        };
        let mut cells = Vec::with_capacity(4 * self.cells.len());
        for &[a, b, c] in &self.cells {
            let ab = middle(a, b, &mut self.directions);
            let bc = middle(b, c, &mut self.directions);
            let ca = middle(c, a, &mut self.directions);
            cells.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        self.cells = cells;
    }
}

/// Sliding along a direction of a net.
#[derive(Clone, Copy)]
struct Sliding {
    /// Percussions times `denominator`, as `Single::sliding` has them.
    percussion: V,
    denominator: f64,
    /// The part across the direction of the slip that these percussions leave, in units of the half widths of *D*.
    across: Vector<3>,
}

/// What was asked of the nets so far.
pub(super) struct Cells {
    asked: usize,
    slidings: [Option<Sliding>; MOST],
    nets: std::slice::Iter<'static, Net>,
}

impl Default for Cells {
    fn default() -> Self {
        Self { asked: 0, slidings: [None; MOST], nets: NETS.iter() }
    }
}

impl<const P: usize> Single<'_, P> {
    /// Solutions that Newton's method finds from the cells of the next net of slip directions in which there may be one;
    /// none if there are not enough evaluations left for the net. `cells` is what was asked before, at first nothing.
    ///
    /// With velocities `v = w/h` of directions `w` and half widths `h` of *D* the percussions of an ellipsoid along the axes
    /// are as evenly spread as the net, whatever the unit of drilling. Between the directions of a cell percussions and slip
    /// are interpolated: on edges and flats of *D* that is what hulls of their corners do. Cells in which the normal force
    /// would pull, or the slip be against the direction, count as well: without them ten of the 23 contacts named above are
    /// solved with one division and 21 with three.
    pub(super) fn over_cells(
        &self,
        cells: &mut Option<Cells>,
        left: &mut Evaluations,
        keep: &mut dyn FnMut(V) -> bool,
    ) -> bool {
        if P != 3 {
            return false;
        }
        let cells = cells.get_or_insert_default();
        let Some(net) = cells.nets.next() else { return false };
        if !left.allow(net.directions.len() - cells.asked) {
            return false;
        }
        let half_width = |i: usize| {
            let mut axis = Vector::<P>::zeros();
            axis[i] = 1.0;
            let direction = self.law.direction();
            0.5 * (direction.support(&axis) + direction.support(&-axis))
        };
        let sizes = Vector::<3>::from_fn(|i, _| half_width(i));
        let slide = |w: &Vector<3>| {
            let (percussion, denominator, slip) =
                self.sliding(&Vector::<P>::from_fn(|i, _| w[i] / sizes[i]))?;
            let slip = Vector::<3>::from_fn(|i, _| slip[i] * sizes[i]);
            Some(Sliding { percussion, denominator, across: slip - w * w.dot(&slip) })
        };
        for (sliding, w) in cells.slidings.iter_mut().zip(&net.directions).skip(cells.asked) {
            left.take();
            *sliding = slide(w);
        }
        cells.asked = net.directions.len();
        for cell in &net.cells {
            if !left.are_left() {
                break;
            }
            let [Some(a), Some(b), Some(c)] = cell.map(|i| cells.slidings[i]) else { continue };
            let outwards = cell.iter().map(|&i| net.directions[i]).sum::<Vector<3>>();
            if let Some(p) = self.between([a, b, c], &outwards)
                && self.newton(p, left).is_some_and(&mut *keep)
            {
                return true;
            }
        }
        false
    }

    /// The percussions with which no slip is left across the directions of a cell, by interpolation; `None` without such.
    fn between(&self, corners: [Sliding; 3], outwards: &Vector<3>) -> Option<V> {
        let [a, b, c] = corners.map(|corner| corner.across);
        let weights = [b.cross(&c), c.cross(&a), a.cross(&b)].map(|area| area.dot(outwards));
        let sum: f64 = weights.iter().sum();
        // The comparisons also turn away NaN.
        if !weights.iter().all(|weight| weight * sum >= 0.0) || !(sum.abs() > 0.0) {
            return None;
        }
        let mut percussion = V::zeros();
        let mut denominator = 0.0;
        for (corner, weight) in corners.iter().zip(weights) {
            percussion += corner.percussion * (weight / sum);
            denominator += corner.denominator * (weight / sum);
        }
        let percussion = percussion / denominator;
        percussion.iter().all(|p| p.is_finite()).then_some(percussion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The triangles cover the sphere once: Euler's characteristic, and the solid angles add up to 4π.
    #[test]
    fn nets_cover_the_sphere_once() {
        for net in NETS.iter() {
            let (corners, cells) = (net.directions.len(), net.cells.len());
            assert!(corners <= MOST && corners + cells - 3 * cells / 2 == 2);
            assert_eq!(net.directions[..NETS[0].directions.len()], NETS[0].directions);
            let angle = |cell: &[usize; 3]| {
                let [a, b, c] = cell.map(|i| net.directions[i]);
                let above = a.dot(&b.cross(&c)).abs();
                2.0 * above.atan2(1.0 + a.dot(&b) + b.dot(&c) + c.dot(&a))
            };
            let sum: f64 = net.cells.iter().map(angle).sum();
            assert!((sum - 4.0 * std::f64::consts::PI).abs() < 1e-12);
        }
    }
}
