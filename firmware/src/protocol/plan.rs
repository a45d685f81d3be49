//! The plan of the scene played: how it might be computed, beside how it is.

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
        /// plan is found; 3: and so is how long the way that is shown is right.
        found: u8,
        /// The cheapest way, which says form, arithmetic and method, by its place in
        /// [`Method::ALL`](double_pendulum::plan::Method::ALL).
        way: u8,
        /// Steps to a frame; 0 for the closed form.
        steps: u32,
        /// The step size, s; 0 for the closed form.
        step: f64,
        /// The largest error expected until the horizon, pixels.
        error: f32,
        /// Cycles to compute a frame, without drawing it (estimate).
        cycles: f32,
        /// Until when it is right to half a pixel, s.
        horizon: f64,
        /// What ends that, by its place in [`Limit::ALL`](double_pendulum::plan::Limit::ALL).
        limit: u8,
        /// Cycles spent on looking ahead (estimate).
        planning: f32,
        /// The same of the way that is shown.
        shown_way: u8,
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
