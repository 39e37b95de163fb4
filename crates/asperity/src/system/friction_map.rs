//! Friction that depends on the place: the factor by which a plane multiplies the friction of what touches it.
//!
//! A map falls into regions within which the factor is smooth. Integrators continue it from the region in which a contact
//! is and change the region where the contact crosses a border.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use crate::argument::{ArgumentError, finite, length, positive, refuse};
use crate::system::ContactLaw;

/// A function of the position in a plane, in its axes from its point.
pub type Field = Arc<dyn Fn([f64; 2]) -> f64 + Send + Sync>;

/// Distance beyond a border, over that of the place from the origin, at which it is crossed: rounding of a place must not
/// cross it back.
const BEYOND: f64 = 1e-12;
/// The same over the size of the map, which may be far larger: rounding of distances from its borders.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The factor of friction over the places of a plane, in its axes from its point.
#[derive(Clone)]
#[non_exhaustive]
pub enum FrictionMap {
    /// Polygons with a factor each.
    Regions(Regions),
    /// Values between which it is interpolated.
    Raster(Raster),
    /// A smooth function with positive values.
    Function(Field),
}

/// Polygons in each of which the factor is constant; later ones cover earlier ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Regions {
    polygons: Vec<Polygon>,
    elsewhere: f64,
    size: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct Polygon {
    vertices: Vec<[f64; 2]>,
    factor: f64,
    /// The least and the largest coordinates of the vertices.
    bounds: [[f64; 2]; 2],
}

/// Values at the nodes of a rectangular grid, interpolated bilinearly, and beyond the grid those of its edge.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    nodes: [Vec<f64>; 2],
    factors: Vec<f64>,
    size: f64,
}

impl fmt::Debug for FrictionMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Regions(regions) => regions.fmt(f),
            Self::Raster(raster) => raster.fmt(f),
            Self::Function(_) => f.write_str("Function(..)"),
        }
    }
}

impl PartialEq for FrictionMap {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Regions(a), Self::Regions(b)) => a == b,
            (Self::Raster(a), Self::Raster(b)) => a == b,
            (Self::Function(a), Self::Function(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

impl FrictionMap {
    /// Polygons with their factors, the later ones on top, and the factor `elsewhere`.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if a polygon has fewer than three vertices or one that is not finite, or a factor is not positive.
    pub fn regions(
        polygons: impl IntoIterator<Item = (Vec<[f64; 2]>, f64)>,
        elsewhere: f64,
    ) -> Result<Self, ArgumentError> {
        positive("elsewhere", elsewhere)?;
        let mut size = f64::MIN_POSITIVE;
        let polygon = |(vertices, factor): (Vec<[f64; 2]>, f64)| {
            finite("regions", vertices.as_flattened())?;
            if vertices.len() < 3 {
                return refuse("regions", "must have three vertices at least each");
            }
            size = vertices.as_flattened().iter().fold(size, |size, x| size.max(x.abs()));
            let extreme = |of: fn(f64, f64) -> f64| {
                [0, 1].map(|k| vertices.iter().map(|v| v[k]).fold(vertices[0][k], of))
            };
            let bounds = [extreme(f64::min), extreme(f64::max)];
            Ok(Polygon { vertices, factor: positive("regions", factor)?, bounds })
        };
        let polygons = polygons.into_iter().map(polygon).collect::<Result<_, _>>()?;
        Ok(Self::Regions(Regions { polygons, elsewhere, size }))
    }

    /// The factor at all pairs of a node along `e₁` and one along `e₂`, one row for each of the first.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if nodes do not ascend, or factors are not as many or not positive.
    pub fn raster(nodes: [Vec<f64>; 2], factors: Vec<f64>) -> Result<Self, ArgumentError> {
        for (name, nodes) in ["x1", "x2"].into_iter().zip(&nodes) {
            finite(name, nodes)?;
            if nodes.is_empty() || nodes.windows(2).any(|pair| pair[0] >= pair[1]) {
                return refuse(name, "must ascend");
            }
        }
        length("factors", nodes[0].len() * nodes[1].len(), factors.len())?;
        factors.iter().try_for_each(|&factor| positive("factors", factor).map(drop))?;
        let size = nodes.iter().flatten().fold(f64::MIN_POSITIVE, |size, x| size.max(x.abs()));
        Ok(Self::Raster(Raster { nodes, factors, size }))
    }

    /// The number of the region of a place.
    pub fn region(&self, place: [f64; 2]) -> usize {
        match self {
            Self::Regions(Regions { polygons, .. }) => {
                let holds = |p: &Polygon| p.apart(place) <= 0.0 && p.distance(place) <= 0.0;
                let on_top = polygons.iter().rposition(holds);
                on_top.unwrap_or(polygons.len())
            }
            Self::Raster(raster) => {
                let [i, j] = [0, 1].map(|k| raster.nodes[k].partition_point(|x| *x <= place[k]));
                i * (raster.nodes[1].len() + 1) + j
            }
            Self::Function(_) => 0,
        }
    }

    /// The factor at a place as it is continued from a region.
    pub fn factor(&self, region: usize, place: [f64; 2]) -> f64 {
        match self {
            Self::Regions(Regions { polygons, elsewhere, .. }) => {
                polygons.get(region).map_or(*elsewhere, |polygon| polygon.factor)
            }
            Self::Raster(raster) => raster.factor(region, place),
            Self::Function(field) => field(place),
        }
    }

    /// A continuous function of the place that becomes positive just outside of a region.
    pub(crate) fn outside(&self, region: usize, place: [f64; 2]) -> f64 {
        match self {
            Self::Regions(Regions { polygons, size, .. }) => {
                let own = polygons.get(region).map_or(f64::NEG_INFINITY, |p| p.distance(place));
                let above = if region < polygons.len() { region + 1 } else { 0 };
                let covered = polygons[above..].iter().fold(own, |most, polygon| {
                    let apart = polygon.apart(place);
                    if apart > 0.0 && -apart <= most {
                        return most;
                    }
                    most.max(-polygon.distance(place))
                });
                covered - beyond(*size, place)
            }
            Self::Raster(raster) => {
                let cell = raster.cell(region);
                let out =
                    cell.iter().zip(place).map(|(range, x)| (range.start - x).max(x - range.end));
                out.fold(f64::NEG_INFINITY, f64::max) - beyond(raster.size, place)
            }
            Self::Function(_) => -1.0,
        }
    }

    /// How far along the line from `a` to `b`, as a part of it, a place outside of the region is where the line has left it.
    pub(crate) fn leaves(&self, region: usize, a: [f64; 2], b: [f64; 2]) -> Option<f64> {
        let mut crossings = match self {
            Self::Regions(Regions { polygons, .. }) => {
                let near = polygons.iter().filter(|polygon| {
                    let [low, high] = polygon.bounds;
                    (0..2).all(|k| a[k].min(b[k]) <= high[k] && a[k].max(b[k]) >= low[k])
                });
                near.flat_map(|polygon| polygon.crossings(a, b)).collect()
            }
            _ => Vec::new(),
        };
        crossings.push(1.0);
        crossings.sort_unstable_by(f64::total_cmp);
        let mut last = 0.0;
        let between =
            crossings.iter().map(|&next| 0.5 * (std::mem::replace(&mut last, next) + next));
        let along = |s: f64| [0, 1].map(|k| a[k] + s * (b[k] - a[k]));
        between.chain([1.0]).find(|&s| self.outside(region, along(s)) > 0.0)
    }

    /// Whether the factor jumps at borders.
    pub(crate) fn jumps(&self) -> bool {
        matches!(self, Self::Regions(_))
    }
}

/// How far beyond a border a place is outside of a region.
fn beyond(size: f64, [x1, x2]: [f64; 2]) -> f64 {
    BEYOND * size.min(x1.abs().max(x2.abs())) + ROUNDING * size
}

impl Polygon {
    fn edges(&self) -> impl Iterator<Item = [[f64; 2]; 2]> {
        let ends = self.vertices.iter().cycle().skip(1);
        self.vertices.iter().zip(ends).map(|(start, end)| [*start, *end])
    }

    /// A distance that the polygon has at least; zero within its bounds.
    fn apart(&self, place: [f64; 2]) -> f64 {
        let [low, high] = self.bounds;
        let out = [0, 1].map(|k| (low[k] - place[k]).max(place[k] - high[k]));
        out[0].max(out[1]).max(0.0)
    }

    /// Distance from the polygon, negative within it.
    fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let (mut nearest, mut inside) = (f64::INFINITY, false);
        for [[x1, y1], [x2, y2]] in self.edges() {
            let (along, from) = ([x2 - x1, y2 - y1], [x - x1, y - y1]);
            let square = along[0] * along[0] + along[1] * along[1];
            let part = (from[0] * along[0] + from[1] * along[1]) / square;
            let height = along[0] * from[1] - along[1] * from[0];
            // An edge of length zero is a point.
            nearest = nearest.min(if part > 0.0 && part < 1.0 {
                height.abs() / square.sqrt()
            } else if part >= 1.0 {
                (x - x2).hypot(y - y2)
            } else {
                from[0].hypot(from[1])
            });
            let rises = y2 > y1;
            inside ^= (y1 > y) != (y2 > y) && rises == (height > 0.0);
        }
        if inside { -nearest } else { nearest }
    }

    /// Where a line crosses the edges, as parts of the line.
    fn crossings(&self, a: [f64; 2], b: [f64; 2]) -> impl Iterator<Item = f64> {
        let along = [b[0] - a[0], b[1] - a[1]];
        self.edges().filter_map(move |[start, end]| {
            let height = |v: [f64; 2]| along[0] * (v[1] - a[1]) - along[1] * (v[0] - a[0]);
            let (from, to) = (height(start), height(end));
            let part = from / (from - to);
            let crossing = [0, 1].map(|k| start[k] + part * (end[k] - start[k]) - a[k]);
            let square = along[0] * along[0] + along[1] * along[1];
            let s = (crossing[0] * along[0] + crossing[1] * along[1]) / square;
            ((from > 0.0) != (to > 0.0) && s > 0.0 && s < 1.0).then_some(s)
        })
    }
}

impl Raster {
    /// The cell with a number, without ends at the edges of the grid.
    fn cell(&self, region: usize) -> [Range<f64>; 2] {
        let columns = self.nodes[1].len() + 1;
        let cell = [region / columns, region % columns];
        [0, 1].map(|k| {
            let node = |i: usize| self.nodes[k].get(i).copied();
            let start = cell[k].checked_sub(1).and_then(node);
            start.unwrap_or(f64::NEG_INFINITY)..node(cell[k]).unwrap_or(f64::INFINITY)
        })
    }

    fn factor(&self, region: usize, place: [f64; 2]) -> f64 {
        let columns = self.nodes[1].len();
        let cell = [region / (columns + 1), region % (columns + 1)];
        // The nodes on both sides, one twice beyond the grid, and the weight of the second.
        let [(i, s), (j, t)] = [0, 1].map(|k| {
            let last = self.nodes[k].len() - 1;
            let sides = [cell[k].saturating_sub(1), cell[k].min(last)];
            let [start, end] = sides.map(|node| self.nodes[k][node]);
            let weight = if end > start { (place[k] - start) / (end - start) } else { 0.0 };
            (sides, weight)
        });
        let row = |i: usize| {
            self.factors[i * columns + j[0]] * (1.0 - t) + self.factors[i * columns + j[1]] * t
        };
        row(i[0]) * (1.0 - s) + row(i[1]) * s
    }
}

/// Multiplies the rows of friction of a contact, each of this width, and their χ by a factor of its friction.
///
/// With `λ = φ λ̃` and `γ̃ = φ γ` the law of λ̃ is the one without the factor, as normal cones do not depend on the length
/// of γ, and `φ Wᵀ` has both: no solver needs to know.
pub(crate) fn scale_rows(
    factor: f64,
    law: &ContactLaw,
    width: usize,
    rows: &mut [f64],
    velocity: &mut [f64],
) {
    let normal = law.normal_rows();
    rows[normal * width..law.rows() * width].iter_mut().for_each(|entry| *entry *= factor);
    velocity[normal..].iter_mut().for_each(|chi| *chi *= factor);
}
