//! The tunable numbers, with their units and the reasons for their values.

use double_pendulum::plan::{Budget, Costs, Problem};

// ---- Time ---------------------------------------------------------------------------------------

/// The number of ticks per second: of the clock, and at full speed of the scene. A tick of the
/// scene advances the motion by 1/60 s.
pub const TICK_RATE: u32 = 60;
/// The smallest number of RK4 steps per tick of the scene, of a motion that is shown for comparison
/// and follows no plan. With this number a step is [`DT`] long.
///
/// In `figure-7` the misprinted motion takes 2 to 8 steps, as many as resolve it in that tick. In
/// `upright` the number is fixed at the start; a motion of high energy has more steps.
pub const STEPS_PER_TICK: u32 = 2;
/// The length of a step at [`STEPS_PER_TICK`] steps per tick, s: 1/120.
pub const DT: f64 = 1.0 / (TICK_RATE * STEPS_PER_TICK) as f64;
/// The largest number of ticks of the scene before a frame is drawn. So a board that keeps up with
/// the motion, but not with drawing every frame, still shows 60/15 = 4 frames per second. The other
/// ticks are completed before the next frame; none is skipped.
pub const MOST_TICKS_PER_FRAME: u32 = 15;

/// The time without a finished frame that counts as a hang, s. It is four times the time of the
/// slowest frame allowed, 15/60 s.
///
/// A watchdog of two stages (LM3S6965) reports a hang after this time, and resets the board
/// after twice this time. One without an interrupt (Pico, STM32F405) does nothing until it resets
/// the board after twice this time; by the STM32F405's own oscillator that is 1.4 to 3.8 s.
pub const WATCHDOG_SECONDS: u32 = 1;

/// The number of ticks without a key after which the panel is dimmed: ten minutes. OLED pixels that
/// are always lit age sooner than the others.
pub const DIM_TICKS: u32 = 10 * 60 * TICK_RATE;

/// The largest speed of a scene, simulated time per real time. At 4 ticks of the scene per tick
/// even the Cortex-M3 still shows most frames. The smallest speed is 1/100.
pub const GREATEST_SPEED: u32 = 4;

// ---- Accuracy -----------------------------------------------------------------------------------

/// The tolerance of a frame, pixels. In an accurate frame both bobs, and so all points of the rods,
/// are within this distance of their positions in the exact motion from the same start. Panel, plan
/// and log use the same tolerance.
pub const HALF_PIXEL: f32 = 0.5;

// ---- The plan -----------------------------------------------------------------------------------

/// The simulated time that is planned for each scene, s. It is longer than the most energetic
/// motion can be predicted in 64 bits.
///
/// A motion that is accurate for all of this time is verified further while the scene runs. The
/// verification stays ahead of the scene by this time.
pub const PLANNED: f64 = 30.0;
/// The number of ticks of the scene after its start in which nothing is planned. While a held
/// button repeats, it restarts the scene sooner than that at full speed, so that nothing is planned
/// for scenes that end at once.
pub const SETTLED_TICKS: u64 = 6;
const _: () = assert!(SETTLED_TICKS > REPEAT_PERIOD_TICKS as u64);
/// The largest cost of the steps in a piece of the search ([`Search::advance`]), cycles of the
/// price list. A single step may exceed it. The least charge for a piece is [`Processor::piece`].
///
/// [`Search::advance`]: double_pendulum::plan::Search::advance
pub const PLANNING_PIECE: f32 = 20_000.0;

/// A class of processors with common prices and budgets, all in estimated cycles. A scene uses the
/// same methods on all processors of a class.
///
/// Nothing is checked here. A price or budget that is not finite and positive makes the planner
/// refuse every motion ([`PlanError::Refused`](double_pendulum::plan::PlanError::Refused)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Processor {
    /// The index in [`PROCESSORS`].
    pub code: u8,
    /// The price list: the cost of a step by each drawn method, cycles.
    pub costs: Costs,
    /// The budget for computing one tick of the scene, cycles. The rest of the time is for drawing
    /// and sending the frame. At a higher speed, a tick of the clock spends it several times. If it
    /// pays for no method, the motion counts as too fast.
    pub frame: f32,
    /// The budget for planning in each tick of the scene, cycles of the price list. The comparison
    /// of frames takes up to a quarter more in addition, which is not counted.
    pub look_ahead: f32,
    /// The work of the map of flips in a tick of the scene.
    pub flips: FlipsPace,
}

impl Processor {
    /// Returns true if the processor has a floating-point unit. It is recognised by the price list:
    /// with one, a step by `Rk4F32DirectionPlain` costs less than one by `Rk4Fixed32`. Equal
    /// prices, and a price that is NaN, count as without.
    pub fn has_float(&self) -> bool {
        self.costs.direction_plain < self.costs.fixed32
    }

    /// Returns the least number of cycles that a piece of planning, or a frame that is computed but
    /// not shown, is charged: the price of a frame by the closed form, at least 1,000. The steps
    /// may cost less than the work around them.
    pub fn piece(&self) -> f32 {
        self.costs.closed_form.max(1_000.0)
    }

    /// Returns the budgets of a problem, cycles of the price list: of each frame, and of all its
    /// planning. A frame lasts [`TICK_RATE`] / `problem.rate` ticks, and has that share of the
    /// budgets of a tick. Planning may spend [`look_ahead`](Self::look_ahead) in each tick until
    /// the last frame, so that the search stays ahead of the scene. A problem has at least one
    /// frame. It is not checked.
    pub fn budget(&self, problem: &Problem) -> Budget {
        let ticks = TICK_RATE as f32 / f32::from(problem.rate);
        Budget {
            frame: ticks * self.frame,
            planning: ticks * self.look_ahead * problem.frames() as f32,
        }
    }
}

/// A Cortex-M3, which has no floating-point unit. The budgets are for a clock of 50 MHz or more. At
/// 50 MHz a tick has 833,000 cycles: 200,000 for the motion, and 380,000 for planning.
pub const CORTEX_M3: Processor = Processor {
    code: 0,
    costs: Costs::CORTEX_M3,
    frame: 200_000.0,
    look_ahead: 380_000.0,
    flips: FIXED,
};
/// A Cortex-M0+, as on the Raspberry Pi Pico. It has no floating-point unit, and no instruction for
/// a product of 64 bits either. The budgets are for a clock of 125 MHz or more. At 125 MHz a tick
/// has 2,083,000 cycles: 330,000 for the motion, and 640,000 for planning.
///
/// In the map of flips, a start whose motion is computed counts four steps more than on a
/// Cortex-M3, so that a tick leaves time for the Pico's serial link.
pub const CORTEX_M0PLUS: Processor = Processor {
    code: 3,
    costs: Costs::CORTEX_M0PLUS,
    frame: 330_000.0,
    look_ahead: 640_000.0,
    flips: FlipsPace { start: 46, ..FIXED },
};
/// A Cortex-M4F, whose floating-point unit computes in `f32` only. The budgets are for a clock of
/// 25 MHz or more. At 25 MHz a tick has 417,000 cycles: 150,000 for the
/// motion, and 190,000 for planning.
pub const CORTEX_M4F: Processor = Processor {
    code: 1,
    costs: Costs::CORTEX_M4F,
    frame: 150_000.0,
    look_ahead: 190_000.0,
    flips: FLOAT,
};
/// The Cortex-M4F of the STM32F405, with the prices of [`CORTEX_M4F`]. The budgets are for its
/// clock of 168 MHz. A tick then has 2,800,000 cycles: 700,000 for the motion, and 1,300,000 for
/// planning. With less planning, the search would end before the errors of a pendulum with a light
/// bob 1 show.
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
/// The class of the processor that the program is compiled for, unless a board names another:
/// [`CORTEX_M4F`] with the hard-float ABI, [`CORTEX_M0PLUS`] for ARMv6-M, and otherwise, as on a
/// host, [`CORTEX_M3`].
pub const PROCESSOR: Processor = if cfg!(target_abi = "eabihf") {
    CORTEX_M4F
} else if cfg!(armv6m) {
    CORTEX_M0PLUS
} else {
    CORTEX_M3
};

// ---- The map of flips ---------------------------------------------------------------------------

/// The budget of the map of flips for a tick of the scene, and the costs that are charged to it,
/// all in steps of the motion. Nothing is checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlipsPace {
    /// The budget of a tick. Its last new start may exceed it, by less than the cost of that start.
    /// With 0 nothing is computed.
    pub steps: u32,
    /// The number of steps that a new start counts as if its motion must be computed. The steps of
    /// that motion count in addition.
    pub start: u32,
    /// The number of steps that a start counts as if it has not enough energy to turn over. It must
    /// not be 0: then one tick would do all such starts in a row.
    pub never: u32,
}
/// Fixed point. A step takes 920 cycles on a Cortex-M3 at 50 MHz, in all nearly half of a frame,
/// and 2,200 on a Cortex-M0+ at 125 MHz.
const FIXED: FlipsPace = FlipsPace {
    steps: 400,
    start: 42,
    never: 13,
};
/// `f32` on a Cortex-M4F. A step takes 230 cycles. A frame has 417,000 at 25 MHz, and 2,800,000 at
/// 168 MHz.
const FLOAT: FlipsPace = FlipsPace {
    steps: 650,
    start: 60,
    never: 10,
};

// ---- The pendulum -------------------------------------------------------------------------------

/// The length of either rod at power-on, m, and in the initial settings of all scenes except
/// `small-0.2`, `small-1` and `small-5`. It gives a period of about 2 s, which is pleasant to
/// watch.
pub const ROD: f64 = 1.0;
/// The gravity in the initial settings of all scenes except those of [`PAGE_GRAVITY`], m/s^2. A
/// command can change it.
pub const GRAVITY: f64 = 9.81;
/// The gravity of the source page, m/s^2. It is in the initial settings of the scenes that repeat
/// the page's own figures: `small-0.2`, `small-1`, `small-5` and `figure-7`.
pub const PAGE_GRAVITY: f64 = 9.8;
/// The mass ratio mu = m2/m1 at power-on, with m1 = 1 kg. It is also in the initial settings of
/// `page`, `frequencies`, `butterfly` and `flips`; the other scenes have their own.
pub const FIRST_MASS_RATIO: f64 = 1.0;
/// The start angle of both rods at power-on, degrees from the downward vertical. It is well in the
/// chaotic regime. The scenes that share it are those of [`FIRST_MASS_RATIO`].
pub const FIRST_ANGLE: f64 = 120.0;
/// The mass ratios that the buttons select, in ascending order.
///
/// They are the Renard series R10 (ISO 3), which is geometric with the ratio 10^(1/10) = 1.26 and
/// rounded so that every label is short. They cover two decades on either side of 1.
pub const MASS_RATIOS: [f64; 41] = [
    0.01, 0.0125, 0.016, 0.02, 0.025, 0.0315, 0.04, 0.05, 0.063, 0.08, //
    0.1, 0.125, 0.16, 0.2, 0.25, 0.315, 0.4, 0.5, 0.63, 0.8, //
    1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0, //
    10.0, 12.5, 16.0, 20.0, 25.0, 31.5, 40.0, 50.0, 63.0, 80.0, 100.0,
];
/// The change of the start angle by a press of left or right, degrees. The panel shows whole ones.
pub const ANGLE_STEP: f64 = 1.0;
/// The largest start angle, degrees: straight up. The smallest is its negative. The buttons stop
/// there, and commands refuse an angle beyond it.
pub const GREATEST_ANGLE: f64 = 180.0;

// ---- Buttons, in ticks of 1/60 s ----------------------------------------------------------------

/// The number of equal readings in a row, one per tick, that count as a level. 2 readings are 17 ms
/// apart, which is longer than contacts bounce. So no press of 1/30 s or longer is lost, unless the
/// board is late: it then reads for several ticks at almost the same time.
pub const DEBOUNCE_TICKS: u8 = 2;
/// The time after which a held button repeats for the first time, ticks: 24/60 = 0.4 s after the
/// tick in which the press is recognised.
pub const REPEAT_DELAY_TICKS: u8 = 24;
/// The time after which a held button repeats again, ticks: 4/60 s, or 15 repetitions per second.
pub const REPEAT_PERIOD_TICKS: u8 = 4;

/// The time after which the select button, held alone, acts, ticks: 48/60 = 0.8 s. It changes the
/// scene, or has the effect that the taps before it select (`app::Controls`). The tick in which the
/// press is recognised counts as the first.
pub const HOLD_TICKS: u8 = 48;
/// The longest time from the end of a tap to the next press that belongs to it, ticks:
/// 24/60 = 0.4 s. Both count when they are recognised, after [`DEBOUNCE_TICKS`] readings.
pub const MOST_TICKS_BETWEEN_TAPS: u8 = 24;

// ---- The frame, in pixels -----------------------------------------------------------------------

/// The position (x, y) of the pivot, pixels to the right of and down from the top left corner of
/// the panel; pixel i covers i to i + 1. It is the middle, so that the motion has the full height.
pub const PIVOT: (f32, f32) = (64.0, 32.0);
/// The length of both rods together, pixels: half the height less the largest bob and its soft
/// edge, 32 - 3 - 0.5.
pub const REACH: f32 = 28.5;
/// The radius of the heavier bob, pixels, at a reach of [`REACH`]; at another reach it is in
/// proportion. The radius of the lighter one is smaller by the cube root of the ratio of their
/// masses.
pub const GREATEST_RADIUS: f32 = 3.0;
/// The smallest radius of a bob, pixels, at any reach. A lighter one is not drawn smaller.
pub const LEAST_RADIUS: f32 = 1.5;
/// Half the width of a rod, pixels.
pub const ROD_HALF_WIDTH: f32 = 0.6;
/// Half the width of the trail of the scene `page`, pixels.
pub const TRAIL_HALF_WIDTH: f32 = 0.8;
/// The brightness of the trail at the bob, of 255. Its grey is 11 of 15.
pub const TRAIL_BRIGHTNESS: u8 = 184;
/// The number of the frame's 64 rows whose trail loses a grey in a tick of the scene. The last of
/// 11 greys is gone after 11 x 64/5 = 141 ticks, 2.3 s of motion.
pub const TRAIL_FADING: u8 = 5;

// ---- The serial link ----------------------------------------------------------------------------

/// The speed of the serial link, bits per second. A frame message of at most 94 bytes takes 94 x
/// 10/460,800 = 2.0 ms of the 16.7 ms of a tick.
pub const BAUD: u32 = 460_800;
/// The largest number of steps whose time is measured at once; a request for more measures this
/// number. They block the board, and may take longer than a tick, 16.7 ms. On a Cortex-M3 at 50 MHz
/// order 16 in 64 bits of fixed point takes 16 x 46,800/50e6 = 15 ms, and `rk4-f64` 21 ms. On a
/// Cortex-M0+ at 125 MHz order 16 takes 16 x 177,400/125e6 = 23 ms.
///
/// The number is not smaller because the measured time includes the call. On a Cortex-M4F a call of
/// `rk4-f32-direction` takes about 550 cycles in addition to its steps of 206. This adds 17 % to
/// each of 16 steps, and would add 67 % to each of 4.
pub const MOST_MEASURED_STEPS: u32 = 16;
/// The number of times in a row that a serial port or an SPI bus is polled before it counts as
/// stuck and the transfer fails. After each byte of the serial port the count begins again. A try
/// takes at least 4 processor cycles, so that the tries last 0.24 ms on the fastest board. The
/// longest wait is for a byte of the serial port, 10/460,800 s = 22 us.
pub const BUS_TRIES: u32 = 10_000;
/// The size, bytes, of the queue of received bytes that wait for the application. When it is full,
/// further ones are lost; over USB the host waits instead. A tick of the serial port brings at most
/// 460,800/10/60 = 768.
pub const RECEIVE_QUEUE: usize = 1024;
/// The size, bytes, of the queue of bytes that wait for the USB host. The host fetches 63 bytes
/// about every 0.1 ms. If it is late, the queue holds some ten frames. A message that does not fit
/// is dropped as a whole, without an error.
pub const USB_QUEUE: usize = 1024;
/// The size, bytes, of the queue of bytes that wait for the Pico's UART: a frame and two answers.
/// The line carries 768 bytes in a tick. A message that does not fit waits for room; after
/// 4 x [`BUS_TRIES`] tries, which take at least 8 ms, it is dropped as a whole with an error.
pub const UART_QUEUE: usize = 256;
/// The largest number of messages that are taken in a tick, commands and damaged ones together.
/// Others wait in the queue. When that is full, bytes are lost, and messages remain unanswered.
pub const MOST_MESSAGES_PER_TICK: usize = 4;
