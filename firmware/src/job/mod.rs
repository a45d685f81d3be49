//! Motions that are computed on request, by any method.
//!
//! A [`Request`] contains a [`Method`] and a motion. It has several uses:
//!
//! - The application on the boards computes it step by step ([`Job`]).
//! - `cargo simulate` computes all of it at once ([`Request::readings`]).
//! - `cargo count` counts the cycles of its steps.
//! - [`Request::crc`] serves to compare its bits on host and chip.
//!
//! All of them run the same code, so that errors can be computed on the host and costs can be
//! counted on the chip.

mod answer;
mod comparison;
mod golden;
mod run;
mod table;
#[cfg(feature = "application")]
mod text;

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use double_pendulum::parts::Advance;
use double_pendulum::{Form, Integrator, Method, Motion, Parameters, Pendulum};

use crate::config::GRAVITY;

pub use answer::Job;
pub use golden::write_golden;
pub use table::{BoardMotion, ON_BOARDS, visit};

/// The CRC of requests, messages and images: CRC-32/ISO-HDLC, the reflected CRC-32 of zip and
/// Ethernet.
pub const CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// A motion to compute.
///
/// The text form of a request is also read by the C programs (`host-tests/peers/c/measure.c`).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "application", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Request {
    pub method: Method,
    /// m1, m2 (kg), l1, l2 (m), g (m/s^2).
    pub parameters: Parameters<f64>,
    /// The initial angles a1 and a2, rad.
    pub angles: [f64; 2],
    /// The initial angular velocities w1 and w2, rad/s.
    pub velocities: [f64; 2],
    /// The step size, s. Of the closed form it may be negative, and has no limit.
    pub dt: f64,
    /// The number of steps from one sample to the next; 0 repeats the initial sample.
    pub stride: u32,
    /// The number of samples after the initial one.
    pub samples: u32,
}

/// The numbers of a requested motion at one time. The state has all digits that the method carries;
/// the other numbers are computed from it in double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "application", derive(serde::Serialize, serde::Deserialize))]
pub struct Reading {
    /// The state a1, a2 (rad, including whole turns), p1, p2 (kg m^2/s).
    pub state: [f64; 4],
    /// The angular velocities w1 and w2, rad/s.
    pub velocities: [f64; 2],
    /// The energy, J. The potential is zero at the pivot.
    pub energy: f64,
}

impl Request {
    /// Returns a request for 10 s of a chaotic motion that every method can compute.
    pub fn on_any_core(method: Method) -> Self {
        let parameters = Parameters {
            m1: 1.0,
            m2: 1.0,
            l1: 1.0,
            l2: 1.0,
            g: GRAVITY,
        };
        let angles = [2.0; 2];
        let velocities = [0.0; 2];
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
    /// closed form, and for parameters that the kernel refuses.
    ///
    /// For RK4 it is [`Pendulum::admissible_step`]; for extrapolation of order 2 K it is K times
    /// that step, which errs as little.
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
}

/// Returns the CRC-32 of all numbers that the method carries, at every sample except the initial
/// one, and of the last state.
fn crc<F: Form>(mut run: F, request: &Request) -> u32 {
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

/// Makes `steps` steps. The counter of cycles (`cargo count`) finds this function by its name, and
/// counts from its first instruction to its return.
#[inline(never)] // Found by its name (`cargo count`, test `count_elf`).
fn counted_steps<R: Advance>(run: &mut R, steps: u32) {
    let mut local = *run;
    local.advance(steps);
    *run = local;
}
