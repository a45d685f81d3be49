//! The history of a curve, against the standard library's queue.

use std::collections::VecDeque;

use fastrand::Rng;
use firmware::graphics::history::History;

fn follows_a_queue<const N: usize>() {
    let mut rng = Rng::with_seed(7);
    let mut history = History::<u32, N>::new(u32::MAX);
    let mut queue = VecDeque::new();
    for _ in 0..3 * N + 2 {
        assert!(history.oldest_first().eq(&queue), "{history:?}");
        assert_eq!((history.len(), history.is_empty()), (queue.len(), queue.is_empty()));
        let value = rng.u32(..1000);
        history.write(value);
        queue.push_back(value);
        if queue.len() > N {
            queue.pop_front();
        }
    }
}

#[test]
fn the_last_values_are_kept_in_order() {
    follows_a_queue::<0>();
    follows_a_queue::<1>();
    follows_a_queue::<2>();
    follows_a_queue::<60>();
}
