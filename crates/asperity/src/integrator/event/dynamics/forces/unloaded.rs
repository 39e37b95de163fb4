//! Shares of closed contacts that carry no load, see [`load_bearing`](crate::integrator::event::contact_problem).

use crate::integrator::event::dynamics::Dynamics;
use crate::integrator::event::dynamics::buffers::Unloaded;
use crate::integrator::event::dynamics::contact_variables::ROWS;
use crate::integrator::event::resolution::PARTS;
use crate::solver::{DEPENDENT, LIGHT};

impl Dynamics<'_> {
    /// The shares `βᵀλ_N` of the contacts without load in the normal forces of those that carry load.
    pub(crate) fn find_unloaded_shares(&mut self) {
        self.contacts.iter_mut().for_each(|contact| contact.share = None);
        if !self.contacts.iter().any(|contact| contact.unloaded) {
            return;
        }
        let mut shares = std::mem::take(&mut self.unloaded);
        let Unloaded { mobility, loaded, multipliers, .. } = &mut shares;
        loaded.clear();
        loaded
            .extend((0..self.contacts.len()).filter(|&i| self.contacts[i].is_closed_unilateral()));
        mobility.factor(loaded.len(), |k, l| self.normal_mobility(loaded[k], loaded[l]));
        multipliers.clear();
        multipliers.extend(loaded.iter().map(|&i| self.contacts[i].normal_force));
        mobility.solve(multipliers);
        for i in 0..self.contacts.len() {
            if self.contacts[i].unloaded {
                self.contacts[i].share = self.unloaded_share(i, &mut shares);
            }
        }
        self.unloaded = shares;
    }

    /// The share of one contact; nothing where those that carry load do not keep it closed.
    fn unloaded_share(&self, i: usize, shares: &mut Unloaded) -> Option<f64> {
        let Unloaded { mobility, loaded, multipliers, dependence } = shares;
        dependence.clear();
        dependence.extend(loaded.iter().map(|&j| self.normal_mobility(i, j)));
        mobility.solve(dependence);
        let (mut share, mut left, mut largest) = (0.0, self.normal_mobility(i, i), 0.0_f64);
        for ((&j, multiplier), part) in loaded.iter().zip(&*multipliers).zip(&*dependence) {
            let entry = self.normal_mobility(i, j);
            share += entry * multiplier;
            left -= entry * part;
            if entry != 0.0 {
                largest = largest.max(self.contacts[j].normal_force);
            }
        }
        let own = self.normal_mobility(i, i);
        let rounding = PARTS * self.normal_rate_scale(i);
        let parts = self.rate(ROWS * i, &self.acceleration).abs() > rounding;
        let dependent = left <= DEPENDENT * own;
        (dependent && !parts).then(|| share - f64::max(LIGHT * largest, rounding / own))
    }
}
