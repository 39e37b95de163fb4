//! The map against differences and against solutions in closed form.

use asperity_set::{
    Ball, Convex, CoulombContensou, Cuboid, Ellipsoid, Pressure, Star, StarSet, Superellipsoid,
    Vector, WedgeAsperity,
};

use super::{ContactMatrix, ContactPoint, Derivatives, Rho};
use crate::law::{FrictionLaw, Law};
use crate::random::random;

/// Uniform in [-1, 1), reproducible.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        random(&mut self.0)
    }

    fn rows(&mut self) -> [f64; 4] {
        std::array::from_fn(|_| self.next())
    }
}

fn ellipsoid<const P: usize>(a: Vector<P>) -> Convex<P> {
    Ellipsoid::new(a).unwrap().into()
}

fn smooth<const P: usize>(a: Vector<P>, s: f64) -> Convex<P> {
    Convex::try_from(Superellipsoid::new(a, s).unwrap()).unwrap()
}

fn extended<const P: usize>(c: impl Into<Star<P>>, d: Convex<P>) -> FrictionLaw<P> {
    FrictionLaw::new(c.into(), d).unwrap()
}

fn plane() -> Vec<FrictionLaw<2>> {
    let a = Vector::<2>::new(0.6, 0.2);
    let turned = ellipsoid(a).rotated(0.5).unwrap();
    vec![
        FrictionLaw::isotropic(0.4).unwrap(),
        FrictionLaw::associated(turned.clone()),
        FrictionLaw::associated(smooth(a, 3.0)),
        FrictionLaw::associated(smooth(a, 1.0)),
        FrictionLaw::associated(Cuboid::symmetric(a).unwrap().into()),
        extended(turned, ellipsoid(a)),
        extended(smooth(a, 3.0), smooth(a, 2.5)),
        FrictionLaw::collinear(Superellipsoid::new(a, 0.7).unwrap().into()).unwrap(),
        extended(WedgeAsperity::new(1.2, 0.6).unwrap(), ellipsoid(Vector::<2>::new(1.0, 0.8))),
    ]
}

fn space() -> Vec<FrictionLaw<3>> {
    let a = Vector::<3>::new(0.6, 0.3, 0.2);
    let drilling = |p| Convex::from(CoulombContensou::new(0.4, p).unwrap());
    vec![
        FrictionLaw::isotropic(0.4).unwrap(),
        FrictionLaw::associated(ellipsoid(a)),
        FrictionLaw::associated(drilling(Pressure::Hertz)),
        FrictionLaw::associated(drilling(Pressure::Uniform)),
        FrictionLaw::associated(smooth(a, 3.0)),
        FrictionLaw::associated(Cuboid::symmetric(a).unwrap().into()),
        extended(ellipsoid(a), Ball::new(1.0).unwrap().into()),
        extended(drilling(Pressure::Hertz), ellipsoid(a)),
    ]
}

fn line() -> Vec<FrictionLaw<1>> {
    let interval = |l, u| Cuboid::new(Vector::<1>::new(l), Vector::<1>::new(u)).unwrap();
    vec![
        FrictionLaw::isotropic(0.4).unwrap(),
        FrictionLaw::associated(interval(-0.2, 0.5).into()),
        extended(Star::Convex(interval(-0.2, 0.5).into()), Ball::new(1.0).unwrap().into()),
    ]
}

/// A law with the prescribed normal percussion of its contact, if any.
#[derive(Debug)]
struct Contact {
    law: Law,
    prescribed: Option<f64>,
}

impl Contact {
    fn normal_rows(&self) -> usize {
        usize::from(self.prescribed.is_none())
    }

    fn len(&self) -> usize {
        self.normal_rows() + self.law.dimension()
    }

    fn at<'a>(&self, at: &'a [[f64; 4]; 2]) -> ContactPoint<'a> {
        let (percussion, xi) = (&at[0][..self.len()], &at[1][..self.len()]);
        ContactPoint { prescribed: self.prescribed, rho: RHO, percussion, xi }
    }
}

fn contacts() -> Vec<Contact> {
    let laws = plane().into_iter().map(Law::from);
    let laws =
        laws.chain(space().into_iter().map(Law::from)).chain(line().into_iter().map(Law::from));
    let both =
        |law: Law| [Some(0.8), None].map(|prescribed| Contact { law: law.clone(), prescribed });
    laws.flat_map(both).collect()
}

const RHO: Rho = Rho { normal: 0.7, tangent: 1.3 };

fn map(contact: &Contact, at: &[[f64; 4]; 2]) -> [f64; 4] {
    let mut out = [0.0; 4];
    contact.law.natural_map(contact.at(at), &mut out[..contact.len()]);
    out
}

#[test]
fn jacobian_is_the_slope_of_the_map() {
    let mut random = Random(7);
    for rows in contacts() {
        let (n, mut compared) = (rows.len(), 0);
        for _ in 0..300 {
            let at = [random.rows(), random.rows()];
            let (mut f, mut a, mut b) = ([0.0; 4], ContactMatrix::zeros(), ContactMatrix::zeros());
            rows.law.natural_map_jet(
                rows.at(&at),
                &mut f[..n],
                Derivatives { a: &mut a, b: &mut b },
            );
            let same = map(&rows, &at);
            assert!((0..n).all(|i| (f[i] - same[i]).abs() <= 1e-12), "{rows:?}");
            for (side, matrix) in [a, b].iter().enumerate() {
                for j in 0..n {
                    let slope = |step: f64| -> [f64; 4] {
                        let (mut ahead, mut behind) = (at, at);
                        ahead[side][j] += step;
                        behind[side][j] -= step;
                        let (f, g) = (map(&rows, &ahead), map(&rows, &behind));
                        std::array::from_fn(|i| (f[i] - g[i]) / (2.0 * step))
                    };
                    // Where they differ there is a kink in between.
                    let (fine, coarse) = (slope(1e-6), slope(4e-6));
                    for i in (0..n).filter(|&i| (fine[i] - coarse[i]).abs() < 1e-6) {
                        let defect = (fine[i] - matrix[(i, j)]).abs();
                        assert!(defect < 1e-5, "{defect:e} of {} in {rows:?}", matrix[(i, j)]);
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared > 300 * n * n, "{compared} {rows:?}");
    }
}

/// Slip along any direction, stick, and an open contact.
fn solutions<const P: usize>(law: &FrictionLaw<P>, rows: &Contact, random: &mut Random) {
    let first = rows.normal_rows();
    let normal = if first == 1 { 1.0 + random.next() * 0.5 } else { 0.8 };
    let slip = Vector::<P>::from_fn(|_, _| random.next());
    let force = law.force(&slip, normal).unwrap();
    let pack = |n: f64, t: &Vector<P>| {
        let mut all = [0.0; 4];
        all[0] = n;
        all[first..first + P].copy_from_slice(t.as_slice());
        all
    };
    let still = Vector::<P>::zeros();
    let inside = slip * (random.next() * normal / law.reservoir().gauge(&slip));
    let cases = [
        [pack(normal, &force), pack(0.0, &slip)],
        [pack(normal, &-inside.abs()), pack(0.0, &still)],
        [pack(normal, &still), pack(0.0, &still)],
    ];
    let gauge = law.reservoir().gauge(&(inside.abs() / normal));
    for (k, case) in cases.iter().enumerate().filter(|(k, _)| *k != 1 || gauge <= 1.0) {
        let f = map(rows, case);
        assert!(f.iter().all(|v| v.abs() <= 1e-10), "{k}: {f:?} {rows:?}");
    }
    if first == 1 {
        let open = [[0.0; 4], pack(0.3, &slip)];
        assert_eq!(map(rows, &open), [0.0; 4]);
    }
}

#[test]
fn map_vanishes_at_solutions() {
    let mut random = Random(11);
    for rows in contacts() {
        for _ in 0..100 {
            match &rows.law {
                Law::Zero(_) => unreachable!(),
                Law::One(law) => solutions(law, &rows, &mut random),
                Law::Two(law) => solutions(law, &rows, &mut random),
                Law::Three(law) => solutions(law, &rows, &mut random),
            }
        }
    }
}

/// With `y = P_T − ρ_T ξ_T`, `R = μh`, `t = y/|y|`, `Q = (R/|y|)(I − ttᵀ)`: `A = [0, 0; −μt, I − Q]`,
/// `B = [ρ_N, 0; μρ_N t, ρ_T Q]`.
#[test]
fn isotropic_friction_is_the_map_of_alart_and_curnier() {
    let mu = 0.4;
    let law = Law::from(FrictionLaw::<2>::isotropic(mu).unwrap());
    let rows = Contact { law, prescribed: None };
    let mut random = Random(3);
    for _ in 0..1000 {
        let (p, xi) = (random.rows(), random.rows());
        let h = p[0] - RHO.normal * xi[0];
        let y = Vector::<2>::from_fn(|i, _| p[i + 1] - RHO.tangent * xi[i + 1]);
        if h <= 0.0 || y.norm() <= mu * h {
            continue;
        }
        let (t, ratio) = (y.normalize(), mu * h / y.norm());
        let (mut a, mut b) = (ContactMatrix::zeros(), ContactMatrix::zeros());
        for i in 0..2 {
            a[(i + 1, 0)] = -mu * t[i];
            b[(i + 1, 0)] = mu * RHO.normal * t[i];
            for j in 0..2 {
                let q = ratio * (f64::from(u8::from(i == j)) - t[i] * t[j]);
                a[(i + 1, j + 1)] = f64::from(u8::from(i == j)) - q;
                b[(i + 1, j + 1)] = RHO.tangent * q;
            }
        }
        b[(0, 0)] = RHO.normal;
        let (mut f, mut by_p, mut by_xi) =
            ([0.0; 3], ContactMatrix::zeros(), ContactMatrix::zeros());
        rows.law.natural_map_jet(
            rows.at(&[p, xi]),
            &mut f,
            Derivatives { a: &mut by_p, b: &mut by_xi },
        );
        assert!((by_p - a).amax() < 1e-14 && (by_xi - b).amax() < 1e-14);
    }
}
