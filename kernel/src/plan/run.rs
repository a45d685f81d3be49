//! One way of computing a scene, picture by picture, and how far two of them are apart on the display.

use crate::error::Error;
use crate::form::{Direction, Form};
use crate::params::Parameters;
use crate::real::Real;
use crate::state::State;

/// The directions of both rods as they would be drawn.
pub(super) type Picture = [Direction<f32>; 2];

/// A motion in the form `F`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run<R: Real, F: Form<R>> {
    form: F,
    carried: F::Carried,
    per_frame: u32,
    precision: core::marker::PhantomData<R>,
}

impl<R: Real, F: Form<R>> Run<R, F> {
    /// With `per_frame` steps for each of the `rate` pictures of a second.
    pub fn new((parameters, state): &(Parameters<R>, State<R>), rate: u16, per_frame: u32) -> Result<Self, Error> {
        let form = F::new(parameters, R::of(1.0 / (f64::from(rate) * f64::from(per_frame))))?;
        let carried = form.start(state)?;
        Ok(Self { form, carried, per_frame, precision: core::marker::PhantomData })
    }

    /// The next picture.
    pub fn advance(&mut self) -> Picture {
        self.form.advance(&mut self.carried, self.per_frame);
        self.form.directions(&self.carried).map(|direction| direction.map(|x| x.to_f64() as f32))
    }
}

/// How far the farther of the two bobs is off, pixels, where `rods` are as long as given; NaN if anything is.
pub(super) fn distance(rods: [f32; 2], a: &Picture, b: &Picture) -> f32 {
    let difference = |rod: usize, axis: usize| rods[rod] * (a[rod][axis] - b[rod][axis]);
    let elbow = [difference(0, 0), difference(0, 1)];
    let tip = [elbow[0] + difference(1, 0), elbow[1] + difference(1, 1)];
    let [elbow, tip] = [elbow, tip].map(|[x, y]| x * x + y * y);
    libm::sqrtf(if elbow > tip { elbow } else { tip })
}
