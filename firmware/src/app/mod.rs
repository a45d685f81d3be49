//! The application: reads the buttons, moves the scene, draws it and sends it, tick by tick.

mod controls;
mod event;
mod instruments;
mod pace;
mod player;
mod warm_restart;

use embedded_io::Write;

use crate::config::{
    MOST_MEASURED_STEPS, MOST_MESSAGES_PER_TICK, MOST_TICKS_PER_FRAME, Processor, RECEIVE_QUEUE,
};
use crate::display::{Controller, Display};
use crate::graphics::{Canvas, FrameBuffers};
use crate::job::{Job, OnBoards, Request};
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

/// The same on a board and in a test: a panel, a byte sink and buttons are all it needs.
#[derive(Debug)]
pub struct App<'a, Panel, Link, Keys> {
    /// Not a part of this, so that neither is too large for the stack while it is made.
    panel: &'a mut Panel,
    pub link: Link,
    keys: Keys,
    controls: Controls,
    pub player: Player<'a>,
    decoder: Decoder,
    /// The motion asked for last, and the number to answer it with.
    work: Option<(u16, Job)>,
    pub canvas: &'a mut Canvas,
    /// Ticks done since reset.
    ticks: u32,
    /// Frames drawn and sent since reset; wraps.
    pub frames: u32,
    /// Ticks without a frame since reset.
    dropped: ThrottledCounter,
    damaged: ThrottledCounter,
    lost: ThrottledCounter,
    last_damage: Option<LinkError>,
    panel_failing: FaultEdge,
    link_failing: FaultEdge,
    pub instruments: Instruments,
    /// The last restart that the board made by itself, for hosts that ask.
    restarted: Option<Restarted>,
    /// Processor cycles of the frame before, from the first tick to the end of its sending.
    busy_cycles: u32,
}

impl<'a, Panel: Display, Link: Write, Keys: Buttons> App<'a, Panel, Link, Keys> {
    /// Before it plays, which takes much of the stack: better when this is at its place.
    #[inline(never)] // while it is made one of it stands on the stack, and not two
    pub fn new(
        processor: Processor,
        FrameBuffers { canvas, ink }: &'a mut FrameBuffers,
        panel: &'a mut Panel,
        link: Link,
        keys: Keys,
    ) -> Self {
        Self {
            panel,
            link,
            keys,
            controls: Controls::default(),
            player: Player::new(processor, ink),
            decoder: Decoder::default(),
            work: None,
            canvas,
            ticks: 0,
            frames: 0,
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

    /// Goes by a clock that stands at `clock` now, and counts frames and ticks without one from `frames` on.
    pub fn count_from(&mut self, clock: u32, frames: u32) {
        (self.ticks, self.frames, self.dropped) =
            (clock, frames, ThrottledCounter::starting(frames, clock));
    }

    /// Goes on after a restart with what was played before it, and tells the host: one that is
    /// connected now at once, and any other when it asks.
    pub fn resume(&mut self, restart: &Record, mut log: impl Log<Panel, Link>) {
        let resumed = !restart.is_given_up() && self.player.resume(&restart.played).is_ok();
        log(Event::Restarted(restart.end, resumed));
        self.restarted = Some(restart.end);
        self.send(&ToHost::Restarted(restart.end), &mut log);
    }

    /// Drives the panel as this controller; `None` identifies it. Returns false if the board has no
    /// panel with a choice of controllers.
    pub fn choose_panel(&mut self, controller: Option<Controller>) -> bool {
        self.panel.choose(controller)
    }

    /// Returns what is played, and the state of the panel.
    pub fn status(&self) -> Status {
        Status {
            panel: self.panel.report(),
            ..self.player.status()
        }
    }

    /// Catches up with the clock, which counts ticks since reset and may wrap, then draws and sends once.
    ///
    /// Every tick is integrated, however late; the state after n ticks does not depend on how often this is called.
    /// At most [`MOST_TICKS_PER_FRAME`] are done per call; the rest are done by the next calls. Returns whether the
    /// clock is caught up with; if not, call again without waiting for the next tick.
    pub fn run_to(&mut self, clock: u32, mut log: impl Log<Panel, Link>) -> bool {
        let late = clock.wrapping_sub(self.ticks);
        let ticks = late.min(MOST_TICKS_PER_FRAME);
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
        if self.player.check() {
            log(Event::Stopped);
        }
        self.player.draw(self.canvas);
        let scene_cycles = (self.instruments.stopwatch)().wrapping_sub(start);
        self.show(scene_cycles, &mut log);
        self.busy_cycles = (self.instruments.stopwatch)().wrapping_sub(start);
        ticks == late
    }

    /// Sends the last frame to the panel if it is still waiting for the bus. Returns true while it
    /// waits.
    pub fn catch_up(&mut self) -> bool {
        self.panel.catch_up(self.canvas)
    }

    /// Takes bytes received over the link, executes and answers. Stops after [`MOST_MESSAGES_PER_TICK`] messages or
    /// [`RECEIVE_QUEUE`] bytes, so that no flood of either delays the frame; what is left in `bytes` waits for the next call.
    pub fn receive(&mut self, bytes: impl IntoIterator<Item = u8>, mut log: impl Log<Panel, Link>) {
        let mut left = MOST_MESSAGES_PER_TICK;
        for byte in bytes.into_iter().take(RECEIVE_QUEUE) {
            match self
                .decoder
                .push(byte)
                .map(|message| message.map(decode_command))
            {
                // Of what is no command: an answer, perhaps its own, looped back. To answer that would have no end.
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

    /// Takes note of how many received bytes have been lost since reset; may wrap.
    pub fn note_lost(&mut self, total: u32, mut log: impl Log<Panel, Link>) {
        self.lost.total = total;
        if let Some(bytes) = self.lost.news(self.ticks) {
            log(Event::Lost { bytes, total });
        }
    }

    /// Does a bounded piece of the work asked for over the link, a step at most; whether there is more. A refusal ends it: the step
    /// is too long for the motion, which has left the finite numbers.
    pub fn work(&mut self, mut log: impl Log<Panel, Link>) -> bool {
        let Some((request, job)) = &mut self.work else {
            return false;
        };
        let (request, index, reading, is_finished) =
            (*request, job.given, job.advance(), job.is_finished());
        match reading {
            Ok(Some(reading)) => self.answer(request, Answer::Sample { index, reading }, &mut log),
            Ok(None) => {}
            Err(error) => self.answer(request, Answer::Refused(error.into()), &mut log),
        }
        !is_finished
    }

    fn tick(&mut self, log: &mut impl Log<Panel, Link>) {
        self.ticks = self.ticks.wrapping_add(1);
        for command in self.controls.tick(self.keys.read()) {
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

    /// Executes a command that came over the link, and answers it; what is wrong with it, if it cannot be.
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
            Command::Measure { steps, in_ram } => {
                let (steps, timed) = (steps.min(MOST_MEASURED_STEPS), self.instruments.timed);
                let (_, job) = self.work.as_mut().ok_or(Field::Message)?;
                Answer::Measured {
                    steps,
                    cycles: job.measure(|motion| timed(motion, steps, in_ram)),
                }
            }
            Command::Panel(controller) => {
                let has_choice = self.choose_panel(controller);
                has_choice.then_some(Answer::Done).ok_or(Field::Panel)?
            }
            Command::Simulate(motion) => return self.begin_work(request, &motion, log),
            _ => Answer::Done,
        };
        self.answer(request, answer, log);
        Ok(())
    }

    /// The samples of the motion follow; first what a step too long for its energy should be.
    #[inline(never)] // what it takes to prepare a motion would be on the stack of every command
    fn begin_work(
        &mut self,
        request: u16,
        motion: &Request,
        log: &mut impl Log<Panel, Link>,
    ) -> Result<(), Field> {
        let run = OnBoards::start(motion).ok_or(Field::Method)??;
        self.work = Some((request, Job::new(run, motion)?));
        log(Event::Asked);
        if let Some(admissible_step) = motion.admissible_step().filter(|step| motion.dt > *step) {
            log(Event::StepTooLong(admissible_step));
            self.answer(request, Answer::StepTooLong(admissible_step), log);
        }
        Ok(())
    }

    #[inline(never)]
    fn show(&mut self, scene_cycles: u32, log: &mut impl Log<Panel, Link>) {
        let shown = self.panel.flush(self.canvas);
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

    /// Sends a message, or the part of it that the link takes in time.
    fn send(&mut self, message: &ToHost, log: &mut impl Log<Panel, Link>) {
        let (mut wire, mut sent) = ([0; MAX_WIRE], Ok(()));
        let mut left = encode(message, &mut wire);
        while !left.is_empty() && sent.is_ok() {
            // A link that takes nothing and says so is no reason to panic: the byte counts as sent.
            sent = self
                .link
                .write(left)
                .map(|count| left = left.get(count.max(1)..).unwrap_or_default());
        }
        self.link_failing
            .note(sent, |error| log(Event::Link(error)));
    }
}
