//! The methods of a job: the type of each method, and the methods that boards have.

use double_pendulum::golden::{Bits, Golden};
use double_pendulum::parts::Canonical;
use double_pendulum::{
    ClosedFormF32, ClosedFormF64, DirectionF32, DirectionF32Plain, Error, Fixed32, Fixed64, Form,
    FormVisitor, HamiltonF32, HamiltonF64, Method,
};

use super::comparison::{Micromath, Textbook};
use super::run::{checked, start};
use super::{Reading, Request, answer, crc};

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
pub const ON_BOARDS: &[Method] = BoardMotion::METHODS;

double_pendulum::motions! {
    /// A motion in progress, by a method of [`ON_BOARDS`].
    ///
    /// Without `extrapolation12-f64` and `extrapolation16-f64` an application is smaller, and `f64`
    /// in software is slow.
    pub enum BoardMotion {
        Rk4F64(HamiltonF64),
        Rk4F32(HamiltonF32),
        Rk4F32Direction(DirectionF32),
        Rk4F32DirectionPlain(DirectionF32Plain),
        Rk4Fixed32(Fixed32),
        Extrapolation8Fixed64(Fixed64<8>),
        Extrapolation10Fixed64(Fixed64<10>),
        Extrapolation12Fixed64(Fixed64<12>),
        Extrapolation16Fixed64(Fixed64<16>),
        ClosedFormF64(ClosedFormF64),
        ClosedFormF32(ClosedFormF32),
    }
}

impl BoardMotion {
    /// Returns the motion of a request at its start. Refuses, by [`Error::NotDrawn`], methods that
    /// boards do not have.
    pub fn start(request: &Request) -> Result<Self, Error> {
        let (parameters, state) = checked(request)?;
        Self::new(request.method, &parameters, &state, request.dt)
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
    /// ([`BoardMotion::start`], [`Job::new`](super::Job::new)), before any call; or
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
    /// Returns the kernel's error if it refuses the request, as [`BoardMotion::start`] does. A motion
    /// that diverges is no error.
    pub fn crc(&self) -> Result<u32, Error> {
        visit(self.method, CrcOf(self))
    }
}
