//! The host's own copy of what a board plays: the same scene code, started as the board says, moved and drawn here.

use std::fmt;

use firmware::app::Player;
use firmware::config::{PROCESSOR, PROCESSORS};
use firmware::graphics::{Canvas, text};
use firmware::motion::Settings;
use firmware::protocol::{Field, Frame, NO_METHOD, Status};
use firmware::scenes::SceneName;

use crate::emulator::host::sheets;
use crate::emulator::qemu::Screenshot;

#[derive(Debug)]
pub struct Mirror {
    player: Player<'static>,
    canvas: Canvas,
}

impl Mirror {
    /// Plays what the board plays, from its start; the field of it that cannot be.
    pub fn of(status: &Status) -> Result<Self, Field> {
        let processor = PROCESSORS.get(usize::from(status.processor)).copied().unwrap_or(PROCESSOR);
        let mut player = Player::on(processor, SceneName::Page, Settings::default(), &mut sheets().ink)?;
        player.resume(&start_of(status))?;
        Ok(Self { player, canvas: Canvas::default() })
    }

    /// Goes on to the step of `frame`, at most this many ticks; whether it is there.
    pub fn advance(&mut self, frame: &Frame, most: u32) -> bool {
        let left = |player: &Player| frame.step.wrapping_sub(player.report().step as u32) as i32;
        for _ in 0..most {
            if left(&self.player) <= 0 {
                return true;
            }
            self.player.tick(|_| ());
            if self.player.check().is_err() || self.player.is_paused() {
                return true;
            }
        }
        left(&self.player) <= 0
    }

    /// The first number of the board's `frame` that is not this one's.
    pub fn difference(&self, frame: &Frame) -> Option<Difference> {
        let pairs = numbers(frame).into_iter().zip(numbers(&self.player.frame()));
        let (number, here) = pairs.into_iter().find(|(board, here)| board != here)?;
        Some(Difference { sequence: frame.sequence, step: frame.step, number: number.0, board: number.1, here: here.1 })
    }

    /// The panel as the board's `frame` shows it.
    pub fn panel(&mut self, frame: &Frame) -> Screenshot {
        self.player.draw(&mut self.canvas);
        if frame.paused != 0 {
            text::pause_mark(&mut self.canvas);
        }
        Screenshot::from(&self.canvas)
    }
}

/// What is played by its start alone: how its time goes is another matter.
pub fn start_of(status: &Status) -> Status {
    let (method, way_steps, cycles, horizon, is_looking) = (NO_METHOD, 0, 0.0, 0.0, 0);
    Status { request: 0, paused: 0, steps: 0, speed: 1.0, method, way_steps, cycles, horizon, is_looking, ..*status }
}

/// A number that board and host do not have alike, by its bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    sequence: u32,
    step: u32,
    number: &'static str,
    board: u64,
    here: u64,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sequence, step, number, board, here } = self;
        write!(f, "frame {sequence}, step {step}: {number} is {board:#x}, the host's {here:#x}")
    }
}

fn numbers(frame: &Frame) -> [(&'static str, u64); 11] {
    let [a1, a2, p1, p2] = frame.state.map(|number| u64::from(number.to_bits()));
    [
        ("scene", frame.scene.into()),
        ("step", frame.step.into()),
        ("time", frame.time.to_bits()),
        ("mass ratio", frame.mass_ratio.to_bits().into()),
        ("start angle", frame.start_angle.to_bits().into()),
        ("a1", a1),
        ("a2", a2),
        ("p1", p1),
        ("p2", p2),
        ("energy error", frame.energy_error.to_bits().into()),
        ("horizon", frame.horizon.to_bits().into()),
    ]
}
