//! Products of the rows of a contact with the velocities of a block, unrolled for the numbers of velocities that bodies
//! have: these products are a good part of a step.

use crate::vectors::unrolled;

/// The entries of some rows that belong to one block.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    /// From the first entry of the block in the first row on.
    pub(super) entries: &'a [f64],
    /// From row to row.
    pub(super) width: usize,
}

impl Part<'_> {
    /// `sums ← sums + A x`, with as many rows as there are sums.
    #[inline(always)]
    pub(super) fn add_product(self, x: &[f64], sums: &mut [f64]) {
        match x.len() {
            1 => self.add_product_of::<1>(x, sums),
            2 => self.add_product_of::<2>(x, sums),
            3 => self.add_product_of::<3>(x, sums),
            6 => self.add_product_of::<6>(x, sums),
            n => {
                for (row, sum) in self.entries.chunks(self.width.max(1)).zip(sums) {
                    *sum += row[..n].iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
                }
            }
        }
    }

    #[inline(always)]
    fn add_product_of<const N: usize>(self, x: &[f64], sums: &mut [f64]) {
        let Ok(x) = <&[f64; N]>::try_from(x) else { return };
        if self.width == N {
            let rows = self.entries.as_chunks().0;
            return unrolled!(m = sums.len() => {
                let (sums, rows) = (&mut sums[..m], &rows[..m]);
                for k in 0..m {
                    sums[k] += dot(&rows[k], x);
                }
            });
        }
        let mut rest = self.entries;
        for sum in sums {
            let Some(row) = rest.first_chunk() else { return };
            *sum += dot(row, x);
            rest = rest.get(self.width..).unwrap_or_default();
        }
    }

    /// `x ← x + Aᵀ factors`, with as many rows as there are factors.
    #[inline(always)]
    pub(super) fn add_transposed(self, factors: &[f64], x: &mut [f64]) {
        match x.len() {
            1 => self.add_transposed_of::<1>(factors, x),
            2 => self.add_transposed_of::<2>(factors, x),
            3 => self.add_transposed_of::<3>(factors, x),
            6 => self.add_transposed_of::<6>(factors, x),
            _ => {
                for (row, factor) in self.entries.chunks(self.width.max(1)).zip(factors) {
                    x.iter_mut().zip(row).for_each(|(x, a)| *x += a * factor);
                }
            }
        }
    }

    #[inline(always)]
    fn add_transposed_of<const N: usize>(self, factors: &[f64], x: &mut [f64]) {
        let Ok(x) = <&mut [f64; N]>::try_from(x) else { return };
        // In registers: what is stored number by number, the processor cannot load in pairs at once.
        let mut sums = *x;
        let mut add =
            |row: &[f64; N], factor: &f64| (0..N).for_each(|i| sums[i] += row[i] * factor);
        if self.width == N {
            let rows = self.entries.as_chunks().0;
            unrolled!(m = factors.len() => {
                let (factors, rows) = (&factors[..m], &rows[..m]);
                for k in 0..m {
                    add(&rows[k], &factors[k]);
                }
            });
        } else {
            let mut rest = self.entries;
            for factor in factors {
                let Some(row) = rest.first_chunk() else { break };
                add(row, factor);
                rest = rest.get(self.width..).unwrap_or_default();
            }
        }
        *x = sums;
    }
}

#[inline(always)]
fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let part = |range: std::ops::Range<usize>| range.map(|i| a[i] * b[i]).sum::<f64>();
    // In two chains of additions, which the processor makes side by side.
    if N == 6 { part(0..3) + part(3..6) } else { part(0..N) }
}
