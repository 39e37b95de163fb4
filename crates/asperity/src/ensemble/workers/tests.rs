//! Members of a batch: each is computed once, by any number of threads.

use super::*;

fn squares(count: usize, threads: usize) -> Vec<usize> {
    let mut found = vec![usize::MAX; count];
    share(
        count,
        threads,
        &Stop::default(),
        || |members: Range<usize>| members.map(|i| i * i).collect::<Vec<_>>(),
        |members, squares| found[members].copy_from_slice(&squares),
        &mut |_, _| ControlFlow::Continue(()),
    );
    found
}

#[test]
fn every_member_is_computed_once_whatever_the_threads() {
    for count in [0, 1, 2, 63, 64, 65, 5000] {
        let expected: Vec<usize> = (0..count).map(|i| i * i).collect();
        for threads in [1, 2, 7] {
            assert_eq!(squares(count, threads), expected);
        }
    }
}

#[test]
fn an_observer_that_breaks_leaves_out_what_nobody_has_begun() {
    let stop = Stop::default();
    let mut seen = 0;
    share(
        1000,
        2,
        &stop,
        || |_: Range<usize>| thread::sleep(Duration::from_millis(20)),
        |members, ()| seen += members.len(),
        &mut |_, _| ControlFlow::Break(()),
    );
    assert!(stop.is_asked());
    assert!(0 < seen && seen < 1000);
}
