//! The table of emulated boards: everything that QEMU and the build need to know about each.

use cycles::Core;
use firmware::config::{self, Processor};
use firmware::graphics::PanelName;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// The name on the command line and in tables.
    pub name: &'static str,
    pub machine: &'static str,
    pub cpu: &'static str,
    /// The compiler's target, one of [`TARGETS`](crate::toolchain::TARGETS).
    pub target: &'static str,
    /// Boards with the same binary differ in their target.
    pub binary: &'static str,
    pub feature: &'static str,
    pub serial_port: usize,
    /// The clock in the emulator, whose cycles the frames report.
    pub hertz: u32,
    pub has_panel: bool,
    pub panel: PanelName,
}

impl Board {
    pub fn names(&self) -> Vec<&'static str> {
        let aliases: &[_] = match self.processor() {
            config::CORTEX_M3 => &["m3"],
            config::CORTEX_M4F => &["slow-m4f"],
            config::STM32F405 => &["m4f"],
            _ => &["pico", "m0"],
        };
        [&[self.name], aliases].concat()
    }

    /// The clock of the processor that the board represents. QEMU's machine with a Cortex-M0+
    /// represents a Raspberry Pi Pico at 125 MHz.
    pub fn processor_hertz(&self) -> u32 {
        if self.core() == Core::M0Plus {
            125_000_000
        } else {
            self.hertz
        }
    }

    /// The duration of an instruction, as the exponent of a power of two in nanoseconds; QEMU
    /// allows no other durations. It is 1.3 cycles of the STM32F405, 2 of the Pico, and 1.6 of the
    /// others.
    pub fn instruction_shift(&self) -> u32 {
        match self.processor_hertz() {
            ..=50_000_000 => 5,
            50_000_001..=125_000_000 => 4,
            _ => 3,
        }
    }

    /// Returns the seconds of an instruction when QEMU's clock counts instructions.
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

    pub fn reports_causes(&self) -> bool {
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

/// QEMU can give this board other processors than its real Cortex-M3.
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
    panel: PanelName::Oled,
};

/// The same with a Cortex-M4F, which exists in QEMU only.
pub const LM3S6965EVB_M4: Board = Board {
    name: "lm3s6965evb-m4",
    cpu: "cortex-m4",
    target: "thumbv7em-none-eabihf",
    ..LM3S6965EVB
};

/// The boards of QEMU. The first one is the default of most commands.
pub const BOARDS: [Board; 4] = [
    LM3S6965EVB,
    LM3S6965EVB_M4,
    STM32F405,
    Board {
        name: "lm3s6965evb-m0",
        cpu: "cortex-m0",
        target: "thumbv6m-none-eabi",
        ..LM3S6965EVB
    },
];

/// The same ELF file is flashed and emulated. QEMU does not emulate its panel, button and I2C.
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
    panel: PanelName::Oled,
};

/// Emulated by rp2040js, so that the fields for QEMU have no meaning.
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

pub const fn pico_with(panel: PanelName) -> Board {
    Board { panel, ..PICO }
}

pub fn every_board() -> impl Iterator<Item = &'static Board> + Clone {
    BOARDS.iter().chain([&PICO])
}
