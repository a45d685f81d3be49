//! What a board is, and how long its processor takes: for the report of a board in the hand.

use super::choice::choice;

choice! {
    /// A board that the firmware is built for.
    BoardName {
        /// Stellaris' evaluation board.
        Lm3s6965evb = 0, "lm3s6965evb";
        /// ARM's MPS2 with image AN386.
        Mps2An386 = 1, "mps2-an386";
        /// Any board with an STM32F405 or F407.
        Stm32f405 = 2, "stm32f405";
        /// Raspberry Pi's Pico.
        Pico = 3, "pico";
    }
}

crate::message! {
    /// Host to chip: say what you are.
    Identify = 0x8A {
        /// Chosen by the host; the answer repeats it.
        request: u16,
    }
}

crate::message! {
    /// Chip to host: what it is.
    Identity = 0x09 {
        /// The command it answers.
        request: u16,
        /// The board, by its [`code`](BoardName::code).
        board: u8,
        /// The processor's clock, Hz.
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
}

crate::message! {
    /// Host to chip: go on with the motion asked for last, so many steps at once and with interrupts off, and say how long
    /// they took. At most [`MOST_MEASURED_STEPS`](crate::config::MOST_MEASURED_STEPS) are made.
    Measure = 0x8B {
        /// Chosen by the host; the answer repeats it.
        request: u16,
        /// How many.
        steps: u32,
        /// By their code in memory if it is not 0, otherwise by that in flash.
        in_ram: u8,
    }
}

crate::message! {
    /// Chip to host: how long they took.
    Measured = 0x0A {
        /// The command it answers.
        request: u16,
        /// Steps made.
        steps: u32,
        /// Processor cycles, what calls them included; 0 where nothing counts cycles, as in QEMU, or the code does not stand there.
        cycles: u32,
    }
}
