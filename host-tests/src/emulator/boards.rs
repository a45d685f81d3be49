//! The emulated boards: one row each, with all that QEMU and the build need to know.

use cycles::Core;
use firmware::config::{self, Processor};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    pub name: &'static str,
    /// QEMU's `-machine`.
    pub machine: &'static str,
    /// QEMU's `-cpu`.
    pub cpu: &'static str,
    pub target: &'static str,
    pub binary: &'static str,
    /// The cargo feature that this binary needs; empty if none.
    pub feature: &'static str,
    /// Which of QEMU's serial ports is the link, counted from 0.
    pub serial_port: usize,
    /// Its clock, which it measures time by, Hz.
    pub hertz: u32,
    /// Whether it has the OLED panel and the five buttons.
    pub has_panel: bool,
}

impl Board {
    /// The clock of the processor that it stands for, Hz: QEMU's machine with a Cortex-M0+ stands for a Raspberry Pi Pico.
    pub fn processor_hertz(&self) -> u32 {
        if self.core() == Core::M0Plus {
            125_000_000
        } else {
            self.hertz
        }
    }

    /// How long an instruction takes where the clock counts them, as a power of two of a nanosecond, for QEMU knows no others:
    /// on the STM32F405 1.3 cycles, on the Cortex-M0+ 2 of 125 MHz, on the others 1.6 of 50 MHz.
    pub fn instruction_shift(&self) -> u32 {
        match self.processor_hertz() {
            ..=50_000_000 => 5,
            50_000_001..=125_000_000 => 4,
            _ => 3,
        }
    }

    /// The same in seconds.
    pub fn instruction(&self) -> f64 {
        f64::from(1 << self.instruction_shift()) * 1e-9
    }

    pub fn processor(&self) -> Processor {
        match (self.binary, self.core()) {
            ("stm32f405", _) => config::STM32F405,
            (_, Core::M4F) => config::CORTEX_M4F,
            (_, Core::M3) => config::CORTEX_M3,
            (_, Core::M0Plus) => config::CORTEX_M0PLUS,
        }
    }

    /// Whether its processor has a memory protection unit and tells the cause of a fault. An M0+ tells none, and QEMU's has no
    /// such unit.
    pub fn is_guarded(&self) -> bool {
        self.core() != Core::M0Plus
    }

    pub fn flash(&self) -> u32 {
        match self.machine {
            "netduinoplus2" => 0x0800_0000,
            _ => 0,
        }
    }

    pub fn core(&self) -> Core {
        match self.cpu {
            "cortex-m3" => Core::M3,
            "cortex-m0" => Core::M0Plus,
            _ => Core::M4F,
        }
    }
}

/// QEMU's board with the OLED panel, which knows several processors.
pub const LM3S6965EVB: Board = Board {
    name: "lm3s6965evb",
    machine: "lm3s6965evb",
    cpu: "cortex-m3",
    target: "thumbv7m-none-eabi",
    binary: "lm3s6965evb",
    feature: "",
    serial_port: 0,
    hertz: 50_000_000,
    has_panel: true,
};

/// ARM's, with neither panel nor buttons: quick to emulate.
pub const MPS2_AN386: Board = Board {
    name: "mps2-an386",
    machine: "mps2-an386",
    cpu: "cortex-m4",
    target: "thumbv7em-none-eabihf",
    binary: "mps2-an386",
    hertz: 25_000_000,
    has_panel: false,
    ..LM3S6965EVB
};

pub const BOARDS: [Board; 5] = [
    LM3S6965EVB,
    Board {
        name: "lm3s6965evb-m4",
        cpu: "cortex-m4",
        target: "thumbv7em-none-eabihf",
        ..LM3S6965EVB
    },
    MPS2_AN386,
    STM32F405,
    Board {
        name: "lm3s6965evb-m0",
        cpu: "cortex-m0",
        target: "thumbv6m-none-eabi",
        ..LM3S6965EVB
    },
];

/// The board that exists: the one ELF file is flashed and emulated. Its panel, button and I2C are not emulated.
pub const STM32F405: Board = Board {
    name: "stm32f405",
    machine: "netduinoplus2",
    cpu: "cortex-m4",
    target: "thumbv7em-none-eabihf",
    binary: "stm32f405",
    feature: "stm32f405",
    serial_port: 2, // USART3
    hertz: 168_000_000,
    has_panel: false,
};

/// The Raspberry Pi Pico, which not QEMU but rp2040js emulates.
pub const PICO: Board = Board {
    name: "pico",
    machine: "rp2040js",
    cpu: "cortex-m0",
    target: "thumbv6m-none-eabi",
    binary: "pico",
    feature: "pico",
    hertz: 125_000_000,
    ..LM3S6965EVB
};

/// Every board that the firmware is built for: those that QEMU emulates, and the Pico.
pub fn every_board() -> impl Iterator<Item = &'static Board> + Clone {
    BOARDS.iter().chain([&PICO])
}
