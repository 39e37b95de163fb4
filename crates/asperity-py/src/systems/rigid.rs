//! Rigid bodies as data; frames may be functions of Python.

use std::sync::Arc;

use asperity::ArgumentError;
use asperity::system::rigid::{
    self, Bodies, Body, Frame, Joint, JointKind, Pair, PlanarBody, Plane, PlaneMotion, Shape,
    Spring,
};
use asperity::system::{Field, FrictionMap, System};
use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyArray3, PyArray4, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::contact_arguments::{item, law, restitution};
use super::time_function::{Raised, keep, taken, time_function};
use crate::convert::{Numbers, Points, numbers, rows};
use crate::errors::{Failure, dimension, parameter};

/// A system of rigid bodies, and what a frame of Python has raised.
#[pyclass(frozen, module = "asperity._core")]
pub struct RigidBodies {
    pub system: rigid::RigidBodies,
    raised: Raised,
}

/// The factor of friction over a plane.
#[pyclass(frozen, module = "asperity._core")]
pub struct FrictionFactor(Arc<FrictionMap>);

#[pymethods]
impl FrictionFactor {
    #[new]
    fn new(given: &Bound<'_, PyAny>) -> PyResult<Self> {
        let map = friction_map(given, &Raised::default())?;
        Ok(Self(map.ok_or_else(|| parameter("friction_factor", "must not be None"))?))
    }

    fn at(&self, x1: f64, x2: f64) -> f64 {
        self.0.factor(self.0.region([x1, x2]), [x1, x2])
    }
}

/// Points and axes of contacts.
type Geometry<'py> = (Bound<'py, PyArray3<f64>>, Bound<'py, PyArray4<f64>>);

/// Two or three numbers as three.
fn padded(values: &[f64], argument: &str) -> PyResult<[f64; 3]> {
    match *values {
        [x, y] => Ok([x, y, 0.0]),
        [x, y, z] => Ok([x, y, z]),
        _ => Err(dimension(argument, "must have 2 or 3 entries")),
    }
}

fn place(part: &Bound<'_, PyDict>, key: &str) -> PyResult<[f64; 3]> {
    padded(numbers(&item(part, key)?.extract::<Numbers<'_>>()?, key)?, key)
}

fn number(part: &Bound<'_, PyDict>, key: &str) -> PyResult<f64> {
    item(part, key)?.extract()
}

fn index(part: &Bound<'_, PyDict>, key: &str) -> PyResult<usize> {
    item(part, key)?.extract()
}

/// A plane, or a line where there is no axis.
fn plane(pair: &Bound<'_, PyDict>, raised: &Raised) -> PyResult<Plane> {
    let given = item(pair, "plane")?;
    let given = given.cast::<PyDict>()?;
    let (point, normal) = (place(given, "point")?, place(given, "normal")?);
    let body = item(given, "body")?.extract()?;
    let velocity = item(given, "velocity")?;
    let motion: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)> = item(given, "motion")?.extract()?;
    if !given.contains("axis")? {
        let motion = motion.map(|(displacement, rotation)| -> PyResult<PlaneMotion> {
            let displacement = time_function(&displacement, "displacement", true, raised)?;
            let rotation = time_function(&rotation, "rotation", true, raised)?;
            Ok(PlaneMotion::planar(&displacement, &rotation).map_err(Failure::from)?)
        });
        let velocity = time_function::<1>(&velocity, "velocity", false, raised)?.spread([0]);
        let line = Plane::line([point[0], point[1]], [normal[0], normal[1]]);
        return Ok(Plane { velocity, motion: motion.transpose()?, body, ..line });
    }
    let motion = motion.map(|(displacement, rotation)| -> PyResult<PlaneMotion> {
        Ok(PlaneMotion {
            displacement: time_function(&displacement, "displacement", true, raised)?,
            rotation: time_function(&rotation, "rotation", true, raised)?,
        })
    });
    Ok(Plane {
        velocity: time_function(&velocity, "velocity", false, raised)?,
        spin: time_function(&item(given, "spin")?, "spin", false, raised)?,
        motion: motion.transpose()?,
        friction: friction_map(&item(given, "friction_factor")?, raised)?,
        body,
        ..Plane::new(point, normal, place(given, "axis")?)
    })
}

fn shape(pair: &Bound<'_, PyDict>, raised: &Raised) -> PyResult<Shape> {
    let body = index(pair, "body")?;
    let kind = item(pair, "kind")?;
    Ok(match kind.extract::<&str>()? {
        "point_plane" => {
            Shape::PointPlane { body, point: place(pair, "point")?, plane: plane(pair, raised)? }
        }
        "sphere_plane" => Shape::SpherePlane {
            body,
            centre: place(pair, "center")?,
            radius: number(pair, "radius")?,
            plane: plane(pair, raised)?,
        },
        "box_plane" => Shape::BoxPlane {
            body,
            half_sizes: place(pair, "half_sizes")?,
            plane: plane(pair, raised)?,
        },
        _ => Shape::SphereSphere {
            body,
            centre: place(pair, "center")?,
            radius: number(pair, "radius")?,
            other: index(pair, "other")?,
            other_centre: place(pair, "other_center")?,
            other_radius: number(pair, "other_radius")?,
        },
    })
}

/// A word, the axis of a body or a function.
fn frame(given: &Bound<'_, PyAny>, raised: &Raised) -> PyResult<Frame> {
    if let Ok(word) = given.extract::<&str>() {
        return Ok(if word == "polar" { Frame::Polar } else { Frame::Plane });
    }
    if let Ok(axis) = given.extract::<Numbers<'_>>() {
        return Ok(Frame::Body { axis: padded(numbers(&axis, "frame")?, "frame")? });
    }
    let check = |angle: f64| match angle.is_finite() {
        true => Ok(angle),
        false => Err(parameter("frame", &format!("must return a finite angle, returned {angle}"))),
    };
    Ok(Frame::Field(field(given, raised, check)))
}

/// A function of the position in a plane whose values pass a check.
fn field(
    given: &Bound<'_, PyAny>,
    raised: &Raised,
    check: impl Fn(f64) -> PyResult<f64> + Send + Sync + 'static,
) -> Field {
    let (function, raised) = (given.clone().unbind(), Arc::clone(raised));
    Arc::new(move |[x1, x2]| {
        let value = Python::attach(|py| check(function.call1(py, (x1, x2))?.extract(py)?));
        value.unwrap_or_else(|error| {
            // The run ends by what is not a number; the exception says why.
            keep(&raised, error);
            f64::NAN
        })
    })
}

/// Polygons with factors and the factor elsewhere, nodes with factors, a function or nothing.
fn friction_map(given: &Bound<'_, PyAny>, raised: &Raised) -> PyResult<Option<Arc<FrictionMap>>> {
    if given.is_none() {
        return Ok(None);
    }
    let map = if let Ok((polygons, elsewhere)) = given.extract::<(Vec<(Vec<[f64; 2]>, f64)>, f64)>()
    {
        FrictionMap::regions(polygons, elsewhere)
    } else if let Ok((x1, x2, factors)) = given.extract::<(Vec<f64>, Vec<f64>, Vec<f64>)>() {
        FrictionMap::raster([x1, x2], factors)
    } else {
        let check = |factor: f64| match factor > 0.0 && factor.is_finite() {
            true => Ok(factor),
            false => {
                let message = format!("must return a positive factor, returned {factor}");
                Err(parameter("friction_factor", &message))
            }
        };
        Ok(FrictionMap::Function(field(given, raised, check)))
    };
    Ok(Some(Arc::new(map.map_err(Failure::from)?)))
}

fn pair(given: &Bound<'_, PyDict>, raised: &Raised) -> PyResult<Pair> {
    let (normal_restitution, tangential_restitution) = restitution(given)?;
    Ok(Pair {
        shape: shape(given, raised)?,
        law: law(given)?,
        frame: frame(&item(given, "frame")?, raised)?,
        normal_force: item(given, "normal_force")?.extract::<Option<f64>>()?.into(),
        normal_restitution,
        tangential_restitution,
        patch_radius: item(given, "patch_radius")?.extract()?,
    })
}

fn spring(given: &Bound<'_, PyDict>, raised: &Raised) -> PyResult<Spring> {
    Ok(Spring {
        body: index(given, "body")?,
        point: place(given, "point")?,
        other: item(given, "other")?.extract()?,
        other_point: place(given, "other_point")?,
        stiffness: number(given, "stiffness")?,
        damping: number(given, "damping")?,
        length: time_function(&item(given, "length")?, "length", false, raised)?,
    })
}

fn joint(given: &Bound<'_, PyDict>) -> PyResult<Joint> {
    let kind = match item(given, "kind")?.extract::<&str>()? {
        "Hinge" => JointKind::Hinge,
        "Slider" => JointKind::Slider,
        _ => JointKind::Weld,
    };
    let (body, other) = (index(given, "body")?, item(given, "other")?.extract()?);
    Ok(Joint { kind, body, other, anchor: place(given, "anchor")?, axis: place(given, "axis")? })
}

/// Force and torque of a body, by its number, at least one of which depends on time.
type TimedLoad<'py> = (usize, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Bodies from one row each: mass, inertia, force and torque; `timed` has the loads of those that have others. Their
/// initial states stay in Python.
fn bodies(
    planar: bool,
    mass: &Numbers<'_>,
    inertia: &Points<'_>,
    load: &Points<'_>,
    timed: &[TimedLoad<'_>],
    raised: &Raised,
) -> PyResult<Bodies> {
    let mass = numbers(mass, "mass")?;
    let (inertia, load) = (inertia.as_array(), load.as_array());
    let (n, wide, loads) = if planar { (mass.len(), 1, 3) } else { (mass.len(), 9, 6) };
    if inertia.dim() != (n, wide) || load.dim() != (n, loads) {
        return Err(dimension("bodies", "must have one row of inertia and of loads each"));
    }
    if planar {
        let body = |i: usize| PlanarBody {
            force: [load[[i, 0]], load[[i, 1]]].into(),
            torque: load[[i, 2]].into(),
            ..PlanarBody::new(mass[i], inertia[[i, 0]])
        };
        let mut bodies: Vec<_> = (0..n).map(body).collect();
        for (number, force, torque) in timed {
            let body = bodies.get_mut(*number).ok_or_else(|| dimension("bodies", "are fewer"))?;
            body.force = time_function(force, "force", false, raised)?;
            body.torque = time_function(torque, "torque", false, raised)?;
        }
        return Ok(bodies.into());
    }
    let three =
        |i: usize, first: usize| -> [f64; 3] { std::array::from_fn(|k| load[[i, first + k]]) };
    let body = |i: usize| Body {
        inertia: std::array::from_fn(|k| std::array::from_fn(|l| inertia[[i, 3 * k + l]])),
        force: three(i, 0).into(),
        torque: three(i, 3).into(),
        ..Body::new(mass[i], [1.0; 3])
    };
    let mut bodies: Vec<_> = (0..n).map(body).collect();
    for (number, force, torque) in timed {
        let body = bodies.get_mut(*number).ok_or_else(|| dimension("bodies", "are fewer"))?;
        body.force = time_function(force, "force", false, raised)?;
        body.torque = time_function(torque, "torque", false, raised)?;
    }
    Ok(bodies.into())
}

#[pymethods]
impl RigidBodies {
    #[new]
    #[allow(clippy::too_many_arguments)] // The Python side calls it in one place, by position.
    fn new(
        planar: bool,
        mass: Numbers<'_>,
        inertia: Points<'_>,
        load: Points<'_>,
        timed_loads: Vec<TimedLoad<'_>>,
        pairs: Vec<Bound<'_, PyDict>>,
        springs: Vec<Bound<'_, PyDict>>,
        joints: Vec<Bound<'_, PyDict>>,
        gravity: Numbers<'_>,
        q0: Numbers<'_>,
    ) -> Result<Self, Failure> {
        let raised = Raised::default();
        let bodies = bodies(planar, &mass, &inertia, &load, &timed_loads, &raised)?;
        let pairs = pairs.iter().map(|given| pair(given, &raised)).collect::<PyResult<Vec<_>>>()?;
        let springs =
            springs.iter().map(|given| spring(given, &raised)).collect::<PyResult<_>>()?;
        let gravity = padded(numbers(&gravity, "gravity")?, "gravity")?;
        let joints = joints.iter().map(joint).collect::<PyResult<Vec<_>>>()?;
        let system = rigid::RigidBodies::new(bodies, &pairs, springs, gravity)?;
        let q0 = numbers(&q0, "q0")?;
        let joined = if joints.is_empty() { system } else { system.with_joints(&joints, q0)? };
        Ok(Self { system: joined, raised })
    }

    /// Whether loads, springs or planes depend on time.
    #[getter]
    fn depends_on_time(&self) -> bool {
        self.system.depends_on_time()
    }

    /// Coordinates after moving with the velocities for `dt`, row by row.
    fn advance<'py>(
        &self,
        py: Python<'py>,
        q: Points<'py>,
        u: Points<'py>,
        dt: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let width = self.system.coordinates();
        let mut moved = vec![0.0; q.as_array().len()];
        for ((q, u), out) in self.states(&q, &u)?.zip(moved.chunks_exact_mut(width)) {
            self.system.advance(q, u, dt, out);
        }
        rows(py, moved, width)
    }

    fn energy<'py>(
        &self,
        py: Python<'py>,
        t: Numbers<'py>,
        q: Points<'py>,
        u: Points<'py>,
    ) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        let (system, t) = (&self.system, numbers(&t, "t")?);
        let energy = |(&t, (q, u))| Ok(system.kinetic_energy(u)? + system.potential_energy(t, q)?);
        let energies: Result<Vec<f64>, Failure> =
            t.iter().zip(self.states(&q, &u)?).map(energy).collect();
        match self.raised() {
            Some(error) => Err(error.into()),
            None => Ok(PyArray1::from_vec(py, energies?)),
        }
    }

    fn momentum<'py>(
        &self,
        py: Python<'py>,
        u: Points<'py>,
    ) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        let momenta = samples(&u, self.system.dof(), "u")?.map(|u| self.system.momentum(u));
        flat(py, momenta)
    }

    fn angular_momentum<'py>(
        &self,
        py: Python<'py>,
        q: Points<'py>,
        u: Points<'py>,
        about: Numbers<'py>,
    ) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        let about = Vector3::from(padded(numbers(&about, "about")?, "about")?);
        let momentum = |(q, u)| self.system.angular_momentum(q, u, &about);
        flat(py, self.states(&q, &u)?.map(momentum))
    }

    /// Forces and torques of joints, `(n_t, n_j, 2, 3)`.
    fn joint_reactions<'py>(
        &self,
        py: Python<'py>,
        t: Numbers<'py>,
        dt: f64,
        q: Points<'py>,
        u: Points<'py>,
        contacts: Points<'py>,
    ) -> Result<Bound<'py, PyArray4<f64>>, Failure> {
        let (n_t, mut reactions) = (q.as_array().nrows(), Vec::new());
        let forces = contacts.as_array();
        let states = numbers(&t, "t")?.iter().zip(self.states(&q, &u)?);
        for ((&t, state), forces) in states.zip(forces.rows()) {
            let made = self.system.joint_reactions((t, dt), state, &forces.to_vec())?;
            reactions.extend(made.iter().flatten().flat_map(|vector| <[f64; 3]>::from(*vector)));
            if let Some(error) = self.raised() {
                return Err(error.into());
            }
        }
        let n_j = reactions.len() / (6 * n_t);
        Ok(PyArray1::from_vec(py, reactions).reshape([n_t, n_j, 2, 3])?)
    }

    /// Contact points `(n_t, n_c, 3)` and the rows e₁, e₂, n, `(n_t, n_c, 3, 3)`.
    fn contact_geometry<'py>(
        &self,
        py: Python<'py>,
        t: Numbers<'py>,
        q: Points<'py>,
    ) -> Result<Geometry<'py>, Failure> {
        let (n_t, n_c) = (q.as_array().nrows(), self.system.contacts().len());
        let (mut points, mut axes) = (Vec::new(), Vec::new());
        let states = samples(&q, self.system.coordinates(), "q")?;
        for (&t, q) in numbers(&t, "t")?.iter().zip(states) {
            for contact in 0..n_c {
                let geometry = self.system.contact_geometry(t, q, contact)?;
                points.extend_from_slice(geometry.point.as_slice());
                for axis in [geometry.e1, geometry.e2, geometry.normal] {
                    axes.extend_from_slice(axis.as_slice());
                }
            }
            if let Some(error) = self.raised() {
                return Err(error.into());
            }
        }
        let points = PyArray1::from_vec(py, points).reshape([n_t, n_c, 3])?;
        Ok((points, PyArray1::from_vec(py, axes).reshape([n_t, n_c, 3, 3])?))
    }
}

impl RigidBodies {
    /// What a frame of Python has raised since the last question.
    pub fn raised(&self) -> Option<PyErr> {
        taken(&self.raised)
    }

    /// Whether there are functions of Python among its frames, motions and loads: each of them holds where it keeps
    /// what it raises.
    pub fn calls_python(&self) -> bool {
        Arc::strong_count(&self.raised) > 1
    }

    /// Coordinates and velocities, sample by sample.
    fn states<'a>(
        &self,
        q: &'a Points<'_>,
        u: &'a Points<'_>,
    ) -> PyResult<impl Iterator<Item = (&'a [f64], &'a [f64])>> {
        let states = samples(q, self.system.coordinates(), "q")?;
        Ok(states.zip(samples(u, self.system.dof(), "u")?))
    }
}

/// The rows of an array with `width` columns.
fn samples<'a>(
    array: &'a Points<'_>,
    width: usize,
    argument: &str,
) -> PyResult<impl Iterator<Item = &'a [f64]>> {
    if array.as_array().ncols() != width {
        return Err(dimension(argument, &format!("must have {width} columns")));
    }
    let values = array.as_slice().map_err(|_| dimension(argument, "must be contiguous"))?;
    Ok(values.chunks_exact(width))
}

fn flat(
    py: Python<'_>,
    vectors: impl Iterator<Item = Result<Vector3<f64>, ArgumentError>>,
) -> Result<Bound<'_, PyArray2<f64>>, Failure> {
    let mut entries = Vec::new();
    for vector in vectors {
        entries.extend_from_slice(vector?.as_slice());
    }
    Ok(rows(py, entries, 3)?)
}
