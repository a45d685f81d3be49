//! The live view in the terminal: the current panel, with the keys sent as commands.

use std::io::{self, stdout};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use firmware::config::TICK_RATE;
use firmware::protocol::Command;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use ratatui::crossterm::style::Colored;
use ratatui::crossterm::terminal::{
    Clear, ClearType, EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode,
    enable_raw_mode, size,
};
use ratatui::crossterm::{cursor, execute};
use ratatui::layout::Rect;
use ratatui::{DefaultTerminal, TerminalOptions, Viewport};

use super::options::scene_of_key;
use super::readings::Help;
use super::session::{Session, faster, slower};
use super::view::draw;
use boards::process;

/// The interval between two reads of the link: a tick, because a board that is emulated frame by
/// frame is no faster than a real one.
const LOOK: Duration = Duration::from_nanos(1_000_000_000 / TICK_RATE as u64);

/// Shows the board until the time is over or the user quits. The terminal is restored in each case.
pub fn watch(session: &mut Session, seconds: f64) -> anyhow::Result<()> {
    // Ctrl-C must leave a usable terminal.
    process::on_interrupt(|| {
        ratatui::restore();

        // A failure cannot be reported any more.
        let _ = execute!(stdout(), cursor::Show);
    });
    let outcome = show(session, seconds, init()?);
    ratatui::try_restore()?;
    outcome
}

/// The size of a terminal that does not know its own, such as a serial console.
const USUAL_SIZE: Rect = Rect::new(0, 0, 80, 24);

fn init() -> io::Result<DefaultTerminal> {
    if !matches!(size(), Ok((0, _) | (_, 0))) {
        return ratatui::try_init();
    }
    let viewport = Viewport::Fixed(USUAL_SIZE);
    let terminal = ratatui::try_init_with_options(TerminalOptions { viewport })?;
    execute!(stdout(), EnterAlternateScreen, Clear(ClearType::All))?;
    Ok(terminal)
}

/// Gives the terminal back to the shell until the process is continued.
fn suspend() -> io::Result<()> {
    execute!(stdout(), LeaveAlternateScreen, cursor::Show)?;
    disable_raw_mode()?;
    process::suspend()
}

/// The shell may have changed the terminal's mode.
fn resume(terminal: &mut DefaultTerminal) -> io::Result<()> {
    disable_raw_mode()?;
    enable_raw_mode()?;
    execute!(stdout(), EnterAlternateScreen, Clear(ClearType::All))?;

    // The next picture is drawn whole. `Terminal::clear` would ask the terminal for its cursor.
    terminal.swap_buffers();
    Ok(())
}

fn show(session: &mut Session, seconds: f64, mut terminal: DefaultTerminal) -> anyhow::Result<()> {
    let colours = !Colored::ansi_color_disabled();
    let continued = process::continued()?;
    let mut is_due = false;

    while session.seconds() < seconds {
        if continued.swap(false, Ordering::Relaxed) {
            resume(&mut terminal)?;
        }

        let heard = Instant::now();
        session.hear()?;

        // The screen is drawn 30 times a second.
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

        // Keys are read for the rest of the tick.
        while event::poll(LOOK.saturating_sub(heard.elapsed()))? {
            let Event::Key(key) = event::read()? else {
                continue;
            };
            match action(key, session.readings.help) {
                Action::Nothing => {}
                Action::Quit => return Ok(()),
                Action::Suspend => suspend()?,
                Action::Help(page) => session.readings.help = page,
                Action::Send(command) => session.command(command)?,
                Action::Slower => session.change_speed(slower)?,
                Action::Faster => session.change_speed(faster)?,
            }
        }
    }

    Ok(())
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Action {
    Nothing,
    Quit,
    Suspend,
    Help(Help),
    Send(Command),
    Slower,
    Faster,
}

fn action(key: KeyEvent, help: Help) -> Action {
    let KeyEvent {
        code,
        modifiers,
        kind,
        ..
    } = key;
    if kind == KeyEventKind::Release {
        return Action::Nothing;
    }
    match code {
        KeyCode::Char('c') if modifiers.contains(KeyModifiers::CONTROL) => return Action::Quit,
        KeyCode::Char('z') if modifiers.contains(KeyModifiers::CONTROL) => return Action::Suspend,
        KeyCode::Char('?') => return Action::Help(help.next()),
        _ if help != Help::Hidden => return Action::Help(Help::Hidden),
        _ => {}
    }

    let command = match code {
        KeyCode::Char('q') => return Action::Quit,
        KeyCode::Char('-' | '_') => return Action::Slower,
        KeyCode::Char('+' | '=') => return Action::Faster,
        KeyCode::Up => Command::Heavier,
        KeyCode::Down => Command::Lighter,
        KeyCode::Left => Command::TurnLeft,
        KeyCode::Right => Command::TurnRight,
        KeyCode::Char(' ') | KeyCode::Enter => Command::Restart,
        KeyCode::Tab | KeyCode::Char('n') => Command::NextScene,
        KeyCode::BackTab | KeyCode::Char('N') => Command::PreviousScene,
        KeyCode::Char('p') => Command::TogglePause,
        KeyCode::Char('.') => Command::Step(1),
        KeyCode::Char(key) => match scene_of_key(key) {
            Some(scene) => Command::Choose(scene),
            None => return Action::Nothing,
        },
        _ => return Action::Nothing,
    };
    Action::Send(command)
}

#[cfg(test)]
mod tests {
    use firmware::scenes::SceneName;

    use super::*;

    fn pressed(code: KeyCode) -> KeyEvent {
        KeyEvent::new(code, KeyModifiers::NONE)
    }

    #[test]
    fn any_key_closes_the_help_and_escape_never_quits() {
        for code in [KeyCode::Esc, KeyCode::Char('q'), KeyCode::Up] {
            for page in [Help::Keys, Help::Numbers] {
                assert_eq!(action(pressed(code), page), Action::Help(Help::Hidden));
            }
        }

        let hidden = |code| action(pressed(code), Help::Hidden);
        assert_eq!(hidden(KeyCode::Esc), Action::Nothing);
        assert_eq!(hidden(KeyCode::Char('q')), Action::Quit);
        assert_eq!(hidden(KeyCode::Char('?')), Action::Help(Help::Keys));
        let interrupt = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        assert_eq!(action(interrupt, Help::Keys), Action::Quit);
    }

    #[test]
    fn the_help_is_turned_over_page_by_page() {
        let mut pages = vec![Help::Hidden];
        while let Action::Help(page) = action(pressed(KeyCode::Char('?')), pages[pages.len() - 1])
            && page != Help::Hidden
        {
            pages.push(page);
        }
        assert_eq!(pages, [Help::Hidden, Help::Keys, Help::Numbers]);
    }

    #[test]
    fn every_scene_has_a_key_of_its_own() {
        let chosen = |key| action(pressed(KeyCode::Char(key)), Help::Hidden);
        let keys = "123456789abcd";
        assert_eq!(keys.len(), SceneName::ALL.len());
        for (key, scene) in keys.chars().zip(SceneName::ALL) {
            assert_eq!(chosen(key), Action::Send(Command::Choose(*scene)), "{key}");
        }
        assert_eq!(chosen('0'), Action::Nothing);
        assert_eq!(chosen('e'), Action::Nothing);
    }
}
