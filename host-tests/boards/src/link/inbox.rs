//! The decoder of received bytes into messages, with counts.

use firmware::protocol::{Decoder, Field, Frame, LinkError, ToHost, read};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub messages: u64,
    /// A first message after [`Inbox::join`] that is damaged does not count.
    pub damaged: u64,
    /// The frames that are missing in the sequence numbers.
    pub lost: u64,
    pub restarts: u64,
}

pub fn refusal(field: Field) -> &'static str {
    match field {
        // A board of this version can read every message of this host, unless the two have
        // different tables of methods.
        Field::Message => "message; its firmware has another version: flash the board again",
        Field::Panel => "panel; it has no OLED on I2C",
        field => field.name(),
    }
}

#[derive(Debug, Default)]
pub struct Inbox {
    /// A new decoder in its place drops the incomplete message.
    pub decoder: Decoder,
    pub counts: Counts,
    expected: Option<u32>,
    is_joining: bool,
    pub damage: Option<LinkError>,
    joins: bool,
}

impl Inbox {
    /// A damaged first message after [`Self::join`] is not counted, because the connection may have
    /// begun within it.
    pub fn take(&mut self, byte: u8) -> Option<ToHost> {
        let message = match self
            .decoder
            .push(byte)?
            .and_then(|bytes| read(bytes).ok_or(LinkError::Malformed))
        {
            Ok(message) => message,
            Err(error) => {
                self.counts.damaged += u64::from(!std::mem::take(&mut self.joins));
                self.damage = Some(error);
                return None;
            }
        };
        self.joins = false;
        self.counts.messages += 1;

        match message {
            ToHost::Frame(Frame { sequence, .. }) => {
                let missing = self
                    .expected
                    .map_or(0, |expected| sequence.wrapping_sub(expected));

                // A smaller number than expected comes from a board that counts from 0 again.
                let restarted = missing > u32::MAX / 2;
                self.counts.restarts += u64::from(restarted);
                if !restarted && !std::mem::take(&mut self.is_joining) {
                    self.counts.lost += u64::from(missing);
                }
                self.is_joining = false;
                self.expected = Some(sequence.wrapping_add(1));
            }
            ToHost::Restarted(_) => {
                self.counts.restarts += 1;
                self.expected = Some(0);
            }
            ToHost::Answer(..) => {}
        }

        Some(message)
    }

    /// Begins a connection. The expected sequence number of the previous one is kept: a smaller
    /// number shows that the board has restarted in between.
    pub fn join(&mut self) {
        self.decoder = Decoder::default();
        self.damage = None;
        self.joins = true;
        self.is_joining = true;
    }
}

#[cfg(test)]
mod tests {
    use firmware::protocol::{MAX_WIRE, encode};

    use super::*;

    fn counts(messages: impl IntoIterator<Item = u32>) -> Counts {
        let mut inbox = Inbox::default();
        for sequence in messages {
            let frame = ToHost::Frame(Frame {
                sequence,
                ..Frame::default()
            });
            encode(&frame, &mut [0; MAX_WIRE])
                .iter()
                .for_each(|&byte| _ = inbox.take(byte));
        }
        inbox.counts
    }

    #[test]
    fn missing_frames_are_counted_over_the_wrap_but_not_over_a_restart_from_0() {
        let sequences = [u32::MAX - 2, u32::MAX - 1, 1, 2, 5];
        assert_eq!(
            counts(sequences),
            Counts {
                messages: 5,
                lost: 4,
                ..Counts::default()
            }
        );
        assert_eq!(
            counts([700, 701, 0, 1]),
            Counts {
                messages: 4,
                restarts: 1,
                ..Counts::default()
            }
        );
    }

    #[test]
    fn frames_between_two_connections_are_not_lost_and_a_restart_between_them_is_counted() {
        let mut inbox = Inbox::default();
        for (sequence, restarts) in [(700, 0), (900, 0), (30, 1), (90, 1)] {
            inbox.join();
            let frame = ToHost::Frame(Frame {
                sequence,
                ..Frame::default()
            });
            encode(&frame, &mut [0; MAX_WIRE])
                .iter()
                .for_each(|&byte| _ = inbox.take(byte));
            assert_eq!((inbox.counts.lost, inbox.counts.restarts), (0, restarts));
        }
    }

    #[test]
    fn a_message_that_is_joined_in_its_middle_is_not_damaged() {
        let mut inbox = Inbox::default();
        inbox.join();

        let mut wire = [0; MAX_WIRE];
        let wire = encode(&ToHost::Frame(Frame::default()), &mut wire);
        let stream = [
            &wire[20..],
            wire,
            &wire[..9],
            &[wire[9] ^ 0x10],
            &wire[10..],
        ]
        .concat();
        assert_eq!(
            stream
                .into_iter()
                .filter_map(|byte| inbox.take(byte))
                .count(),
            1
        );
        assert_eq!(
            inbox.counts,
            Counts {
                messages: 1,
                damaged: 1,
                ..Counts::default()
            }
        );
    }
}
