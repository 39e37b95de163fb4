//! What is asked of one contact, and a solution of it.

use asperity_set::Vector;

use crate::contact::Phase;

/// What is asked of the solution of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Policy {
    /// The one that the selection rule takes, and whether there are others.
    Prove,
    /// The first one that is found, as near to the selection rule as stick and Newton's method from the last slip
    /// come: for iterations that visit the contact again.
    FirstFound,
}

/// A solution of one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LocalSolution<const P: usize> {
    /// What the contact does.
    pub phase: Phase,
    /// Normal percussion.
    pub normal: f64,
    /// Tangential percussion.
    pub tangent: Vector<P>,
    /// Tangential velocity `ξ`.
    pub slip: Vector<P>,
    /// Not isolated, or a double root: perturbing the data may remove or split it.
    pub degenerate: bool,
    /// Whether the contact is known to have others.
    pub ambiguous: bool,
}

impl LocalSolution<0> {
    /// The solution `0 ≤ P_N ⊥ g_NN P_N + b_N ≥ 0` of a contact without friction.
    pub(crate) fn on_the_normal(b_n: f64, g_nn: f64) -> Self {
        let (phase, normal) =
            if b_n >= 0.0 { (Phase::Open, 0.0) } else { (Phase::Stick, -b_n / g_nn) };
        Self::new(phase, normal, Vector::zeros(), Vector::zeros())
    }
}

impl<const P: usize> LocalSolution<P> {
    /// A solution that is isolated, beside which no other is known.
    #[inline(always)]
    pub(crate) fn new(phase: Phase, normal: f64, tangent: Vector<P>, slip: Vector<P>) -> Self {
        Self { phase, normal, tangent, slip, degenerate: false, ambiguous: false }
    }

    /// Writes the percussions to the contact's own rows, of which the first may be a normal one.
    #[inline(always)]
    pub(crate) fn store(&self, percussion: &mut [f64]) {
        // At once: the next contact reads the first two of them together, and would wait for one that is written alone.
        if P == 2
            && let Ok(all) = <&mut [f64; 3]>::try_from(&mut *percussion)
        {
            *all = [self.normal, self.tangent[0], self.tangent[1]];
            return;
        }
        let first = percussion.len() - P;
        if first == 1 {
            percussion[0] = self.normal;
        }
        percussion[first..].copy_from_slice(self.tangent.as_slice());
    }
}
