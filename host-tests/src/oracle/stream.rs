//! What a board is to stream of the page's scene, by the kernel alone: nothing of the firmware but its step.

use double_pendulum::form::{DirectionForm, Form, Winding};
use double_pendulum::{Parameters, State};
use firmware::config::{DT, GRAVITY, ROD};

/// Equal rods let go from rest, in compensated `f32`.
#[derive(Clone, Debug)]
pub struct Expected {
    form: DirectionForm<f32>,
    carried: <DirectionForm<f32> as Form<f32>>::Carried,
    windings: [Winding<f32>; 2],
}

impl Expected {
    /// From rest with both rods at `angle` (rad).
    pub fn new(mass_ratio: f32, angle: f32) -> Self {
        let parameters = Parameters::equal_rods(mass_ratio, ROD, GRAVITY);
        let form = DirectionForm::new(&parameters, DT).expect("the board simulates it");
        let carried = form.start(&State::at_rest(angle, angle)).expect("the board starts there");
        Self { form, carried, windings: [Winding::new(angle); 2] }
    }

    /// Makes `steps` steps.
    pub fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.form.advance(&mut self.carried, 1);
            let directions = self.form.directions(&self.carried);
            self.windings.iter_mut().zip(directions).for_each(|(winding, direction)| winding.observe(direction));
        }
    }

    /// a1, a2, p1, p2 as they are streamed.
    pub fn state(&self) -> [f32; 4] {
        let State { a1, a2, p1, p2 } = self.form.state(&self.carried);
        let [winding1, winding2] = &self.windings;
        [winding1.unwrap(a1), winding2.unwrap(a2), p1, p2].map(|number| number as f32)
    }
}
