//! The events that the application logs, and the counters that limit their rate.

use embedded_io::ErrorType;

use crate::app::PlannerEvent;
use crate::config::TICK_RATE;
use crate::display::{Display, Found};
use crate::motion::Settings;
use crate::protocol::{Command, Field, LinkError, Restarted};
use crate::scenes::SceneName;

/// An event for the log. Totals are since reset, and wrap; the other counts are since the last
/// event of that kind. `Panel` and `Link` are the types of the errors of the panel and of the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event<Panel, Link> {
    /// The board has restarted on its own. True if it plays the same scene as before; false if the
    /// restarts in a row are too many, or if that scene cannot be played.
    Restarted(Restarted, bool),
    /// A command, of a button or from the link, has started a scene with these settings, whose
    /// angles are in degrees. The first scene, and one that is resumed after a restart, have no
    /// such event.
    Started(SceneName, Settings),
    /// The command of a button is impossible because of this field. Nothing changes. (A command
    /// from the link gets an answer instead.)
    Refused(Command, Field),
    /// This number of ticks has passed without a frame. It is logged at most once a second, so that
    /// logging does not cause further delay.
    Dropped { ticks: u32, total: u32 },
    /// Damaged messages came over the link; `last` is the error of the latest. It is logged at most
    /// once a second.
    Damaged {
        messages: u32,
        total: u32,
        last: LinkError,
    },
    /// The host has sent bytes faster than they were taken. It is logged at most once a second.
    Lost { bytes: u32, total: u32 },
    /// The driver of the panel has returned an error with a frame: the first one, or one after a
    /// frame without an error. The error may be about earlier frames ([`Display::flush`]). Further
    /// errors in a row, also different ones, are not logged.
    Panel(Panel),
    /// The panel answers for the first time, or again.
    PanelFound(Found),
    /// A message did not reach the link: the first one, or one after a message that did. Further
    /// failures in a row are not logged, and neither is the next success.
    Link(Link),
    /// A host has requested a motion, and its computation begins. A request that is refused has no
    /// event.
    Asked,
    /// The scene's motion is too fast for this chip, or for the method that the user has selected:
    /// at its start by a command, or later, when it has left the finite numbers. The scene does not
    /// advance until it is started again. The first scene, and one that is resumed after a restart,
    /// have no such event at their start.
    Stopped,
    /// The step of the requested motion is longer than this, s: the longest step that resolves
    /// every motion of its energy. The motion is computed all the same.
    StepTooLong(f64),
    /// The planner has a result, or a method begins to compute the motion that is shown.
    Motion(PlannerEvent),
}

/// A function that takes the events of an application with this panel and link, one at a time, in
/// their order. It is called in the middle of the application's work, which waits for it, and
/// returns nothing.
pub trait Log<Panel: Display, Link: ErrorType>: FnMut(Event<Panel::Error, Link::Error>) {}

impl<Panel: Display, Link: ErrorType, F: FnMut(Event<Panel::Error, Link::Error>)> Log<Panel, Link>
    for F
{
}

/// A count that wraps, and whose growth is reported at most once a second.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ThrottledCounter {
    /// The count itself, which may also be set.
    pub(super) total: u32,
    /// The total at the last report, and the tick of that report.
    reported: u32,
    tick: u32,
}

impl ThrottledCounter {
    /// Creates a count that is `total` at this tick of the clock, as if it were reported now. The
    /// default is `total` 0 at tick 0.
    pub(super) fn starting(total: u32, tick: u32) -> Self {
        Self {
            total,
            reported: total,
            tick,
        }
    }

    /// Raises the count, without a report.
    pub(super) fn add(&mut self, count: u32) {
        self.total = self.total.wrapping_add(count);
    }

    /// Returns the growth since the last report, if it is not zero and a second, 60 ticks, has
    /// passed since then; this is the next report. Otherwise returns `None`, and the growth is
    /// kept. `tick` is the present tick of the clock, which may wrap.
    pub(super) fn news(&mut self, tick: u32) -> Option<u32> {
        let grown = self.total.wrapping_sub(self.reported);
        let is_time = grown != 0 && tick.wrapping_sub(self.tick) >= TICK_RATE;
        is_time.then(|| {
            *self = Self::starting(self.total, tick);
            grown
        })
    }
}

/// The state of a repeated operation: true if its last attempt failed; the default is false. Only
/// the first failure in a row is reported.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FaultEdge(bool);

impl FaultEdge {
    /// Takes the result of an attempt, and calls `say` with a first failure.
    pub(super) fn note<E>(&mut self, result: Result<(), E>, say: impl FnOnce(E)) {
        let failed_before = core::mem::replace(&mut self.0, result.is_err());
        if let Err(error) = result
            && !failed_before
        {
            say(error);
        }
    }
}
