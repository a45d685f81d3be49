//! What the application says of itself.

use double_pendulum::Error;
use embedded_io::ErrorType;

use crate::app::command::Command;
use crate::app::player::News;
use crate::app::warm_restart::WarmRestart;
use crate::display::Display;
use crate::display::controller::Found;
use crate::motion::settings::Settings;
use crate::protocol::{Field, LinkError};
use crate::scenes::SceneName;

/// What is worth a line in the log.
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
        /// Since this was last said.
        ticks: u32,
        /// Since reset.
        total: u32,
    },
    /// Damaged messages came over the link. Said at most once a second, too.
    Damaged {
        /// Since this was last said.
        messages: u32,
        /// Since reset.
        total: u32,
        /// What was wrong with the last one.
        last: LinkError,
    },
    /// The host sent bytes faster than they were taken. Said at most once a second, too.
    Lost {
        /// Since this was last said.
        bytes: u32,
        /// Since reset.
        total: u32,
    },
    /// A frame did not reach the panel, though the one before did.
    Panel(Panel),
    /// A panel answers.
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
    /// What becomes of the motion.
    Motion(News),
}

/// What takes the events of an application with such a panel and link.
pub trait Log<Panel: Display, Link: ErrorType>: FnMut(Event<Panel::Error, Link::Error>) {}

impl<Panel: Display, Link: ErrorType, F: FnMut(Event<Panel::Error, Link::Error>)> Log<Panel, Link> for F {}
