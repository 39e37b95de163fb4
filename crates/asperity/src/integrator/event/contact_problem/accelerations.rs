//! What closed contacts without slip do next: the contact problem on the level of accelerations.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::contact::{ContactProblem, Phase};
use crate::integrator::event::contact_problem::load_bearing::{ClosedContact, load_bearing};
use crate::integrator::event::contact_problem::problem::{
    Decision, Participants, Question, Solved, Solving,
};
use crate::integrator::event::dynamics::{ContactVariables, Dynamics, ROWS, SlidingForces};
use crate::integrator::event::outcome::Outcome;
use crate::integrator::event::resolution::{NOTHING, ROUNDED, ROUNDING, SOLVED, SOLVED_EXACTLY};
use crate::integrator::event::state::{EvaluationError, State};
use crate::linear::LeastNorm;
use crate::solver::{LIGHT, RANK};
use crate::vectors::{add, largest, norm};

/// Slip acceleration over the load below which the contact problem may miss what friction along the slip can hold.
const SLOW: f64 = 1e-6;
/// Cosine between a slip and its acceleration above which it grows along itself.
const ALONG: f64 = 0.9;
/// Speed of slips whose direction settles, over the load, and how often it does: each time to about this share.
const SPEED: f64 = 1e-3;
const SETTLED: usize = 4;
/// Change of the force of a contact that would keep it from slipping, over the largest force of all, up to which it may
/// count as at rest. In a nearly immobile direction an acceleration below those limits may ask for any force.
const HELD: f64 = 1e-2;
/// Iterations of singular value and eigenvalue decompositions, of which matrices of four rows take some ten.
const MOST_ITERATIONS: usize = 100;

/// How often contacts are set aside or return at most, besides once for each of them.
const MORE_EXCHANGES: usize = 4;

/// Closed contacts that the contact problem leaves out.
struct SetAside {
    /// Those that the slipping contacts hold in all their directions already.
    immobile: Vec<usize>,
    /// Those that carry no load.
    unloaded: Vec<Unloaded>,
}

/// A closed contact that carries no load.
struct Unloaded {
    contact: usize,
    /// Whether its slip vanishes, so that the contact problem would decide on it.
    at_rest: bool,
}

impl SetAside {
    /// The contacts that carried no load before.
    fn before(dynamics: &mut Dynamics<'_>) -> Self {
        let mut aside = Self { immobile: Vec::new(), unloaded: Vec::new() };
        for i in 0..dynamics.contacts.len() {
            if dynamics.contacts[i].unloaded {
                aside.unload(dynamics, i);
            }
        }
        aside
    }

    /// Takes the load of a contact.
    fn unload(&mut self, dynamics: &mut Dynamics<'_>, i: usize) {
        let contact = &mut dynamics.contacts[i];
        self.unloaded.push(Unloaded { contact: i, at_rest: contact.undecided });
        (contact.mode, contact.unloaded, contact.undecided) = (Phase::Open, true, false);
    }

    /// Those that slipping contacts held are asked again: what held them may have opened.
    fn ask_immobile(&mut self, dynamics: &mut Dynamics<'_>) {
        self.immobile.drain(..).for_each(|i| dynamics.contacts[i].undecided = true);
    }

    /// Sets contacts aside or lets them return, as they carry load or not; whether there are any.
    fn exchange(
        &mut self,
        dynamics: &mut Dynamics<'_>,
        closed: &[ClosedContact],
        carries: &[bool],
    ) -> bool {
        let mut changed = false;
        for (closed, &carries) in closed.iter().zip(carries) {
            let before = self.unloaded.iter().position(|u| u.contact == closed.contact);
            if let Some(place) = before.filter(|_| carries) {
                let Unloaded { contact, at_rest } = self.unloaded.swap_remove(place);
                let contact = &mut dynamics.contacts[contact];
                (contact.unloaded, contact.undecided) = (false, at_rest);
                contact.mode = if at_rest { Phase::Open } else { Phase::Slip };
                changed = true;
            } else if closed.carries && !carries {
                self.unload(dynamics, closed.contact);
                changed = true;
            }
        }
        changed
    }
}

/// Decides on the contacts that are undecided. Afterwards the dynamics hold the accelerations, the modes, and for
/// contacts that begin to slip γ̇ in place of γ.
///
/// Contacts that can share normal forces in many ways have the shares of equal compliance. What the contact problem finds
/// without this rule holds where it finds nothing with it.
pub(crate) fn decide(
    dynamics: &mut Dynamics<'_>,
    state: &State,
    question: Question,
    solving: &Solving<'_, '_>,
) -> Result<Decision, EvaluationError> {
    let asked = dynamics.contacts.clone();
    let closed = |contact: &&ContactVariables| !contact.is_free() && contact.prescribed.is_none();
    let unloaded = asked.iter().any(|contact| contact.unloaded);
    if unloaded || asked.iter().filter(closed).count() > 1 {
        dynamics.undecided_share = true;
        let shared = decide_with_shares(dynamics, state, question, solving);
        dynamics.undecided_share = false;
        let decision = shared?;
        if !matches!(
            decision,
            Decision::Ended(Outcome::NoSolution { .. } | Outcome::Stagnated { .. })
        ) {
            return Ok(decision);
        }
        dynamics.contacts = asked;
    }
    decide_with_shares(dynamics, state, question, solving)
}

/// Decides with the shares that the dynamics find, if they look for them.
fn decide_with_shares(
    dynamics: &mut Dynamics<'_>,
    state: &State,
    question: Question,
    solving: &Solving<'_, '_>,
) -> Result<Decision, EvaluationError> {
    let mut aside = SetAside::before(dynamics);
    let mut exchanges = 0;
    // Contacts that would have to pull are set aside, those that would carry come back, and all decide again.
    loop {
        dynamics.contacts.iter_mut().filter(|c| c.undecided).for_each(|c| c.mode = Phase::Open);
        dynamics.evaluate(state.t, &state.q, &state.u, SlidingForces::Updated)?;
        let n = dynamics.n;
        // The slipping contacts, whose normal forces change with those of the others.
        let slipping = dynamics.constrained_rows().to_vec();
        let mut normal_forces = dynamics.constraint_forces().to_vec();
        let undecided =
            (0..dynamics.contacts.len()).filter(|&i| dynamics.contacts[i].undecided).collect();
        let (participants, answers) = Participants::constrained(dynamics, undecided);
        let immobile = participants.immobile(dynamics);
        if !immobile.is_empty() {
            immobile.iter().for_each(|&i| dynamics.contacts[i].undecided = false);
            aside.immobile.extend(immobile);
            continue;
        }
        let load: Vec<f64> = {
            let shared = |row| dynamics.sharing.product(row, &slipping, &normal_forces);
            let rate = |&row: &usize| dynamics.rate(row, &dynamics.acceleration) + shared(row);
            participants.rows.iter().map(rate).collect()
        };
        let problem =
            participants.problem(dynamics, &load, question, |contact| contact.prescribed)?;
        let solved = match participants.solve(&problem, solving) {
            Ok(solved) => solved,
            Err(outcome) => return Ok(Decision::Ended(outcome)),
        };
        for (k, force) in solved.found.percussion.iter().enumerate() {
            add(&mut dynamics.acceleration, *force, &participants.responses[k * n..][..n]);
            add(&mut normal_forces, *force, &answers[k * slipping.len()..][..slipping.len()]);
        }
        let smallest =
            (0..slipping.len()).min_by(|&a, &b| normal_forces[a].total_cmp(&normal_forces[b]));
        let lifted = smallest.filter(|&k| normal_forces[k] < 0.0).map(|k| slipping[k] / ROWS);
        if !dynamics.undecided_share {
            if let Some(contact) = lifted {
                aside.unload(dynamics, contact);
                aside.ask_immobile(dynamics);
                continue;
            }
        } else if lifted.is_some() || dynamics.sharing.dependent || !aside.unloaded.is_empty() {
            let rests = (participants.contacts.iter().zip(problem.contacts()).enumerate())
                .filter(|(_, (i, _))| dynamics.contacts[**i].prescribed.is_none())
                .map(|(k, (&i, rows))| {
                    let opens = solved.found.states[k].phase == Phase::Open;
                    let force = rows.normal_percussion(&solved.found.percussion);
                    let carries = !opens || dynamics.sharing.includes(i);
                    ClosedContact { contact: i, slips: false, force, carries }
                });
            let slips = slipping.iter().zip(&normal_forces);
            let slips = slips.map(|(row, &force)| ClosedContact {
                contact: row / ROWS,
                slips: true,
                force,
                carries: true,
            });
            let set_aside = aside.unloaded.iter().map(|unloaded| ClosedContact {
                contact: unloaded.contact,
                slips: !unloaded.at_rest,
                force: 0.0,
                carries: false,
            });
            let closed: Vec<_> = slips.chain(set_aside).chain(rests).collect();
            let Some(carries) = load_bearing(dynamics, &closed) else {
                return Ok(Decision::Ended(Outcome::unsolved(closed[0].contact)));
            };
            if aside.exchange(dynamics, &closed, &carries) {
                exchanges += 1;
                if exchanges > closed.len() + MORE_EXCHANGES {
                    return Ok(Decision::Ended(Outcome::unsolved(closed[0].contact)));
                }
                aside.ask_immobile(dynamics);
                continue;
            }
            // To `load_bearing` normals that are nearly parallel are dependent, to the dynamics they are not.
            let most = closed.iter().map(|contact| contact.force.abs()).fold(0.0, f64::max);
            let pulls = |&k: &usize| normal_forces[k] < -LIGHT * most;
            if let Some(k) = smallest.filter(pulls) {
                return Ok(Decision::Ended(Outcome::unsolved(slipping[k] / ROWS)));
            }
        }
        for (row, &force) in slipping.iter().zip(&normal_forces) {
            // The evaluation knew nothing of the contacts that have been decided on.
            let contact = &mut dynamics.contacts[row / ROWS];
            (contact.normal_force, contact.force) = (force, contact.sliding.map(|f| f * force));
        }
        for &i in &aside.immobile {
            let contact = &mut dynamics.contacts[i];
            (contact.mode, contact.tolerated_excess) = (Phase::Stick, 0.0);
            (contact.force, contact.slip) = ([0.0; 3], [0.0; 3]);
            contact.normal_force = contact.prescribed.unwrap_or(0.0);
        }
        adopt(dynamics, &participants, &problem, &solved);
        stick_at_limit(dynamics, &participants, &problem, &solved, question);
        stick_undriven(dynamics, state, &participants, &problem, solving)?;
        open_without_load(dynamics, &participants.contacts);
        let scale = largest(&load).max(dynamics.load);
        settle_unloaded(dynamics, &aside.unloaded, SOLVED * scale);
        return Ok(Decision::Made { ambiguous: solved.ambiguous });
    }
}

/// Contacts without load open, stick where all that they touch rests, or else stay closed by the contacts that carry load.
fn settle_unloaded(dynamics: &mut Dynamics<'_>, unloaded: &[Unloaded], at_rest: f64) {
    if unloaded.is_empty() {
        return;
    }
    let parts = dynamics.parts_of_contacts();
    for &Unloaded { contact: i, at_rest: still } in unloaded {
        let rate = |row| dynamics.rate(row, &dynamics.acceleration);
        let slips = |k: usize| parts[k] == parts[i] && dynamics.contacts[k].mode == Phase::Slip;
        let rests = still
            && dynamics.rows_of(i).all(|row| rate(row).abs() <= at_rest)
            && !(0..parts.len()).any(slips);
        let opens = rate(ROWS * i) > at_rest;
        let contact = &mut dynamics.contacts[i];
        contact.mode = if rests { Phase::Stick } else { Phase::Open };
        // Beyond the shares of equal compliance nothing tells when an unloaded contact would carry again.
        contact.unloaded = !rests && !opens && dynamics.undecided_share;
        (contact.normal_force, contact.force) = (0.0, [0.0; 3]);
        contact.tolerated_excess = 0.0;
        if still {
            contact.slip = [0.0; 3];
        }
    }
}

/// Takes over modes, forces and slip accelerations of the contacts that have been decided on.
fn adopt(
    dynamics: &mut Dynamics<'_>,
    participants: &Participants,
    problem: &ContactProblem,
    Solved { found, velocity, .. }: &Solved,
) {
    for (k, (&i, rows)) in participants.contacts.iter().zip(problem.contacts()).enumerate() {
        let contact = &mut dynamics.contacts[i];
        (contact.mode, contact.undecided) = (found.states[k].phase, false);
        contact.tolerated_excess = 0.0;
        contact.normal_force = rows.normal_percussion(&found.percussion);
        for (r, row) in rows.tangential_rows().enumerate() {
            contact.force[r] = found.percussion[row];
            contact.slip[r] = velocity[row];
        }
        if contact.mode == Phase::Slip && contact.normal_force > 0.0 {
            contact.sliding = contact.force.map(|f| f / contact.normal_force);
            dynamics.contacts[i].resistance = dynamics.resistance(i);
        }
    }
}

/// Contacts that begin to slip or to open by rounding only stick: the others prevent it, the load is just what
/// friction can hold, or other contacts carry all of it.
fn stick_at_limit(
    dynamics: &mut Dynamics<'_>,
    participants: &Participants,
    problem: &ContactProblem,
    Solved { found, velocity: accelerations, .. }: &Solved,
    question: Question,
) {
    let force = largest_force(problem, &found.percussion);
    let load = largest(problem.free_velocity());
    let curved = |&i: &usize| dynamics.contacts[i].p > 1;
    let shared = participants.contacts.len() > 1 && participants.contacts.iter().any(curved);
    for (k, (&i, rows)) in participants.contacts.iter().zip(problem.contacts()).enumerate() {
        let own = rows.offset..rows.offset + rows.len();
        let slips = dynamics.contacts[i].mode == Phase::Slip;
        let at_rest = if shared && !slips { SOLVED } else { SOLVED_EXACTLY };
        let alone = slips.then(|| Alone::new(dynamics, &participants.rows[own.clone()]));
        let rate = &accelerations[own.clone()];
        let is_rounding =
            |alone: &Alone| alone.explains(dynamics, &found.percussion[own.clone()], rate);
        let rests = norm(rate) <= at_rest * load || alone.as_ref().is_some_and(is_rounding);
        // Forces in stick are those that hold the contact, but where only the end of stick is in question.
        let keeps_force = force == 0.0 || question == Question::WhetherStickGoesOn;
        let can_be_held = |alone: &Alone| {
            keeps_force || change_that_holds(problem, k, rate, &alone.mobility) <= HELD * force
        };
        let contact = &mut dynamics.contacts[i];
        if rests && alone.as_ref().map_or(contact.prescribed.is_none(), can_be_held) {
            contact.mode = Phase::Stick;
            contact.slip = [0.0; 3];
        }
    }
}

/// Contacts that begin to slip slowly stick where friction along their slip gives no power to it: the contact problem leaves
/// forces off the direction of the slip by the root of its residual there, and friction too small to hold the load.
///
/// The direction is that in which slips settle that have a speed already. The power is that of the accelerations by friction
/// along it, in the least motion with these rates ξ of the slip, `ξᵀG⁺ξ′`: its error is the square of that of the direction.
fn stick_undriven(
    dynamics: &mut Dynamics<'_>,
    state: &State,
    participants: &Participants,
    problem: &ContactProblem,
    solving: &Solving<'_, '_>,
) -> Result<(), EvaluationError> {
    let slips = |i: usize| dynamics.contacts[i].mode == Phase::Slip;
    let begins: Vec<usize> = participants.contacts.iter().copied().filter(|&i| slips(i)).collect();
    let fastest = begins.iter().map(|&i| norm(&dynamics.contacts[i].slip)).fold(0.0, f64::max);
    // The problem of one contact is solved exactly.
    let alone = participants.contacts.len() < 2;
    if alone || fastest == 0.0 || fastest > SLOW * dynamics.load {
        return Ok(());
    }
    if are_held(dynamics, &participants.contacts, &begins) {
        rest(dynamics, &begins);
        return Ok(());
    }
    let mut rates: Vec<f64> =
        (participants.rows.iter()).map(|&row| dynamics.rate(row, &dynamics.acceleration)).collect();
    let mut moving = problem.clone();
    for _ in 0..SETTLED {
        let fastest = largest(&rates);
        if fastest == 0.0 {
            break;
        }
        let factor = SPEED * dynamics.load / fastest;
        let free =
            problem.free_velocity().iter().zip(&rates).map(|(load, rate)| load + factor * rate);
        free.zip(moving.free_velocity_mut()).for_each(|(free, to)| *to = free);
        match participants.solve(&moving, solving) {
            Ok(solved) if largest(&solved.velocity) > 0.0 => rates = solved.velocity,
            _ => break,
        }
    }
    if solving.observer.has_asked_to_stop() {
        return Ok(());
    }
    let (found, acceleration) = (dynamics.contacts.clone(), dynamics.acceleration.clone());
    let tangential = |k: usize| {
        let rows = problem.contacts()[k].tangential_rows();
        let mut slip = [0.0; 3];
        slip.iter_mut().zip(&rates[rows]).for_each(|(to, rate)| *to = *rate);
        slip
    };
    let at_rest = f64::MIN_POSITIVE.cbrt();
    for (k, &i) in participants.contacts.iter().enumerate() {
        // Slips that begin have the factor of rest; squares of this speed do not vanish yet.
        let direction = tangential(k).map(|rate| at_rest * rate / largest(&rates));
        if let Some(sliding) = dynamics.law(i).sliding(&direction).filter(|_| begins.contains(&i)) {
            dynamics.contacts[i].sliding = sliding;
        }
    }
    dynamics.evaluate(state.t, &state.q, &state.u, SlidingForces::Kept)?;
    let own: Vec<usize> = (0..participants.rows.len())
        .filter(|&k| begins.contains(&(participants.rows[k] / ROWS)))
        .collect();
    let row = |k: usize| participants.rows[own[k]];
    let slip = DVector::from_fn(own.len(), |k, _| rates[own[k]]);
    let driven = DVector::from_fn(own.len(), |k, _| dynamics.rate(row(k), &dynamics.acceleration));
    let mobility = DMatrix::from_fn(own.len(), own.len(), |a, b| {
        dynamics.mobility(row(a), row(b), dynamics.response(row(b)))
    });
    let Some(factors) = LeastNorm::new(mobility, RANK) else {
        (dynamics.contacts, dynamics.acceleration) = (found, acceleration);
        return Ok(());
    };
    let (forces, forces_driven) = (factors.solve(&slip), factors.solve(&driven));
    let (power, own_power) = (forces.dot(&driven), forces.dot(&slip));
    // Of rates that no motion has, as redundant contacts on surfaces that turn have by rounding, what some motion has.
    let possible = factors.range() * factors.range().tr_mul(&slip);
    let growth = if own_power > 0.0 { power / own_power * possible.amax() } else { 0.0 };
    let rests = growth <= SOLVED_EXACTLY * dynamics.load;
    // Where the slip grows along itself, these are better accelerations than those that were found.
    let along = power > ALONG * (own_power * forces_driven.dot(&driven)).sqrt()
        && begins.iter().all(|&i| dynamics.law(i).is_associated());
    if rests || !along {
        (dynamics.contacts, dynamics.acceleration) = (found, acceleration);
    } else {
        let now = dynamics.contacts.iter_mut().zip(&found);
        now.for_each(|(contact, found)| contact.slip = found.slip);
    }
    if rests {
        rest(dynamics, &begins);
    } else if along {
        let slipping = participants.contacts.iter().enumerate().filter(|(_, i)| begins.contains(i));
        slipping.for_each(|(k, &i)| {
            dynamics.contacts[i].slip = tangential(k).map(|rate| rate * growth / slip.amax());
        });
    }
    Ok(())
}

/// Contacts do not begin to slip.
fn rest(dynamics: &mut Dynamics<'_>, contacts: &[usize]) {
    for &i in contacts {
        let contact = &mut dynamics.contacts[i];
        (contact.mode, contact.slip) = (Phase::Stick, [0.0; 3]);
    }
}

/// Whether the other contacts that have been decided on, and their own normals, leave slips no direction: redundant contacts on
/// surfaces that turn have slips of rounding, which no motion has.
fn are_held(dynamics: &Dynamics<'_>, decided: &[usize], slipping: &[usize]) -> bool {
    let constraints = |&i: &usize| {
        let rows = dynamics.rows_of(i);
        // None of a prescribed force, whose rows begin behind it.
        let normal = rows.start..ROWS * i + 1;
        match dynamics.contacts[i].mode {
            Phase::Stick => rows,
            Phase::Slip => normal,
            _ => 0..0,
        }
    };
    let held: Vec<usize> = decided.iter().flat_map(constraints).collect();
    let free: Vec<usize> =
        slipping.iter().flat_map(|&i| ROWS * i + 1..=ROWS * i + dynamics.contacts[i].p).collect();
    are_dependent(dynamics, &free, &held)
}

/// Whether constraints along some rows leave no motion along any of the others.
fn are_dependent(dynamics: &Dynamics<'_>, rows: &[usize], constraints: &[usize]) -> bool {
    let mobility = |a: usize, b: usize| dynamics.mobility(a, b, dynamics.response(b));
    let entry = |a: usize, b: usize| mobility(constraints[a], constraints[b]);
    let matrix = DMatrix::from_fn(constraints.len(), constraints.len(), entry);
    let Some(factors) = LeastNorm::new(matrix, RANK) else { return false };
    rows.iter().all(|&row| {
        let coupling = DVector::from_fn(constraints.len(), |k, _| mobility(constraints[k], row));
        let own = mobility(row, row);
        own - coupling.dot(&factors.solve(&coupling)) <= NOTHING * own
    })
}

/// Contacts that begin to slip open where their normal force is rounding and others hold their surfaces together: constraints
/// that hold the same would share what those carry.
fn open_without_load(dynamics: &mut Dynamics<'_>, decided: &[usize]) {
    for &i in decided {
        let contact = dynamics.contacts[i];
        let own = dynamics.normal_mobility(i, i);
        let light = contact.normal_force * own <= ROUNDING * dynamics.load;
        if contact.mode != Phase::Slip || contact.prescribed.is_some() || !light {
            continue;
        }
        let constraints = |k: usize| {
            let rows = dynamics.rows_of(k);
            match dynamics.contacts[k].mode {
                Phase::Stick => rows,
                Phase::Slip if k != i && rows.start == ROWS * k => rows.start..rows.start + 1,
                _ => 0..0,
            }
        };
        let rows: Vec<usize> = (0..dynamics.contacts.len()).flat_map(constraints).collect();
        if are_dependent(dynamics, &[ROWS * i], &rows) {
            let contact = &mut dynamics.contacts[i];
            (contact.mode, contact.slip) = (Phase::Open, [0.0; 3]);
            (contact.normal_force, contact.force) = (0.0, [0.0; 3]);
        }
    }
}

/// A contact as if it were the only one.
///
/// Where slipping contacts leave hardly a direction free, accelerations and mobilities along the rows of another contact
/// are small differences of those that it would have alone, and rounding is a part of them: a contact at rest would
/// begin to slip again and again.
struct Alone<'r> {
    rows: &'r [usize],
    /// `WᵀM⁻¹W` of the contact.
    mobility: DMatrix<f64>,
}

impl<'r> Alone<'r> {
    fn new(dynamics: &Dynamics<'_>, rows: &'r [usize]) -> Self {
        let entry =
            |a: usize, b: usize| dynamics.mobility(rows[a], rows[b], dynamics.response(rows[b]));
        Self { rows, mobility: DMatrix::from_fn(rows.len(), rows.len(), entry) }
    }

    /// Whether accelerations along the rows are rounding of those that the forces of the contact would give it alone.
    ///
    /// Each row is compared with itself, so that neither bodies that the contact does not touch nor units count. Directions
    /// in which the constraints of a sticking contact are dependent do not rest: no constraint would hold it there.
    fn explains(&self, dynamics: &Dynamics<'_>, forces: &[f64], rates: &[f64]) -> bool {
        let effect = |row: usize| -> f64 {
            let parts = self.rows.iter().zip(forces).map(|(&other, force)| {
                let terms = dynamics.row(row).iter().zip(dynamics.response(other));
                force.abs() * terms.map(|(w, response)| (w * response).abs()).sum::<f64>()
            });
            parts.sum()
        };
        let small = |(&row, rate): (&usize, &f64)| rate.abs() <= ROUNDING * effect(row);
        self.rows.iter().zip(rates).all(small) && self.holds_all_directions()
    }

    /// Whether a constraint along each row holds another direction, as far as [`RANK`] tells.
    fn holds_all_directions(&self) -> bool {
        if !self.mobility.iter().all(|x| x.is_finite()) {
            return false;
        }
        let parts = SymmetricEigen::try_new(self.mobility.clone(), f64::EPSILON, MOST_ITERATIONS);
        parts.is_some_and(|parts| parts.eigenvalues.min() > RANK * parts.eigenvalues.max())
    }
}

/// The least change of the force of a contact alone, in units of mobilities of one, that takes its accelerations away; zero
/// where its mobility cannot be told. `alone` are its mobilities without other contacts.
fn change_that_holds(
    problem: &ContactProblem,
    contact: usize,
    accelerations: &[f64],
    alone: &DMatrix<f64>,
) -> f64 {
    let len = accelerations.len();
    let unit = |mobility: f64| if mobility > 0.0 { 1.0 / mobility.sqrt() } else { 1.0 };
    let units = DVector::from_fn(len, |a, _| unit(problem.delassus().own(contact, a, a)));
    let scaled = DMatrix::from_fn(len, len, |a, b| {
        problem.delassus().own(contact, a, b) * units[a] * units[b]
    });
    let rates = DVector::from_column_slice(accelerations).component_mul(&units);
    if !scaled.iter().chain(&rates).all(|x| x.is_finite()) {
        return 0.0;
    }
    let Some(factors) = scaled.try_svd(true, true, f64::EPSILON, MOST_ITERATIONS) else {
        return 0.0;
    };
    let rounding = |a: usize| ROUNDING * alone[(a, a)] * units[a] * units[a];
    let rounded = ROUNDED * factors.singular_values.max();
    let least = (0..len).map(rounding).fold(rounded, f64::max);
    factors.solve(&rates, least).map_or(0.0, |change| change.norm())
}

/// The largest force along any row of the problem that has a mobility, in the same units.
fn largest_force(problem: &ContactProblem, percussion: &[f64]) -> f64 {
    let mut largest: f64 = 0.0;
    for (k, rows) in problem.contacts().iter().enumerate() {
        for (a, row) in (rows.offset..rows.offset + rows.len()).enumerate() {
            let mobility = problem.delassus().own(k, a, a);
            if mobility > 0.0 {
                largest = largest.max(percussion[row].abs() * mobility.sqrt());
            }
        }
    }
    largest
}
