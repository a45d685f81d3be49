//! The serial link under fire: bits flipped at random between encoder and decoder.

use fastrand::Rng;
use firmware::protocol::{Decoder, Frame, MAX_WIRE, Message, encode};

/// What became of the frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ThrottledCounter {
    /// Frames sent.
    pub sent: u64,
    /// Frames of which a bit was flipped on the way.
    pub damaged: u64,
    /// Frames received as they were sent.
    pub received: u64,
    /// Frames received that were never sent: damage that got past the check. Must be 0.
    pub forged: u64,
    /// Frames that came undamaged and were not received. Must be 0.
    pub missed: u64,
    /// Frames missing from the sequence of those received.
    pub lost: u64,
}

/// A link that flips each bit with the same chance.
pub struct Flips {
    rng: Rng,
    /// ln(1 - chance)
    log_of_unflipped: f64,
    /// Bits until the next flip.
    left: u64,
    decoder: Decoder,
    expected: u32,
    tally: ThrottledCounter,
}

impl Flips {
    /// With the same seed, the same flips.
    pub fn new(seed: u64, chance: f64) -> Self {
        let mut flips = Self {
            rng: Rng::with_seed(seed),
            log_of_unflipped: (-chance).ln_1p(),
            left: 0,
            decoder: Decoder::default(),
            expected: 0,
            tally: ThrottledCounter::default(),
        };
        flips.left = flips.gap();
        flips
    }

    /// Bits from one flip to the next: how long chance misses.
    fn gap(&mut self) -> u64 {
        ((1.0 - self.rng.f64()).ln() / self.log_of_unflipped) as u64
    }

    /// Sends one frame of random content, and takes what comes.
    pub fn send(&mut self) {
        let sent = self.frame();
        let mut wire = [0; MAX_WIRE];
        let mut bytes = encode(&sent, &mut wire).to_vec();
        let damaged = self.flip(&mut bytes);
        let mut received = false;
        for byte in bytes {
            let Some(message) = self.decoder.push(byte) else { continue };
            let Ok((kind, fields)) = message else { continue };
            let frame = (kind == Frame::KIND).then(|| Frame::read(fields)).flatten();
            if frame != Some(sent) || received {
                self.tally.forged += 1;
            } else {
                received = true;
                self.tally.lost += u64::from(sent.sequence.wrapping_sub(self.expected));
                self.expected = sent.sequence.wrapping_add(1);
            }
        }
        self.tally.sent += 1;
        self.tally.damaged += u64::from(damaged);
        self.tally.received += u64::from(received);
        self.tally.missed += u64::from(!damaged && !received);
    }

    /// What became of the frames so far. All that are missing up to the last one received are counted as lost.
    pub fn tally(&self) -> ThrottledCounter {
        let unseen = (self.tally.sent as u32).wrapping_sub(self.expected);
        ThrottledCounter { lost: self.tally.lost + u64::from(unseen), ..self.tally }
    }

    fn frame(&mut self) -> Frame {
        let rng = &mut self.rng;
        Frame {
            sequence: self.tally.sent as u32,
            dropped: rng.u32(..4),
            lost: rng.u32(..4),
            scene: rng.u8(..12),
            paused: 0,
            step: rng.u32(..),
            time: rng.f64(),
            mass_ratio: rng.f32(),
            start_angle: rng.f32(),
            state: [rng.f32(), rng.f32(), rng.f32(), rng.f32()],
            energy_error: 0.0,
            method: rng.u8(..8),
            way_steps: rng.u16(..),
            horizon: f32::INFINITY,
            is_looking: rng.u8(..2),
            scene_cycles: rng.u32(..),
            busy_cycles: rng.u32(..),
        }
    }

    /// Whether a bit was flipped.
    fn flip(&mut self, bytes: &mut [u8]) -> bool {
        let bits = 8 * bytes.len() as u64;
        let mut flipped = false;
        while self.left < bits {
            let at = self.left as usize;
            bytes[at / 8] ^= 1 << (at % 8);
            flipped = true;
            self.left += 1 + self.gap();
        }
        self.left -= bits;
        flipped
    }
}
