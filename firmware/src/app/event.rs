//! The events that the application logs, and the counters that limit their rate.

use embedded_io::ErrorType;

use crate::app::PlannerEvent;
use crate::config::TICK_RATE;
use crate::display::{Display, Found};
use crate::motion::Settings;
use crate::protocol::{Command, Field, LinkError, Restarted};
use crate::scenes::SceneName;

/// Totals are since reset, and wrap; the other counts are since the last event of that kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event<Panel, Link> {
    /// The board has restarted on its own. True if it plays the same scene as before.
    Restarted(Restarted, bool),
    /// A command has started a scene.
    Started(SceneName, Settings),
    /// The command of a button is impossible because of this field. (A command from the link gets
    /// an answer instead.)
    Refused(Command, Field),
    /// This number of ticks has passed without a frame. Logged at most once a second, so that
    /// logging causes no further delay.
    Dropped {
        ticks: u32,
        total: u32,
    },
    /// Damaged messages came over the link; `last` is the error of the latest.
    Damaged {
        messages: u32,
        total: u32,
        last: LinkError,
    },
    /// The host has sent bytes faster than they were taken.
    Lost {
        bytes: u32,
        total: u32,
    },
    /// The first error of several in a row of the panel.
    Panel(Panel),
    /// The panel answers for the first time, or again.
    PanelFound(Found),
    /// The first of several messages in a row that did not reach the link.
    Link(Link),
    /// A host has requested a motion, and its computation begins.
    Asked,
    /// The scene's motion is too fast for this chip, or for the method that the user has selected.
    Stopped,
    /// The board could not keep the speed, and has lowered it to this one.
    Slowed(f32),
    /// The longest step that resolves every motion of that energy, s. The motion is computed all
    /// the same.
    StepTooLong(f64),
    Motion(PlannerEvent),
}

pub trait Log<Panel: Display, Link: ErrorType>: FnMut(Event<Panel::Error, Link::Error>) {}

impl<Panel: Display, Link: ErrorType, F: FnMut(Event<Panel::Error, Link::Error>)> Log<Panel, Link>
    for F
{
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ThrottledCounter {
    pub(super) total: u32,
    reported: u32,
    tick: u32,
}

impl ThrottledCounter {
    pub(super) fn starting(total: u32, tick: u32) -> Self {
        Self {
            total,
            reported: total,
            tick,
        }
    }

    pub(super) fn add(&mut self, count: u32) {
        self.total = self.total.wrapping_add(count);
    }

    /// Returns the growth since the last report, if a second has passed since then.
    pub(super) fn news(&mut self, tick: u32) -> Option<u32> {
        let grown = self.total.wrapping_sub(self.reported);
        let is_time = grown != 0 && tick.wrapping_sub(self.tick) >= TICK_RATE;
        is_time.then(|| {
            *self = Self::starting(self.total, tick);
            grown
        })
    }
}

/// True if the last attempt of a repeated operation failed. Only the first failure in a row is
/// reported.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FaultEdge(bool);

impl FaultEdge {
    pub(super) fn note<E>(&mut self, result: Result<(), E>, say: impl FnOnce(E)) {
        let failed_before = core::mem::replace(&mut self.0, result.is_err());
        if let Err(error) = result
            && !failed_before
        {
            say(error);
        }
    }
}
