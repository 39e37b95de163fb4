//! Event functions: functions of the state whose zeros are events, and where these zeros are.

pub(crate) mod between_stages;
pub(crate) mod root;

pub(crate) use between_stages::NODES;

use crate::contact::Phase;
use crate::integrator::event::dynamics::Dynamics;
use crate::integrator::event::resolution::SOLVED;

/// A function that is not positive while a contact stays in its mode. It becomes positive where a gap closes, a
/// sticking force leaves the reservoir, the normal force of a slipping contact vanishes, or a closed contact without load
/// would carry some.
pub(crate) fn contact_event_function(dynamics: &Dynamics<'_>, i: usize) -> f64 {
    let contact = &dynamics.contacts[i];
    match (contact.mode, contact.prescribed) {
        (Phase::Open, None) => {
            contact.share.unwrap_or_else(|| -contact.gap - dynamics.rounded_overlap(i))
        }
        (Phase::Stick | Phase::Slip, _) if contact.redistributed => -1.0,
        (Phase::Stick, _) => excess(dynamics, i),
        (Phase::Slip, None) => -contact.normal_force,
        _ => -1.0,
    }
}

/// A function that becomes positive where a contact leaves its region of a map of friction.
pub(crate) fn border_function(dynamics: &Dynamics<'_>, i: usize) -> f64 {
    let contact = &dynamics.contacts[i];
    if contact.is_free() { -1.0 } else { contact.outside }
}

/// How far the friction force of a sticking contact lies outside the reservoir.
pub(crate) fn excess(dynamics: &Dynamics<'_>, i: usize) -> f64 {
    let contact = &dynamics.contacts[i];
    dynamics.law(i).gauge(&contact.force.map(|f| -f))
        - contact.normal_force
        - contact.tolerated_excess
}

/// The excess of a sticking force over the reservoir that may be rounding.
pub(crate) fn rounded_excess(dynamics: &Dynamics<'_>) -> f64 {
    let pressing = dynamics.contacts.iter().map(|contact| contact.normal_force);
    SOLVED * pressing.fold(f64::MIN_POSITIVE, f64::max)
}
