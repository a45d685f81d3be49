//! What the host asks for. Every intact message is answered, with its number.

use double_pendulum::{Method, Parameters};

use super::message::numbered;

/// A motion to compute, by a method that the chip's application has or not.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Request {
    /// By its place in the table, which is its [`method_code`](super::method_code); any other makes the message unreadable.
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

numbered! {
    /// Compute this motion and send its samples. A new request replaces one under way.
    Simulate = 0x81 {
        motion: Request,
    }
    /// Set one parameter and start again with it. Speed does not start again.
    Set = 0x82 {
        /// What to set, by its [`code`](super::Field::code).
        field: u8,
        /// In SI units.
        value: f64,
    }
    /// Play a scene with the settings that are its own.
    Choose = 0x83 {
        /// The scene, by its [`code`](crate::scenes::SceneName::code).
        scene: u8,
    }
    /// Start again with the same settings.
    Restart = 0x84 {}
    /// Stop the scene's time, or let it go on.
    Pause = 0x85 {
        /// 0: go on; any other: stop.
        paused: u8,
    }
    /// Let the scene do so many ticks, one in each tick of the clock, then stop.
    Step = 0x86 {
        ticks: u32,
    }
    /// Say what is played.
    Ask = 0x87 {}
    /// Say what the plan of the scene is, as far as it is found.
    AskPlan = 0x88 {}
    /// Do what a tap on one button asks for, as the keys of a host's terminal do.
    Press = 0x89 {
        /// The button, by its [`code`](crate::app::Key::code).
        key: u8,
    }
    /// Say what you are.
    Identify = 0x8A {}
    /// Go on with the motion asked for last, so many steps at once and with interrupts off, and say how long they took. At most
    /// [`MOST_MEASURED_STEPS`](crate::config::MOST_MEASURED_STEPS) are made.
    Measure = 0x8B {
        steps: u32,
        /// By their code in memory if it is not 0, otherwise by that in flash.
        in_ram: u8,
    }
}
