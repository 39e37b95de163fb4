//! Steps of kinematic trees by the arrays of an engine.

use std::collections::HashMap;
use std::sync::Arc;

use asperity::mechanism::{
    Axis, Closing, Jacobian, Listed, Rows, TreeFactor, TreeStepper as Stepper, Unilateral,
    pyramid_edges,
};
use asperity::solver::Stop;
use numpy::ndarray::ArrayView1;
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray1};
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

/// What an engine lists: its numbers of rows, and the addresses and geoms of contacts; which contacts have rows, and the first rows
/// of limits and contacts.
#[derive(Default)]
struct Listing {
    counts: (usize, usize, usize),
    addresses: Vec<i32>,
    geoms: Vec<i32>,
    contacts: Vec<usize>,
    rows: Vec<usize>,
}

/// The first row of limits and contacts, the number of limits; first rows, numbers of contacts and their geoms.
type Layout<'py> =
    (usize, usize, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Vec<(i32, i32)>);

impl Listing {
    fn pair(&self, contact: usize) -> (i32, i32) {
        (self.geoms[2 * contact], self.geoms[2 * contact + 1])
    }

    fn layout<'py>(&self, py: Python<'py>) -> Layout<'py> {
        let numbers = |list: &[usize]| array(py, list.iter().map(|&k| k as i64).collect());
        let pairs = self.contacts.iter().map(|&contact| self.pair(contact)).collect();
        let (equalities, joints, limits) = self.counts;
        (equalities + joints, limits, numbers(&self.rows), numbers(&self.contacts), pairs)
    }
}

/// What is known of a geom: a number that does not depend on the order of geoms, whether it rests, whether it is a plane, and by how
/// much it rests in others.
type Geom = (u64, bool, bool, f64);

/// The law of a pair of geoms: its rows, those where nothing drills, its axis with what carries it, and its restitution.
#[derive(Clone, Copy)]
struct PairLaw {
    rows: Rows,
    flat: Option<Rows>,
    axis: Option<(Axis, Option<usize>)>,
    restitution: f64,
}

/// Keys of contacts begin here, behind those of joints and limits; those of a pair follow each other.
const CONTACTS: u64 = 1 << 40;
const POINTS: u64 = 1 << 20;
/// A direction along which no two corners of a box, or points of a grid, have the same coordinate: 1, √2, √3.
const PLACE: [f64; 3] = [1.0, std::f64::consts::SQRT_2, 1.732_050_807_568_877_2];

/// A stepper, and what the engine lists.
#[pyclass(module = "asperity._core")]
pub struct TreeStepper {
    stepper: Stepper,
    geoms: Vec<Geom>,
    /// Laws of pairs of geoms; none where no contact has friction.
    pairs: Option<HashMap<(i32, i32), PairLaw>>,
    listing: Arc<Listing>,
    /// Whether what is listed has the same keys in the next step.
    stays: bool,
    /// The distances at which limits and contacts rest.
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
    listing: Arc<Listing>,
}

#[pymethods]
impl TreeStepper {
    #[new]
    fn new(
        laws: Option<Vec<Bound<'_, Law>>>,
        solver: &Solver,
        starts: Integers<'_>,
        ancestors: Integers<'_>,
        trees: Integers<'_>,
        geoms: Vec<Geom>,
    ) -> Result<Self, Failure> {
        let pairs = laws.is_some().then(HashMap::new);
        let laws = laws.iter().flatten().map(|law| law.get().0.clone()).collect();
        let [starts, ancestors, trees] = [&starts, &ancestors, &trees].map(indices);
        let factor = TreeFactor::new(starts, ancestors, trees)?;
        Ok(Self {
            stepper: Stepper::new(laws, solver.0, factor)?,
            geoms,
            pairs,
            listing: Arc::default(),
            stays: false,
            rest: Vec::new(),
            axes: Vec::new(),
        })
    }

    /// Whether the engine lists what it listed before, with the same keys.
    fn is_listed(
        &self,
        counts: (usize, usize, usize),
        addresses: Short<'_>,
        geoms: PyReadonlyArray2<'_, i32>,
    ) -> bool {
        let known = &*self.listing;
        self.stays
            && counts == known.counts
            && addresses.as_array().iter().eq(&known.addresses)
            && geoms.as_array().iter().eq(&known.geoms)
    }

    /// Gives a pair of geoms a law, and one without its drilling, with an axis that is carried by a geom or body, which
    /// follow each other, or by the world.
    fn learn(
        &mut self,
        pair: (i32, i32),
        kind: i64,
        restitution: f64,
        axis: Option<([f64; 3], Option<usize>, bool, f64)>,
        flat: Option<usize>,
    ) {
        let rows = match kind {
            FRICTIONLESS => Rows::Frictionless,
            law => Rows::Contact(law as usize),
        };
        let axis = axis.map(|(axis, carrier, is_reversed, radius)| {
            (Axis { axis, is_reversed, radius }, carrier)
        });
        if let Some(pairs) = &mut self.pairs {
            let flat = flat.map(Rows::Contact);
            pairs.insert(pair, PairLaw { rows, flat, axis, restitution });
        }
    }

    /// Takes in what the engine lists: counts of rows of equalities, dry joints and limits; of contacts the first rows, geoms, distances
    /// at rest and positions; distances of limits at rest; positions and rotations of geoms. Returns contacts of pairs that have no law
    /// yet, which it has to learn before.
    #[allow(clippy::too_many_arguments)] // The Python side calls it in one place, by position.
    fn list(
        &mut self,
        counts: (usize, usize, usize),
        addresses: Short<'_>,
        geoms: PyReadonlyArray2<'_, i32>,
        margins: Numbers<'_>,
        detection: f64,
        limits: Option<Numbers<'_>>,
        positions: Points<'_>,
        places: Points<'_>,
        rotations: Points<'_>,
    ) -> Result<Vec<usize>, Failure> {
        let addresses: Vec<i32> = addresses.as_array().iter().copied().collect();
        let contacts: Vec<usize> = (0..addresses.len()).filter(|&k| addresses[k] >= 0).collect();
        let geoms = geoms.as_array().iter().copied().collect();
        let begin = counts.0 + counts.1;
        let mut rows: Vec<usize> = (begin..begin + counts.2).collect();
        rows.extend(contacts.iter().map(|&k| addresses[k] as usize));
        let listing = Listing { counts, addresses, geoms, contacts, rows };
        let rows = Rows::Frictionless;
        let plain = PairLaw { rows, flat: None, axis: None, restitution: 0.0 };
        let law = |k: usize| self.pairs.as_ref().map_or(Some(&plain), |p| p.get(&listing.pair(k)));
        let known: Vec<&PairLaw> = listing.contacts.iter().filter_map(|&k| law(k)).collect();
        if known.len() < listing.contacts.len() {
            let is_new = |k: &usize| law(*k).is_none();
            return Ok(listing.contacts.iter().copied().filter(is_new).collect());
        }
        let keys = if self.pairs.is_some() {
            let (keys, stays) = self.keys(&listing, &positions, &places, &rotations);
            self.stays = stays;
            keys
        } else {
            self.stays = true;
            (begin + counts.2..).map(|key| key as u64).take(listing.contacts.len()).collect()
        };
        let limit =
            |row: usize| Unilateral { row, rows, flat: None, key: row as u64, restitution: 0.0 };
        let contact = |((law, &row), key): ((&&PairLaw, &usize), u64)| Unilateral {
            row,
            rows: law.rows,
            flat: law.flat,
            key,
            restitution: law.restitution,
        };
        let own = known.iter().zip(&listing.rows[counts.2..]).zip(keys).map(contact);
        let unilateral = (begin..begin + counts.2).map(limit).chain(own).collect();
        let axes = known
            .iter()
            .enumerate()
            .filter_map(|(k, law)| law.axis.map(|(axis, carrier)| (counts.2 + k, axis, carrier)));
        self.axes = axes.collect();
        self.rest.clear();
        match &limits {
            None => self.rest.resize(counts.2, 0.0),
            Some(limits) => self.rest.extend_from_slice(numbers(limits, "limits")?),
        }
        let margins = margins.as_array();
        self.rest.extend(listing.contacts.iter().map(|&k| {
            let (one, other) = listing.pair(k);
            let depth = |geom: i32| self.geoms[geom as usize].3;
            margins[k] - detection - depth(one).min(depth(other))
        }));
        self.stepper.list(Listed { bilateral: counts.0, dry: counts.1, unilateral });
        self.listing = Arc::new(listing);
        Ok(Vec::new())
    }

    /// The largest depth of contacts of these geoms, with these distances and margins.
    fn depth(
        &self,
        geoms: PyReadonlyArray2<'_, i32>,
        distances: Numbers<'_>,
        margins: Numbers<'_>,
        detection: f64,
    ) -> f64 {
        let own = distances.as_array().into_iter().zip(margins.as_array());
        let rests = |pair: ArrayView1<'_, i32>| {
            pair.iter().map(|&geom| self.geoms[geom as usize].3).fold(f64::INFINITY, f64::min)
        };
        let geoms = geoms.as_array();
        let depths = geoms.rows().into_iter().zip(own);
        let depths = depths.map(|(pair, (gap, margin))| margin - detection - rests(pair) - gap);
        depths.fold(0.0, f64::max)
    }

    /// What is listed.
    fn layout<'py>(&self, py: Python<'py>) -> Layout<'py> {
        self.listing.layout(py)
    }

    /// Takes in the rows at a place, with `h` times the forces of dry joints; the largest depth of a limit or contact.
    #[allow(clippy::too_many_arguments)] // The Python side calls it in one place, by position.
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
        let (equalities, joints, limits) = self.listing.counts;
        let positions = numbers(&positions, "positions")?;
        let begin = (equalities + joints).min(positions.len());
        let distances = distances.as_array();
        let of_contacts = self.listing.contacts.iter().filter_map(|&k| distances.get(k).copied());
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

    /// Turns rows at this place to the axes of laws: frames of contacts, rotations of geoms and bodies; with factors of the friction of
    /// contacts.
    fn turn(
        &mut self,
        frames: Points<'_>,
        geoms: Points<'_>,
        bodies: Points<'_>,
        factors: Option<Numbers<'_>>,
    ) -> Result<(), Failure> {
        let factors = factors.as_ref().map(|factors| numbers(factors, "factors")).transpose()?;
        let (frames, geoms, bodies) = (frames.as_array(), geoms.as_array(), bodies.as_array());
        let limits = self.listing.counts.2;
        let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        for (number, axis, carrier) in &self.axes {
            let rotation = carrier.map_or(identity, |k| {
                let geom = k < geoms.nrows();
                let row = if geom { geoms.row(k) } else { bodies.row(k - geoms.nrows()) };
                std::array::from_fn(|i| row[i])
            });
            let frame = frames.row(self.listing.contacts[number - limits]);
            let turn = axis.turn(&rotation, &std::array::from_fn(|i| frame[3 + i]));
            let factor = factors.map_or(1.0, |factors| factors[number - limits]);
            self.stepper.turn(*number, turn.scaled(factor));
        }
        Ok(())
    }

    /// Adds velocities from outside the trees to all rows of the engine at this place.
    fn drive(&mut self, velocities: Numbers<'_>) -> Result<(), Failure> {
        Ok(self.stepper.drive(numbers(&velocities, "velocities")?)?)
    }

    /// Takes in the velocities without percussions, by accelerations at these `velocities`, which become their mean with those
    /// `before`; whether they are finite.
    fn accelerate(
        &mut self,
        acceleration: Numbers<'_>,
        before: Numbers<'_>,
        mut velocities: PyReadwriteArray1<'_, f64>,
        h: f64,
        damping: Option<Numbers<'_>>,
    ) -> Result<bool, Failure> {
        let before = numbers(&before, "before")?;
        let damping = damping.as_ref().map(|d| numbers(d, "damping")).transpose()?;
        let all = velocities.as_slice_mut();
        let all = all.map_err(|_| dimension("velocities", "must be contiguous"))?;
        let acceleration = numbers(&acceleration, "acceleration")?;
        let is_finite = self.stepper.accelerate(acceleration, before, all, h, damping)?;
        let free = self.stepper.free_velocity().iter().zip(before);
        all.iter_mut().zip(free).for_each(|(mean, (free, v))| *mean = 0.5 * (v + free));
        Ok(is_finite)
    }

    /// Solves a step from the velocities without percussions and those before, with gaps that close in half of it.
    fn step(
        &mut self,
        py: Python<'_>,
        before: Numbers<'_>,
        h: f64,
        exact: f64,
        tolerance: f64,
    ) -> Result<TreeStep, Failure> {
        let before = numbers(&before, "velocity")?;
        let stepper = &mut self.stepper;
        let report = asked(py, |cancelled| {
            let stop = Stop::at(tolerance).unless(cancelled);
            stepper.step(before, Closing { time: 0.5 * h, exact, stop })
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
            listing: Arc::clone(&self.listing),
        })
    }

    /// Whether the last step was one from these velocities without percussions.
    fn was_from(&self, part: f64) -> bool {
        self.stepper.was_from(part)
    }

    /// Whether the percussions of the last step do more work than physics allows.
    fn gains_energy(&self, before: Numbers<'_>, part: f64) -> PyResult<bool> {
        Ok(self.stepper.gains_energy(numbers(&before, "before")?, part))
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
        let (equalities, joints, limits) = self.listing.counts;
        let begin = equalities + joints + limits;
        let mut edges = vec![0.0; count];
        if forces.is_empty() || begin > count {
            return Ok(array(py, edges));
        }
        edges[..begin].copy_from_slice(&forces[..begin]);
        for (&contact, first) in self.listing.contacts.iter().zip(self.stepper.rows().skip(limits))
        {
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

    /// The least change of coordinates that closes the equalities, with these values, and the gaps below a limit.
    fn close<'py>(
        &mut self,
        py: Python<'py>,
        equalities: Numbers<'_>,
        limit: f64,
        tolerance: f64,
    ) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        let equalities = numbers(&equalities, "equalities")?;
        let stepper = &mut self.stepper;
        let change = asked(py, |cancelled| {
            let stop = Stop::at(tolerance).unless(cancelled);
            stepper.close(equalities, limit, stop).map(<[f64]>::to_vec)
        })??;
        Ok(array(py, change))
    }

    /// From how far contacts came that end deeper than this after half a step with these velocities.
    fn came(&self, depth: f64, after: Numbers<'_>, half: f64) -> PyResult<f64> {
        let (after, limits) = (numbers(&after, "after")?, self.listing.counts.2);
        let contacts = self.stepper.gaps().iter().zip(&self.listing.rows).skip(limits);
        let inside = contacts.filter(|(gap, _)| **gap < -depth);
        let came = inside.map(|(gap, row)| gap - half * self.stepper.row_velocity(*row, after));
        Ok(came.fold(0.0, f64::max))
    }

    /// The item that the last step was refused for.
    fn refused(&self) -> Option<usize> {
        self.stepper.refused()
    }

    /// Which limits and contacts took part in the last step.
    fn near<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        array(py, self.stepper.near().to_vec())
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
        array(py, (0..self.listing.counts.0).map(|row| self.stepper.moves(row)).collect())
    }

    /// What takes part in the last step: entries of `G` row by row, velocities without percussions, kinds, bounds and keys.
    #[allow(clippy::type_complexity)] // The Python side unpacks it in one place.
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

impl TreeStepper {
    /// Keys of contacts that do not depend on the order in which geoms and contacts are listed, and whether they stay in the next step.
    ///
    /// Points of a pair are numbered by their places on the geom that moves; those on a plane are always in the same order.
    fn keys(
        &self,
        listing: &Listing,
        positions: &Points<'_>,
        places: &Points<'_>,
        rotations: &Points<'_>,
    ) -> (Vec<u64>, bool) {
        let [positions, places, rotations] = [positions, places, rotations].map(|p| p.as_array());
        let geom = |geom: i32| self.geoms[geom as usize];
        let pair = |contact: usize| {
            let (one, other) = listing.pair(contact);
            let (a, b) = (geom(one).0, geom(other).0);
            a.min(b) * self.geoms.len() as u64 + a.max(b)
        };
        let place = |contact: usize| {
            let (one, other) = listing.pair(contact);
            let carrier = if geom(one).1 { other } else { one } as usize;
            let (own, center) = (positions.row(contact), places.row(carrier));
            let rotation = rotations.row(carrier);
            let along = |i: usize| (0..3).map(|j| rotation[3 * i + j] * PLACE[j]).sum::<f64>();
            (0..3).map(|i| (own[i] - center[i]) * along(i)).sum::<f64>()
        };
        let mut order: Vec<(u64, f64, usize)> = Vec::with_capacity(listing.contacts.len());
        order.extend(listing.contacts.iter().enumerate().map(|(k, &c)| (pair(c), 0.0, k)));
        order.sort_unstable_by_key(|entry| (entry.0, entry.2));
        let several = order.windows(2).any(|two| two[0].0 == two[1].0);
        if several {
            order.iter_mut().for_each(|entry| entry.1 = place(listing.contacts[entry.2]));
            order.sort_unstable_by(|a, b| {
                (a.0.cmp(&b.0)).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2))
            });
        }
        let (mut keys, mut last, mut ordinal) = (vec![0; order.len()], None, 0);
        for (pair, _, k) in order {
            ordinal = if last == Some(pair) { ordinal + 1 } else { 0 };
            last = Some(pair);
            keys[k] = CONTACTS + pair * POINTS + ordinal;
        }
        let on_plane = |&contact: &usize| {
            let (one, other) = listing.pair(contact);
            geom(one).2 || geom(other).2
        };
        (keys, !several || listing.contacts.iter().all(on_plane))
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

    /// What was listed.
    fn layout<'py>(&self, py: Python<'py>) -> Layout<'py> {
        self.listing.layout(py)
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
