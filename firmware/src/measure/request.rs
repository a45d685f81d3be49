//! What to run, as one line of text, and what came out, as another.

use core::fmt;

use double_pendulum::{Parameters, State};

/// One run: which arithmetic, from where, how far.
///
/// As text: the name, the samples, the steps, then m1 m2 l1 l2 g a1 a2 dt as the hexadecimal bits of their `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request<'a> {
    /// Name of the [`Subject`](super::Subject).
    pub subject: &'a str,
    /// How many states go into the CRC.
    pub samples: u32,
    /// Steps from one sample to the next.
    pub steps: u32,
    /// Masses, lengths and gravity.
    pub parameters: Parameters<f64>,
    /// The starting angles, rad; the start is from rest.
    pub angles: [f64; 2],
    /// The step, s.
    pub dt: f64,
}

/// Why a request is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RequestError {
    /// A word is missing or is not a number.
    Malformed,
    /// No subject has this name.
    UnknownSubject,
    /// The kernel refuses the parameters.
    Refused(double_pendulum::Error),
}

impl fmt::Display for RequestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RequestError::Malformed => f.write_str("malformed request"),
            RequestError::UnknownSubject => f.write_str("unknown subject"),
            RequestError::Refused(error) => write!(f, "{error}"),
        }
    }
}

impl core::error::Error for RequestError {}

impl<'a> Request<'a> {
    /// Reads the text form.
    pub fn parse(line: &'a str) -> Result<Self, RequestError> {
        let mut words = line.split_ascii_whitespace();
        let subject = words.next().ok_or(RequestError::Malformed)?;
        let mut count = || words.next().and_then(|word| word.parse().ok()).ok_or(RequestError::Malformed);
        let [samples, steps] = [count()?, count()?];
        let mut real = || {
            let bits = words.next().and_then(|word| u64::from_str_radix(word, 16).ok());
            bits.map(f64::from_bits).ok_or(RequestError::Malformed)
        };
        let parameters = Parameters { m1: real()?, m2: real()?, l1: real()?, l2: real()?, g: real()? };
        Ok(Self { subject, samples, steps, parameters, angles: [real()?, real()?], dt: real()? })
    }
}

impl fmt::Display for Request<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Parameters { m1, m2, l1, l2, g } = self.parameters;
        let [a1, a2] = self.angles;
        write!(f, "{} {} {}", self.subject, self.samples, self.steps)?;
        [m1, m2, l1, l2, g, a1, a2, self.dt].into_iter().try_for_each(|real| write!(f, " {:016x}", real.to_bits()))
    }
}

/// What a run came to. Two runs are the same to the bit if their outcomes are equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// CRC-32 of the bits of all that is carried, at every sample.
    pub crc: u32,
    /// The last state.
    pub state: State<f64>,
}

impl Outcome {
    /// Reads the text form: the CRC, then a1 a2 p1 p2, all as hexadecimal bits.
    pub fn parse(line: &str) -> Result<Self, RequestError> {
        let mut words = line.split_ascii_whitespace();
        let crc = words.next().and_then(|word| u32::from_str_radix(word, 16).ok()).ok_or(RequestError::Malformed)?;
        let mut real = || {
            let bits = words.next().and_then(|word| u64::from_str_radix(word, 16).ok());
            bits.map(f64::from_bits).ok_or(RequestError::Malformed)
        };
        Ok(Self { crc, state: [real()?, real()?, real()?, real()?].into() })
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:08x}", self.crc)?;
        <[f64; 4]>::from(self.state).into_iter().try_for_each(|real| write!(f, " {:016x}", real.to_bits()))
    }
}
