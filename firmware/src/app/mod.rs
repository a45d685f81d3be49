//! The application: reads the buttons, and in each tick advances the scene, draws it and sends it.

mod controls;
mod event;
mod instruments;
mod pace;
mod player;
mod warm_restart;

use embedded_io::Write;

use crate::config::{
    DIM_TICKS, MOST_MEASURED_STEPS, MOST_MESSAGES_PER_TICK, Processor, RECEIVE_QUEUE,
};
use crate::display::{Display, PanelOptions};
use crate::graphics::Canvas;
use crate::job::{BoardMotion, Job, Request};
use crate::protocol::{
    Answer, Command, Decoder, Field, Frame, LinkError, MAX_WIRE, PlayState, Restarted, Status,
    ToHost, decode_command, encode,
};
use event::{FaultEdge, ThrottledCounter};

pub use controls::{Buttons, Controls, Key, NoButtons, Pressed};
pub use event::{Event, Log};
pub use instruments::Instruments;
pub use player::{PlannerEvent, Player};
pub use warm_restart::{Journal, Kept, MOST_RESTARTS, Record, SOUND_FRAMES};

/// The application. It needs only a panel, a byte sink and buttons, so that it is the same on a
/// board and in a test.
///
/// The main loop calls its functions; no interrupt does. A message blocks only while the link's
/// `write` blocks.
#[derive(Debug)]
pub struct App<'a, Panel, Link, Keys> {
    /// The panel is borrowed, so that neither it nor the application is too large for the stack
    /// while it is created.
    panel: &'a mut Panel,
    pub link: Link,
    keys: Keys,
    controls: Controls,
    pub player: Player<'a>,
    decoder: Decoder,
    /// The last requested motion, and the number of its command.
    work: Option<(u16, Job)>,
    ticks: u32,
    pub frames: u32,
    without_key: u32,
    dropped: ThrottledCounter,
    damaged: ThrottledCounter,
    lost: ThrottledCounter,
    last_damage: Option<LinkError>,
    panel_failing: FaultEdge,
    link_failing: FaultEdge,
    pub instruments: Instruments,
    restarted: Option<Restarted>,
    /// Of the previous frame, from its first tick to the end of its transfer.
    busy_cycles: u32,
}

impl<'a, Panel: Display, Link: Write, Keys: Buttons> App<'a, Panel, Link, Keys> {
    /// Creates an application that shows an empty figure until a command, or [`Player::play`],
    /// starts a scene. The start of a scene needs much stack, so it is done when the application is
    /// at its final place.
    // Inlined, `application` has a stack frame of 8,740 bytes.
    #[inline(never)]
    pub fn new(
        processor: Processor,
        canvas: Canvas<'a>,
        panel: &'a mut Panel,
        link: Link,
        keys: Keys,
    ) -> Self {
        Self {
            panel,
            link,
            keys,
            controls: Controls::default(),
            player: Player::new(processor, canvas),
            decoder: Decoder::default(),
            work: None,
            ticks: 0,
            frames: 0,
            without_key: 0,
            dropped: ThrottledCounter::default(),
            damaged: ThrottledCounter::default(),
            lost: ThrottledCounter::default(),
            last_damage: None,
            panel_failing: FaultEdge::default(),
            link_failing: FaultEdge::default(),
            instruments: Instruments::default(),
            restarted: None,
            busy_cycles: 0,
        }
    }

    /// Sets the clock to tick `clock`, and the counts to `frames`: a test begins near a wrap.
    pub fn count_from(&mut self, clock: u32, frames: u32) {
        self.ticks = clock;
        self.frames = frames;
        self.dropped = ThrottledCounter::starting(frames, clock);
    }

    /// Plays the scene from before a restart again, and reports the restart to the host. After more
    /// than [`MOST_RESTARTS`] restarts in a row the present scene continues instead.
    pub fn resume(&mut self, restart: &Record, mut log: impl Log<Panel, Link>) {
        let resumed = !restart.is_given_up() && self.player.resume(&restart.played).is_ok();
        log(Event::Restarted(restart.end, resumed));
        self.restarted = Some(restart.end);
        self.send(&ToHost::Restarted(restart.end), &mut log);
    }

    /// Drives the panel as chosen, from the next frame on, if it has such options.
    pub fn choose_panel(&mut self, chosen: PanelOptions) -> bool {
        self.panel.choose(chosen)
    }

    /// Returns the answer to [`Command::Ask`].
    pub fn status(&self) -> Status {
        Status {
            panel: self.panel.report(),
            ..self.player.status()
        }
    }

    /// Catches up with the clock, then draws one frame and sends it to the panel and over the link.
    /// `clock` is the number of the current tick.
    ///
    /// In each tick the buttons are read, their commands are executed, and the scene advances. No
    /// tick is left out, however late it is, so that the state after n ticks does not depend on the
    /// number of calls.
    ///
    /// A call advances the scene by at most [`MOST_TICKS_PER_FRAME`] ticks; all ticks of the clock
    /// but the last count as ticks without a frame. Returns false if ticks are left.
    ///
    /// [`MOST_TICKS_PER_FRAME`]: crate::config::MOST_TICKS_PER_FRAME
    pub fn run_to(&mut self, clock: u32, mut log: impl Log<Panel, Link>) -> bool {
        let late = clock.wrapping_sub(self.ticks);
        let ticks = late.min(self.player.pace.most_ticks());
        if ticks == 0 {
            return true;
        }

        let start = (self.instruments.stopwatch)();
        for _ in 0..ticks {
            self.tick(&mut log);
        }

        self.dropped.add(ticks - 1);
        if let Some(ticks) = self.dropped.news(self.ticks) {
            log(Event::Dropped {
                ticks,
                total: self.dropped.total,
            });
        }
        self.player.pace.note_frame(ticks);
        if self.player.check() {
            log(Event::Stopped);
        }

        self.player.draw();
        let scene_cycles = (self.instruments.stopwatch)().wrapping_sub(start);
        self.show(scene_cycles, &mut log);
        self.busy_cycles = (self.instruments.stopwatch)().wrapping_sub(start);
        ticks == late
    }

    /// Lowers a speed above 1 that the board cannot keep. Only for a board: the frames of a browser
    /// may be rare although it computes fast enough.
    pub fn keep_pace(&mut self, mut log: impl Log<Panel, Link>) {
        if let Some(speed) = self.player.pace.lower() {
            log(Event::Slowed(speed));
        }
    }

    /// Sends the last frame to the panel if it is still waiting for the bus and the bus is free.
    /// Returns true if it still waits.
    pub fn catch_up(&mut self) -> bool {
        self.panel.catch_up(&self.player.canvas)
    }

    /// Takes bytes received over the link, executes the commands and answers them.
    ///
    /// Stops after [`MOST_MESSAGES_PER_TICK`] messages or [`RECEIVE_QUEUE`] bytes, so that a flood
    /// of either does not delay the frame.
    pub fn receive(&mut self, bytes: impl IntoIterator<Item = u8>, mut log: impl Log<Panel, Link>) {
        let mut left = MOST_MESSAGES_PER_TICK;
        for byte in bytes.into_iter().take(RECEIVE_QUEUE) {
            match self
                .decoder
                .push(byte)
                .map(|message| message.map(decode_command))
            {
                // Ignore messages that are not commands, such as our own answers on a looped-back
                // link. Replying to them would never end.
                None | Some(Ok(None)) => continue,
                Some(Ok(Some((request, command)))) => {
                    let reply = command
                        .ok_or(Field::Message)
                        .and_then(|command| self.reply(request, command, &mut log));
                    if let Err(field) = reply {
                        self.answer(request, Answer::Refused(field), &mut log);
                    }
                }
                Some(Err(error)) => {
                    self.damaged.add(1);
                    self.last_damage = Some(error);
                }
            }

            left -= 1;
            if left == 0 {
                break;
            }
        }

        if let Some(last) = self.last_damage
            && let Some(messages) = self.damaged.news(self.ticks)
        {
            log(Event::Damaged {
                messages,
                total: self.damaged.total,
                last,
            });
        }
    }

    /// Takes the number of received bytes that have been lost since reset.
    pub fn note_lost(&mut self, total: u32, mut log: impl Log<Panel, Link>) {
        self.lost.total = total;
        if let Some(bytes) = self.lost.news(self.ticks) {
            log(Event::Lost { bytes, total });
        }
    }

    /// Performs at most one step of the job of the host, and sends the sample that is then due.
    /// Returns true if more is left.
    pub fn work(&mut self, mut log: impl Log<Panel, Link>) -> bool {
        let Some((request, job)) = &mut self.work else {
            return false;
        };
        let request = *request;
        let index = job.given;
        let reading = job.advance();
        let is_finished = job.is_finished();
        match reading {
            Ok(Some(reading)) => self.answer(request, Answer::Sample { index, reading }, &mut log),
            Ok(None) => {}
            Err(error) => self.answer(request, Answer::Refused(error.into()), &mut log),
        }
        !is_finished
    }

    fn tick(&mut self, log: &mut impl Log<Panel, Link>) {
        self.ticks = self.ticks.wrapping_add(1);
        let pressed = self.keys.read();
        self.without_key = if pressed == Pressed::default() {
            self.without_key.saturating_add(1)
        } else {
            0
        };
        for command in self.controls.tick(pressed) {
            if let Err(field) = self.execute(command, log) {
                log(Event::Refused(command, field));
            }
        }
        self.player.tick(|news| log(Event::Motion(news)));
    }

    fn execute(&mut self, command: Command, log: &mut impl Log<Panel, Link>) -> Result<(), Field> {
        if self.player.execute(command)? {
            log(Event::Started(self.player.name, self.player.settings));
            if self.player.state() == PlayState::Stopped {
                log(Event::Stopped);
            }
            if let Some(stepping) = self.player.report.stepping {
                log(Event::Motion(PlannerEvent::Shown(
                    stepping,
                    self.player.cost(stepping),
                )));
            }
        }
        Ok(())
    }

    fn reply(
        &mut self,
        request: u16,
        command: Command,
        log: &mut impl Log<Panel, Link>,
    ) -> Result<(), Field> {
        self.execute(command, log)?;
        let answer = match command {
            Command::Ask => Answer::Status(self.status()),
            Command::AskPlan => Answer::Planned(self.player.plan()),
            Command::Identify => Answer::Identity(self.instruments.identity()),
            Command::AskRestart => Answer::Restart(self.restarted),
            Command::Measure(steps) => {
                let steps = steps.min(MOST_MEASURED_STEPS);
                let timed = self.instruments.timed;
                let (_, job) = self.work.as_mut().ok_or(Field::Message)?;
                Answer::Measured {
                    steps,
                    cycles: job.measure(|motion| timed(motion, steps)),
                }
            }
            Command::Panel(controller) => {
                self.change_panel(|chosen| chosen.controller = controller)?
            }
            Command::Turn(is_turned) => self.change_panel(|chosen| chosen.is_turned = is_turned)?,
            Command::Dim(dims) => self.change_panel(|chosen| chosen.stays_bright = !dims)?,
            Command::Simulate(motion) => return self.begin_work(request, &motion, log),
            _ => {
                self.without_key = 0;
                Answer::Done
            }
        };
        self.answer(request, answer, log);
        Ok(())
    }

    fn change_panel(&mut self, change: impl FnOnce(&mut PanelOptions)) -> Result<Answer, Field> {
        let mut chosen = self.panel.report().chosen;
        change(&mut chosen);
        self.without_key = 0;
        let has_choice = self.choose_panel(chosen);
        has_choice.then_some(Answer::Done).ok_or(Field::Panel)
    }

    /// Begins the job of a requested motion.
    #[inline(never)] // Inlined, it takes 464 bytes of flash (M0+).
    fn begin_work(
        &mut self,
        request: u16,
        motion: &Request,
        log: &mut impl Log<Panel, Link>,
    ) -> Result<(), Field> {
        let run = BoardMotion::start(motion)?;
        self.work = Some((request, Job::new(run, motion)?));
        log(Event::Asked);
        if let Some(admissible_step) = motion.admissible_step().filter(|step| motion.dt > *step) {
            log(Event::StepTooLong(admissible_step));
            self.answer(request, Answer::StepTooLong(admissible_step), log);
        }
        Ok(())
    }

    #[inline(never)] // Test `scenes` profiles it by its name.
    fn show(&mut self, scene_cycles: u32, log: &mut impl Log<Panel, Link>) {
        self.panel.dim(self.without_key >= DIM_TICKS);
        let canvas = &mut self.player.canvas;
        let shown = self.panel.flush(canvas);
        match shown {
            Ok(()) => canvas.settle(),
            Err(_) => canvas.touch_all(),
        }
        self.panel_failing
            .note(shown, |error| log(Event::Panel(error)));
        if let Some(found) = self.panel.found() {
            log(Event::PanelFound(found));
        }

        let frame = Frame {
            sequence: self.frames,
            dropped: self.dropped.total,
            lost: self.lost.total,
            scene_cycles,
            busy_cycles: self.busy_cycles,
            ..self.player.frame()
        };
        self.send(&ToHost::Frame(frame), log);
        self.frames = self.frames.wrapping_add(1);
    }

    fn answer(&mut self, request: u16, answer: Answer, log: &mut impl Log<Panel, Link>) {
        self.send(&ToHost::Answer(request, answer), log);
    }

    fn send(&mut self, message: &ToHost, log: &mut impl Log<Panel, Link>) {
        let mut wire = [0; MAX_WIRE];
        let mut sent = Ok(());
        let mut left = encode(message, &mut wire);
        while !left.is_empty() && sent.is_ok() {
            // A link that returns 0 is no reason to panic: one byte counts as sent.
            sent = self
                .link
                .write(left)
                .map(|count| left = left.get(count.max(1)..).unwrap_or_default());
        }
        self.link_failing
            .note(sent, |error| log(Event::Link(error)));
    }
}
