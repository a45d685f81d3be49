//! In the terminal: the panel as it is now, the keys sent as commands.

use std::io::stdout;
use std::time::{Duration, Instant};

use anyhow::ensure;
use firmware::protocol::Command;
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use ratatui::crossterm::style::Colored;
use ratatui::crossterm::{cursor, execute};

use super::DemoOptions;
use super::session::Session;
use super::view::draw;
use crate::console::cli::say;
use crate::emulator::process;

/// From one screenshot to the next: 30 per second.
const PERIOD: Duration = Duration::from_millis(33);
/// From one look at the link to the next: half a tick.
const LOOK: Duration = Duration::from_millis(8);

/// Shows the board until the user has seen enough; whether all was well.
pub fn run(options: &DemoOptions, mut session: Session) -> anyhow::Result<bool> {
    process::on_interrupt(|| {
        ratatui::restore();
        // It is too late to tell if this fails.
        let _ = execute!(stdout(), cursor::Show);
    });
    let terminal = ratatui::try_init()?;
    let outcome = show(options, &mut session, terminal);
    ratatui::try_restore()?;
    outcome?;
    finish(session)
}

fn show(options: &DemoOptions, session: &mut Session, mut terminal: DefaultTerminal) -> anyhow::Result<()> {
    let colours = !Colored::ansi_color_disabled();
    loop {
        session.hear()?;
        session.look()?;
        terminal.draw(|frame| draw(frame, session.source.name(), &session.screenshot, &session.readings, colours))?;
        let is_over = options.seconds.is_some_and(|seconds| session.seconds() >= seconds);
        if is_over || keys(session)? {
            return Ok(());
        }
    }
}

/// Until the next screenshot is due: does what the keys ask for. Whether the user wants to quit.
fn keys(session: &mut Session) -> anyhow::Result<bool> {
    let due = Instant::now() + PERIOD;
    loop {
        session.hear()?;
        let left = due.saturating_duration_since(Instant::now());
        if !event::poll(left.min(LOOK))? {
            if left.is_zero() {
                return Ok(false);
            }
            continue;
        }
        match event::read()? {
            Event::Key(KeyEvent { kind: KeyEventKind::Release, .. }) => {}
            Event::Key(KeyEvent { code: KeyCode::Char('q') | KeyCode::Esc, .. }) => return Ok(true),
            Event::Key(KeyEvent { code: KeyCode::Char('c'), modifiers: KeyModifiers::CONTROL, .. }) => return Ok(true),
            Event::Key(KeyEvent { code, .. }) => obey(session, code)?,
            _ => {}
        }
    }
}

fn obey(Session { source, readings, .. }: &mut Session, code: KeyCode) -> anyhow::Result<()> {
    match code {
        KeyCode::Up => source.send(Command::Heavier),
        KeyCode::Down => source.send(Command::Lighter),
        KeyCode::Left => source.send(Command::TurnLeft),
        KeyCode::Right => source.send(Command::TurnRight),
        KeyCode::Char(' ') | KeyCode::Enter => source.send(Command::Restart),
        KeyCode::Tab | KeyCode::Char('n') => source.send(Command::NextScene),
        KeyCode::BackTab | KeyCode::Char('N') => source.send(Command::PreviousScene),
        KeyCode::Char('p') => source.send(Command::TogglePause),
        KeyCode::Char('.') => source.send(Command::Step(1)),
        KeyCode::Char('?') => {
            readings.help = !readings.help;
            Ok(())
        }
        _ => Ok(()),
    }
}

/// With the terminal as it was: completes the files and says how it went.
fn finish(mut session: Session) -> anyhow::Result<bool> {
    session.finish()?;
    ensure!(session.readings.frame.is_some(), "{}: no frame came", session.source.name());
    say(session.readings.report())?;
    Ok(session.readings.comparison.difference().is_none())
}
