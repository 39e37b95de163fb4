//! Sets whose dimension is known at run time only.

use asperity::set::Star;

/// A set of any dimension.
#[derive(Debug, Clone)]
pub enum AnyStar {
    One(Star<1>),
    Two(Star<2>),
    Three(Star<3>),
}

impl AnyStar {
    pub fn dimension(&self) -> usize {
        match self {
            Self::One(_) => 1,
            Self::Two(_) => 2,
            Self::Three(_) => 3,
        }
    }
}

/// Does the same with the set inside, whatever its dimension.
macro_rules! each {
    ($any:expr, $set:ident => $call:expr) => {
        match $any {
            AnyStar::One($set) => $call,
            AnyStar::Two($set) => $call,
            AnyStar::Three($set) => $call,
        }
    };
}

/// Makes another set of the same dimension from the set inside.
macro_rules! map {
    ($any:expr, $set:ident => $make:expr) => {
        match $any {
            AnyStar::One($set) => AnyStar::One($make),
            AnyStar::Two($set) => AnyStar::Two($make),
            AnyStar::Three($set) => AnyStar::Three($make),
        }
    };
}

/// Does the same with two sets of one dimension; `$otherwise` if they have two.
macro_rules! both {
    ($first:expr, $second:expr, ($a:ident, $b:ident) => $call:expr, $otherwise:expr) => {
        match ($first, $second) {
            (AnyStar::One($a), AnyStar::One($b)) => $call,
            (AnyStar::Two($a), AnyStar::Two($b)) => $call,
            (AnyStar::Three($a), AnyStar::Three($b)) => $call,
            _ => $otherwise,
        }
    };
}

/// Builds the set of a dimension known at run time only.
macro_rules! build {
    ($dimension:expr, $argument:expr, $P:ident => $make:expr) => {
        match $dimension {
            1 => {
                const $P: usize = 1;
                AnyStar::One($make)
            }
            2 => {
                const $P: usize = 2;
                AnyStar::Two($make)
            }
            3 => {
                const $P: usize = 3;
                AnyStar::Three($make)
            }
            other => {
                let message = format!("must give a set of dimension 1, 2 or 3, gives {other}");
                return Err(dimension($argument, &message).into());
            }
        }
    };
}

/// Combines sets of the same dimension.
macro_rules! combined {
    ($sets:expr, $combine:expr) => {{
        let same = |p| $sets.iter().all(|set| set.dimension() == p);
        match $sets.first().map(|set| set.dimension()) {
            Some(1) if same(1) => {
                AnyStar::One($combine(&$crate::sets::any_star::inside!($sets, One))?)
            }
            Some(2) if same(2) => {
                AnyStar::Two($combine(&$crate::sets::any_star::inside!($sets, Two))?)
            }
            Some(3) if same(3) => {
                AnyStar::Three($combine(&$crate::sets::any_star::inside!($sets, Three))?)
            }
            Some(_) => return Err(dimension("sets", "must have one dimension").into()),
            None => return Err(parameter("sets", "must hold at least one set").into()),
        }
    }};
}

macro_rules! inside {
    ($sets:expr, $arm:ident) => {
        $sets
            .iter()
            .filter_map(|set| match &set.0 {
                AnyStar::$arm(set) => Some(set.clone()),
                _ => None,
            })
            .collect::<Vec<_>>()
    };
}

pub(crate) use both;
pub(crate) use build;
pub(crate) use combined;
pub(crate) use each;
pub(crate) use inside;
pub(crate) use map;
