//! The restarts of a board, as a host at its port observes them.
//!
//! A restart ends a USB connection, so the board's own message about it reaches no host. The host
//! therefore sends a question about the last restart after it has opened the port, and whenever the
//! frames are counted from 0 again.

use firmware::protocol::{Answer, Cause, Restarted, ToHost};

/// The number of messages after which an unanswered question is repeated. A board sends 60 messages
/// a second.
const PATIENCE: u32 = 60;

/// The restarts that a host has observed. The default is the start of the first connection: none
/// observed, and the question due.
#[derive(Debug, Default)]
pub struct Restarts {
    /// The last restart that the board has reported, including one before the connection. `None`
    /// before its first answer, and if it has made none since it was switched on or reset.
    pub last: Option<Restarted>,
    /// The number of restarts since the host first opened the port, including those by the power
    /// switch. Several restarts between two reports of the board count as one.
    pub count: u32,
    /// The question of the present connection.
    question: Question,
    /// True if the frames are counted from 0 again and the board has not yet reported the cause.
    recounted: bool,
    /// True if the board has answered at least once.
    is_known: bool,
}

/// The state of the question about the last restart.
#[derive(Debug, Default, PartialEq)]
enum Question {
    /// The question is sent after the next message.
    #[default]
    Due,
    /// The question was sent, and this number of messages has arrived without an answer.
    Asked(u32),
    /// The board has reported its last restart.
    Answered,
}

impl Restarts {
    /// Begins a connection. The question about the last restart is due; everything else is kept.
    pub fn join(&mut self) {
        self.question = Question::Due;
    }

    /// Takes a message. `recounted` is true if the message is a frame that shows that the frames
    /// are counted from 0 again ([`Inbox`](super::Inbox) counts these as restarts). Returns a line
    /// for the user, without a newline, if the board reports a new restart.
    ///
    /// A restart that only the frames show gives `None` at first. It makes the question due, and
    /// the board's answer gives the line and is counted. Without such a frame before it, a restart
    /// that the first answer reports gives the line, but is not counted, because it was before the
    /// connection; and an answer that repeats the last report gives `None`.
    pub fn take(&mut self, message: &ToHost, recounted: bool) -> Option<String> {
        match *message {
            ToHost::Restarted(end) => {
                self.question = Question::Answered;
                self.learn(Some(end), true)
            }
            ToHost::Answer(_, Answer::Restart(end)) => {
                self.question = Question::Answered;
                let recounted = std::mem::take(&mut self.recounted);
                self.learn(end, recounted)
            }
            _ => {
                // The next report of the board names the cause.
                if recounted {
                    self.recounted = true;
                    self.question = Question::Due;
                }
                None
            }
        }
    }

    /// Returns true if the question must be sent now, and counts it as sent. It is called once
    /// after each message, so that nothing is sent to a device that is not a board. While the
    /// question is unanswered, the next 60 calls return false, and the one after them true again.
    pub fn is_question_due(&mut self) -> bool {
        let (is_due, next) = match self.question {
            Question::Due | Question::Asked(PATIENCE..) => (true, Question::Asked(0)),
            Question::Asked(messages) => (false, Question::Asked(messages + 1)),
            Question::Answered => (false, Question::Answered),
        };
        self.question = next;
        is_due
    }

    /// Takes the board's report of its last restart.
    fn learn(&mut self, end: Option<Restarted>, recounted: bool) -> Option<String> {
        let is_first = !std::mem::replace(&mut self.is_known, true);
        // A report that was already there at the first connection is not a new restart.
        let is_new = std::mem::replace(&mut self.last, end) != end;
        let has_restarted = recounted || is_new && !is_first && end.is_some();
        self.count += u32::from(has_restarted);
        match end {
            Some(end) if is_new || recounted => Some(describe_restart(&end)),
            None if recounted => Some("the board has been switched on or reset".to_owned()),
            _ => None,
        }
    }
}

/// Returns a restart in one line without a newline: the cause (`reset` if unknown), the scene and
/// tick of the last frame, the program counter and the return address (hexadecimal) unless the
/// former is 0, and the number of restarts in a row ([`Restarted`]).
pub fn describe_restart(end: &Restarted) -> String {
    let place = match end.pc {
        0 => String::new(),
        pc => format!(", pc {pc:#010x}, lr {:#010x}", end.lr),
    };
    format!(
        "the board has restarted after a {} in {end}{place} (in a row: {})",
        end.cause.map_or("reset", Cause::name),
        end.restarts
    )
}

#[cfg(test)]
mod tests {
    use firmware::protocol::Frame;

    use super::*;

    fn frame() -> ToHost {
        ToHost::Frame(Frame::default())
    }

    fn end(restarts: u8) -> Restarted {
        Restarted {
            cause: Some(Cause::Hang),
            restarts,
            pc: 0x1000_1234,
            ..Restarted::default()
        }
    }

    fn answer(end: Option<Restarted>) -> ToHost {
        ToHost::Answer(0, Answer::Restart(end))
    }

    /// The first question is due after the first message, and again after 60 messages without an
    /// answer. After an answer none is due until the next connection.
    #[test]
    fn no_question_precedes_a_message_and_an_unanswered_one_is_repeated() {
        let mut restarts = Restarts::default();
        let mut asked = 0;
        for _ in 0..=PATIENCE + 1 {
            restarts.take(&frame(), false);
            asked += u32::from(restarts.is_question_due());
        }
        assert_eq!(asked, 2);

        // An answer ends the questions until the link connects again.
        restarts.take(&answer(None), false);
        assert!((0..1000).all(|_| !restarts.is_question_due()));
        restarts.join();
        assert!(restarts.is_question_due());
    }

    /// A restart before the first connection is reported with its cause, place and number, but not
    /// counted. The same report after a new connection is no news. A different one is reported and
    /// counted.
    #[test]
    fn an_earlier_restart_is_reported_at_the_first_connection_only() {
        let mut restarts = Restarts::default();
        let line = restarts.take(&answer(Some(end(1))), false).expect("a line");
        for part in ["after a hang", "scene page, step 0", "0x10001234", "row: 1"] {
            assert!(line.contains(part), "no {part:?} in {line:?}");
        }
        assert!(
            !super::describe_restart(&Restarted::default()).contains("pc"),
            "unknown"
        );
        assert_eq!(restarts.count, 0, "it was before");

        // The cable is unplugged and plugged in again.
        restarts.join();
        assert_eq!(restarts.take(&answer(Some(end(1))), false), None);

        // The next restart ended the connection.
        restarts.join();
        assert!(restarts.take(&answer(Some(end(2))), false).is_some());
        assert_eq!((restarts.count, restarts.last), (1, Some(end(2))));
    }

    /// The board reports the same restart as before, but its frames are counted from 0 again. The
    /// question is due, the restart is reported, and it is counted once.
    #[test]
    fn a_restart_like_the_last_one_is_recognised_by_the_frames() {
        let mut restarts = Restarts::default();
        restarts.take(&answer(Some(end(1))), false);
        restarts.join();
        assert_eq!(restarts.take(&frame(), true), None);
        assert!(restarts.is_question_due());
        assert!(restarts.take(&answer(Some(end(1))), false).is_some());
        assert_eq!(restarts.count, 1);
    }

    /// After a crash, the frames are counted from 0 again and the board reports no restart. The
    /// line reports that it was switched on or reset, and it counts as one restart.
    #[test]
    fn a_board_that_was_switched_off_is_not_reported_as_crashed() {
        let mut restarts = Restarts::default();
        restarts.take(&answer(Some(end(1))), false);
        restarts.take(&frame(), true);
        let line = restarts.take(&answer(None), false);
        assert_eq!(
            line.as_deref(),
            Some("the board has been switched on or reset")
        );
        assert_eq!((restarts.count, restarts.last), (1, None));
    }
}
