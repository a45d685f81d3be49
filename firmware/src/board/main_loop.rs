//! The application of every board, its main loop and its log.

use core::fmt::Debug;
use core::mem::MaybeUninit;

use defmt::Debug2Format;
use double_pendulum::plan::Plan;
use embedded_io::Write;

use super::{Clock, Receiver, cycles};
use crate::app::{App, Event};
use crate::controls::Buttons;
use crate::display::Display;
use crate::planner::Finding;
use crate::settings::Settings;
use crate::sheets::Sheets;

/// Makes the application as it is switched on, at its place.
pub fn application<'a, Panel, Link, Keys>(
    place: &'a mut MaybeUninit<App<'a, Panel, Link, Keys>>,
    sheets: &'a mut Sheets,
    panel: Panel,
    link: Link,
    keys: Keys,
) -> &'a mut App<'a, Panel, Link, Keys>
where
    Panel: Display,
    Link: Write,
    Keys: Buttons,
{
    match App::new(Settings::default(), sheets, panel, link, keys) {
        Ok(app) => place.write(app),
        Err(error) => {
            defmt::error!("{}", error);
            panic!("the first settings describe no pendulum")
        }
    }
}

/// Runs the application for ever; between ticks it works for the host, or sleeps.
///
/// Kept apart from the start-up code, which may panic; this may not (test `no_panic`).
#[inline(never)]
pub fn run<Panel, Link, Keys>(app: &'static mut App<Panel, Link, Keys>, mut receiver: Receiver, clock: Clock) -> !
where
    Panel: Display<Error: Debug>,
    Link: Write,
    Keys: Buttons,
{
    app.use_stopwatch(cycles);
    app.use_tick(clock.period());
    let mut now = clock.ticks();
    app.count_from(now, 0);
    loop {
        while !app.run_to(now, log) {}
        app.receive(&mut receiver, log);
        while clock.ticks() == now && app.work(log) {}
        while app.plan(clock.left_after(now), log) {}
        now = clock.wait_after(now);
    }
}

/// Writes one event to the log.
fn log<Panel: Debug, Link: Debug>(event: Event<Panel, Link>) {
    match event {
        Event::Started(scene, settings) => defmt::info!("start: {} with {}", scene, settings),
        Event::Refused(command, field) => defmt::warn!("refused {}: {}", command, field),
        Event::Dropped { ticks, total } => defmt::warn!("dropped {} pictures, {} since reset", ticks, total),
        Event::Panel(error) => defmt::error!("panel: {}", Debug2Format(&error)),
        Event::Damaged { messages, total, last } => {
            defmt::warn!("{} damaged messages, {} since reset, the last: {}", messages, total, last);
        }
        Event::Stopped(error) => defmt::error!("stopped: {}", error),
        Event::Coarse(step) => defmt::warn!("the step is too long for this energy, {} s would do", step),
        Event::Found(Finding::Plan(Plan { way, steps, error, cycles, horizon, limit, .. })) => defmt::info!(
            "plan: {=str}, {} steps to a picture, {} pixels off until {} s ({=str}), {} cycles a picture",
            way.name(),
            steps,
            error,
            horizon,
            limit.name(),
            cycles,
        ),
        Event::Found(Finding::Shown { shown: Plan { way, steps, error, cycles, horizon, .. }, plan }) => defmt::info!(
            "shown: {=str}, {} steps to a picture, {} pixels off until {} s ({=str}), {} cycles a picture",
            way.name(),
            steps,
            error,
            horizon,
            if plan.horizon > horizon { "the plan is right for longer" } else { "as long as the plan" },
            cycles,
        ),
        Event::Found(Finding::Refused(error)) => defmt::warn!("no plan: {}", error),
        Event::Asked => defmt::info!("computing a motion on request"),
        Event::Link(error) => defmt::error!("serial link: {}", Debug2Format(&error)),
    }
}
