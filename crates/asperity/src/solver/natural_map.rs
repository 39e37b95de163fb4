//! TEMPORARY until helper's version
use crate::contact::{ContactRows, NormalForce};
use crate::law::{FrictionLaw, Law};
use asperity_set::{Convex, ConvexSet, Matrix, StarSet, Vector};
use nalgebra::SMatrix;
pub(super) type Small = SMatrix<f64, 4, 4>;
#[derive(Debug, Clone, Copy)]
pub(super) struct Rho {
    pub normal: f64,
    pub tangent: f64,
}
pub(super) fn value(rows: &ContactRows, rho: Rho, p: &[f64], xi: &[f64], out: &mut [f64]) {
    match &rows.law {
        Law::One(l) => map(l, rows, rho, p, xi, out, None),
        Law::Two(l) => map(l, rows, rho, p, xi, out, None),
        Law::Three(l) => map(l, rows, rho, p, xi, out, None),
    }
}
pub(super) fn jet(
    rows: &ContactRows,
    rho: Rho,
    p: &[f64],
    xi: &[f64],
    out: &mut [f64],
    a: &mut Small,
    b: &mut Small,
) {
    match &rows.law {
        Law::One(l) => map(l, rows, rho, p, xi, out, Some((a, b))),
        Law::Two(l) => map(l, rows, rho, p, xi, out, Some((a, b))),
        Law::Three(l) => map(l, rows, rho, p, xi, out, Some((a, b))),
    }
}
fn project_jet<const P: usize>(
    d: &Convex<P>,
    y: &Vector<P>,
    start: &Vector<P>,
) -> (Vector<P>, Matrix<P>) {
    if let Convex::Ball(ball) = d {
        let n = y.norm();
        let mu = ball.size();
        if n <= mu {
            return (*y, Matrix::identity());
        }
        let t = y / n;
        return (t * mu, (Matrix::identity() - t * t.transpose()) * (mu / n));
    }
    let z = d.project_from(y, start);
    if z == *y {
        return (z, Matrix::identity());
    }
    let h = 1e-7 * y.norm().max(z.norm());
    let mut j = Matrix::<P>::zeros();
    for k in 0..P {
        let mut s = *y;
        s[k] += h;
        let c = (d.project_from(&s, &z) - z) / h;
        for i in 0..P {
            j[(i, k)] = c[i];
        }
    }
    (z, j)
}
fn map<const P: usize>(
    law: &FrictionLaw<P>,
    rows: &ContactRows,
    rho: Rho,
    p: &[f64],
    xi: &[f64],
    out: &mut [f64],
    jac: Option<(&mut Small, &mut Small)>,
) {
    let f = rows.normal_rows();
    let (h, unil) = match rows.normal {
        NormalForce::Prescribed(v) => (v, false),
        NormalForce::Unilateral => (p[0] - rho.normal * xi[0], true),
    };
    let want = jac.is_some();
    let (mut za, mut zb) = (Small::zeros(), Small::zeros());
    if !(h > 0.0) {
        out[..f + P].copy_from_slice(&p[..f + P]);
        if let Some((a, b)) = jac {
            *a = Small::identity();
            b.fill(0.0);
        }
        return;
    }
    if unil {
        out[0] = rho.normal * xi[0];
        zb[(0, 0)] = rho.normal;
    }
    let pt = Vector::<P>::from_fn(|i, _| p[f + i]);
    let g = Vector::<P>::from_fn(|i, _| xi[f + i]);
    let x = -pt / h;
    let w = x + g * (rho.tangent / h);
    let (d, c) = (law.direction(), law.reservoir());
    let assoc = law.alpha_min() == 1.0;
    let (alpha, grad) = if assoc || x.amax() == 0.0 {
        (1.0, Vector::zeros())
    } else {
        let (kd, gd) = d.gauge_jet(&x);
        let (kc, gc) = c.gauge_jet(&x);
        let a = 1.0 / (kd - kc + 1.0);
        (a, (gd - gc) * (-a * a))
    };
    let y = w * alpha;
    let (z, j) = if want {
        project_jet(d, &y, &(x * alpha))
    } else {
        (d.project_from(&y, &(x * alpha)), Matrix::zeros())
    };
    let (inv, dinv) = if assoc || z.amax() == 0.0 {
        (1.0, Vector::zeros())
    } else {
        let (kd, gd) = d.gauge_jet(&z);
        let (kc, gc) = c.gauge_jet(&z);
        let s = kc - kd + 1.0;
        (1.0 / s, (gc - gd) * (-1.0 / (s * s)))
    };
    let gz = z * inv;
    let ft = pt + gz * h;
    out[f..f + P].copy_from_slice(ft.as_slice());
    let Some((a, b)) = jac else { return };
    // dg = G dy
    let gm = (Matrix::identity() * inv + z * dinv.transpose()) * j;
    // dy = alpha dw + w grad.dx ; dx = -dP/h - x dh/h ; dw = dx + rho(dxi/h - xi dh/h^2)
    let ydx = Matrix::identity() * alpha + w * grad.transpose();
    let dp = -(gm * ydx); // h*G*ydx*(-1/h)
    let dxi = gm * (alpha * rho.tangent);
    let dh = gz - gm * (ydx * x + g * (alpha * rho.tangent / h));
    for i in 0..P {
        for k in 0..P {
            za[(f + i, f + k)] = dp[(i, k)] + if i == k { 1.0 } else { 0.0 };
            zb[(f + i, f + k)] = dxi[(i, k)];
        }
        if unil {
            za[(f + i, 0)] = dh[i];
            zb[(f + i, 0)] = -rho.normal * dh[i];
        }
    }
    *a = za;
    *b = zb;
}
