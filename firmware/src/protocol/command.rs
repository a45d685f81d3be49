//! Commands and their answers. Every intact command is answered by [`Done`], [`Status`] or
//! [`Refused`](super::Refused), with its request number.

crate::message! {
    /// Host to chip: set one parameter and start again with it. Speed does not start again.
    Set = 0x82 {
        /// Chosen by the host; the answer repeats it.
        request: u16,
        /// What to set, by its [`code`](crate::protocol::Field::code).
        field: u8,
        /// The unit of the value, by its [`code`](crate::protocol::Unit::code).
        unit: u8,
        /// The value.
        value: f64,
    }
}

crate::message! {
    /// Host to chip: play a scene with the settings that are its own.
    Choose = 0x83 {
        /// Chosen by the host; the answer repeats it.
        request: u16,
        /// The scene, by its [`code`](crate::scenes::SceneName::code).
        scene: u8,
    }
}

crate::message! {
    /// Host to chip: start again with the same settings.
    Restart = 0x84 {
        /// Chosen by the host; the answer repeats it.
        request: u16,
    }
}

crate::message! {
    /// Host to chip: stop the scene's time, or let it go on.
    Pause = 0x85 {
        /// Chosen by the host; the answer repeats it.
        request: u16,
        /// 0: go on; any other: stop.
        paused: u8,
    }
}

crate::message! {
    /// Host to chip: let the scene do so many ticks, one in each tick of the clock, then stop.
    Step = 0x86 {
        /// Chosen by the host; the answer repeats it.
        request: u16,
        /// How many.
        ticks: u32,
    }
}

crate::message! {
    /// Host to chip: do what a tap on one button asks for, as the keys of a host's terminal do.
    Press = 0x89 {
        /// Chosen by the host; the answer repeats it.
        request: u16,
        /// The button, by its [`code`](crate::app::controls::Key::code).
        key: u8,
    }
}

crate::message! {
    /// Host to chip: say what is played.
    Ask = 0x87 {
        /// Chosen by the host; the answer repeats it.
        request: u16,
    }
}

crate::message! {
    /// Chip to host: the command has been executed.
    Done = 0x04 {
        /// The command it answers.
        request: u16,
    }
}

crate::message! {
    /// Chip to host: what is played, and from what start.
    Status = 0x05 {
        /// The command it answers.
        request: u16,
        /// The scene, by its [`code`](crate::scenes::SceneName::code).
        scene: u8,
        /// 1 if its time stands still, else 0.
        paused: u8,
        /// Ticks still to do before it stops, if it was told to do some.
        steps: u32,
        /// Simulated time per real time.
        speed: f32,
        /// m1, m2 (kg), l1, l2 (m), g (m/s^2).
        parameters: [f32; 5],
        /// Start angles of rod 1 and rod 2, degrees.
        degrees: [f32; 2],
        /// Angular velocities of rod 1 and rod 2 at the start, rad/s.
        velocities: [f32; 2],
        /// The class of the processor, by its place in [`PROCESSORS`](crate::config::PROCESSORS).
        processor: u8,
        /// The method that was asked for, by its [`method_code`](super::method_code); [`NO_METHOD`](super::NO_METHOD): as the
        /// plan has it.
        asked: u8,
        /// The method by which the motion is computed; [`NO_METHOD`](super::NO_METHOD) where there is none to choose.
        method: u8,
        /// Its steps to a frame.
        way_steps: u32,
        /// Cycles to compute a frame, without drawing it (estimate).
        cycles: f32,
        /// Until when the frames are known to be right to half a pixel, s since the start.
        horizon: f32,
        /// 1 if that may yet turn out to be later, else 0.
        is_looking: u8,
    }
}
