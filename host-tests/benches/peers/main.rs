//! `cargo bench --bench peers`: this kernel's classical step beside that of two integration libraries, on this machine.
//!
//! Times are taken in turns and given as ratios only, because a machine's speed drifts. With `--count NAME STEPS` one
//! arithmetic runs once and prints its last state, for an instruction counter around it.

mod contestants;

use std::hint::black_box;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use contestants::CONTESTANTS;

/// Steps of one run.
const STEPS: u32 = 20_000;
/// Runs of each, in turns; the fastest counts.
const ROUNDS: usize = 15;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    match words.as_slice() {
        [] => compare(),
        [option, name, steps] if option == "--count" => return count(name, steps),
        _ => {
            eprintln!("peers [--count NAME STEPS]");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

fn count(name: &str, steps: &str) -> ExitCode {
    let contestant = CONTESTANTS.iter().find(|contestant| contestant.name == name);
    match (contestant, steps.parse()) {
        (Some(contestant), Ok(steps)) => {
            println!("{:?}", (contestant.run)(steps));
            ExitCode::SUCCESS
        }
        _ => {
            eprintln!("no such contestant or number: {name} {steps}");
            ExitCode::from(2)
        }
    }
}

fn compare() {
    let mut fastest = vec![Duration::MAX; CONTESTANTS.len()];
    for _ in 0..ROUNDS {
        for (contestant, fastest) in CONTESTANTS.iter().zip(&mut fastest) {
            let start = Instant::now();
            black_box((contestant.run)(black_box(STEPS)));
            *fastest = start.elapsed().min(*fastest);
        }
    }
    println!("time per step of classical RK4, relative to {}", CONTESTANTS[0].name);
    for (contestant, time) in CONTESTANTS.iter().zip(&fastest) {
        println!("{:44} {:6.2}", contestant.name, time.as_secs_f64() / fastest[0].as_secs_f64());
    }
}
