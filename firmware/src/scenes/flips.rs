//! The map of flips: it shows for every start whether a rod turns over, and when. It is computed on
//! the board, coarse first.

use double_pendulum::flips::{Flip, Flips as Search, step_size};
use double_pendulum::parts::Falling;
// The methods for processors with and without a floating-point unit. A board links only the method
// of its own processor, for both.
#[cfg(target_abi = "eabihf")]
use double_pendulum::{DirectionF32Plain as WithFpu, DirectionF32Plain as WithoutFpu};
#[cfg(not(target_os = "none"))]
use double_pendulum::{DirectionF32Plain as WithFpu, Fixed32 as WithoutFpu};
use double_pendulum::{Error, Form};
#[cfg(all(target_os = "none", not(target_abi = "eabihf")))]
use double_pendulum::{Fixed32 as WithFpu, Fixed32 as WithoutFpu};

use crate::config::FlipsPace;
use crate::graphics::{Anchor, Canvas, Fading, Format, Palette, label, text};
use crate::motion::{Resources, Settings};
use crate::scenes::{Report, Scene, Shows, time};

/// The time that is searched for a flip, in units of sqrt(l1/g).
const LIMIT: f32 = 100.0;
/// The number of greys for the time of the flip, 2 to 15. They are on a logarithmic scale from
/// sqrt(l1/g) to the limit of 100 sqrt(l1/g); 15 is the soonest, and every flip before sqrt(l1/g).
/// Grey 1 means no flip before the limit, and black (0) means that no flip is possible.
pub const GREYS: u8 = 14;
const LATER: u8 = 1;

/// The size of the first blocks, cells across and down. The next blocks are half as large.
const COARSEST: i32 = 8;

/// The cells of the map, each of which shows one start: a pixel on an OLED, and a square of 2 x 2
/// on a larger panel, whose map would take minutes otherwise.
#[derive(Clone, Copy, Debug)]
struct Grid {
    /// The size of a cell, pixels.
    cell: i32,
    columns: i32,
    rows: i32,
}

impl Grid {
    fn of(format: Format) -> Self {
        let cell = format.units(1).max(1);
        Self {
            cell,
            columns: format.right() / cell,
            rows: format.bottom() / cell,
        }
    }

    /// Returns the number of rows to compute. The lower half of the map is the upper half turned by
    /// half a turn, because both starts are mirror images.
    fn computed_rows(self) -> i32 {
        (self.rows + 1) / 2
    }
}

/// The search in the processor's numbers, and the motion that it follows.
#[derive(Clone, Debug)]
enum Searching {
    WithFpu(Search<WithFpu>, Option<Falling<WithFpu>>),
    WithoutFpu(Search<WithoutFpu>, Option<Falling<WithoutFpu>>),
}

/// The map of flips, which fills the canvas: a1 across and a2 upwards, each from -180 to 180
/// degrees, and both rods at rest at the start. The start of a cell is in its middle. The brightness is the time of the first flip: the sooner, the brighter, grey 15 to 2
/// ([`GREYS`]). Grey 1 means no flip before 100 sqrt(l1/g), and black (0) that no flip is possible.
///
/// The map is computed coarse first. Until a cell is computed, it has the grey of a computed start
/// in the same block of 8 x 8, 4 x 4 or 2 x 2 cells, and before that it is black. The corners show
/// the progress, then the mass ratio, and the simulated time of the computation.
///
/// The ink contains the map. Of the settings only the pendulum matters, not its start. Zero gravity
/// is refused. A requested method is ignored.
#[derive(Clone, Debug)]
pub struct Flips {
    searching: Searching,
    pace: FlipsPace,
    grid: Grid,
    mass_ratio: f32,
    /// sqrt(l1/g), s.
    unit: f32,
    block: Block,
    /// The number of blocks that are done. When all are done, it is the number of pixels of the
    /// upper half.
    done: u32,
    /// The number of ticks until all was done.
    elapsed: u64,
}

/// A block of cells: its size, which is 0 when all is done, and its top left cell, whose start is
/// computed.
#[derive(Clone, Copy, Debug)]
struct Block {
    size: i32,
    x: i32,
    y: i32,
}

impl Block {
    /// Returns the next block, without those whose start was computed for a larger block.
    fn next(self, grid: Grid) -> Self {
        let Self {
            mut size,
            mut x,
            mut y,
        } = self;
        loop {
            // Go to the right, then down, then to blocks of half the size.
            x += size;
            if x >= grid.columns {
                x = 0;
                y += size;
            }
            if y >= grid.computed_rows() {
                size /= 2;
                x = 0;
                y = 0;
            }
            // A smaller block is new unless a larger block began at its cell.
            if size == 0 || size == COARSEST || (x | y) & size != 0 {
                return Self { size, x, y };
            }
        }
    }

    /// Returns the start angles of the block, rad: the middle of its top left cell.
    fn start(self, grid: Grid) -> [f32; 2] {
        // The cells are whole numbers, so that opposite starts are exact mirror images.
        let angle = |cells: i32, all: i32| cells as f32 * (core::f32::consts::PI / all as f32);
        [
            angle(2 * self.x + 1 - grid.columns, grid.columns),
            angle(grid.rows - 1 - 2 * self.y, grid.rows),
        ]
    }

    /// Fills the block and its mirror image with a grey.
    fn paint(self, grid: Grid, map: &mut Canvas, grey: u8) {
        let right = (self.x + self.size).min(grid.columns);
        let bottom = (self.y + self.size).min(grid.computed_rows());
        let rectangles = [
            [self.x, self.y, right, bottom],
            [
                grid.columns - right,
                grid.rows - bottom,
                grid.columns - self.x,
                grid.rows - self.y,
            ],
        ];
        for [left, top, right, bottom] in rectangles.map(|edges| edges.map(|edge| edge * grid.cell))
        {
            for y in top..bottom {
                if let Some(mut row) = map.row_mut(y, left..right) {
                    row.fill(left..right, grey);
                }
            }
        }
    }
}

impl Flips {
    /// Creates the map as [`Scene::new`] does, with `pace` as the work per tick, which may be that
    /// of another processor. With a budget of 0 steps it is never computed.
    ///
    /// On a host the map is computed in `f32` if `in_float`, and otherwise in fixed point. A board
    /// links only the method of its own processor, and uses it whatever `in_float` says. Of the
    /// settings only the parameters matter.
    ///
    /// # Errors
    ///
    /// Refuses parameters that describe no pendulum, zero gravity, because nothing moves without
    /// it, and a pendulum out of the range of the method's numbers.
    pub fn at_pace(
        settings: &Settings,
        pace: FlipsPace,
        in_float: bool,
        format: Format,
    ) -> Result<Self, Error> {
        // The search lasts for a fixed number of units of time.
        let parameters = &settings.parameters.cast();
        let unit = libm::sqrtf(parameters.l1 / parameters.g);
        let dt = step_size(parameters)?;
        let steps = (LIMIT * unit / dt as f32) as u32;
        let searching = if in_float {
            Searching::WithFpu(Search::new(parameters, dt, steps)?, None)
        } else {
            Searching::WithoutFpu(Search::new(parameters, dt, steps)?, None)
        };
        Ok(Self {
            searching,
            pace,
            grid: Grid::of(format),
            mass_ratio: settings.mass_ratio(),
            unit,
            block: Block {
                size: COARSEST,
                x: 0,
                y: 0,
            },
            done: 0,
            elapsed: 0,
        })
    }

    /// Returns true if all pixels are computed. Further ticks change nothing. With a budget of 0
    /// steps it is always false.
    pub fn is_done(&self) -> bool {
        self.block.size == 0
    }
}

/// Starts the motion from these angles, or makes at most `steps` steps of it. Returns the cost, in
/// steps, and the flip when it is known.
fn work<F: Form<Real = f32>>(
    search: &Search<F>,
    falling: &mut Option<Falling<F>>,
    [a1, a2]: [f32; 2],
    steps: u32,
    pace: FlipsPace,
) -> (u32, Option<Flip<f32>>) {
    // A new start costs more than a step, even if it can never flip.
    let Some(motion) = falling else {
        // The search refuses no angle of the map.
        *falling = Falling::start(search, a1, a2).ok().flatten();
        return if falling.is_some() {
            (pace.start, None)
        } else {
            (pace.never, Some(Flip::Never))
        };
    };

    // Follow the motion for the rest of the budget.
    let before = motion.steps;
    let flip = motion.advance(search, steps);
    let made = motion.steps.wrapping_sub(before);
    if flip.is_some() {
        *falling = None;
    }
    (made.max(1), flip)
}

/// Returns the grey of a flip, where `unit` is sqrt(l1/g), s.
fn grey(flip: Flip<f32>, unit: f32) -> u8 {
    match flip {
        Flip::Never => 0,
        Flip::Later => LATER,
        Flip::After(time) => {
            let level = libm::logf(time / unit) * (f32::from(GREYS) / libm::logf(LIMIT));
            15 - (level.max(0.0) as u8).min(GREYS - 1)
        }
    }
}

impl Scene for Flips {
    const SHOWS: Shows = Shows::Figure;
    const FADING: Fading = Fading::NEVER;
    const PALETTE: Palette = Palette::Map;

    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error> {
        Ok((
            Self::at_pace(
                settings,
                resources.processor.flips,
                resources.processor.has_float(),
                resources.format,
            )?,
            None,
        ))
    }

    fn tick(&mut self, ticks: u64, ink: &mut Canvas) {
        if self.is_done() {
            return;
        }
        self.elapsed = ticks;
        // Spend the budget of the tick, block by block.
        let mut left = self.pace.steps;
        while left > 0 && !self.is_done() {
            let start = self.block.start(self.grid);
            let pace = self.pace;
            let (cost, flip) = match &mut self.searching {
                Searching::WithFpu(search, falling) => work(search, falling, start, left, pace),
                Searching::WithoutFpu(search, falling) => work(search, falling, start, left, pace),
            };
            left = left.saturating_sub(cost);
            if let Some(flip) = flip {
                self.block.paint(self.grid, ink, grey(flip, self.unit));
                self.block = self.block.next(self.grid);
                self.done += 1;
            }
        }
    }

    fn draw(&self, _: &Report, canvas: &mut Canvas) {
        // The time of the computation.
        text::write_on(
            canvas,
            &label::time(time(self.elapsed)),
            Anchor::Right(0),
            text::WHITE_ON_BLACK,
        );

        // The progress, and the mass ratio at the end.
        let corner = if self.is_done() {
            label::mass_ratio(self.mass_ratio)
        } else {
            let all = ((self.grid.columns * self.grid.computed_rows()) as u32).max(1);
            label::label("", (100 * self.done / all) as f32, 0, " %")
        };
        text::write_on(canvas, &corner, Anchor::Left(0), text::WHITE_ON_BLACK);
    }
}
