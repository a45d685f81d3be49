//! What the application says of itself.

use double_pendulum::Error;
use embedded_io::ErrorType;

use crate::app::{News, WarmRestart};
use crate::display::{Display, Found};
use crate::motion::Settings;
use crate::protocol::{Command, Field, LinkError};
use crate::scenes::SceneName;

/// What is worth a line in the log. Totals are since reset, what is beside them since it was last said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event<Panel, Link> {
    /// The board has restarted by itself; whether it plays what it played before.
    Restarted(WarmRestart, bool),
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
    /// The step is too long for the scene's motion, which has left the finite numbers; it stands at its last good
    /// frame until it is started again.
    Stopped(Error),
    /// The step is longer than this, s, the longest that resolves every motion of the energy of what was asked for.
    StepTooLong(f64),
    Motion(News),
}

/// What takes the events of an application with such a panel and link.
pub trait Log<Panel: Display, Link: ErrorType>: FnMut(Event<Panel::Error, Link::Error>) {}

impl<Panel: Display, Link: ErrorType, F: FnMut(Event<Panel::Error, Link::Error>)> Log<Panel, Link> for F {}
