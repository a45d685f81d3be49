//! The standards of comparison for tests: exact motions, known answers and tolerances.

pub mod hard_cases;
pub mod known_answers;
#[path = "../../../kernel/src/tests/random.rs"]
pub mod random;
pub mod snapshot;
pub mod textbook;
pub mod tolerances;
pub mod trials;
