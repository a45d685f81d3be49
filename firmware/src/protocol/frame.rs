//! The telemetry frame.

crate::message! {
    /// One drawn frame, sent as soon as it is on the panel.
    Frame = 0x01 {
        /// Drawn frames since reset; a gap is a frame lost on the way, unless the board has [`Restarted`](super::Restarted).
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
        /// Mass ratio mu = m2/m1.
        mass_ratio: f32,
        /// Start angle of rod 1, rad; on the page that of both.
        start_angle: f32,
        /// The canonical state a1, a2 (rad), p1, p2 (kg m^2/s), to the bit.
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
        /// 1 if that may yet turn out to be later, else 0.
        is_looking: u8,
        /// Counts of the processor clock that the scene took for this frame, moving and drawing: cycles on a chip; QEMU
        /// does not model cycles, there they say how much of the tick its own clock let pass.
        scene_cycles: u32,
        /// The same for all of the frame before, sending it to the panel and over the link included.
        busy_cycles: u32,
    }
}
