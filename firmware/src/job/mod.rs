//! Motions computed on request, by any method.
//!
//! A [`Request`] names a [`Method`] and a motion. The service on the boards answers it step by step
//! ([`Job`]), `cargo simulate` all at once ([`Request::readings`]); `cargo count` counts its steps, and its bits on host and
//! chip are compared, by [`Request::crc`]. It is the same code wherever it runs, so that errors may be computed on the host
//! and costs counted on the chip.

mod answer;
mod comparison;
mod golden;
mod run;
mod table;

use core::fmt;

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use double_pendulum::{Integrator, Method, Motion, Parameters, Pendulum};
use heapless::Vec;
use serde::{Deserialize, Serialize};

use crate::config::GRAVITY;

pub use answer::Job;
pub use golden::write_golden;
pub use run::Run;
pub use table::{AnyRun, ON_BOARDS, OnBoards};

/// The reflected CRC-32 of zip and Ethernet.
pub const CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// The most bytes that a request takes in postcard's format.
const MAX_BYTES: usize = 1 + 10 * 8 + 2 * 5;

/// A motion to compute, by a method that the chip's application has or not. As text, the C programs read it, too
/// (`host-tests/peers-c/measure.c`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Request {
    pub method: Method,
    /// m1, m2 (kg), l1, l2 (m), g (m/s^2), in this order.
    pub parameters: Parameters<f64>,
    /// a1, a2 at the start, rad.
    pub angles: [f64; 2],
    /// w1, w2 at the start, rad/s.
    pub velocities: [f64; 2],
    /// Step size, s.
    pub dt: f64,
    /// Steps from one sample to the next.
    pub stride: u32,
    /// Samples after the one at the start.
    pub samples: u32,
}

/// What is told of a motion asked for. The state is widened, which loses nothing, and of the fast forms given to the last digit
/// they carry; what follows from it is computed in double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// a1, a2 (rad), p1, p2 (kg m^2/s).
    pub state: [f64; 4],
    /// w1, w2, rad/s.
    pub velocities: [f64; 2],
    /// Energy, J; zero potential at the pivot.
    pub energy: f64,
}

impl Request {
    /// 10 s of a chaotic motion, 2,560 steps, which every method can compute.
    pub fn on_any_core(method: Method) -> Self {
        let parameters = Parameters {
            m1: 1.0,
            m2: 1.0,
            l1: 1.0,
            l2: 1.0,
            g: GRAVITY,
        };
        let (angles, velocities) = ([2.0; 2], [0.0; 2]);
        Self {
            method,
            parameters,
            angles,
            velocities,
            dt: 1.0 / 256.0,
            stride: 80,
            samples: 32,
        }
    }

    /// Returns the longest step, s, that resolves every motion of this energy; `None` for the
    /// closed form, which takes any step, and for values that the kernel refuses.
    ///
    /// For RK4 it is [`Pendulum::admissible_step`]. A step of extrapolation of order 2 K errs as
    /// little when it is K times as long.
    pub fn admissible_step(&self) -> Option<f64> {
        let ([a1, a2], [w1, w2]) = (self.angles, self.velocities);
        let share = match self.method.integrator() {
            Integrator::ClosedForm => return None,
            Integrator::Rk4 => 1,
            Integrator::Extrapolation => self.method.order() / 2,
        };
        let pendulum = Pendulum::<f64>::new(&self.parameters).ok()?;
        let step = pendulum.admissible_step(&pendulum.to_state(&Motion { a1, a2, w1, w2 }));
        Some(f64::from(share) * step.ok()?)
    }

    /// From its bytes in postcard's format, each as two hexadecimal digits.
    pub fn parse(text: &str) -> Option<Self> {
        let mut bytes = Vec::<u8, MAX_BYTES>::new();
        let byte = |digits: &[u8]| u8::from_str_radix(core::str::from_utf8(digits).ok()?, 16).ok();
        for digits in text.as_bytes().chunks(2) {
            bytes.push(byte(digits)?).ok()?;
        }
        postcard::take_from_bytes(&bytes)
            .ok()
            .filter(|(_, rest)| rest.is_empty())
            .map(|(request, _)| request)
    }
}

/// As [`Request::parse`] reads it.
impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = &mut [0; MAX_BYTES];
        let bytes = postcard::to_slice(self, bytes).map_err(|_| fmt::Error)?;
        bytes.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// CRC-32 of all that is carried at every sample but the one at the start, and of the last state.
fn crc(mut run: impl Run, request: &Request) -> u32 {
    let mut digest = CRC.digest();
    for _ in 0..request.samples {
        counted_steps(&mut run, request.stride);
        run.bits(|word| digest.update(&word.to_le_bytes()));
    }
    <[f64; 4]>::from(run.state())
        .iter()
        .for_each(|number| digest.update(&number.to_le_bytes()));
    digest.finalize()
}

/// What the counter counts, from this function's first instruction to its return; it finds it by this name.
#[inline(never)]
fn counted_steps<R: Run>(run: &mut R, steps: u32) {
    let mut local = *run;
    local.advance(steps);
    *run = local;
}
