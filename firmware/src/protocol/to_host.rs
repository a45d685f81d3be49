//! What a board sends: a frame after each that it has drawn, and answers.

use super::message::{messages, numbered};

/// What is told of a motion asked for. The state is widened, which loses nothing, and of the fast forms given to the last digit
/// they carry; what follows from it is computed in double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Reading {
    /// a1, a2 (rad), p1, p2 (kg m^2/s).
    pub state: [f64; 4],
    /// w1, w2, rad/s.
    pub velocities: [f64; 2],
    /// Energy, J; zero potential at the pivot.
    pub energy: f64,
}

messages! {
    /// One drawn frame, sent as soon as it is on the panel.
    Frame = 0x01 {
        /// Drawn frames since reset; a gap is a frame lost on the way, unless the board has [`Restarted`].
        sequence: u32,
        /// Ticks whose frame was never drawn, since reset.
        dropped: u32,
        /// Bytes from the host that were lost because they came faster than they were taken, since reset; at least so many.
        lost: u32,
        /// The scene, by its [`code`](crate::scenes::SceneName::code).
        scene: u8,
        /// 1 if the scene's time stands still, else 0.
        paused: u8,
        /// Steps of 1/60 s since the last restart; their low 32 bits, which last 828 days.
        step: u32,
        /// Simulated time since the last restart, s: `step` times that.
        time: f64,
        mass_ratio: f32,
        /// Start angle of rod 1, rad; on the page that of both.
        start_angle: f32,
        /// The canonical state a1, a2 (rad, turns counted), p1, p2 (kg m^2/s), to the last bit.
        state: [f32; 4],
        /// (E - E0)/(E0 - Emin): the energy error relative to the energy at the start above hanging at rest.
        energy_error: f32,
        /// The method by which the motion is computed, by its [`method_code`](super::method_code);
        /// [`NO_METHOD`](super::NO_METHOD) where there is none to choose.
        method: u8,
        /// Its steps to a frame.
        way_steps: u16,
        /// Until when the frames are known to be right to half a pixel, s since the last restart; infinity where nothing can
        /// be wrong.
        horizon: f32,
        /// 1 if that is a lower bound so far, else 0.
        is_looking: u8,
        /// Counts of the processor clock that the scene took for this frame, moving and drawing: cycles on a chip; QEMU
        /// does not model cycles, there they say how much of the tick its own clock let pass.
        scene_cycles: u32,
        /// The same for all of the frame before, sending it to the panel and over the link included.
        busy_cycles: u32,
    }
    /// The board has restarted by itself and plays on, from the start of its scene. The frames after it are counted from 0 again.
    /// What is said of the program and the scene is how things stood before.
    Restarted = 0x08 {
        /// Why, by its [`code`](crate::app::Cause::code).
        cause: u8,
        /// Restarts in a row, this one included; the board forgets them after a minute without one.
        restarts: u8,
        /// Where the program was, as far as that could be found out, else 0.
        pc: u32,
        /// Where it would have returned to, likewise.
        lr: u32,
        /// The processor's Configurable Fault Status Register.
        cfsr: u32,
        /// The scene that was shown, by its [`code`](crate::scenes::SceneName::code).
        scene: u8,
        /// The integration step of the last frame shown; its low 32 bits, as in a frame.
        step: u32,
    }
}

numbered! {
    /// One sample of the motion asked for. The first one, index 0, is the start.
    Sample = 0x02 {
        index: u32,
        reading: Reading,
    }
    /// The request cannot be computed, or not to its end, or the command not executed; nothing was changed.
    Refused = 0x03 {
        /// The field that is wrong, by its [`code`](super::Field::code).
        field: u8,
    }
    /// The command has been executed.
    Done = 0x04 {}
    /// What is played, and from what start.
    Status = 0x05 {
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
        /// Start angles of rod 1 and rod 2, degrees: as the buttons set them.
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
        /// 1 if that is a lower bound so far, else 0.
        is_looking: u8,
    }
    /// The motion asked for follows, but its step is too long to resolve every motion of its energy.
    StepTooLong = 0x06 {
        /// The longest step that would, s.
        admissible_step: f64,
    }
    /// The plan of the scene. What is not found yet is 0.
    Planned = 0x07 {
        /// 0: there is nothing to plan, no motion is shown or the kernel refuses it; 1: the search is under way; 2: the
        /// plan is found.
        found: u8,
        /// The cheapest method, by its [`method_code`](super::method_code); [`NO_METHOD`](super::NO_METHOD) if nothing affordable
        /// is right in any frame, with no more about it but the limit.
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
        /// What ends that, by its [`limit_code`](super::limit_code).
        limit: u8,
        /// Cycles spent on planning (estimate).
        planning: f32,
        /// The display's height that was planned for, pixels: both rods together are half of it long.
        height: f64,
        /// For how long the plan is made, s.
        duration: f64,
        /// What computing a frame may cost, cycles.
        frame_budget: f32,
        /// What planning may cost, cycles.
        planning_budget: f32,
    }
    /// What the board is.
    Identity = 0x09 {
        /// The board, by its [`code`](super::BoardName::code).
        board: u8,
        hertz: u32,
        /// What the processor says that it is: CPUID.
        processor: u32,
        /// What the chip says that it is, and its unique number; zeros where it has none.
        chip: [u32; 4],
        /// CRC-32 of the program in its flash, code and constants.
        image: u32,
        /// Bytes of that.
        image_bytes: u32,
    }
    /// How long steps took.
    Measured = 0x0A {
        steps: u32,
        /// Processor cycles, what calls them included; 0 where nothing counts cycles, as in QEMU, or the code does not stand there.
        cycles: u32,
    }
}
