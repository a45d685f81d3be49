//! The plan of the scene played.

use double_pendulum::Method;
use double_pendulum::plan::Limit;

/// The code of no method: nothing affordable holds.
pub const NO_METHOD: u8 = u8::MAX;

/// A method's code on the wire: its place in the table.
pub const fn method_code(method: Method) -> u8 {
    method as u8
}

/// The method with this code.
pub fn method_of(code: u8) -> Option<Method> {
    Method::ALL.get(usize::from(code)).copied()
}

/// The code on the wire of what ends a horizon.
pub const fn limit_code(limit: Limit) -> u8 {
    match limit {
        Limit::End => 0,
        Limit::Growth => 1,
        Limit::Budget => 2,
        Limit::Planning => 3,
        Limit::Method => 4,
        _ => u8::MAX,
    }
}

crate::message! {
    /// Host to chip: say what the plan of the scene is, as far as it is found.
    AskPlan = 0x88 {
        /// Chosen by the host; the answer repeats it.
        request: u16,
    }
}

crate::message! {
    /// Chip to host: the plan of the scene. What is not found yet is 0.
    Planned = 0x07 {
        /// The command it answers.
        request: u16,
        /// 0: there is nothing to plan, no motion is shown or the kernel refuses it; 1: the search is under way; 2: the
        /// plan is found.
        found: u8,
        /// The cheapest method, by its [`method_code`]; [`NO_METHOD`] if nothing affordable is right in any frame, with no
        /// more about it but the limit.
        method: u8,
        /// Steps to a frame; 0 for the closed form.
        steps: u32,
        /// The step size, s; 0 for the closed form.
        dt: f64,
        /// The largest error expected until the horizon, pixels.
        error: f32,
        /// Cycles to compute a frame, without drawing it (estimate).
        cycles: f32,
        /// Until when it is right to half a pixel about the exact motion, s; as far as was looked when it was found.
        horizon: f64,
        /// What ends that, by its [`limit_code`].
        limit: u8,
        /// Cycles spent on looking ahead (estimate).
        planning: f32,
        /// The display's height that was planned for, pixels: both rods together are half of it long.
        height: f64,
        /// For how long the plan is made, s.
        duration: f64,
        /// What computing a frame may cost, cycles.
        frame_budget: f32,
        /// What looking ahead may cost, cycles.
        planning_budget: f32,
    }
}
