//! Parts of a system that nothing connects, each with steps, events and scales of its own, merged into one motion.
//!
//! The part whose next step or event ends first goes on. At that time the others lie within their next steps, where their
//! states are interpolated, so that a sample holds all parts at one time.

use std::ops::ControlFlow;

use crate::argument::{ArgumentError, refuse};
use crate::integrator::event::integration::variables::{Ending, Integration, Next};
use crate::integrator::event::motion::{Event, EventKind, Motion};
use crate::integrator::event::options::{Options, Section};
use crate::integrator::event::outcome::Outcome;
use crate::integrator::event::state::EvaluationError;
use crate::integrator::observer::Observer;
use crate::integrator::samples::Samples;
use crate::system::{InitialState, System, SystemPart};

/// Integrates a system; the motion, and why the integration has ended.
pub(crate) fn run(
    system: &dyn System,
    start: &InitialState,
    options: &Options,
    observer: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(Motion, Outcome), ArgumentError> {
    // How far the run is, parts of it being at different times.
    let mut latest = options.t_start;
    let mut observer = |t: f64| {
        latest = latest.max(t);
        observer(latest)
    };
    let observer = Observer::new(&mut observer);
    let parts = parts(system, options);
    check(system, &parts)?;
    let settings: Vec<(InitialState, Options)> = parts
        .iter()
        .map(|part| {
            let q = part.coordinates.iter().map(|&k| start.q[k]).collect();
            let u = part.velocities.iter().map(|&k| start.u[k]).collect();
            (InitialState { q, u }, options_of(part, options, system.coordinates()))
        })
        .collect();
    let integrations = if parts.is_empty() {
        vec![Integration::new(system, start, options, &observer)]
    } else {
        let all = parts.iter().zip(&settings);
        all.map(|(part, (start, options))| {
            Integration::new(part.system.as_ref(), start, options, &observer)
        })
        .collect()
    };
    let merged = vec![0; integrations.len()];
    let mut run =
        Run { parts: &parts, options, integrations, merged, events: Vec::new(), unseen: 0 };
    if let Err(error) = run.check_overlap()? {
        return Ok((run.motion(system), Outcome::Error(error)));
    }
    let outcome = run.integrate();
    Ok((run.motion(system), outcome))
}

/// The parts of a system; none where it is one, or where the height above a section depends on several.
fn parts(system: &dyn System, options: &Options) -> Vec<SystemPart> {
    let parts = system.parts();
    let whole = match &options.section {
        Some(section) => {
            let matters = |k: usize| section.normal[k] != 0.0;
            let concerned = parts.iter().filter(|part| {
                let velocities = part.velocities.iter().map(|k| system.coordinates() + k);
                part.coordinates.iter().copied().chain(velocities).any(matters)
            });
            concerned.count() != 1
        }
        None => false,
    };
    if whole { Vec::new() } else { parts }
}

/// Refuses parts that do not hold every coordinate, velocity and contact of the system once.
fn check(system: &dyn System, parts: &[SystemPart]) -> Result<(), ArgumentError> {
    let whole = [system.coordinates(), system.dof(), system.contacts().len()];
    let mut all = [const { Vec::new() }; 3];
    let mut fits = true;
    for SystemPart { system, coordinates, velocities, contacts } in parts {
        let own = [system.coordinates(), system.dof(), system.contacts().len()];
        for ((all, list), own) in all.iter_mut().zip([coordinates, velocities, contacts]).zip(own) {
            fits &= list.len() == own;
            all.extend_from_slice(list);
        }
    }
    for (list, count) in all.iter_mut().zip(whole) {
        list.sort_unstable();
        fits &= parts.is_empty() || list.iter().copied().eq(0..count);
    }
    let message = "must have parts that hold every coordinate, velocity and contact once";
    if fits { Ok(()) } else { refuse("system", message) }
}

/// The options of a part, with the section if it depends on it.
fn options_of(part: &SystemPart, options: &Options, coordinates: usize) -> Options {
    let section = options.section.as_ref().and_then(|section| {
        let places = part.coordinates.iter().copied();
        let places = places.chain(part.velocities.iter().map(|k| coordinates + k));
        let normal: Vec<f64> = places.map(|k| section.normal[k]).collect();
        let concerned = normal.iter().any(|entry| *entry != 0.0);
        concerned.then(|| Section { normal, ..section.clone() })
    });
    Options { section, start: None, ..options.clone() }
}

/// The integrations of all parts.
struct Run<'r, 'a> {
    /// None if there is one integration of the whole.
    parts: &'r [SystemPart],
    options: &'r Options,
    integrations: Vec<Integration<'a>>,
    /// Number of events of each part that are among those of all.
    merged: Vec<usize>,
    events: Vec<Event>,
    /// Number of steps since the last sample.
    unseen: usize,
}

impl<'a> Run<'_, 'a> {
    /// The number in the whole of a contact of a part.
    fn number(&self, part: usize, contact: usize) -> usize {
        self.parts.get(part).map_or(contact, |part| part.contacts[contact])
    }

    /// Refuses contacts that overlap at the beginning.
    fn check_overlap(&mut self) -> Result<Result<(), EvaluationError>, ArgumentError> {
        let mut first: Option<(usize, f64)> = None;
        for part in 0..self.integrations.len() {
            let (contact, depth) = match self.integrations[part].overlap() {
                Ok(None) => continue,
                Ok(Some(found)) => found,
                Err(error) => return Ok(Err(error)),
            };
            let contact = self.number(part, contact);
            if first.is_none_or(|(earlier, _)| contact < earlier) {
                first = Some((contact, depth));
            }
        }
        first.map_or(Ok(Ok(())), |(contact, depth)| {
            let message =
                format!("must not let contacts overlap, contact {contact} does by {depth:.3e}");
            refuse("q0", message)
        })
    }

    fn integrate(&mut self) -> Outcome {
        let all: Vec<usize> = (0..self.integrations.len()).collect();
        let mut group = Vec::with_capacity(all.len());
        let mut outcome = self.go_on(&all, Integration::begin);
        loop {
            if let Some(outcome) = outcome {
                return outcome;
            }
            let mut earliest = f64::INFINITY;
            for integration in &mut self.integrations {
                if let Err(error) = integration.look_ahead() {
                    integration.next = Some(Next::Ended(Outcome::Error(error)));
                }
                if !integration.is_over() {
                    earliest = earliest.min(integration.time_of_next());
                }
            }
            let next = |part: &usize| {
                let integration = &self.integrations[*part];
                !integration.is_over() && integration.time_of_next() == earliest
            };
            group.clear();
            group.extend(all.iter().copied().filter(next));
            if group.is_empty() {
                group.clone_from(&all);
            }
            outcome = self.go_on(&group, Integration::go_on);
        }
    }

    /// Lets some parts do something at one time, and shows the others there.
    fn go_on(
        &mut self,
        group: &[usize],
        act: impl Fn(&mut Integration<'a>) -> Ending,
    ) -> Option<Outcome> {
        let samples = &self.integrations[0].motion.samples;
        let (kept, known, mut ended) = (samples.len(), self.events.len(), None);
        let (mut t, mut ends_before_event) = (f64::NEG_INFINITY, false);
        for &part in group {
            let integration = &mut self.integrations[part];
            match act(integration) {
                Ok(None) => {}
                Ok(Some(outcome)) => ended = ended.or(Some((part, outcome))),
                Err(error) => ended = ended.or(Some((part, Outcome::Error(error)))),
            }
            t = t.max(integration.state.t);
            ends_before_event |= integration.ending.is_some();
            ends_before_event |= integration.state.t == integration.end_of_piece();
            self.merge_events(part);
        }
        self.unseen += group.len();
        let has_event = ends_before_event || self.events.len() > known;
        let needed = has_event || self.unseen >= self.integrations.len();
        let shown = if self.parts.is_empty() { Ok(()) } else { self.show(group, t, kept, needed) };
        let ended = ended.map(|(part, outcome)| self.in_the_whole(part, outcome));
        let outcome =
            ended.or_else(|| self.has_too_many_events().then_some(Outcome::TooManyEvents));
        let is_error = matches!(outcome, Some(Outcome::Error(_)));
        let shown = match &outcome {
            None => shown,
            // The samples of the others until then, as far as they are known.
            Some(Outcome::Error(_)) => self.end_beside(group, t),
            Some(_) => shown.and_then(|()| self.end_at(group, t)),
        };
        match shown {
            Err(error) if !is_error => Some(Outcome::Error(error)),
            _ => outcome,
        }
    }

    /// Where all steps are kept, gives all parts as many samples as those have that have gone on. Between events there is one
    /// whenever the parts have made a step on average.
    fn show(
        &mut self,
        group: &[usize],
        t: f64,
        kept: usize,
        needed: bool,
    ) -> Result<(), EvaluationError> {
        if self.options.sample.is_some() {
            return Ok(());
        }
        self.unseen *= usize::from(!needed);
        let lengths = group.iter().map(|&part| self.integrations[part].motion.samples.len());
        let count = if needed { lengths.fold(kept, usize::max) } else { kept };
        for integration in &mut self.integrations {
            integration.motion.samples.truncate(count);
            for _ in integration.motion.samples.len()..count {
                integration.sample_beside(t)?;
            }
        }
        Ok(())
    }

    /// The samples of the other parts until the last one of a group.
    fn end_beside(&mut self, group: &[usize], t: f64) -> Result<(), EvaluationError> {
        let mut all = self.integrations.iter_mut().enumerate();
        all.try_for_each(|(part, integration)| match group.contains(&part) {
            true => Ok(()),
            false => integration.end_beside(t),
        })
    }

    /// The last sample of all parts, unless they have it.
    fn end_at(&mut self, group: &[usize], t: f64) -> Result<(), EvaluationError> {
        self.end_beside(group, t)?;
        for &part in group {
            let integration = &mut self.integrations[part];
            if integration.motion.samples.t.last() != Some(&t) {
                if !self.parts.is_empty() && integration.stale {
                    integration.evaluate_at_start()?;
                }
                integration.record();
            }
        }
        Ok(())
    }

    /// Takes the new events of a part among those of all. Several parts may meet the same kink.
    fn merge_events(&mut self, part: usize) {
        if self.parts.is_empty() {
            return;
        }
        let new = self.integrations[part].motion.events[self.merged[part]..].to_vec();
        self.merged[part] += new.len();
        for event in new {
            let kink = event.kind == EventKind::Kink;
            let mut others = self.events.iter().rev().take_while(|other| other.time == event.time);
            if !kink || others.all(|other| other.kind != EventKind::Kink) {
                let contact = event.contact.map(|contact| self.number(part, contact));
                self.events.push(Event { contact, ..event });
            }
        }
    }

    /// An outcome with the number of its contact in the whole.
    fn in_the_whole(&self, part: usize, outcome: Outcome) -> Outcome {
        match outcome {
            Outcome::NoSolution { contact, mut unsolvable } => {
                let contacts = unsolvable.iter_mut().flat_map(|proof| &mut proof.contacts);
                contacts.for_each(|contact| *contact = self.number(part, *contact));
                Outcome::NoSolution { contact: self.number(part, contact), unsolvable }
            }
            Outcome::Stagnated { cause, contact } => {
                let contact = contact.map(|contact| self.number(part, contact));
                Outcome::Stagnated { cause, contact }
            }
            outcome => outcome,
        }
    }

    fn has_too_many_events(&self) -> bool {
        let counted = |part: &Integration<'_>| part.motion.events.len() - part.uncounted;
        let events: usize = self.integrations.iter().map(counted).sum();
        !self.parts.is_empty() && events >= self.options.max_events
    }

    /// The motion of all parts, as long as all are known.
    fn motion(mut self, system: &dyn System) -> Motion {
        if self.parts.is_empty() {
            return self.integrations.pop().map(|whole| whole.motion).unwrap_or_default();
        }
        let dimensions: Vec<usize> =
            system.contacts().iter().map(|contact| contact.law().dimension()).collect();
        let mut all = Samples::new(system.coordinates(), system.dof(), &dimensions);
        let mut places = vec![(0, 0); dimensions.len()];
        for (part, SystemPart { contacts, .. }) in self.parts.iter().enumerate() {
            contacts.iter().enumerate().for_each(|(i, &number)| places[number] = (part, i));
        }
        let samples: Vec<&Samples> =
            self.integrations.iter().map(|part| &part.motion.samples).collect();
        let (mut q, mut u) = (vec![0.0; all.coordinates], vec![0.0; all.dof]);
        for (k, &t) in samples[0].t.iter().enumerate() {
            if samples.iter().any(|part| part.t.get(k) != Some(&t)) {
                break;
            }
            for &(part, i) in &places {
                all.push_contact(&samples[part].contact(k, i));
            }
            for (part, places) in samples.iter().zip(self.parts) {
                let state = part.state(k);
                places.coordinates.iter().zip(state.q).for_each(|(&to, &from)| q[to] = from);
                places.velocities.iter().zip(state.u).for_each(|(&to, &from)| u[to] = from);
            }
            all.push_state(t, &q, &u);
        }
        let (mut steps, mut rejected_steps) = (0, 0);
        for Integration { motion, .. } in &self.integrations {
            steps += motion.steps;
            rejected_steps += motion.rejected_steps;
        }
        Motion { samples: all, events: self.events, steps, rejected_steps }
    }
}
