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
        let mut numbers = Vec::new();
        self.number(&mut numbers);
        numbers
    }

    /// The members of every component, and which of the contacts that touch these members belong to it; nothing if all is one
    /// component.
    pub(crate) fn split(
        self,
        touched: impl Iterator<Item = usize>,
    ) -> Vec<(Vec<usize>, Vec<usize>)> {
        let of = self.numbers();
        let count = of.iter().max().map_or(0, |last| last + 1);
        if count < 2 {
            return Vec::new();
        }
        let mut parts = vec![(Vec::new(), Vec::new()); count];
        of.iter().enumerate().for_each(|(member, &part)| parts[part].0.push(member));
        touched.enumerate().for_each(|(contact, member)| parts[of[member]].1.push(contact));
        parts
    }

    /// The same as [`numbers`](Self::numbers) in a buffer; the number of components.
    fn number(&mut self, numbers: &mut Vec<usize>) -> usize {
        numbers.clear();
        let mut count = 0;
        for i in 0..self.towards_first.len() {
            let first = self.first(i);
            numbers.push(if first == i { count } else { numbers[first] });
            count += usize::from(first == i);
        }
        count
    }
}

/// The members of every component, components in the order of their first members.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Members {
    /// Where the members of every component begin, and where the last ones end.
    starts: Vec<usize>,
    members: Vec<usize>,
    /// The component of every member.
    numbers: Vec<usize>,
}

impl Members {
    /// Takes the members of other components, in the buffers that are there.
    pub(crate) fn update(&mut self, components: &mut Components) {
        let count = components.number(&mut self.numbers);
        let Self { starts, members, numbers } = self;
        starts.clear();
        starts.resize(count + 1, 0);
        for &number in &*numbers {
            starts[number + 1] += 1;
        }
        for component in 0..count {
            starts[component + 1] += starts[component];
        }
        members.clear();
        members.resize(numbers.len(), 0);
        for (member, &number) in numbers.iter().enumerate() {
            members[starts[number]] = member;
            starts[number] += 1;
        }
        // Every start has moved on to where the next component begins.
        starts.rotate_right(1);
        starts[0] = 0;
    }

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
