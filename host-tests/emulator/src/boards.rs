//! The table of emulated boards: everything that QEMU and the build need to know about each.

use cycles::Core;
use firmware::config::{self, Processor};
use firmware::display::PanelName;

/// A board that the firmware is built for, and its emulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// The name on the command line and in tables.
    pub name: &'static str,
    /// QEMU's `-machine`.
    pub machine: &'static str,
    /// QEMU's `-cpu`.
    pub cpu: &'static str,
    /// The compiler's target, one of [`TARGETS`](crate::toolchain::TARGETS).
    pub target: &'static str,
    /// The binary of the firmware that is its application. Boards with the same binary differ in
    /// their target.
    pub binary: &'static str,
    /// The feature of the package `firmware` that this binary needs; empty if none.
    pub feature: &'static str,
    /// The number of QEMU's serial port that is the link, counted from 0.
    pub serial_port: usize,
    /// The frequency of the clock that measures the emulated board's time, Hz: the unit of the
    /// `scene_cycles` and `busy_cycles` of its frames.
    pub hertz: u32,
    /// True if the emulated board has the OLED panel and the five buttons.
    pub has_panel: bool,
    /// The panel that the firmware is built for.
    pub panel: PanelName,
}

impl Board {
    /// Returns the name on the command line, and older names of the board or its chip.
    pub fn names(&self) -> Vec<&'static str> {
        let aliases: &[_] = match self.processor() {
            config::CORTEX_M3 => &["m3"],
            config::CORTEX_M4F => &["slow-m4f"],
            config::STM32F405 => &["m4f"],
            _ => &["pico", "m0"],
        };
        [&[self.name], aliases].concat()
    }

    /// Returns the clock frequency of the processor that the board represents, Hz. It is `hertz`,
    /// except for QEMU's machine with a Cortex-M0+: that represents a Raspberry Pi Pico at 125 MHz,
    /// and `hertz` is its clock in QEMU.
    pub fn processor_hertz(&self) -> u32 {
        if self.core() == Core::M0Plus {
            125_000_000
        } else {
            self.hertz
        }
    }

    /// Returns the duration of an instruction when QEMU's clock counts instructions, as the
    /// exponent of a power of two in nanoseconds; QEMU allows no other durations. It has no meaning
    /// for the Pico.
    ///
    /// It is 3 on the STM32F405 (8 ns, 1.3 of its cycles), 4 on the Cortex-M0+ (16 ns, 2 cycles of
    /// 125 MHz), and 5 on the others (32 ns, 1.6 cycles of 50 MHz).
    pub fn instruction_shift(&self) -> u32 {
        match self.processor_hertz() {
            ..=50_000_000 => 5,
            50_000_001..=125_000_000 => 4,
            _ => 3,
        }
    }

    /// Returns the duration of an instruction, s, when QEMU's clock counts instructions: 2 to the
    /// power of [`Self::instruction_shift`] ns. It has no meaning for the Pico.
    pub fn instruction(&self) -> f64 {
        f64::from(1 << self.instruction_shift()) * 1e-9
    }

    /// Returns the class of the processor, with its price list and budgets. The STM32F405 has its
    /// own; the others follow from [`Self::core`].
    pub fn processor(&self) -> Processor {
        match (self.binary, self.core()) {
            ("stm32f405", _) => config::STM32F405,
            (_, Core::M4F) => config::CORTEX_M4F,
            (_, Core::M3) => config::CORTEX_M3,
            (_, Core::M0Plus) => config::CORTEX_M0PLUS,
        }
    }

    /// Returns true if the processor reports the cause of a fault. Only a Cortex-M0+ does not.
    pub fn reports_causes(&self) -> bool {
        self.core() != Core::M0Plus
    }

    /// Returns the first address of the flash of a board in QEMU, where the processor reads its
    /// vectors. It is 0 for the Pico, which is not its address of the flash.
    pub fn flash(&self) -> u32 {
        match self.machine {
            "netduinoplus2" => 0x0800_0000,
            _ => 0,
        }
    }

    /// Returns the kind of core, which determines the timings of instructions. It is chosen by
    /// `cpu`: the `cortex-m0` counts as a Cortex-M0+, and any name but that and `cortex-m3` as a
    /// Cortex-M4F.
    pub fn core(&self) -> Core {
        match self.cpu {
            "cortex-m3" => Core::M3,
            "cortex-m0" => Core::M0Plus,
            _ => Core::M4F,
        }
    }
}

/// The board with an OLED panel and buttons in QEMU, here with the Cortex-M3 of the real one at 50
/// MHz. QEMU can give it other processors.
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

/// The boards of QEMU: the LM3S6965 with a Cortex-M3 (`lm3s6965evb`), then with a Cortex-M4F
/// (`lm3s6965evb-m4`), [`STM32F405`], and the LM3S6965 with a Cortex-M0+ (`lm3s6965evb-m0`). The first one is the default of most commands.
pub const BOARDS: [Board; 4] = [
    LM3S6965EVB,
    Board {
        name: "lm3s6965evb-m4",
        cpu: "cortex-m4",
        target: "thumbv7em-none-eabihf",
        ..LM3S6965EVB
    },
    STM32F405,
    Board {
        name: "lm3s6965evb-m0",
        cpu: "cortex-m0",
        target: "thumbv6m-none-eabi",
        ..LM3S6965EVB
    },
];

/// The board with a Cortex-M4F at 168 MHz that exists as hardware: the same ELF file is flashed and
/// emulated. QEMU does not emulate its panel, button and I2C, so `has_panel` is false.
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

/// The Raspberry Pi Pico with a Cortex-M0+ at 125 MHz, a panel and buttons. It is emulated by
/// rp2040js instead of QEMU, which does not know its `machine` and ends at once. Its `serial_port`
/// has no meaning, and its `cpu` is for [`Board::core`].
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

/// Returns the Pico with this panel.
pub const fn pico_with(panel: PanelName) -> Board {
    Board { panel, ..PICO }
}

/// Returns every board that the firmware is built for: the [`BOARDS`] of QEMU in their order, then
/// the [`PICO`].
pub fn every_board() -> impl Iterator<Item = &'static Board> + Clone {
    BOARDS.iter().chain([&PICO])
}
