//! What is connected with what, by union and find.

/// Connected components of `0..n`; the first member of each stands for it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Components {
    towards_first: Vec<usize>,
}

impl Components {
    /// Nothing of `0..n` is connected.
    pub(crate) fn separate(&mut self, n: usize) {
        self.towards_first.clear();
        self.towards_first.extend(0..n);
    }

    /// Connects two members.
    pub(crate) fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.towards_first[a.max(b)] = a.min(b);
    }

    /// The first member of the component of `i`.
    pub(crate) fn first(&mut self, mut i: usize) -> usize {
        let next = &mut self.towards_first;
        while next[i] != i {
            next[i] = next[next[i]];
            i = next[i];
        }
        i
    }

    /// The component of every member, numbered from zero in the order of their first members.
    pub(crate) fn numbers(mut self) -> Vec<usize> {
        let (mut numbers, mut count) = (vec![0; self.towards_first.len()], 0);
        for i in 0..numbers.len() {
            let first = self.first(i);
            numbers[i] = if first == i { count } else { numbers[first] };
            count += usize::from(first == i);
        }
        numbers
    }
}
