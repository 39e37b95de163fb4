//! What a contact remembers from one solve to the next.

use super::ContactProblem;

use crate::argument::{ArgumentError, length};
use crate::vectors::{copy, dot};

/// What a contact does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
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
    pub slip: [f64; 3],
    /// The two slip velocities before that, latest first.
    earlier: [[f64; 3]; 2],
    /// How many of them belong to the present slip.
    known: u8,
}

impl ContactState {
    /// Nothing is known.
    pub(crate) const UNKNOWN: Self =
        Self { phase: Phase::Unknown, slip: [0.0; 3], earlier: [[0.0; 3]; 2], known: 0 };

    /// A state without further history.
    pub fn new(phase: Phase, slip: [f64; 3]) -> Self {
        Self { phase, slip, ..Self::default() }
    }

    /// A state with its history: the last three slip velocities, latest first, and how many of the earlier two
    /// belong to the present slip.
    pub fn with_history(phase: Phase, [slip, one, two]: [[f64; 3]; 3], known: u8) -> Self {
        Self { phase, slip, earlier: [one, two], known: known.min(2) }
    }

    /// The last three slip velocities, latest first, and how many of the earlier two belong to the present slip.
    pub fn history(&self) -> ([[f64; 3]; 3], u8) {
        ([self.slip, self.earlier[0], self.earlier[1]], self.known)
    }

    /// Becomes the state after a further step from `before`.
    #[inline]
    pub(crate) fn follow(&mut self, before: &Self, phase: Phase, slip: [f64; 3]) {
        self.phase = phase;
        if phase == Phase::Slip {
            let continues = before.phase == Phase::Slip;
            self.known = if continues { (before.known + 1).min(2) } else { 0 };
            self.slip = slip;
            self.earlier[0] = before.slip;
            self.earlier[1] = before.earlier[0];
        } else {
            (self.slip, self.earlier, self.known) = (before.slip, Default::default(), 0);
        }
    }

    /// The state after a further step.
    #[inline]
    pub(crate) fn after(&self, phase: Phase, slip: [f64; 3]) -> Self {
        let mut state = Self::default();
        state.follow(self, phase, slip);
        state
    }

    /// The slip velocity extrapolated by a step, a good start for Newton's method.
    #[inline]
    pub(crate) fn ahead(&self) -> [f64; 3] {
        let (last, [one, two]) = (&self.slip, &self.earlier);
        let ahead: [f64; 3] = match self.known {
            0 => return self.slip,
            1 => std::array::from_fn(|i| 2.0 * last[i] - one[i]),
            _ => std::array::from_fn(|i| 3.0 * (last[i] - one[i]) + two[i]),
        };
        // Where the slip ceases, extrapolation would turn it round.
        if dot(&ahead, last) > 0.5 * dot(last, last) { ahead } else { self.slip }
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

    /// Whether there is a percussion per row of a problem and a state per contact.
    #[inline]
    pub(crate) fn fits(&self, problem: &ContactProblem) -> bool {
        self.percussion.len() == problem.rows() && self.states.len() == problem.contacts().len()
    }

    /// Takes over the percussions that another one remembers; states are those of nothing in particular.
    #[inline(always)]
    pub(crate) fn start_from(&mut self, other: &Self) {
        if self.percussion.len() == other.percussion.len() {
            copy(&other.percussion, &mut self.percussion);
        } else {
            self.percussion.clone_from(&other.percussion);
        }
        if self.states.len() != other.states.len() {
            self.states.resize(other.states.len(), ContactState::default());
        }
    }

    /// Nothing remembered for a problem without contacts, with the buffers that are there.
    pub(crate) fn clear(&mut self) {
        self.percussion.clear();
        self.states.clear();
    }

    /// Takes over what another one remembers, in the buffers that are there.
    #[inline]
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.percussion.clone_from(&other.percussion);
        self.states.clone_from(&other.states);
    }

    /// What is remembered of an earlier solution.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if there are not as many percussions and velocities as rows and phases as contacts.
    pub fn from_solution(
        problem: &ContactProblem,
        percussion: &[f64],
        velocity: &[f64],
        phases: impl IntoIterator<Item = Phase>,
    ) -> Result<Self, ArgumentError> {
        problem.check_rows("percussion", percussion)?;
        problem.check_rows("velocity", velocity)?;
        let phases: Vec<Phase> = phases.into_iter().collect();
        length("phases", problem.contacts().len(), phases.len())?;
        let states = problem.contacts().iter().zip(phases).map(|(rows, phase)| {
            let mut slip = [0.0; 3];
            if phase == Phase::Slip {
                for (i, row) in rows.tangential_rows().enumerate() {
                    slip[i] = velocity[row] + problem.restitution()[row];
                }
            }
            ContactState::new(phase, slip)
        });
        Ok(Self { percussion: percussion.to_vec(), states: states.collect() })
    }
}
