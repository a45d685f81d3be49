//! Messages that come over the serial link: commands are passed on, motions computed in the time that the frame
//! leaves free.

use crate::app::HostCommand;
use crate::job::{Job, OnBoards, Reading, Request};
use crate::protocol::{Decoder, Field, LinkError, Message, Refused, Sample, Simulate, StepTooLong, TO_CHIP};

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Received {
    /// A motion is asked for; its samples follow.
    Accepted,
    /// The same, with a step too long for its energy: what to answer before the samples.
    StepTooLong(StepTooLong),
    /// A command to be executed and answered.
    HostCommand(HostCommand),
    /// The message is answered with a refusal; nothing was changed.
    Refused(Refused),
    /// Damaged bytes; nothing was changed, and there is no one to answer.
    Damaged(LinkError),
}

/// Cuts messages out of the received bytes and computes the last motion asked for.
#[derive(Debug, Default)]
pub struct Service {
    decoder: Decoder,
    work: Option<Work>,
}

#[derive(Debug)]
struct Work {
    request: u16,
    index: u32,
    job: Job,
}

impl Service {
    /// Takes one received byte; what it came to, if it ends a message.
    pub fn receive(&mut self, byte: u8) -> Option<Received> {
        let (kind, fields) = match self.decoder.push(byte)? {
            Ok(message) => message,
            Err(error) => return Some(Received::Damaged(error)),
        };
        if kind & TO_CHIP == 0 {
            return None; // An answer, perhaps its own, looped back: to answer that would have no end.
        }
        Some(match (kind == Simulate::KIND).then(|| Simulate::read(fields)).flatten() {
            Some(message) => self.accept(&message),
            None => HostCommand::read(kind, fields).map_or_else(Received::Refused, Received::HostCommand),
        })
    }

    fn accept(&mut self, message: &Simulate) -> Received {
        let request = message.request;
        let asked = Request::from_message(message);
        match asked.and_then(|asked| Ok((Job::new(&asked)?, asked.admissible_step()))) {
            Ok((job, admissible)) => {
                self.work = Some(Work { request, index: 0, job });
                match admissible {
                    Some(admissible_step) if message.dt > admissible_step => {
                        Received::StepTooLong(StepTooLong { request, admissible_step })
                    }
                    _ => Received::Accepted,
                }
            }
            Err(field) => Received::Refused(Refused { request, field: field.code() }),
        }
    }

    pub fn is_busy(&self) -> bool {
        self.work.as_ref().is_some_and(|work| !work.job.is_finished())
    }

    /// Lets `advance` go on with the motion asked for last, beyond its last sample; `None` if there is none.
    pub fn measure<T>(&mut self, advance: impl FnOnce(&mut OnBoards) -> T) -> Option<T> {
        self.work.as_mut().map(|work| work.job.measure(advance))
    }

    /// Computes at most one step; the sample, when one is due. A refusal ends the work: the step is too long for the
    /// motion, which has left the finite numbers.
    pub fn work(&mut self) -> Option<Result<Sample, Refused>> {
        let Work { request, index, job } = self.work.as_mut().filter(|work| !work.job.is_finished())?;
        let (request, number) = (*request, *index);
        let reading = job.advance();
        *index = index.wrapping_add(u32::from(matches!(reading, Ok(Some(_)))));
        match reading {
            Ok(reading) => reading.map(|Reading { state, velocities, energy }| {
                Ok(Sample { request, index: number, state, velocities, energy })
            }),
            Err(error) => Some(Err(Refused { request, field: Field::from(error).code() })),
        }
    }
}
