//! A motion computed for a day on request, beside the same on the host.

use double_pendulum::{Method, Parameters, Pendulum, State};
use firmware::job::{Job, Request};
use firmware::protocol::{Frame, Sample};

use host_tests::emulator::qemu::{Machine, QemuError, Settings};

use super::Outcome;

/// Equal rods let go at 0.5 rad, in compensated `f32`.
const PHYSICS: Request = Request {
    method: Method::Rk4F32Direction,
    parameters: Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81 },
    angles: [0.5, 0.5],
    velocities: [0.0, 0.0],
    dt: 1.0 / 256.0,
    stride: 256 * 60,
    samples: 0,
};
/// The largest energy error, at first and by each step: what compensated `f32` still rounds away drifts, by 5e-12 a step as
/// measured over 22 million steps. RK4's own dissipation at this step is 6e-14.
const GREATEST_ENERGY_ERROR: (f64, f64) = (1e-6, 1e-11);

/// Computes `minutes` of the motion on the board, a sample each minute.
pub(super) fn physics(settings: &Settings, minutes: u32) -> Result<Outcome, QemuError> {
    let request = Request { samples: minutes, ..PHYSICS };
    let mut host: Job = Job::new(&request).expect("a motion that the kernel computes");
    let mut machine = Machine::start(settings)?;
    let mut outcome = Outcome::default();
    outcome.frame(&machine.wait_for::<Frame>()?);
    machine.serial.send(&request.message(1))?;

    let mut start = None;
    let mut index = 0;
    while index <= minutes {
        let message = machine.receive()?;
        if let Some(frame) = message.read() {
            outcome.frame(&frame);
        }
        let Some(sample) = message.read::<Sample>() else { continue };
        let expected = loop {
            if let Some(reading) = host.advance().expect("the motion stays finite") {
                break reading;
            }
        };
        if sample.index != index || sample.state.map(f64::to_bits) != expected.state.map(f64::to_bits) {
            outcome.fault(format!("sample {index} is not the host's"));
        }
        let start = *start.get_or_insert(sample.energy);
        let error = ((sample.energy - start) / (start - least_energy())).abs();
        outcome.energy_error = outcome.energy_error.max(error);
        let steps = f64::from(request.stride) * f64::from(index);
        if error.is_nan() || error > GREATEST_ENERGY_ERROR.0 + GREATEST_ENERGY_ERROR.1 * steps {
            outcome.fault(format!("energy error {error:.1e} after {steps} steps"));
        }
        index += 1;
    }
    outcome.end(&machine, settings.board);
    machine.quit()?;
    Ok(outcome)
}

/// Of the pendulum hanging at rest, J.
fn least_energy() -> f64 {
    Pendulum::new(PHYSICS.parameters).map_or(f64::NAN, |pendulum| pendulum.energy(&State::default()))
}
