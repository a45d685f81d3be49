//! A motion asked for over the link: the request, its samples, its refusal.

crate::message! {
    /// Host to chip: compute this motion and send its samples. A new request replaces one under way.
    Simulate = 0x81 {
        /// Chosen by the host; every answer repeats it.
        request: u16,
        /// The method, by its [`method_code`](super::method_code).
        method: u8,
        /// m1, m2 (kg), l1, l2 (m), g (m/s^2).
        parameters: [f64; 5],
        /// a1, a2 at the start, rad.
        angles: [f64; 2],
        /// w1, w2 at the start, rad/s.
        velocities: [f64; 2],
        /// Step size, s.
        dt: f64,
        /// Steps from one sample to the next.
        stride: u32,
        /// Samples after the one at the start.
        samples: u32,
    }
}

crate::message! {
    /// Chip to host: one sample of the motion asked for. The first one, index 0, is the start.
    Sample = 0x02 {
        /// The request it answers.
        request: u16,
        /// Counts the samples of the request.
        index: u32,
        /// a1, a2 (rad), p1, p2 (kg m^2/s); to the last digit carried; an f32 is widened, which loses nothing.
        state: [f64; 4],
        /// w1, w2, rad/s.
        velocities: [f64; 2],
        /// The energy, J; zero potential at the pivot.
        energy: f64,
    }
}

crate::message! {
    /// Chip to host: the motion asked for follows, but its step is too long to resolve every motion of its energy.
    StepTooLong = 0x06 {
        /// The request it answers.
        request: u16,
        /// The longest step that would, s.
        admissible_step: f64,
    }
}

crate::message! {
    /// Chip to host: the request cannot be computed, or not to its end, or the command not executed; nothing was changed.
    Refused = 0x03 {
        /// The request it answers.
        request: u16,
        /// The field that is wrong, by its [`code`](crate::protocol::Field::code).
        field: u8,
    }
}
