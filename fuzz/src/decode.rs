//! Numbers, vectors and sets from bytes: reasonable ones mostly, extreme ones now and then.
//!
//! When the bytes run out everything becomes its simplest value, so that every input means something.

use arbitrary::Unstructured;
use asperity::set::{
    Ball, CappedRectangle, Convex, CoulombContensou, Cuboid, Ellipse, Ellipsoid, Matrix,
    PolarCurve, Polygon, Pressure, SetError, Star, Superellipsoid, SupportCurve, Vector,
    WedgeAsperity,
};

/// How far from one numbers may lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Range {
    /// 1e±2.
    Narrow,
    /// 1e±8, rarely.
    Wide,
    /// Anything, also what is no number.
    Any,
}

/// The bytes, and what is made of them.
pub struct Source<'a>(Unstructured<'a>);

impl<'a> Source<'a> {
    pub fn new(data: &'a [u8]) -> Self {
        Self(Unstructured::new(data))
    }

    pub fn byte(&mut self) -> u8 {
        self.0.arbitrary().unwrap_or(0)
    }

    /// One of `0..n`.
    pub fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n
    }

    /// Whether something that happens once in `n` happens.
    pub fn once_in(&mut self, n: usize) -> bool {
        self.below(n) == n - 1
    }

    /// In `[0, 1)`, on a grid on which coincidences are frequent.
    pub fn unit(&mut self) -> f64 {
        let fine: u16 = self.0.arbitrary().unwrap_or(0);
        if fine & 3 == 0 { f64::from(fine >> 12) / 16.0 } else { f64::from(fine) / 65536.0 }
    }

    /// In `[-1, 1)`.
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// An angle in `[-π, π)`, often a multiple of a sixteenth of a turn.
    pub fn angle(&mut self) -> f64 {
        std::f64::consts::PI * self.signed()
    }

    /// A positive number.
    pub fn size(&mut self, range: Range) -> f64 {
        let near = 10f64.powf(2.0 * self.signed());
        match (range, self.byte()) {
            (Range::Narrow, _) | (_, 0..=199) => near,
            (_, 200..=239) => near * 10f64.powf(6.0 * self.signed()),
            (Range::Wide, _) => 1.0,
            (Range::Any, 240..=249) => near * 10f64.powf(290.0 * self.signed()),
            (Range::Any, k) => [f64::MIN_POSITIVE, 5e-324, f64::MAX, f64::INFINITY, f64::NAN, 0.0]
                [usize::from(k) - 250],
        }
    }

    /// A number of either sign, now and then zero.
    pub fn number(&mut self, range: Range) -> f64 {
        let size = self.size(range);
        match self.byte() {
            0..=15 => 0.0,
            16..=135 => size,
            _ => -size,
        }
    }

    pub fn vector<const P: usize>(&mut self, range: Range) -> Vector<P> {
        Vector::from_fn(|_, _| self.number(range))
    }

    /// Not the zero vector.
    pub fn direction<const P: usize>(&mut self) -> Vector<P> {
        let direction = Vector::<P>::from_fn(|_, _| self.signed());
        if direction.amax() > 0.0 { direction } else { Vector::repeat(1.0) }
    }

    fn sizes<const P: usize>(&mut self, range: Range) -> Vector<P> {
        Vector::from_fn(|_, _| self.size(range))
    }

    fn exponent(&mut self) -> f64 {
        match self.below(8) {
            0 => 1.0,
            1 => 2.0,
            2 => 0.3 + 0.7 * self.unit(),
            3 => 1.0 + 0.2 * self.unit(),
            4 | 5 => 1.2 + 5.0 * self.unit(),
            6 => 5.0 + 100.0 * self.unit(),
            _ => self.size(Range::Wide),
        }
    }

    /// A convex set; `None` where the parameters are refused.
    pub fn convex<const P: usize>(&mut self, range: Range, depth: usize) -> Option<Convex<P>> {
        self.star(range, depth)?.as_convex().cloned()
    }

    /// A tree of sets; `None` where parameters are refused.
    pub fn star<const P: usize>(&mut self, range: Range, depth: usize) -> Option<Star<P>> {
        // Combinations of drilling sets have no closed form for anything and take seconds: there are none.
        let depth = if P == 3 { depth.min(1) } else { depth };
        let kind = match self.below(if depth == 0 { 8 } else { 14 }) {
            kind @ 4..=7 if P == 3 && depth == 0 => kind - 4,
            kind => kind,
        };
        let set: Result<Star<P>, SetError> = match kind {
            0 => Ball::new(self.size(range)).map(|set| Convex::from(set).into()),
            1 => Ellipsoid::new(self.sizes(range)).map(|set| Convex::from(set).into()),
            2 => Superellipsoid::new(self.sizes(range), self.exponent()).map(Star::from),
            3 => {
                let (lower, upper) = (self.sizes(range), self.sizes(range));
                Cuboid::new(-lower, upper).map(|set| Convex::from(set).into())
            }
            4..=7 => return self.special(range),
            8 => self.star::<P>(range, depth - 1)?.scaled(self.size(range)),
            9 | 10 => {
                let map = Matrix::from_fn(|i, j| self.number(range) + f64::from(u8::from(i == j)));
                self.star(range, depth - 1)?.mapped(&map)
            }
            11 => Star::intersection(&self.stars(range, depth - 1)?),
            12 => Star::union(&self.stars(range, depth - 1)?),
            _ => Star::minkowski_sum(&self.stars(range, depth - 1)?),
        };
        set.ok()
    }

    fn stars<const P: usize>(&mut self, range: Range, depth: usize) -> Option<Vec<Star<P>>> {
        let count = [2, 2, 3, 1][self.below(4)];
        (0..count).map(|_| self.star(range, depth)).collect()
    }

    /// A set that exists in one dimension only, or another simple one.
    fn special<const P: usize>(&mut self, range: Range) -> Option<Star<P>> {
        // The dimension is known to the type only: the set goes through `Any`.
        let set: Box<dyn std::any::Any> = match P {
            2 => Box::new(self.planar(range)?),
            3 => {
                let pressure = [Pressure::Hertz, Pressure::Uniform][self.below(2)];
                let set = CoulombContensou::new(self.size(range), pressure).ok()?;
                Box::new(Star::<3>::from(Convex::from(set)))
            }
            _ => {
                let widths = Vector::<1>::new(self.size(range));
                Box::new(Star::<1>::from(Convex::from(Cuboid::symmetric(widths).ok()?)))
            }
        };
        set.downcast::<Star<P>>().ok().map(|set| *set)
    }

    fn planar(&mut self, range: Range) -> Option<Star<2>> {
        let set = match self.below(7) {
            0 => {
                let (a, b, cap) = (self.size(range), self.size(range), self.size(range));
                CappedRectangle::new(a, b, cap).map(|set| Convex::from(set).into())
            }
            1 => {
                let (mu, slope) = (self.size(range), 1.05 * self.unit());
                WedgeAsperity::new(mu, (slope / mu).atan()).map(Star::from)
            }
            2 => Polygon::new(&self.outline(range)).map(Star::from),
            3 => {
                let (angle, radius) = self.samples(range);
                PolarCurve::new(&angle, &radius).map(Star::from)
            }
            4 => {
                let (angle, support) = self.samples(range);
                SupportCurve::new(&angle, &support).map(|set| Convex::from(set).into())
            }
            5 => {
                let (n1, n2) = (self.size(range), self.size(range));
                let nu = 2.1 * self.signed() / (n1 * n2);
                Ellipse::from_intercepts(n1, n2, nu).and_then(|(a, b, angle)| {
                    Convex::from(Ellipse::new(Vector::<2>::new(a, b))?)
                        .rotated(angle)
                        .map(Star::from)
                })
            }
            _ => {
                let angle = self.angle();
                self.star::<2>(range, 0).map_or(Err(SetError::SingularMap), |s| s.rotated(angle))
            }
        };
        set.ok()
    }

    /// Corners of a polygon, around the origin mostly.
    fn outline(&mut self, range: Range) -> Vec<Vector<2>> {
        let count = 3 + self.below(8);
        let (size, rough) = (self.size(range), self.below(3));
        let corner = |k: usize, source: &mut Self| {
            let shift = if rough == 2 { source.signed() } else { 0.3 * source.signed() };
            let angle = std::f64::consts::TAU * (k as f64 + shift) / count as f64;
            let radius = if rough == 0 { 1.0 } else { source.unit() };
            Vector::<2>::new(angle.cos(), angle.sin()) * (size * radius)
        };
        (0..count).map(|k| corner(k, self)).collect()
    }

    /// Angles and values of a curve that differs from a circle by a few harmonics and, now and then, by noise.
    fn samples(&mut self, range: Range) -> (Vec<f64>, Vec<f64>) {
        let count = 8 + 4 * self.below(16);
        let (size, noise) = (self.size(range), if self.once_in(4) { 0.1 } else { 0.0 });
        let harmonics: Vec<(f64, f64)> =
            (2..5).map(|k| (self.signed() * 0.5 / f64::from(k * k - 1), self.angle())).collect();
        let jitter = 0.9 * self.unit();
        (0..count)
            .map(|k| {
                let angle =
                    std::f64::consts::TAU * (k as f64 + jitter * self.signed()) / count as f64;
                let wave =
                    |(k, (a, p)): (usize, &(f64, f64))| a * f64::cos((k + 2) as f64 * angle + p);
                let series: f64 = harmonics.iter().enumerate().map(wave).sum();
                (angle, size * (1.0 + series + noise * self.signed()))
            })
            .unzip()
    }
}
