//! The search: inputs varied at random, kept if they come to something new.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use std::{io, process, thread};

use fastrand::Rng;

use super::{Outcome, Target};
use crate::console::cli::complain;

/// The longest input, bytes: some of every message's length and more than any number has digits.
const LONGEST: usize = 256;
/// Guards against hanging only: many times what any execution takes.
const HANG: Duration = Duration::from_secs(120);
/// Numbers at which formulas change or break.
const EDGES: [f64; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    1e-3,
    1e3,
    1e-300,
    1e300,
    f64::MIN_POSITIVE,
    5e-324,
    f64::MAX,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
    f64::EPSILON,
];

/// A broken promise.
#[derive(Clone, Debug)]
pub struct Found {
    /// What breaks it.
    pub input: Vec<u8>,
}

/// A search under way.
pub struct Search {
    target: Target,
    rng: Rng,
    /// An input for each outcome, the shortest known.
    corpus: BTreeMap<Outcome, Vec<u8>>,
    seeds: Vec<Vec<u8>>,
    watch: Watch,
}

impl Search {
    /// Begins with the target's seeds and its corpus.
    pub fn new(target: Target) -> io::Result<Self> {
        let mut seeds = (target.seeds)();
        seeds.extend(target.corpus()?.into_iter().map(|(_, input)| input));
        let mut search =
            Self { target, rng: Rng::with_seed(1), corpus: BTreeMap::new(), seeds, watch: Watch::start(target.name) };
        for input in search.seeds.clone() {
            // A seed that breaks a promise is found by the test that runs the corpus.
            if let Ok(outcome) = search.execute(&input) {
                search.corpus.insert(outcome, input);
            }
        }
        Ok(search)
    }

    /// One execution.
    pub fn step(&mut self) -> Result<(), Found> {
        let input = self.vary();
        let outcome = self.execute(&input)?;
        let known = self.corpus.get(&outcome);
        if known.is_none_or(|known| input.len() < known.len()) {
            self.corpus.insert(outcome, input);
        }
        Ok(())
    }

    /// How many different things inputs have come to.
    pub fn outcomes(&self) -> usize {
        self.corpus.len()
    }

    /// Makes this the target's corpus.
    pub fn keep(&self) -> io::Result<()> {
        self.target.keep(&self.corpus)
    }

    fn execute(&self, input: &[u8]) -> Result<Outcome, Found> {
        self.watch.begin(input);
        let run = AssertUnwindSafe(|| (self.target.run)(input));
        catch_unwind(run).map_err(|_| Found { input: input.to_vec() })
    }

    fn any(&mut self) -> Vec<u8> {
        let count = self.corpus.len() + self.seeds.len();
        match self.rng.usize(0..count + 1).checked_sub(1) {
            Some(at) if at < self.seeds.len() => self.seeds[at].clone(),
            Some(at) => self.corpus.values().nth(at - self.seeds.len()).cloned().unwrap_or_default(),
            None => {
                let length = self.rng.usize(..LONGEST);
                std::iter::repeat_with(|| self.rng.u8(..)).take(length).collect()
            }
        }
    }

    fn vary(&mut self) -> Vec<u8> {
        let mut input = self.any();
        for _ in 0..self.rng.u8(1..=4) {
            let at = self.rng.usize(0..=input.len());
            match self.rng.u8(0..8) {
                0 => flip(&mut input, at, self.rng.u8(0..8)),
                1 => replace(&mut input, at, &[self.rng.u8(..)]),
                2 => input.insert(at, self.rng.u8(..)),
                3 => input.truncate(at),
                4 => {
                    let edge = EDGES[self.rng.usize(..EDGES.len())];
                    // Numbers lie one after the other, from the beginning or up to the end.
                    let first = if self.rng.bool() { 0 } else { input.len() % 8 };
                    replace(&mut input, at / 8 * 8 + first, &edge.to_le_bytes());
                }
                5 => {
                    let length = self.rng.usize(1..=8);
                    let bytes: Vec<_> = std::iter::repeat_with(|| self.rng.u8(..)).take(length).collect();
                    replace(&mut input, at, &bytes);
                }
                6 => {
                    let other = self.any();
                    input.truncate(at);
                    input.extend(other.into_iter().skip(at));
                }
                _ => {
                    let end = self.rng.usize(at..=input.len());
                    input.drain(at..end);
                }
            }
        }
        input.truncate(LONGEST);
        input
    }
}

fn flip(input: &mut [u8], at: usize, bit: u8) {
    if let Some(byte) = input.get_mut(at) {
        *byte ^= 1 << bit;
    }
}

fn replace(input: &mut [u8], at: usize, bytes: &[u8]) {
    for (place, byte) in input.iter_mut().skip(at).zip(bytes) {
        *place = *byte;
    }
}

/// Ends the program if one execution takes longer than [`HANG`], and says with what.
struct Watch {
    input: Arc<Mutex<Vec<u8>>>,
    executions: Arc<AtomicU64>,
    over: Arc<AtomicBool>,
}

impl Watch {
    fn start(name: &'static str) -> Self {
        let watch = Self { input: Arc::default(), executions: Arc::default(), over: Arc::default() };
        let (input, executions, over) =
            (Arc::clone(&watch.input), Arc::clone(&watch.executions), Arc::clone(&watch.over));
        thread::spawn(move || {
            let mut seen = 0;
            while !over.load(Ordering::Relaxed) {
                thread::sleep(HANG);
                let now = executions.load(Ordering::Relaxed);
                if now == seen && !over.load(Ordering::Relaxed) {
                    let input = input.lock().unwrap_or_else(PoisonError::into_inner);
                    complain(format_args!("error: {name} hangs on {:02x?}", *input));
                    process::exit(1);
                }
                seen = now;
            }
        });
        watch
    }

    fn begin(&self, input: &[u8]) {
        let mut shown = self.input.lock().unwrap_or_else(PoisonError::into_inner);
        shown.clear();
        shown.extend_from_slice(input);
        self.executions.fetch_add(1, Ordering::Relaxed);
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
    }
}
