//! In the terminal: the panel as it is now, the keys sent as commands.

use std::io::stdout;
use std::time::{Duration, Instant};

use firmware::config::TICK_RATE;
use firmware::protocol::Command;
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use ratatui::crossterm::style::Colored;
use ratatui::crossterm::{cursor, execute};

use super::session::Session;
use super::view::draw;
use crate::emulator::process;

/// From one look at the link to the next: a tick, for a board that is emulated frame by frame goes no faster than a real one.
const LOOK: Duration = Duration::from_nanos(1_000_000_000 / TICK_RATE as u64);

/// Shows the board for so long, or until the user has seen enough.
pub fn watch(session: &mut Session, seconds: f64) -> anyhow::Result<()> {
    process::on_interrupt(|| {
        ratatui::restore();
        // It is too late to tell if this fails.
        let _ = execute!(stdout(), cursor::Show);
    });
    let terminal = ratatui::try_init()?;
    let outcome = show(session, seconds, terminal);
    ratatui::try_restore()?;
    outcome
}

fn show(session: &mut Session, seconds: f64, mut terminal: DefaultTerminal) -> anyhow::Result<()> {
    let colours = !Colored::ansi_color_disabled();
    let mut is_due = false;
    while session.seconds() < seconds {
        let heard = Instant::now();
        session.hear()?;
        // 30 screenshots a second.
        is_due = !is_due;
        if is_due {
            session.look()?;
            terminal.draw(|frame| {
                draw(
                    frame,
                    session.name(),
                    &session.screenshot,
                    &session.readings,
                    colours,
                )
            })?;
        }
        while event::poll(LOOK.saturating_sub(heard.elapsed()))? {
            match event::read()? {
                Event::Key(KeyEvent {
                    kind: KeyEventKind::Release,
                    ..
                }) => {}
                Event::Key(KeyEvent {
                    code: KeyCode::Char('q') | KeyCode::Esc,
                    ..
                }) => return Ok(()),
                Event::Key(KeyEvent {
                    code: KeyCode::Char('c'),
                    modifiers: KeyModifiers::CONTROL,
                    ..
                }) => {
                    return Ok(());
                }
                Event::Key(KeyEvent { code, .. }) => execute(session, code)?,
                _ => {}
            }
        }
    }
    Ok(())
}

fn execute(
    Session {
        source, readings, ..
    }: &mut Session,
    code: KeyCode,
) -> anyhow::Result<()> {
    source.send(match code {
        KeyCode::Up => Command::Heavier,
        KeyCode::Down => Command::Lighter,
        KeyCode::Left => Command::TurnLeft,
        KeyCode::Right => Command::TurnRight,
        KeyCode::Char(' ') | KeyCode::Enter => Command::Restart,
        KeyCode::Tab | KeyCode::Char('n') => Command::NextScene,
        KeyCode::BackTab | KeyCode::Char('N') => Command::PreviousScene,
        KeyCode::Char('p') => Command::TogglePause,
        KeyCode::Char('.') => Command::Step(1),
        _ => {
            readings.help ^= code == KeyCode::Char('?');
            return Ok(());
        }
    })
}
