//! The plan of the scene played: how it might be computed, beside how it is.

use double_pendulum::plan::{Limit, Method};

/// The code of no method: nothing affordable holds. And of what this version of the protocol does not know.
pub const NO_METHOD: u8 = u8::MAX;

/// A method's code on the wire, whatever its place among the others.
pub const fn method_code(method: Method) -> u8 {
    match method {
        Method::ClosedForm => 0,
        Method::DirectionPlain => 1,
        Method::Direction => 2,
        Method::Angle => 3,
        Method::Direction8 => 4,
        _ => NO_METHOD,
    }
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
        /// plan is found; 3: and so is how long the method is right that is shown.
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
        /// Until when it is right to half a pixel about the exact motion, s.
        horizon: f64,
        /// What ends that, by its [`limit_code`].
        limit: u8,
        /// Cycles spent on looking ahead (estimate).
        planning: f32,
        /// The same of the method that is shown; its horizon is 0 if it is right in no frame.
        shown_method: u8,
        /// See `steps`.
        shown_steps: u32,
        /// See `error`.
        shown_error: f32,
        /// See `cycles`.
        shown_cycles: f32,
        /// See `horizon`.
        shown_horizon: f64,
        /// See `limit`.
        shown_limit: u8,
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
