//! What the application says of itself: what is news, and not again and again.

use embedded_io::ErrorType;

use crate::app::PlannerEvent;
use crate::config::TICK_RATE;
use crate::display::{Display, Found};
use crate::motion::Settings;
use crate::protocol::{Command, Field, LinkError, Restarted};
use crate::scenes::SceneName;

/// What is worth a line in the log. Totals are since reset, what is beside them since it was last said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event<Panel, Link> {
    /// The board has restarted by itself; whether it plays what it played before.
    Restarted(Restarted, bool),
    /// A scene starts with these settings.
    Started(SceneName, Settings),
    /// This is not possible because of this; all goes on as it was.
    Refused(Command, Field),
    /// Ticks passed without a frame. Said at most once a second, so that saying it does not make it worse.
    Dropped {
        ticks: u32,
        total: u32,
    },
    /// Damaged messages came over the link. Said at most once a second, too.
    Damaged {
        messages: u32,
        total: u32,
        last: LinkError,
    },
    /// The host sent bytes faster than they were taken. Said at most once a second, too.
    Lost {
        bytes: u32,
        total: u32,
    },
    /// A frame did not reach the panel, though the one before did.
    Panel(Panel),
    PanelFound(Found),
    /// A frame did not reach the link, though the one before did.
    Link(Link),
    /// A motion is asked for over the link.
    Asked,
    /// The scene's motion is too fast for this chip, or for the method that the user has selected.
    /// It stands still until it is started again.
    Stopped,
    /// The step is longer than this, s, the longest that resolves every motion of the energy of what was asked for.
    StepTooLong(f64),
    Motion(PlannerEvent),
}

/// What takes the events of an application with such a panel and link.
pub trait Log<Panel: Display, Link: ErrorType>: FnMut(Event<Panel::Error, Link::Error>) {}

impl<Panel: Display, Link: ErrorType, F: FnMut(Event<Panel::Error, Link::Error>)> Log<Panel, Link>
    for F
{
}

/// A count that wraps. How it has grown is said at most once a second, so that saying it does not make it worse.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ThrottledCounter {
    pub(super) total: u32,
    said: u32,
    tick: u32,
}

impl ThrottledCounter {
    /// Counts from `total` on, at this tick.
    pub(super) fn starting(total: u32, tick: u32) -> Self {
        Self {
            total,
            said: total,
            tick,
        }
    }

    pub(super) fn add(&mut self, count: u32) {
        self.total = self.total.wrapping_add(count);
    }

    /// By how much it has grown, if it has and it is time to say so.
    pub(super) fn news(&mut self, tick: u32) -> Option<u32> {
        let grown = self.total.wrapping_sub(self.said);
        let is_time = grown != 0 && tick.wrapping_sub(self.tick) >= TICK_RATE;
        is_time.then(|| {
            *self = Self::starting(self.total, tick);
            grown
        })
    }
}

/// Whether something that is done again and again fails; said only when it did not fail before.
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
