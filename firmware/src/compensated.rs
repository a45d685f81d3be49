//! A motion in `f32` whose additions lose nothing: for starts that differ by less than plain `f32` can tell apart.

use double_pendulum::{State, rk4};

/// The state and, beside it, what its numbers are too short to hold.
///
/// A step's increment is far smaller than the state it is added to, so a plain sum drops its last digits every time;
/// here they are kept and added with the next increment (compensated summation, W. Kahan 1965).
#[derive(Clone, Copy, Debug)]
pub struct Compensated {
    state: [f32; 4],
    rest: [f32; 4],
}

impl Compensated {
    /// At `state`.
    pub fn new(state: State<f32>) -> Self {
        Self { state: state.into(), rest: [0.0; 4] }
    }

    /// The sum of this and `change`, which may be smaller than the state's last digit.
    pub fn moved(self, change: [f32; 4]) -> Self {
        let [mut state, mut rest] = [[0.0; 4]; 2];
        for i in 0..4 {
            let added = change[i] + self.rest[i];
            state[i] = self.state[i] + added;
            rest[i] = added - (state[i] - self.state[i]);
        }
        Self { state, rest }
    }

    /// A time `dt` (s) later, by one RK4 step of the equations z' = `derivatives`(z).
    pub fn step(self, derivatives: impl Fn(&[f32; 4]) -> [f32; 4], dt: f32) -> Self {
        let ahead = |change: &[f32; 4]| derivatives(&core::array::from_fn(|i| self.state[i] + change[i]));
        self.moved(rk4::step(ahead, &[0.0; 4], dt))
    }

    /// The state, rounded.
    pub fn state(&self) -> State<f32> {
        self.state.into()
    }

    /// How far angle 1 and angle 2 are ahead of those of `other`, rad.
    pub fn ahead_of(&self, other: &Self) -> [f32; 2] {
        core::array::from_fn(|i| (self.state[i] - other.state[i]) + (self.rest[i] - other.rest[i]))
    }
}
