//! The system in a mode: rows, gaps, relative velocities and responses of its contacts.

use std::ops::Range;

use crate::contact::Phase;
use crate::integrator::event::dynamics::buffers::{
    Constraints, Projection, SmoothJacobian, Stencil, TimeParts, Unloaded,
};
use crate::integrator::event::dynamics::chart::Chart;
use crate::integrator::event::dynamics::contact_variables::{ContactVariables, ROWS};
use crate::integrator::event::dynamics::forces::sharing::Sharing;
use crate::integrator::event::state::EvaluationError;
use crate::law::Law;
use crate::system::friction_map::scale_rows;
use crate::system::mass::MassFactors;
use crate::system::{System, SystemError};
use crate::vectors::{dot, largest, norm};

/// The equations of motion in the present mode, and what they gave where they were evaluated last.
#[derive(Debug)]
pub(crate) struct Dynamics<'a> {
    pub(crate) system: &'a dyn System,
    /// The associated laws of contacts that have others, if they have been asked for.
    laws_of_stick: Vec<Option<Option<Law>>>,
    /// The coordinates of the integration, through which alone the system is evaluated.
    pub(crate) chart: Chart<'a>,
    /// Number of degrees of freedom.
    pub(crate) n: usize,
    pub(crate) contacts: Vec<ContactVariables>,
    pub(crate) acceleration: Vec<f64>,
    /// The largest component of the accelerations that the forces would give one by one. The acceleration may be their
    /// difference, as small as rounding makes it, and is compared with this.
    pub(crate) load: f64,
    /// The parts of functions of time.
    pub(crate) time_parts: TimeParts,
    /// Beginning and end of the smooth piece of functions of time in which the motion is.
    pub(crate) piece: Range<f64>,
    /// How far rounding may move a contact in the present step while the forces there balance.
    pub(crate) creep: f64,
    /// The last time of evaluation: forces may jump at the end of the motion, to which their limit from the left belongs.
    pub(crate) latest: f64,
    /// Contacts whose force is given by a point of *D* instead of the sliding direction, and these points.
    pub(crate) direction_points: Vec<(usize, [f64; 3])>,
    /// `W_Nᵀ` and `Wᵀ`, [`ROWS`] per contact.
    pub(crate) rows: Vec<f64>,
    /// The velocities from the first to the last block that a contact touches, among which its rows and responses lie.
    pub(crate) spans: Vec<Range<usize>>,
    /// χ, as many entries as there are rows.
    pub(crate) chi: Vec<f64>,
    /// `ẇ_Nᵀu` and `Ẇᵀu + χ̇`, likewise.
    pub(crate) drift: Vec<f64>,
    /// `M⁻¹` times the rows.
    pub(crate) response: Vec<f64>,
    pub(crate) factor: Option<MassFactors>,
    /// Whether rows and mass never change.
    pub(crate) constant: bool,
    /// Whether rows have been evaluated.
    ready: bool,
    pub(crate) stencil: Stencil,
    pub(crate) constraints: Constraints,
    pub(crate) sharing: Sharing,
    pub(crate) unloaded: Unloaded,
    /// Whether contacts that are undecided share normal forces with those that are not.
    pub(crate) undecided_share: bool,
    pub(crate) smooth: SmoothJacobian,
    pub(crate) projection: Projection,
    pub(crate) scratch_rows: Vec<f64>,
    pub(crate) scratch: Vec<f64>,
}

impl<'a> Dynamics<'a> {
    /// The system between two times, all contacts open.
    pub(crate) fn new(system: &'a dyn System, chart: Chart<'a>, times: Range<f64>) -> Self {
        let (n, rows) = (system.dof(), ROWS * system.contacts().len());
        let constant = chart.is_constant();
        let span = |contact: usize| {
            let (blocks, touched) = (system.blocks(), system.touched(contact));
            let ends = touched.first().zip(touched.last());
            ends.map_or(0..n, |(&a, &b)| blocks.range(a).start..blocks.range(b).end)
        };
        Self {
            system,
            laws_of_stick: vec![None; system.contacts().len()],
            chart,
            n,
            contacts: system.contacts().iter().map(ContactVariables::new).collect(),
            acceleration: vec![0.0; n],
            load: 0.0,
            time_parts: TimeParts::default(),
            latest: times.end.next_down(),
            piece: times,
            creep: 0.0,
            direction_points: Vec::new(),
            rows: vec![0.0; rows * n],
            spans: (0..system.contacts().len()).map(span).collect(),
            chi: vec![0.0; rows],
            drift: vec![0.0; rows],
            response: vec![0.0; rows * n],
            factor: None,
            constant,
            ready: false,
            stencil: Stencil::new(rows),
            constraints: Constraints::default(),
            sharing: Sharing::default(),
            unloaded: Unloaded::default(),
            undecided_share: false,
            smooth: SmoothJacobian::new(n, rows),
            projection: Projection::default(),
            scratch_rows: vec![0.0; ROWS * n],
            scratch: vec![0.0; n],
        }
    }

    /// Contacts that stick are undecided, and those without load that would stick with it.
    pub(crate) fn leave_stick_undecided(&mut self) {
        for contact in &mut self.contacts {
            let would_stick = contact.unloaded && contact.is_still();
            contact.undecided = contact.mode == Phase::Stick || would_stick;
        }
    }

    pub(crate) fn law(&self, i: usize) -> &'a Law {
        self.system.contacts()[i].law()
    }

    /// The law that tells whether a contact can stick on.
    pub(crate) fn law_of_stick(&mut self, i: usize) -> &Law {
        let law = self.law(i);
        let associated = self.laws_of_stick[i].get_or_insert_with(|| law.associated());
        associated.as_ref().unwrap_or(law)
    }

    pub(crate) fn row(&self, row: usize) -> &[f64] {
        &self.rows[row * self.n..(row + 1) * self.n]
    }

    /// `M⁻¹` times a row.
    pub(crate) fn response(&self, row: usize) -> &[f64] {
        &self.response[row * self.n..(row + 1) * self.n]
    }

    /// A row times a vector.
    pub(crate) fn along(&self, row: usize, vector: &[f64]) -> f64 {
        let span = self.spans[row / ROWS].clone();
        dot(&self.row(row)[span.clone()], &vector[span])
    }

    /// A row times the response, or another combination of them, of the contact of another row.
    pub(crate) fn mobility(&self, row: usize, of: usize, response: &[f64]) -> f64 {
        let (own, other) = (&self.spans[row / ROWS], &self.spans[of / ROWS]);
        let span = own.start.max(other.start)..own.end.min(other.end);
        if span.is_empty() { 0.0 } else { dot(&self.row(row)[span.clone()], &response[span]) }
    }

    /// `w_NᵀM⁻¹w_N` of two contacts.
    pub(crate) fn normal_mobility(&self, i: usize, j: usize) -> f64 {
        self.mobility(ROWS * i, ROWS * j, self.response(ROWS * j))
    }

    /// `γ_N` or a component of γ at these velocities.
    pub(crate) fn velocity(&self, row: usize, u: &[f64]) -> f64 {
        self.along(row, u) + self.chi[row]
    }

    /// `γ̈_N` or a component of `γ̇` with these accelerations.
    pub(crate) fn rate(&self, row: usize, acceleration: &[f64]) -> f64 {
        self.along(row, acceleration) + self.drift[row]
    }

    /// The least slip over the entries of its rows, of the slipping contacts at the evaluated state that have some slip.
    pub(crate) fn slowest_slip(&self) -> f64 {
        let size = |i: usize| {
            let rows = ROWS * i + 1..=ROWS * i + self.contacts[i].p;
            norm(&self.contacts[i].slip)
                / rows.map(|row| largest(self.row(row))).fold(0.0, f64::max)
        };
        let slips = (0..self.contacts.len()).filter(|&i| self.contacts[i].mode == Phase::Slip);
        slips.map(size).filter(|size| *size > 0.0).fold(f64::INFINITY, f64::min)
    }

    /// Rows of a contact along which it can have forces of its own.
    pub(crate) fn rows_of(&self, i: usize) -> Range<usize> {
        let contact = &self.contacts[i];
        let first = ROWS * i + usize::from(contact.prescribed.is_some());
        first..ROWS * i + 1 + contact.p
    }

    /// Rows, gaps and relative velocities of all contacts.
    pub(crate) fn kinematics(
        &mut self,
        t: f64,
        q: &[f64],
        u: &[f64],
    ) -> Result<(), EvaluationError> {
        let (n, fresh) = (self.n, !self.constant || !self.ready);
        self.chart.place(q);
        for (i, contact) in self.contacts.iter_mut().enumerate() {
            let own = &mut self.rows[ROWS * i * n..ROWS * (i + 1) * n];
            if fresh {
                let first = usize::from(contact.prescribed.is_some());
                let chi = &mut self.chi[ROWS * i + first..ROWS * i + 1 + contact.p];
                contact.gap =
                    self.chart.rows(t, i, &mut own[first * n..(1 + contact.p) * n], chi)?;
                if let Some((map, place)) = self.chart.friction_place(t, i) {
                    if contact.is_free() || contact.region.is_none() {
                        contact.region = Some(map.region(place));
                    }
                    let region = contact.region.unwrap_or_default();
                    (contact.place, contact.outside) = (place, map.outside(region, place));
                    contact.by_place = map.factor(region, place);
                    let (law, rows) = (&self.system.contacts()[i], &mut own[first * n..]);
                    scale_rows(contact.by_place, law, n, rows, chi);
                }
            } else if contact.prescribed.is_none() {
                contact.gap = self.chart.gap(t, i)?;
            }
        }
        if fresh {
            self.response.copy_from_slice(&self.rows);
            self.chart.pull_back(&mut self.rows);
        }
        for (i, contact) in self.contacts.iter_mut().enumerate() {
            let rows = self.rows[(ROWS * i + 1) * n..].chunks_exact(n);
            let chi = &self.chi[ROWS * i + 1..ROWS * i + 1 + contact.p];
            let span = self.spans[i].clone();
            let (u, mut size) = (&u[span.clone()], 0.0);
            for ((slip, chi), row) in contact.slip.iter_mut().zip(chi).zip(rows) {
                let row = &row[span.clone()];
                *slip = *chi + dot(row, u);
                let parts: f64 = row.iter().zip(u).map(|(w, u)| (w * u).abs()).sum();
                size += (chi.abs() + parts) * (chi.abs() + parts);
            }
            contact.size = size.sqrt();
        }
        if !fresh {
            return Ok(());
        }
        if self.factor.is_none() || !self.system.constancy().mass {
            let mut factors = self.factor.take().unwrap_or_default();
            self.chart.factor_mass(t, &mut factors)?;
            self.factor = Some(factors);
        }
        if let Some(factor) = &self.factor {
            let blocks = self.system.blocks();
            for (i, rows) in self.response.chunks_exact_mut(ROWS * n).enumerate() {
                for row in rows.chunks_exact_mut(n) {
                    for &block in self.system.touched(i) {
                        factor.solve_block(self.system, block, &mut row[blocks.range(block)]);
                    }
                }
            }
        }
        self.chart.pull_responses(&mut self.response);
        self.ready = true;
        (0..self.contacts.len())
            .filter(|&i| !self.contacts[i].is_free())
            .try_for_each(|i| self.check_rows(i))
    }

    /// Refuses directions of a contact that move nothing.
    pub(crate) fn check_rows(&self, i: usize) -> Result<(), EvaluationError> {
        let mobility = |row: usize| self.along(row, self.response(row));
        // The comparison also turns away NaN.
        if self.rows_of(i).any(|row| !(mobility(row) > 0.0)) {
            return Err(SystemError::direction(i).into());
        }
        Ok(())
    }

    /// The accelerations of the system without contacts, into `out`, at the coordinates whose kinematics have been evaluated.
    pub(crate) fn free_acceleration(
        &mut self,
        t: f64,
        u: &[f64],
        out: &mut [f64],
    ) -> Result<(), EvaluationError> {
        self.chart.forces(t, u, out)?;
        if let Some(factor) = &self.factor {
            factor.solve(self.system, out);
        }
        self.chart.pull_acceleration(out);
        Ok(())
    }

    /// Friction of a contact that slips, for unit normal force, whether or not it carries load.
    pub(crate) fn sliding(&self, i: usize) -> [f64; 3] {
        let contact = &self.contacts[i];
        match contact.mode {
            Phase::Slip => contact.sliding,
            _ => self.law(i).sliding(&contact.slip).unwrap_or_default(),
        }
    }

    /// `w_NᵀM⁻¹(w_N + W f)` over `w_NᵀM⁻¹w_N` of a slipping unilateral contact.
    pub(crate) fn resistance(&self, i: usize) -> f64 {
        let contact = &self.contacts[i];
        let normal = self.row(ROWS * i);
        let friction = (0..contact.p)
            .map(|r| contact.sliding[r] * dot(normal, self.response(ROWS * i + 1 + r)));
        match contact.prescribed {
            Some(_) => 1.0,
            None => 1.0 + friction.sum::<f64>() / dot(normal, self.response(ROWS * i)),
        }
    }
}
