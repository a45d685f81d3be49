//! The golden bits: the bits of motions that are stored in `golden/bits.csv`.
//!
//! The tests of this crate compare every method whose type is in this crate with that file. The
//! repository's tests also compare the two other methods of the table, and all methods on every
//! emulated core. A change of a bit therefore shows as a change of the file.
//!
//! The file begins with the [`HEADER`]. For each method, in the order of [`Method::ALL`], it has a
//! [`Line`] for each of the [`MOTIONS`], in their order.

use core::fmt;

use crate::error::Error;
use crate::methods::Form;
use crate::pendulum::{Parameters, Pendulum, State};
use crate::table::Method;

/// The header line of the file, without a line feed.
pub const HEADER: &str = "method,motion,checksum,a1,a2,p1,p2";

/// The number of steps of each motion.
pub const STEPS: u32 = 640;

/// The step, s. It is not an `f32`, so that the rounding of a method's constants takes effect.
const DT: f64 = 1.0 / 240.0;

/// A motion of the file: a pendulum, its start and its step. It has [`STEPS`] steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Golden {
    /// The name in the column `motion`.
    pub name: &'static str,
    /// The pendulum, in SI units.
    pub parameters: Parameters<f64>,
    /// The state before the first step, in SI units.
    pub start: State<f64>,
    /// The step, s; negative if time runs backwards.
    pub dt: f64,
}

/// A regular motion of unequal rods and masses.
const REGULAR: Golden = Golden {
    name: "regular",
    parameters: Parameters {
        m1: 1.5,
        m2: 0.7,
        l1: 0.8,
        l2: 1.2,
        g: 9.81,
    },
    start: State {
        a1: 0.3,
        a2: -0.4,
        p1: 0.2,
        p2: -0.1,
    },
    dt: DT,
};

/// A chaotic motion of unequal rods and masses.
const CHAOTIC: Golden = Golden {
    name: "chaotic",
    parameters: Parameters {
        m1: 0.7,
        m2: 2.1,
        l1: 1.3,
        l2: 0.6,
        g: 9.81,
    },
    start: State {
        a1: 2.0,
        a2: -2.6,
        p1: 1.1,
        p2: -2.3,
    },
    dt: DT,
};

/// The motions of every method, in the order of the file: a regular one, the same backwards in
/// time, a chaotic one, and the same backwards in time. Each motion backwards has the start of the
/// motion forwards, and steps of -1/240 s instead of 1/240 s.
pub const MOTIONS: [Golden; 4] = [
    REGULAR,
    Golden {
        name: "regular-backwards",
        dt: -DT,
        ..REGULAR
    },
    CHAOTIC,
    Golden {
        name: "chaotic-backwards",
        dt: -DT,
        ..CHAOTIC
    },
];

/// The bits of a motion by one method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bits {
    /// The FNV-1a hash, 64 bits, of all words that the method carries, after each step, without
    /// those of the start. A word is a `u64`, little-endian. The number and order of the words
    /// depend on the method.
    pub checksum: u64,
    /// The bits of a1, a2, p1 and p2 at the end, as `f64` in SI units. The angles include whole
    /// turns.
    pub state: [u64; 4],
}

impl Golden {
    /// Computes the bits of this motion by the method `F`, in [`STEPS`] single steps.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`Pendulum::new`], [`Pendulum::run`] and
    /// [`Run::advance`](crate::Run::advance).
    pub fn bits<F: Form>(&self) -> Result<Bits, Error> {
        let pendulum = Pendulum::<f64>::new(&self.parameters)?;
        let mut run = pendulum.run::<F>(&self.start, self.dt)?.counting_turns();

        let mut checksum = FNV_OFFSET;
        for _ in 0..STEPS {
            run.advance(1)?;
            // The checksum includes every step.
            run.bits(|word| checksum = fnv_1a(checksum, &word.to_le_bytes()));
        }

        Ok(Bits {
            checksum,
            state: <[f64; 4]>::from(run.state()).map(f64::to_bits),
        })
    }
}

/// A line of the file: a motion by a method, and its bits.
///
/// Displays as the columns of [`HEADER`], separated by commas, without a line feed. The checksum
/// and the bits have 16 lower-case hexadecimal digits each.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a>(pub Method, pub &'a Golden, pub Bits);

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(method, motion, bits) = self;
        write!(f, "{method},{},{:016x}", motion.name, bits.checksum)?;
        bits.state
            .iter()
            .try_for_each(|word| write!(f, ",{word:016x}"))
    }
}

/// The factor of the FNV-1a hash of 64 bits.
const FNV_PRIME: u64 = 0x0000_0100_0000_01b3;
/// The FNV-1a hash of an empty sequence of bytes.
pub const FNV_OFFSET: u64 = 0xcbf2_9ce4_8422_2325;

/// Returns the FNV-1a hash of a sequence: `hash` is the hash of its earlier bytes, at first
/// [`FNV_OFFSET`], and `bytes` are the next ones (G. Fowler, L. C. Noll, K.-P. Vo). Without bytes
/// it returns `hash`.
#[must_use]
pub fn fnv_1a(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(FNV_PRIME)
    })
}
