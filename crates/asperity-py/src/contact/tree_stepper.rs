//! Steps of kinematic trees by the arrays of an engine.

use asperity::mechanism::{
    Axis, Closing, Jacobian, Listed, Rows, TreeFactor, TreeStepper as Stepper, Unilateral,
    pyramid_edges,
};
use asperity::solver::Stop;
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use super::outcome::array;
use super::solver::Solver;
use super::stepper::{BILATERAL, DRY_FRICTION, FRICTIONLESS, Step};
use crate::convert::{Numbers, Points, numbers};
use crate::errors::{Failure, dimension};
use crate::interrupt::asked;
use crate::law::Law;

type Integers<'py> = PyReadonlyArray1<'py, i64>;
/// Numbers of an engine in 32 bits.
type Short<'py> = PyReadonlyArray1<'py, i32>;

/// What an engine lists: its numbers of rows, and the addresses and geoms of contacts.
#[derive(Default, PartialEq)]
struct Identity {
    counts: (usize, usize, usize),
    addresses: Vec<i32>,
    geoms: Vec<i32>,
}

/// A stepper, and what the engine lists.
#[pyclass(module = "asperity._core")]
pub struct TreeStepper {
    stepper: Stepper,
    identity: Identity,
    /// Numbers of the contacts among those of the engine, and the distances at which limits and contacts rest.
    contacts: Vec<usize>,
    rest: Vec<f64>,
    /// Axes of the laws of contacts, and what carries them; places of the geoms and bodies follow each other.
    axes: Vec<(usize, Axis, Option<usize>)>,
}

/// A step of kinematic trees that was solved.
#[pyclass(frozen, module = "asperity._core")]
pub struct TreeStep {
    step: Option<Py<Step>>,
    velocity: Vec<f64>,
    near: Vec<bool>,
    gaps: Vec<f64>,
    forces: Vec<f64>,
    generalised: Vec<f64>,
}

#[pymethods]
impl TreeStepper {
    #[new]
    fn new(
        laws: Vec<Bound<'_, Law>>,
        solver: &Solver,
        starts: Integers<'_>,
        ancestors: Integers<'_>,
        trees: Integers<'_>,
    ) -> Result<Self, Failure> {
        let laws = laws.iter().map(|law| law.get().0.clone()).collect();
        let [starts, ancestors, trees] = [&starts, &ancestors, &trees].map(indices);
        let factor = TreeFactor::new(starts, ancestors, trees)?;
        Ok(Self {
            stepper: Stepper::new(laws, solver.0, factor)?,
            identity: Identity::default(),
            contacts: Vec::new(),
            rest: Vec::new(),
            axes: Vec::new(),
        })
    }

    /// Whether the engine lists what it listed before.
    fn is_listed(
        &self,
        counts: (usize, usize, usize),
        addresses: Short<'_>,
        geoms: PyReadonlyArray2<'_, i32>,
    ) -> bool {
        let Identity { counts: known, addresses: list, geoms: pairs } = &self.identity;
        counts == *known
            && addresses.as_array().iter().eq(list)
            && geoms.as_array().iter().eq(pairs)
    }

    /// Takes in what the engine lists: counts of rows of equalities, dry joints and limits; of limits and contacts the first rows,
    /// kinds, keys and distances at rest; numbers of contacts.
    #[allow(clippy::too_many_arguments)] // The Python side calls it in one place, by position.
    fn list(
        &mut self,
        counts: (usize, usize, usize),
        addresses: Short<'_>,
        geoms: PyReadonlyArray2<'_, i32>,
        contacts: Integers<'_>,
        rows: Integers<'_>,
        kinds: Integers<'_>,
        keys: Integers<'_>,
        rest: Numbers<'_>,
    ) -> Result<(), Failure> {
        let addresses = addresses.as_array().iter().copied().collect();
        let geoms = geoms.as_array().iter().copied().collect();
        self.identity = Identity { counts, addresses, geoms };
        self.contacts = indices(&contacts);
        self.rest = numbers(&rest, "rest")?.to_vec();
        let all = rows.as_array();
        let own = all.iter().zip(kinds.as_array()).zip(keys.as_array());
        let unilateral = own.map(|((&row, &kind), &key)| Unilateral {
            row: row as usize,
            rows: match kind {
                FRICTIONLESS => Rows::Frictionless,
                law => Rows::Contact(law as usize),
            },
            key: key as u64,
        });
        let unilateral = unilateral.collect();
        self.stepper.list(Listed { bilateral: counts.0, dry: counts.1, unilateral });
        self.axes.clear();
        Ok(())
    }

    /// Gives a limit or contact an axis, carried by a geom or body, which follow each other, or by the world.
    fn carry(
        &mut self,
        number: usize,
        axis: [f64; 3],
        carrier: Option<usize>,
        is_reversed: bool,
        radius: f64,
    ) {
        self.axes.push((number, Axis { axis, is_reversed, radius }, carrier));
    }

    /// Takes in the rows at a place, with `h` times the forces of dry joints; the largest depth of a limit or contact.
    #[allow(clippy::too_many_arguments)]
    fn place(
        &mut self,
        jacobian: Numbers<'_>,
        sparsity: Option<(Short<'_>, Short<'_>, Short<'_>)>,
        positions: Numbers<'_>,
        distances: Numbers<'_>,
        dry: Numbers<'_>,
        h: f64,
    ) -> Result<f64, Failure> {
        let values = numbers(&jacobian, "jacobian")?;
        let jacobian = match &sparsity {
            None => Jacobian::Dense(values),
            Some((counts, firsts, columns)) => Jacobian::Sparse {
                counts: integers(counts)?,
                firsts: integers(firsts)?,
                columns: integers(columns)?,
                values,
            },
        };
        let (equalities, joints, limits) = self.identity.counts;
        let positions = numbers(&positions, "positions")?;
        let begin = (equalities + joints).min(positions.len());
        let distances = distances.as_array();
        let of_contacts = self.contacts.iter().filter_map(|&k| distances.get(k).copied());
        let of_all = positions[begin..].iter().copied().take(limits).chain(of_contacts);
        let gaps = of_all.zip(&self.rest).map(|(distance, rest)| distance - rest);
        let dry = numbers(&dry, "dry")?;
        let bounds = dry.iter().skip(equalities).map(|force| h * force);
        self.stepper.place(jacobian, gaps, bounds)?;
        Ok(-self.stepper.gaps().iter().copied().fold(0.0, f64::min))
    }

    /// Takes in the factors of the mass matrix.
    fn factor(&mut self, values: Numbers<'_>) -> Result<(), Failure> {
        Ok(self.stepper.factor.refill(numbers(&values, "factor")?)?)
    }

    /// Whether contacts have axes.
    fn has_axes(&self) -> bool {
        !self.axes.is_empty()
    }

    /// Turns rows at this place to the axes of laws: frames of contacts, rotations of geoms and bodies.
    fn turn(
        &mut self,
        frames: Points<'_>,
        geoms: Points<'_>,
        bodies: Points<'_>,
    ) -> Result<(), Failure> {
        let (frames, geoms, bodies) = (frames.as_array(), geoms.as_array(), bodies.as_array());
        let limits = self.identity.counts.2;
        let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        for (number, axis, carrier) in &self.axes {
            let rotation = carrier.map_or(identity, |k| {
                let geom = k < geoms.nrows();
                let row = if geom { geoms.row(k) } else { bodies.row(k - geoms.nrows()) };
                std::array::from_fn(|i| row[i])
            });
            let frame = frames.row(self.contacts[number - limits]);
            self.stepper
                .turn(*number, axis.turn(&rotation, &std::array::from_fn(|i| frame[3 + i])));
        }
        Ok(())
    }

    /// Moves the surfaces of contacts against each other at this place.
    fn move_surfaces(&mut self, velocities: Points<'_>) {
        let (velocities, limits) = (velocities.as_array(), self.identity.counts.2);
        for (k, &contact) in self.contacts.iter().enumerate() {
            let own = velocities.row(contact);
            self.stepper.move_surface(limits + k, std::array::from_fn(|i| own[i]));
        }
    }

    /// Solves a step from the velocities without percussions and those before, with gaps that close in half of it.
    fn step(
        &mut self,
        py: Python<'_>,
        free: Numbers<'_>,
        before: Numbers<'_>,
        h: f64,
        exact: f64,
        tolerance: f64,
    ) -> Result<TreeStep, Failure> {
        let (free, before) = (numbers(&free, "free_velocity")?, numbers(&before, "velocity")?);
        let stepper = &mut self.stepper;
        let report = asked(py, |cancelled| {
            let stop = Stop::at(tolerance).unless(cancelled);
            stepper.step(free, before, Closing { time: 0.5 * h, exact, stop })
        })??;
        let step = report.map(|report| Py::new(py, Step::of(report, stepper.stepper())));
        let step = step.transpose()?;
        let mut forces = if step.is_some() { self.stepper.percussions() } else { Vec::new() };
        forces.iter_mut().for_each(|force| *force /= h);
        Ok(TreeStep {
            step,
            velocity: self.stepper.velocity().to_vec(),
            near: self.stepper.near().to_vec(),
            gaps: self.stepper.gaps().to_vec(),
            generalised: self.stepper.generalised(&forces),
            forces,
        })
    }

    /// Whether the last step was one from these velocities.
    fn was_from(&self, free: Numbers<'_>, part: f64) -> Result<bool, Failure> {
        Ok(self.stepper.was_from(numbers(&free, "free_velocity")?, part))
    }

    /// Forces of all rows of the engine, those of contacts along the edges of pyramids at these addresses.
    fn pyramids<'py>(
        &self,
        py: Python<'py>,
        step: &TreeStep,
        count: usize,
        addresses: Short<'_>,
        dimensions: Short<'_>,
        friction: Points<'_>,
    ) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        let forces = &step.forces;
        let (equalities, joints, limits) = self.identity.counts;
        let begin = equalities + joints + limits;
        let mut edges = vec![0.0; count];
        if forces.is_empty() || begin > count {
            return Ok(array(py, edges));
        }
        edges[..begin].copy_from_slice(&forces[..begin]);
        for (&contact, first) in self.contacts.iter().zip(self.stepper.rows().skip(limits)) {
            let size = dimensions.as_array()[contact] as usize;
            let place = addresses.as_array()[contact] as usize;
            let edges = edges.get_mut(place..place + (2 * size - 2).max(1));
            let Some(own) = edges else { continue };
            let friction = friction.as_array();
            let friction = friction.row(contact).into_iter().copied();
            pyramid_edges(&forces[first..first + size], friction, own);
        }
        Ok(array(py, edges))
    }

    /// The least change of coordinates that closes these rows.
    fn least_change<'py>(
        &mut self,
        py: Python<'py>,
        rows: Integers<'_>,
        before: Numbers<'_>,
        tolerance: f64,
    ) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        let (rows, before) = (indices(&rows), numbers(&before, "before")?);
        let stepper = &mut self.stepper;
        let change = asked(py, |cancelled| {
            let stop = Stop::at(tolerance).unless(cancelled);
            stepper.least_change(&rows, before, stop).map(<[f64]>::to_vec)
        })??;
        Ok(array(py, change))
    }

    fn forget(&mut self) {
        self.stepper.forget();
    }

    /// Gaps of limits and contacts at this place.
    fn gaps<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.stepper.gaps().to_vec())
    }

    /// Velocities of rows of the engine.
    fn row_velocities<'py>(
        &self,
        py: Python<'py>,
        rows: Integers<'_>,
        velocities: Numbers<'_>,
    ) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        let velocities = numbers(&velocities, "velocities")?;
        let own = indices(&rows).into_iter();
        Ok(array(py, own.map(|row| self.stepper.row_velocity(row, velocities)).collect()))
    }

    /// Which rows of equalities something can move.
    fn moves<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        array(py, (0..self.identity.counts.0).map(|row| self.stepper.moves(row)).collect())
    }

    /// What takes part in the last step: entries of `G` row by row, velocities without percussions, kinds, bounds and keys.
    #[allow(clippy::type_complexity)]
    fn problem(&self) -> (Vec<f64>, Vec<f64>, Vec<i64>, Vec<f64>, Vec<u64>) {
        let (items, keys, free) = self.stepper.items();
        let kind = |rows: &Rows| match *rows {
            Rows::Contact(law) => law as i64,
            Rows::Frictionless => FRICTIONLESS,
            Rows::Bilateral => BILATERAL,
            Rows::DryFriction(_) => DRY_FRICTION,
        };
        let bound = |rows: &Rows| if let Rows::DryFriction(bound) = *rows { bound } else { 0.0 };
        let (kinds, bounds) = (items.iter().map(kind).collect(), items.iter().map(bound).collect());
        (self.stepper.delassus(), free.to_vec(), kinds, bounds, keys.to_vec())
    }
}

#[pymethods]
impl TreeStep {
    /// What solved it; none if nothing takes part.
    #[getter]
    fn step(&self, py: Python<'_>) -> Option<Py<Step>> {
        self.step.as_ref().map(|step| step.clone_ref(py))
    }

    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.velocity.clone())
    }

    /// Which limits and contacts took part.
    #[getter]
    fn near<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        array(py, self.near.clone())
    }

    #[getter]
    fn gaps<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.gaps.clone())
    }

    /// Percussions of all rows of the engine over the step; none if nothing takes part.
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.forces.clone())
    }

    /// `W P` over the step.
    #[getter]
    fn generalised<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.generalised.clone())
    }
}

fn indices(array: &Integers<'_>) -> Vec<usize> {
    array.as_array().iter().map(|&k| k as usize).collect()
}

fn integers<'a>(array: &'a Short<'_>) -> PyResult<&'a [i32]> {
    array.as_slice().map_err(|_| dimension("sparsity", "must be contiguous"))
}
