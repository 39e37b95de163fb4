//! Fuzz targets: bytes become sets, laws, contact problems and systems, and what comes out is checked.
//!
//! Every target is a function of bytes that panics on a finding. `make fuzz` gives it to libFuzzer, which looks
//! for bytes that reach new code; `tests/replay.rs` gives it the committed corpus and bytes of a seeded
//! generator, on the ordinary toolchain.
//!
//! | target | made of the bytes | must hold |
//! |---|---|---|
//! | [`sets`] | trees of sets in one, two, three dimensions | finite or an error; polarity, Euler, projections |
//! | [`one_contact`] | a law and a block of any rank | laws hold if converged, a solution is not denied |
//! | [`many_contacts`] | any `G`, every solver, any start | the same |
//! | [`events`] | linear systems with contacts | ends; forces in their reservoirs, no overlap |
//! | [`steps`] | the same systems | finite; forces in their reservoirs |
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod decode;
pub mod events;
mod laws;
pub mod many_contacts;
pub mod one_contact;
pub mod sets;
pub mod steps;
mod systems;
mod truth;

/// A target: a name, which is that of its corpus, and its function.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [Target; 5] = [
    ("sets", sets::check),
    ("one_contact", one_contact::check),
    ("many_contacts", many_contacts::check),
    ("events", events::check),
    ("steps", steps::check),
];
