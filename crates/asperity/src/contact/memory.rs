//! What a contact remembers from one solve to the next.

use super::ContactProblem;

/// What a contact does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(i8)]
pub enum Phase {
    /// Nothing is known yet.
    #[default]
    Unknown = -1,
    /// No contact force.
    Open = 0,
    /// The reservoir holds the force strictly or on its boundary, and the slip vanishes.
    Stick = 1,
    /// The force is on the boundary of the reservoir.
    Slip = 2,
}

impl Phase {
    /// The phase with this number.
    pub fn from_number(number: i8) -> Option<Self> {
        [Self::Unknown, Self::Open, Self::Stick, Self::Slip]
            .into_iter()
            .find(|&phase| phase as i8 == number)
    }
}

/// State of one contact that decides between several solutions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactState {
    /// Last phase.
    pub phase: Phase,
    /// Last slip velocity, unused components zero; only its direction counts.
    pub direction: [f64; 3],
    /// The two slip velocities before that, latest first: extrapolation gives Newton's method a better
    /// start.
    pub(crate) earlier: [[f64; 3]; 2],
    /// How many of them belong to the present slip.
    pub(crate) known: u8,
}

impl ContactState {
    /// A state without further history.
    pub fn new(phase: Phase, direction: [f64; 3]) -> Self {
        Self { phase, direction, ..Self::default() }
    }
}

/// Start percussions and contact states: a warm start, and the input of the selection rule.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Memory {
    /// Percussions, as the rows of the problem.
    pub percussion: Vec<f64>,
    /// One state per contact.
    pub states: Vec<ContactState>,
}

impl Memory {
    /// Nothing remembered for a problem of `rows` rows and `contacts` contacts.
    pub fn new(rows: usize, contacts: usize) -> Self {
        Self { percussion: vec![0.0; rows], states: vec![ContactState::default(); contacts] }
    }

    /// What is remembered of an earlier solution.
    pub fn from_solution(
        problem: &ContactProblem,
        percussion: &[f64],
        velocity: &[f64],
        phases: impl IntoIterator<Item = Phase>,
    ) -> Self {
        let states = problem.contacts.iter().zip(phases).map(|(rows, phase)| {
            let mut direction = [0.0; 3];
            if phase == Phase::Slip {
                for (i, row) in (rows.tangent()..rows.offset + rows.len()).enumerate() {
                    direction[i] = velocity[row] + problem.restitution[row];
                }
            }
            ContactState::new(phase, direction)
        });
        Self { percussion: percussion.to_vec(), states: states.collect() }
    }
}
