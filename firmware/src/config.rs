//! The tunable numbers, with their units and the reasons for their values.

use double_pendulum::plan::{Budget, Costs, Problem};

// ---- Time ---------------------------------------------------------------------------------------

/// The number of ticks per second of the clock, and at full speed of the scene.
pub const TICK_RATE: u32 = 60;
/// The smallest number of RK4 steps per tick, of a motion that is shown for comparison and follows
/// no plan.
pub const STEPS_PER_TICK: u32 = 2;
pub const DT: f64 = 1.0 / (TICK_RATE * STEPS_PER_TICK) as f64;
/// The largest number of ticks of the scene before a frame is drawn, so that a board that keeps up
/// with the motion, but not with drawing it, still shows 4 frames per second.
pub const MOST_TICKS_PER_FRAME: u32 = 15;

/// The time without a finished frame that counts as a hang, s: four times the time of the slowest
/// frame allowed. A watchdog resets the board after twice this time.
pub const WATCHDOG_SECONDS: u32 = 1;

/// The number of ticks without a key after which the panel is dimmed. OLED pixels that are always
/// lit age sooner than the others.
pub const DIM_TICKS: u32 = 10 * 60 * TICK_RATE;

/// The largest speed of a scene, simulated time per real time. Even the Cortex-M3 then still shows
/// most frames.
pub const GREATEST_SPEED: u32 = 4;

// ---- Accuracy -----------------------------------------------------------------------------------

/// The tolerance of a frame, pixels: the largest distance of a bob from its position in the exact
/// motion from the same start.
pub const HALF_PIXEL: f32 = 0.5;

// ---- The plan -----------------------------------------------------------------------------------

/// The simulated time that is planned for each scene, s. It is longer than the most energetic
/// motion can be predicted in 64 bits.
pub const PLANNED: f64 = 30.0;
/// The number of ticks after its start in which nothing is planned for a scene. A held button
/// restarts scenes faster than that.
pub const SETTLED_TICKS: u64 = 6;
const _: () = assert!(SETTLED_TICKS > REPEAT_PERIOD_TICKS as u64);
/// The largest cost of the steps in a piece of the search, cycles of the price list. A single step
/// may exceed it. A board that plans ahead checks its clock after each piece, 0.4 ms at 50 MHz.
pub const PLANNING_PIECE: f32 = 20_000.0;

/// A class of processors with common prices and budgets, all in estimated cycles. A scene uses the
/// same methods on all processors of a class.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Processor {
    pub code: u8,
    pub costs: Costs,
    /// The budget for computing one tick of the scene. The rest of the time is for drawing and
    /// sending the frame.
    pub frame: f32,
    /// The budget for planning in each tick of the clock.
    pub look_ahead: f32,
    pub flips: FlipsPace,
}

impl Processor {
    /// Reads the price list, because the host plays for every processor.
    pub fn has_float(&self) -> bool {
        self.costs.direction_plain < self.costs.fixed32
    }

    /// Returns the least number of cycles that a piece of planning, or a frame that is computed but
    /// not shown, is charged. The steps may cost less than the work around them.
    pub fn piece(&self) -> f32 {
        self.costs.closed_form.max(1_000.0)
    }

    /// Returns the budgets of a problem. The search may spend [`look_ahead`](Self::look_ahead) in
    /// each tick until the last frame, so that it stays ahead of the scene.
    pub fn budget(&self, problem: &Problem) -> Budget {
        let ticks = TICK_RATE as f32 / f32::from(problem.rate);
        Budget {
            frame: ticks * self.frame,
            planning: ticks * self.look_ahead * problem.frames() as f32,
        }
    }
}

/// A Cortex-M3 at 50 MHz or more. At 50 MHz a tick has 833,000 cycles. With 440,000 of
/// planning, figure 7 with a light bob was late.
pub const CORTEX_M3: Processor = Processor {
    code: 0,
    costs: Costs::CORTEX_M3,
    frame: 200_000.0,
    look_ahead: 400_000.0,
    flips: FIXED,
};
/// A Cortex-M0+ at 125 MHz or more, as on the Raspberry Pi Pico. A tick has 2,083,000 cycles. A
/// start in the map of flips counts four steps more than on a Cortex-M3, so that a tick leaves time
/// for the serial link.
pub const CORTEX_M0PLUS: Processor = Processor {
    code: 3,
    costs: Costs::CORTEX_M0PLUS,
    frame: 330_000.0,
    look_ahead: 700_000.0,
    flips: FlipsPace { start: 46, ..FIXED },
};
/// A Cortex-M4F at 25 MHz or more. At 25 MHz a tick has 417,000 cycles.
pub const CORTEX_M4F: Processor = Processor {
    code: 1,
    costs: Costs::CORTEX_M4F,
    frame: 158_000.0,
    look_ahead: 200_000.0,
    flips: FLOAT,
};
/// The Cortex-M4F of the STM32F405 at 168 MHz. A tick has 2,800,000 cycles. With less planning, the
/// search would end before the errors of a pendulum with a light bob 1 show.
pub const STM32F405: Processor = Processor {
    code: 2,
    frame: 700_000.0,
    look_ahead: 1_300_000.0,
    flips: FlipsPace {
        steps: 5500,
        ..FLOAT
    },
    ..CORTEX_M4F
};
/// The processor classes, indexed by their code on the link.
pub const PROCESSORS: [Processor; 4] = [CORTEX_M3, CORTEX_M4F, STM32F405, CORTEX_M0PLUS];
/// The class of the processor that the program is compiled for, unless a board names another.
pub const PROCESSOR: Processor = if cfg!(target_abi = "eabihf") {
    CORTEX_M4F
} else if cfg!(armv6m) {
    CORTEX_M0PLUS
} else {
    CORTEX_M3
};

// ---- The map of flips ---------------------------------------------------------------------------

/// The budget of the map of flips for a tick of the scene, and the costs that are charged to it,
/// all in steps of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlipsPace {
    pub steps: u32,
    /// The cost of a new start whose motion must be computed, in addition to its steps.
    pub start: u32,
    /// The cost of a start that has not enough energy to turn over. It must not be 0: then one tick
    /// would do all such starts in a row.
    pub never: u32,
}
/// Fixed point. A step takes 920 cycles on a Cortex-M3, in all nearly half of a frame, and 2,200 on
/// a Cortex-M0+.
const FIXED: FlipsPace = FlipsPace {
    steps: 400,
    start: 42,
    never: 13,
};
/// `f32` on a Cortex-M4F, where a step takes 230 cycles.
const FLOAT: FlipsPace = FlipsPace {
    steps: 650,
    start: 60,
    never: 10,
};

// ---- The pendulum -------------------------------------------------------------------------------

/// The length of a rod in most scenes, m. It gives a period of about 2 s, which is pleasant to
/// watch.
pub const ROD: f64 = 1.0;
pub const GRAVITY: f64 = 9.81;
/// The gravity of the source page, m/s^2, in the scenes that repeat the page's own figures.
pub const PAGE_GRAVITY: f64 = 9.8;
/// The mass ratio m2/m1 at power-on.
pub const FIRST_MASS_RATIO: f64 = 1.0;
/// The start angle of both rods at power-on, degrees. It is well in the chaotic regime.
pub const FIRST_ANGLE: f64 = 120.0;
/// The mass ratios that the buttons select: the Renard series R10 (ISO 3), which is geometric and
/// rounded so that every label is short.
pub const MASS_RATIOS: [f64; 41] = [
    0.01, 0.0125, 0.016, 0.02, 0.025, 0.0315, 0.04, 0.05, 0.063, 0.08, //
    0.1, 0.125, 0.16, 0.2, 0.25, 0.315, 0.4, 0.5, 0.63, 0.8, //
    1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0, //
    10.0, 12.5, 16.0, 20.0, 25.0, 31.5, 40.0, 50.0, 63.0, 80.0, 100.0,
];
/// The change of the start angle by a press of left or right, degrees.
pub const ANGLE_STEP: f64 = 1.0;
/// The largest start angle, degrees: straight up.
pub const GREATEST_ANGLE: f64 = 180.0;

// ---- Buttons, in ticks of 1/60 s ----------------------------------------------------------------

/// The number of equal readings in a row, one per tick, that count as a level. 17 ms is longer than
/// contacts bounce.
pub const DEBOUNCE_TICKS: u8 = 2;
pub const REPEAT_DELAY_TICKS: u8 = 24;
pub const REPEAT_PERIOD_TICKS: u8 = 4;

/// The time after which the select button, held alone, acts.
pub const HOLD_TICKS: u8 = 48;
pub const MOST_TICKS_BETWEEN_TAPS: u8 = 24;

// ---- The frame, in pixels -----------------------------------------------------------------------

/// The position (x, y) of the pivot, right and down from the top left corner of the panel; pixel i
/// covers i to i + 1. It is the middle, so that the motion has the full height.
pub const PIVOT: (f32, f32) = (64.0, 32.0);
/// The length of both rods together on an OLED: half the height less the largest bob and its soft
/// edge, 32 - 3 - 0.5.
pub const REACH: f32 = 28.5;
/// The radius of the heavier bob at a reach of [`REACH`]; at another reach it is in proportion.
pub const GREATEST_RADIUS: f32 = 3.0;
/// The smallest radius of a bob.
pub const LEAST_RADIUS: f32 = 1.5;
pub const ROD_HALF_WIDTH: f32 = 0.6;
/// Half the width of the trail of the scene `page`.
pub const TRAIL_HALF_WIDTH: f32 = 0.8;
/// The brightness of the trail at the bob, of 255. Its grey is 11 of 15.
pub const TRAIL_BRIGHTNESS: u8 = 184;
/// The number of rows, of 64, whose trail loses a grey in a tick of the scene. The last of 11 greys
/// is gone after 11 x 64/5 = 141 ticks, 2.3 s of motion.
pub const TRAIL_FADING: u8 = 5;

// ---- The serial link ----------------------------------------------------------------------------

/// The speed of the serial link, bits per second. The longest frame message takes 2.0 ms of a tick.
pub const BAUD: u32 = 460_800;
/// The largest number of steps whose time is measured at once. They block the board: on a
/// Cortex-M0+ 16 steps of order 16 take 23 ms.
///
/// The number is not smaller because the measured time includes the call, about 550 cycles on a
/// Cortex-M4F. That adds 17 % to each of 16 steps of `rk4-f32-direction`, and would add 67 % to
/// each of 4.
pub const MOST_MEASURED_STEPS: u32 = 16;
/// The number of times in a row that a serial port or an SPI bus is polled before it counts as
/// stuck. The tries last at least 0.24 ms; the longest wait is for a byte of the serial port, 22
/// us.
pub const BUS_TRIES: u32 = 10_000;
/// The size of the queue of received bytes that wait for the application. A tick of the serial port
/// brings at most 768.
pub const RECEIVE_QUEUE: usize = 1024;
/// The size of the queue of bytes that wait for the USB host. The host fetches 63 bytes about every
/// 0.1 ms. If it is late, the queue holds some ten frames.
pub const USB_QUEUE: usize = 1024;
/// The size of the queue of bytes that wait for the Pico's UART: a frame and two answers. The line
/// carries 768 bytes in a tick.
pub const UART_QUEUE: usize = 256;
/// The largest number of messages that are taken in a tick, so that a flood delays no frame.
pub const MOST_MESSAGES_PER_TICK: usize = 4;
