//! The methods of a job: the type of each method, and the methods that boards have.

use double_pendulum::golden::{Bits, Golden};
use double_pendulum::parts::{Canonical, DrawnMotion};
use double_pendulum::{
    ClosedFormF64, Error, Fixed64, Form, FormVisitor, HamiltonF32, HamiltonF64, Method, State,
};

use super::comparison::{Micromath, Textbook};
use super::run::{start, start_drawn};
use super::{Reading, Request, Run, answer, crc};

/// Calls `visitor` with the type that computes `method`: a type of the kernel or, for a comparison
/// with the kernel, of this module. Returns the visitor's result. Every method has a type, so the
/// visitor is always called, once, and `visit` adds no error of its own.
///
/// This links every method. Hosts and the program `measure` use it; the application of a board does
/// not.
pub fn visit<V, T, E>(method: Method, visitor: V) -> Result<T, E>
where
    V: FormVisitor<Output = Result<T, E>>,
    E: From<Error>,
{
    match method {
        Method::Rk4F32Micromath => visitor.visit::<Canonical<f32, Micromath>>(),
        Method::TextbookF32 => visitor.visit::<Canonical<f32, Textbook>>(),
        method => method
            .visit(visitor)
            .unwrap_or_else(|| Err(Error::NotDrawn { method }.into())),
    }
}

/// The methods that every board's application links. The first is the default of `cargo simulate`.
pub const ON_BOARDS: &[Method] = &[
    Method::Rk4F64,
    Method::Rk4F32,
    Method::Rk4F32Direction,
    Method::Rk4F32DirectionPlain,
    Method::Rk4Fixed32,
    Method::Extrapolation8Fixed64,
    Method::Extrapolation10Fixed64,
    Method::Extrapolation12Fixed64,
    Method::Extrapolation16Fixed64,
    Method::ClosedFormF64,
    Method::ClosedFormF32,
];

/// A motion in progress, by a method of [`ON_BOARDS`].
#[derive(Clone, Copy, Debug)]
pub enum OnBoards {
    /// A method that scenes are drawn by ([`Method::DRAWN`]).
    Drawn(DrawnMotion),
    /// [`Method::Rk4F64`].
    Rk4F64(HamiltonF64),
    /// [`Method::Rk4F32`].
    Rk4F32(HamiltonF32),
    /// [`Method::Extrapolation8Fixed64`].
    Extrapolation8Fixed64(Fixed64<8>),
    /// [`Method::Extrapolation12Fixed64`].
    Extrapolation12Fixed64(Fixed64<12>),
    /// [`Method::Extrapolation16Fixed64`].
    Extrapolation16Fixed64(Fixed64<16>),
    /// [`Method::ClosedFormF64`].
    ClosedFormF64(ClosedFormF64),
}

impl OnBoards {
    /// Returns the motion of a request at its start. Returns `None` if boards do not have the
    /// method. `stride` and `samples` are not used.
    ///
    /// # Errors
    ///
    /// The inner result is the kernel's error if it refuses the request: parameters that describe
    /// no pendulum, a start that is not finite or out of the method's range, or a step that the
    /// method cannot make. Such a step is NaN, infinite, 0, negative or too long
    /// ([`Pendulum::check_step`]); only the closed form makes negative and long ones, but it
    /// refuses a pendulum without gravity.
    ///
    /// [`Pendulum::check_step`]: double_pendulum::Pendulum::check_step
    // Inlined, 1,176 bytes of flash and a stack frame of 5,324 bytes in `begin_work` (M3).
    #[inline(never)]
    pub fn start(request: &Request) -> Option<Result<Self, Error>> {
        Some(match request.method {
            Method::Rk4F32Direction
            | Method::Rk4F32DirectionPlain
            | Method::Rk4Fixed32
            | Method::Extrapolation10Fixed64
            | Method::ClosedFormF32 => start_drawn(request).map(Self::Drawn),
            Method::Rk4F64 => start(request).map(Self::Rk4F64),
            Method::Rk4F32 => start(request).map(Self::Rk4F32),
            Method::Extrapolation8Fixed64 => start(request).map(Self::Extrapolation8Fixed64),
            Method::Extrapolation12Fixed64 => start(request).map(Self::Extrapolation12Fixed64),
            Method::Extrapolation16Fixed64 => start(request).map(Self::Extrapolation16Fixed64),
            Method::ClosedFormF64 => start(request).map(Self::ClosedFormF64),
            // Without these an application is smaller. `f64` in software is slow.
            Method::Extrapolation12F64
            | Method::Extrapolation16F64
            | Method::Rk4F32Micromath
            | Method::TextbookF32 => return None,
        })
    }
}

impl Run for OnBoards {
    fn advance(&mut self, steps: u32) {
        match self {
            Self::Drawn(motion) => motion.advance(steps),
            Self::Rk4F64(motion) => Run::advance(motion, steps),
            Self::Rk4F32(motion) => Run::advance(motion, steps),
            Self::Extrapolation8Fixed64(motion) => Run::advance(motion, steps),
            Self::Extrapolation12Fixed64(motion) => Run::advance(motion, steps),
            Self::Extrapolation16Fixed64(motion) => Run::advance(motion, steps),
            Self::ClosedFormF64(motion) => Run::advance(motion, steps),
        }
    }

    fn state(&self) -> State<f64> {
        match self {
            Self::Drawn(motion) => motion.state(),
            Self::Rk4F64(motion) => Run::state(motion),
            Self::Rk4F32(motion) => Run::state(motion),
            Self::Extrapolation8Fixed64(motion) => Run::state(motion),
            Self::Extrapolation12Fixed64(motion) => Run::state(motion),
            Self::Extrapolation16Fixed64(motion) => Run::state(motion),
            Self::ClosedFormF64(motion) => Run::state(motion),
        }
    }

    fn sides(&self) -> Option<[[i32; 2]; 2]> {
        match self {
            Self::Drawn(motion) => (!motion.has_turns()).then(|| motion.sides()),
            Self::Rk4F64(motion) => Run::sides(motion),
            Self::Rk4F32(motion) => Run::sides(motion),
            Self::Extrapolation8Fixed64(motion) => Run::sides(motion),
            Self::Extrapolation12Fixed64(motion) => Run::sides(motion),
            Self::Extrapolation16Fixed64(motion) => Run::sides(motion),
            Self::ClosedFormF64(motion) => Run::sides(motion),
        }
    }
}

/// Computes the bits of a motion of the kernel's golden file.
pub(super) struct GoldenBits<'a>(pub &'a Golden);

impl FormVisitor for GoldenBits<'_> {
    type Output = Result<Bits, Error>;

    fn visit<F: Form>(self) -> Self::Output {
        self.0.bits::<F>()
    }
}

/// Passes every reading of a request to `each`.
struct Readings<'a, Each> {
    request: &'a Request,
    each: Each,
}

impl<E: From<Error>, Each: FnMut(&Reading) -> Result<(), E>> FormVisitor for Readings<'_, Each> {
    type Output = Result<(), E>;

    fn visit<F: Form>(self) -> Self::Output {
        answer::readings(start::<F>(self.request)?, self.request, self.each)
    }
}

/// Computes the CRC-32 of the motion of a request.
struct CrcOf<'a>(&'a Request);

impl FormVisitor for CrcOf<'_> {
    type Output = Result<u32, Error>;

    fn visit<F: Form>(self) -> Self::Output {
        Ok(crc(start::<F>(self.0)?, self.0))
    }
}

impl Request {
    /// Calls `each` with every reading, the initial one first, until it returns an error. These are
    /// `samples` + 1 readings, of `u32::MAX` samples one fewer, and `stride` times `samples` steps;
    /// their number is not limited. Every method is computed, also one that boards lack.
    ///
    /// # Errors
    ///
    /// Returns the error of `each`; the kernel's error if it refuses the request
    /// ([`OnBoards::start`], [`Job::new`](super::Job::new)), before any call; or
    /// [`Error::Diverged`] in place of the first reading that is not finite.
    pub fn readings<E: From<Error>>(
        &self,
        each: impl FnMut(&Reading) -> Result<(), E>,
    ) -> Result<(), E> {
        let request = self;
        visit(self.method, Readings { request, each })
    }

    /// Returns the CRC-32/ISO-HDLC of all numbers that the method carries, at every sample except
    /// the initial one, and then of the last state, a1, a2, p1, p2 in SI units as `f64`; all are
    /// little-endian. Without samples it is of the initial state alone. Bit-identical runs have the
    /// same CRC; runs that differ at a sample have different ones, except by a chance of 1 in 2^32.
    ///
    /// It makes `stride` times `samples` steps; their number is not limited. A start of
    /// too many turns for [`Job`](super::Job) is accepted.
    ///
    /// # Errors
    ///
    /// Returns the kernel's error if it refuses the request, as [`OnBoards::start`] does. A motion
    /// that diverges is no error.
    pub fn crc(&self) -> Result<u32, Error> {
        visit(self.method, CrcOf(self))
    }
}
