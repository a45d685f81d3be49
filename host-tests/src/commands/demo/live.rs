//! In the terminal: the panel as it is now, the keys as its buttons.

use std::io::stdout;
use std::time::{Duration, Instant};

use firmware::config::TICK_RATE;
use firmware::protocol::{Ask, Choose, Pause, Status, Step};
use firmware::scenes::SceneName;
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use ratatui::crossterm::{cursor, execute};

use super::headless::finish;
use super::panel::Depth;
use super::readings::Readings;
use super::record::Recording;
use super::taps::Taps;
use super::view::draw;
use super::{Stage, broken};
use crate::console::cli::{complain, say};
use crate::emulator::process;
use crate::emulator::qemu::{Clock, Key, Machine, Screenshot, Settings};

/// Nobody watches longer.
const LIMIT: Duration = Duration::from_secs(24 * 3600);
/// From one screenshot to the next: 30 per second.
const PERIOD: Duration = Duration::from_millis(33);
/// From one look at the board's clock to the next: half a tick, so that buttons are pressed and let go in time.
const LOOK: Duration = Duration::from_millis(8);

/// Shows the machine until the user has seen enough; whether all was well.
pub fn run(stage: &Stage, recording: Option<Recording>) -> anyhow::Result<bool> {
    let machine = Machine::start(&Settings {
        qemu: stage.toolchain.qemu(),
        board: stage.options.board,
        elf: &stage.elf,
        debugger: true,
        clock: Clock::Real,
        window: stage.window,
        limit: LIMIT,
    })
    .map_err(broken)?;
    let mut show = Show {
        stage,
        machine,
        recording,
        readings: Readings::default(),
        screenshot: Screenshot::blank(),
        depth: Depth::of_terminal(),
        taps: Taps::default(),
    };
    process::on_interrupt(|| {
        ratatui::restore();
        // There is nobody left to tell if this fails.
        let _ = execute!(stdout(), cursor::Show);
    });
    let terminal = ratatui::try_init()?;
    let outcome = show.run(terminal);
    ratatui::try_restore()?;
    outcome?;
    show.finish()
}

struct Show<'a> {
    stage: &'a Stage<'a>,
    machine: Machine,
    recording: Option<Recording>,
    readings: Readings,
    screenshot: Screenshot,
    depth: Depth,
    taps: Taps,
}

/// What a key of the keyboard means.
enum Wish {
    Press(Key),
    /// Another scene, found from the present one.
    Scene(fn(SceneName) -> SceneName),
    Pause,
    Step,
    Quit,
}

impl Show<'_> {
    fn run(&mut self, mut terminal: DefaultTerminal) -> anyhow::Result<()> {
        let board = self.stage.options.board.name;
        let last = self.stage.options.seconds.map(|seconds| (seconds * f64::from(TICK_RATE)).ceil() as u32);
        let mut awake = false;
        loop {
            self.observe()?;
            let ticks = self.readings.summary.ticks();
            if !awake && ticks > 0 {
                self.machine.wake_keys().map_err(broken)?;
                self.play(self.stage.options.scene)?;
                awake = true;
            }
            terminal.draw(|frame| draw(frame, board, &self.screenshot, &self.readings, self.depth))?;
            if last.is_some_and(|last| ticks >= last) || self.execute()? || self.has_ended()? {
                return Ok(());
            }
        }
    }

    /// Looks at the machine.
    fn observe(&mut self) -> anyhow::Result<()> {
        self.hear()?;
        self.machine.log.arrived().for_each(|line| self.readings.line(line));
        self.readings.counts = self.machine.serial.counts();
        if self.has_ended()? {
            return Ok(());
        }
        self.screenshot = self.machine.screenshot().map_err(broken)?;
        if let Some(recording) = &mut self.recording {
            recording.add(self.screenshot.clone(), self.readings.summary.ticks())?;
        }
        Ok(())
    }

    /// Takes what the board has sent. Where it has started anew, it is asked from where: frames tell of rod 1 only.
    fn hear(&mut self) -> anyhow::Result<()> {
        let messages: Vec<_> = self.machine.serial.all_arrived().collect();
        for message in messages {
            if let Some(Status { degrees, .. }) = message.read() {
                self.readings.start = Some(degrees);
            }
            if message.read().is_some_and(|frame| self.readings.frame(frame)) {
                self.machine.serial.send(&Ask { request: 0 }).map_err(broken)?;
            }
        }
        Ok(())
    }

    /// Until the next screenshot is due: presses and lets go of buttons. Whether the user wants to quit.
    fn execute(&mut self) -> anyhow::Result<bool> {
        let due = Instant::now() + PERIOD;
        loop {
            self.hear()?;
            if let Some((key, down)) = self.taps.change(self.readings.summary.ticks()) {
                self.machine.set_key(key, down).map_err(broken)?;
            }
            let left = due.saturating_duration_since(Instant::now());
            if !event::poll(left.min(LOOK))? {
                if left.is_zero() {
                    return Ok(false);
                }
                continue;
            }
            match wish(&event::read()?) {
                Some(Wish::Quit) => return Ok(true),
                Some(Wish::Press(key)) => self.taps.add(key),
                Some(Wish::Scene(other)) => {
                    if let Some(now) = SceneName::from_code(self.readings.frame.scene) {
                        self.play(other(now))?;
                    }
                }
                Some(Wish::Pause) => {
                    let paused = u8::from(self.readings.frame.paused == 0);
                    self.machine.serial.send(&Pause { request: 0, paused }).map_err(broken)?;
                }
                Some(Wish::Step) => self.machine.serial.send(&Step { request: 0, ticks: 1 }).map_err(broken)?,
                None => {}
            }
        }
    }

    /// Has the board play a scene, unless it does already.
    fn play(&mut self, scene: SceneName) -> anyhow::Result<()> {
        if self.readings.frame.scene == scene.code() {
            return Ok(());
        }
        self.machine.serial.send(&Choose { request: 0, scene: scene.code() }).map_err(broken)
    }

    /// QEMU ends by itself when its window is closed or the firmware has crashed.
    fn has_ended(&mut self) -> anyhow::Result<bool> {
        Ok(self.machine.ended().map_err(broken)?.is_some())
    }

    /// With the terminal as it was: completes the files and says how it went.
    fn finish(mut self) -> anyhow::Result<bool> {
        let screenshot = self.screenshot.clone();
        finish(self.stage, self.recording.take(), || Ok(screenshot))?;
        let ended = self.machine.ended().map_err(broken)?;
        if let Some(status) = ended.filter(|status| !status.success()) {
            self.machine.log.rest().for_each(|line| self.readings.line(line));
            self.readings.lines.iter().for_each(complain);
            anyhow::bail!("the firmware or QEMU ended: {status}");
        }
        say(self.readings.summary.report(self.readings.counts))?;
        Ok(true)
    }
}

fn wish(event: &Event) -> Option<Wish> {
    let Event::Key(KeyEvent { code, modifiers, kind, .. }) = event else { return None };
    if *kind == KeyEventKind::Release {
        return None;
    }
    match code {
        KeyCode::Char('c') if modifiers.contains(KeyModifiers::CONTROL) => Some(Wish::Quit),
        KeyCode::Char('q') | KeyCode::Esc => Some(Wish::Quit),
        KeyCode::Tab | KeyCode::Char('n') => Some(Wish::Scene(SceneName::next)),
        KeyCode::BackTab | KeyCode::Char('N') => Some(Wish::Scene(SceneName::previous)),
        KeyCode::Char('p') => Some(Wish::Pause),
        KeyCode::Char('.') => Some(Wish::Step),
        KeyCode::Up => Some(Wish::Press(Key::Up)),
        KeyCode::Down => Some(Wish::Press(Key::Down)),
        KeyCode::Left => Some(Wish::Press(Key::Left)),
        KeyCode::Right => Some(Wish::Press(Key::Right)),
        KeyCode::Char(' ') | KeyCode::Enter => Some(Wish::Press(Key::Select)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wish_of(code: KeyCode, modifiers: KeyModifiers) -> Option<Wish> {
        wish(&Event::Key(KeyEvent::new(code, modifiers)))
    }

    #[test]
    fn keys_mean_what_the_line_of_keys_says() {
        let pressed = |code| match wish_of(code, KeyModifiers::NONE) {
            Some(Wish::Press(key)) => Some(key),
            _ => None,
        };
        assert_eq!(pressed(KeyCode::Up), Some(Key::Up));
        assert_eq!(pressed(KeyCode::Down), Some(Key::Down));
        assert_eq!(pressed(KeyCode::Left), Some(Key::Left));
        assert_eq!(pressed(KeyCode::Right), Some(Key::Right));
        assert_eq!(pressed(KeyCode::Char(' ')), Some(Key::Select));
        assert_eq!(pressed(KeyCode::Enter), Some(Key::Select));
        let scene = |code| match wish_of(code, KeyModifiers::NONE) {
            Some(Wish::Scene(other)) => Some(other(SceneName::Page)),
            _ => None,
        };
        assert_eq!(scene(KeyCode::Tab), Some(SceneName::Page.next()));
        assert_eq!(scene(KeyCode::BackTab), Some(SceneName::Page.previous()));
        assert!(matches!(wish_of(KeyCode::Char('p'), KeyModifiers::NONE), Some(Wish::Pause)));
        assert!(matches!(wish_of(KeyCode::Char('.'), KeyModifiers::NONE), Some(Wish::Step)));
        for quit in [KeyCode::Char('q'), KeyCode::Esc] {
            assert!(matches!(wish_of(quit, KeyModifiers::NONE), Some(Wish::Quit)));
        }
        assert!(matches!(wish_of(KeyCode::Char('c'), KeyModifiers::CONTROL), Some(Wish::Quit)));
        assert!(wish_of(KeyCode::Char('x'), KeyModifiers::NONE).is_none());
    }
}
