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

/// The members of every component, components in the order of their first members.
#[derive(Debug, Clone, Default)]
pub(crate) struct Members {
    starts: Vec<usize>,
    members: Vec<usize>,
}

impl Members {
    /// Number of components.
    #[inline]
    pub(crate) fn count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// The members of a component, ascending.
    #[inline]
    pub(crate) fn of(&self, component: usize) -> &[usize] {
        &self.members[self.starts[component]..self.starts[component + 1]]
    }
}

impl From<Components> for Members {
    fn from(components: Components) -> Self {
        let numbers = components.numbers();
        let count = numbers.iter().map(|number| number + 1).max().unwrap_or(0);
        let mut starts = vec![0; count + 1];
        for &number in &numbers {
            starts[number + 1] += 1;
        }
        for component in 0..count {
            starts[component + 1] += starts[component];
        }
        let (mut next, mut members) = (starts.clone(), vec![0; numbers.len()]);
        for (member, &number) in numbers.iter().enumerate() {
            members[next[number]] = member;
            next[number] += 1;
        }
        Self { starts, members }
    }
}
