//! What a board says when it has restarted by itself.

crate::message! {
    /// Chip to host: the board has restarted by itself and plays on, from the start of its scene. The frames after it are
    /// counted from 0 again. What is said of the program and the scene is how things stood before.
    Restarted = 0x08 {
        /// Why, by its [`code`](crate::app::warm_restart::Cause::code).
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
