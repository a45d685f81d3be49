//! The golden bits: the bits of motions that are stored in `golden/bits.csv`.
//!
//! The file begins with the [`HEADER`]. For each method, in the order of [`Method::ALL`], it has a
//! [`Line`] for each of the [`MOTIONS`], in their order.

use core::fmt;

use crate::error::Error;
use crate::methods::Form;
use crate::pendulum::{Parameters, Pendulum, State};
use crate::table::Method;

pub const HEADER: &str = "method,motion,checksum,a1,a2,p1,p2";

/// The number of steps of each motion.
pub const STEPS: u32 = 640;

/// It is not an `f32`, so that the rounding of a method's constants takes effect.
const DT: f64 = 1.0 / 240.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Golden {
    pub name: &'static str,
    pub parameters: Parameters<f64>,
    pub start: State<f64>,
    pub dt: f64,
}

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
    /// The FNV-1a hash of all words that the method carries, after each step.
    pub checksum: u64,
    /// The bits of a1, a2, p1 and p2 at the end, as `f64`.
    pub state: [u64; 4],
}

impl Golden {
    /// Computes the bits of this motion by the method `F`.
    pub fn bits<F: Form>(&self) -> Result<Bits, Error> {
        let pendulum = Pendulum::<f64>::new(&self.parameters)?;
        let mut run = pendulum.run::<F>(&self.start, self.dt)?.counting_turns();

        let mut checksum = FNV_OFFSET;
        for _ in 0..STEPS {
            run.advance(1)?;
            run.bits(|word| checksum = fnv_1a(checksum, &word.to_le_bytes()));
        }

        Ok(Bits {
            checksum,
            state: <[f64; 4]>::from(run.state()).map(f64::to_bits),
        })
    }
}

/// A line of the file, which `Display` writes.
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

const FNV_PRIME: u64 = 0x0000_0100_0000_01b3;
pub const FNV_OFFSET: u64 = 0xcbf2_9ce4_8422_2325;

/// Continues the FNV-1a hash of 64 bits (G. Fowler, L. C. Noll, K.-P. Vo), which starts at
/// [`FNV_OFFSET`].
#[must_use]
pub fn fnv_1a(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(FNV_PRIME)
    })
}
