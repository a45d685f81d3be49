//! The corpus, and a little of the search: `cargo fuzz-all` does more of it.

use host_tests::commands::fuzz::{Flips, Search, TARGETS, ThrottledCounter};

/// Executions of each target: some seconds of a slow machine.
const EXECUTIONS: u32 = 10_000;
/// Outcomes that each target's corpus holds at least: a search that reached fewer would try little.
const LEAST_OUTCOMES: [(&str, usize); 8] = [
    ("decoder", 40),
    ("commands", 30),
    ("parameters", 40),
    ("steppers", 200),
    ("plans", 60),
    ("requests", 120),
    ("numbers", 6),
    ("options", 12),
];

#[test]
fn the_corpus_keeps_every_promise() {
    for target in TARGETS {
        let corpus = target.corpus().unwrap_or_else(|error| panic!("{error}"));
        assert!(!corpus.is_empty(), "{}", target.name);
        for (_, input) in corpus {
            (target.run)(&input);
        }
    }
}

#[test]
fn random_input_breaks_no_promise() {
    for (target, (name, least)) in TARGETS.into_iter().zip(LEAST_OUTCOMES) {
        assert_eq!(target.name, name);
        let mut search = Search::new(target).unwrap_or_else(|error| panic!("{error}"));
        for _ in 0..EXECUTIONS {
            search.step().unwrap_or_else(|found| panic!("{name}: {:02x?}", found.input));
        }
        assert!(search.outcomes() >= least, "{name}: only {} outcomes", search.outcomes());
    }
}

#[test]
fn no_damaged_frame_is_taken_for_good_and_no_good_one_is_missed() {
    // At the harsher chance almost every frame is damaged, and there are more forgeries to catch.
    for (chance, frames) in [(1e-4, 50_000), (1e-2, 50_000)] {
        let mut link = Flips::new(2, chance);
        (0..frames).for_each(|_| link.send());
        let ThrottledCounter { sent, damaged, received, forged, missed, lost } = link.tally();
        assert!(damaged > frames / 50, "the link is under fire: {damaged} of {sent}");
        assert_eq!((forged, missed, lost, received), (0, 0, damaged, sent - damaged), "at {chance}");
    }
}
