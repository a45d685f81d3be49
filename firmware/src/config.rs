//! Every number that may be tuned, with its unit and the arithmetic behind it.

use double_pendulum::plan::{Budget, Costs, Problem};

use crate::prices;

// ---- Time -----------------------------------------------------------------------------------------------------------

/// Ticks per second: one tick moves the pendulum by one frame's worth of time.
pub const TICK_RATE: u32 = 60;
/// RK4 steps per tick, 1/120 s, of what a scene shows beside the motion that is planned.
pub const STEPS_PER_TICK: u32 = 2;
/// Their length, s.
pub const DT: f64 = 1.0 / (TICK_RATE * STEPS_PER_TICK) as f64;
/// The most ticks integrated before a frame is drawn: a board too slow for every frame still shows
/// 60/15 = 4 per second. Ticks beyond it wait for the next frame; none is ever skipped.
pub const MOST_TICKS_PER_FRAME: u32 = 15;

/// A board that finishes no frame for so long, s, hangs: four times as long as the slowest frame allowed, which is
/// 15/60 s. The watchdog says so then, and when as much time again has passed it resets the board.
pub const WATCHDOG_SECONDS: u32 = 1;

/// The fastest a scene may be played, simulated time per real time: at 4 ticks of the scene per tick even the Cortex-M3 still
/// shows most frames. The slowest is a hundredth.
pub const GREATEST_SPEED: u32 = 4;

// ---- What counts as right -------------------------------------------------------------------------------------------

/// A frame is right, on the panel's clock, in the plan and in the log alike, as long as nothing in it is farther, pixels,
/// from where the exact motion of the same start has it.
pub const HALF_PIXEL: f32 = 0.5;

// ---- The plan -------------------------------------------------------------------------------------------------------

/// For how long each scene is planned, s: longer than the most energetic motion can be predicted in 64 bits. One that is
/// right for so long is looked at farther as time goes on, always so far ahead.
pub const PLANNED: f64 = 30.0;
/// Ticks from the start of a scene until planning begins. A held button restarts the scene sooner than that.
pub const SETTLED_TICKS: u64 = 6;
const _: () = assert!(SETTLED_TICKS > REPEAT_PERIOD_TICKS as u64);
/// A piece of the search, cycles, unless a single step is more.
pub const PLANNING_PIECE: f32 = 20_000.0;

/// A class of processors, by what a plan must know of it: so that a scene goes by the same methods on all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Processor {
    /// Its place in [`PROCESSORS`].
    pub code: u8,
    /// The counter's estimates.
    pub costs: Costs,
    /// What computing a frame may cost, cycles; the rest is for drawing and sending it.
    pub frame: f32,
    /// What is spent in each tick on planning, cycles; comparing frames takes up to a quarter more.
    pub look_ahead: f32,
    pub flips: FlipsPace,
}

impl Processor {
    /// Whether it has a floating-point unit: else steps in fixed point cost less.
    pub fn has_float(&self) -> bool {
        self.costs.direction_plain < self.costs.fixed32
    }

    /// The least that a piece of planning takes, cycles, and a frame that is not shown: its steps may cost less than what
    /// is done around them.
    pub fn piece(&self) -> f32 {
        self.costs.closed_form.max(1_000.0)
    }

    /// What may be spent: on planning as much as the scene has ticks for, so that the search keeps ahead of it.
    pub fn budget(&self, problem: &Problem) -> Budget {
        Budget {
            frame: self.frame,
            planning: self.look_ahead * problem.frames() as f32,
        }
    }
}

/// A Cortex-M3, which has no floating-point unit: at 50 MHz a tick has 833,000 cycles.
pub const CORTEX_M3: Processor = Processor {
    code: 0,
    costs: prices::CORTEX_M3,
    frame: 200_000.0,
    look_ahead: 380_000.0,
    flips: FIXED,
};
/// A Cortex-M0+, which has no long product either, as on the Raspberry Pi Pico: at 125 MHz a tick has 2,083,000 cycles. A start of
/// the map counts four steps more, so that a tick of it leaves the Pico's port its share.
pub const CORTEX_M0PLUS: Processor = Processor {
    code: 3,
    costs: prices::CORTEX_M0PLUS,
    frame: 300_000.0,
    look_ahead: 640_000.0,
    flips: FlipsPace {
        steps: 400,
        start: 46,
        ..FIXED
    },
};
/// A Cortex-M4F, whose floating-point unit knows `f32` only: the slowest board, at 25 MHz, has 417,000 cycles in a tick. A
/// plain step costs less than the closed form's two sincos.
pub const CORTEX_M4F: Processor = Processor {
    code: 1,
    costs: prices::CORTEX_M4F,
    frame: 150_000.0,
    look_ahead: 190_000.0,
    flips: FLOAT,
};
/// The STM32F405's at 168 MHz: 2,800,000 cycles in a tick. Less planning ends before the errors of a light elbow show.
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
/// Every class, by its code on the wire.
pub const PROCESSORS: [Processor; 4] = [CORTEX_M3, CORTEX_M4F, STM32F405, CORTEX_M0PLUS];
/// The class of a board that names no other.
pub const PROCESSOR: Processor = if cfg!(target_abi = "eabihf") {
    CORTEX_M4F
} else if cfg!(armv6m) {
    CORTEX_M0PLUS
} else {
    CORTEX_M3
};

// ---- The map of flips -----------------------------------------------------------------------------------------------

/// What the map may take of each tick, in its own steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlipsPace {
    pub steps: u32,
    /// How many steps a new start counts as.
    pub start: u32,
    /// The same of a start that has not the energy to turn over.
    pub never: u32,
}
/// Fixed point: 920 cycles a step on a Cortex-M3 at 50 MHz, nearly half of a frame, and 2,200 on a Cortex-M0+ at 125 MHz.
const FIXED: FlipsPace = FlipsPace {
    steps: 400,
    start: 42,
    never: 13,
};
/// `f32` on a Cortex-M4F: 230 cycles a step, of 417,000 in a frame at 25 MHz, and of 2,800,000 at 168 MHz.
const FLOAT: FlipsPace = FlipsPace {
    steps: 650,
    start: 60,
    never: 10,
};

// ---- The pendulum ---------------------------------------------------------------------------------------------------

/// Length of either rod, m: a period of about 2 s, which is pleasant to watch.
pub const ROD: f32 = 1.0;
pub const GRAVITY: f64 = 9.81;
/// The source page's, m/s^2: where its own figures are shown, this is.
pub const PAGE_GRAVITY: f64 = 9.8;
/// Mass ratio mu = m2/m1 at power-on.
pub const FIRST_MASS_RATIO: f32 = 1.0;
/// Start angle of both rods at power-on, degrees: well into the chaotic regime.
pub const FIRST_ANGLE: f32 = 120.0;
/// The mass ratios the buttons step through: the Renard series R10 (ISO 3), geometric with ratio 10^(1/10) = 1.26 and
/// rounded so that every label is short, over two decades either side of 1.
pub const MASS_RATIOS: [f32; 41] = [
    0.01, 0.0125, 0.016, 0.02, 0.025, 0.0315, 0.04, 0.05, 0.063, 0.08, //
    0.1, 0.125, 0.16, 0.2, 0.25, 0.315, 0.4, 0.5, 0.63, 0.8, //
    1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0, //
    10.0, 12.5, 16.0, 20.0, 25.0, 31.5, 40.0, 50.0, 63.0, 80.0, 100.0,
];
/// The step of the start angle, degrees.
pub const ANGLE_STEP: f32 = 1.0;
/// The greatest start angle, degrees: straight up. The least is its mirror image.
pub const GREATEST_ANGLE: f32 = 180.0;

// ---- Buttons, in ticks of 1/60 s ------------------------------------------------------------------------------------

/// A level must be read this often in a row to count: 2 readings are 17 ms apart, longer than contacts bounce.
pub const DEBOUNCE_TICKS: u8 = 2;
/// A held button repeats for the first time after 24/60 = 0.4 s,
pub const REPEAT_DELAY_TICKS: u8 = 24;
/// and then every 4/60 s: 15 steps per second.
pub const REPEAT_PERIOD_TICKS: u8 = 4;

/// Select held alone for 48/60 = 0.8 s changes the scene.
pub const HOLD_TICKS: u8 = 48;
/// Taps and a hold belong together if no more than 24/60 = 0.4 s lie between them.
pub const MOST_TICKS_BETWEEN_TAPS: u8 = 24;

// ---- The frame, in pixels -----------------------------------------------------------------------------------------

/// Where the pivot sits, from the panel's top left corner: its middle, so that the motion has the full height.
pub const PIVOT: (f32, f32) = (64.0, 32.0);
/// Both rods stretched out reach this far: half the height less the largest bob and its soft edge, 32 - 3 - 0.5.
pub const REACH: f32 = 28.5;
/// Radius of the heavier bob. The lighter one's follows by volume.
pub const GREATEST_RADIUS: f32 = 3.0;
/// No bob is drawn smaller than this.
pub const LEAST_RADIUS: f32 = 1.5;
pub const ROD_HALF_WIDTH: f32 = 0.6;
pub const TRAIL_HALF_WIDTH: f32 = 0.8;
/// Brightness of the trail at the bob, of 255: its grey is 11.
pub const TRAIL_BRIGHTNESS: u8 = 184;
/// Rows of the trail that lose a grey in a tick: the last of 11 greys is gone after 11 x 64/5 = 141 ticks, 2.3 s of motion.
pub const TRAIL_FADING: u8 = 5;

// ---- The serial link ------------------------------------------------------------------------------------------------

/// Bits per second. A frame of at most 94 bytes takes 94 x 10/460,800 = 2.0 ms of the tick's 16.7 ms.
pub const BAUD: u32 = 460_800;
/// Steps that are measured at once, at most: of order 8 in `f64` they keep a Cortex-M3 at 50 MHz from everything else for
/// 16 x 136,500/50e6 = 44 ms.
pub const MOST_MEASURED_STEPS: u32 = 16;
/// How often a bus is asked whether it is done before it counts as stuck. A try takes at least 4 processor cycles, so this is
/// 0.24 ms of the fastest board; the slowest thing waited for is a byte of the serial port, 10/460,800 s = 22 us.
pub const BUS_TRIES: u32 = 10_000;
/// Received bytes waiting for the application; one tick brings at most 460,800/10/60 = 768.
pub const RECEIVE_QUEUE: usize = 1024;
/// Bytes waiting for the USB host, which fetches 63 about every 0.1 ms: a dozen frames, should it be late.
pub const USB_QUEUE: usize = 1024;
/// Bytes on their way to the Pico's UART: a frame and two answers. The line takes 768 in a tick.
pub const UART_QUEUE: usize = 256;
/// Messages executed per tick at most; more wait in the queue, and when that is full are lost and never answered.
pub const MOST_MESSAGES_PER_TICK: usize = 4;
