//! Who takes part: the regular scene, classical RK4 in f64, every state kept by those who always do.

use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};
use double_pendulum::trig::Own;
use double_pendulum::{Parameters, Pendulum, State};
use ode_solvers::{Rk4, System, Vector4};

/// The step, s.
const DT: f64 = 1.0 / 256.0;
const ANGLES: [f64; 2] = [0.5, 0.5];
const PARAMETERS: Parameters<f64> = Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81 };

/// One way to take the steps.
pub struct Contestant {
    pub name: &'static str,
    /// The state after so many steps.
    pub run: fn(u32) -> [f64; 4],
}

/// This kernel first.
pub const CONTESTANTS: &[Contestant] = &[
    Contestant { name: "double-pendulum", run: kernel },
    Contestant { name: "ode_solvers, the book's equations", run: |steps| ode_solvers_rk4(Book, steps) },
    Contestant { name: "ode_solvers, this kernel's equations", run: |steps| ode_solvers_rk4(pendulum(), steps) },
    Contestant { name: "differential-equations, the book's equations", run: |steps| differential_rk4(Book, steps) },
    Contestant { name: "differential-equations, this kernel's", run: |steps| differential_rk4(pendulum(), steps) },
];

/// Right-hand sides in the order a1, a2, p1, p2.
trait Equations {
    fn derivatives(&self, z: &[f64; 4]) -> [f64; 4];
}

fn pendulum() -> Pendulum<f64, Own> {
    match Pendulum::with_trig(PARAMETERS) {
        Ok(pendulum) => pendulum,
        Err(error) => panic!("{error}"),
    }
}

impl Equations for Pendulum<f64, Own> {
    fn derivatives(&self, z: &[f64; 4]) -> [f64; 4] {
        Pendulum::derivatives(self, z)
    }
}

/// The equations as the book prints them, with the standard library's sine and cosine: what a user would write.
struct Book;

impl Equations for Book {
    fn derivatives(&self, &[a1, a2, p1, p2]: &[f64; 4]) -> [f64; 4] {
        let Parameters { m1, m2, l1, l2, g } = PARAMETERS;
        let (sin, cos) = ((a1 - a2).sin(), (a1 - a2).cos());
        let den = m1 + m2 * sin * sin;
        let squares = p1 * p1 * m2 * l2 * l2 - 2.0 * p1 * p2 * m2 * l1 * l2 * cos + p2 * p2 * (m1 + m2) * l1 * l1;
        let a_1 = p1 * p2 * sin / (l1 * l2 * den);
        let a_2 = squares * (2.0 * (a1 - a2)).sin() / (2.0 * l1 * l1 * l2 * l2 * den * den);
        [
            (p1 * l2 - p2 * l1 * cos) / (l1 * l1 * l2 * den),
            (p2 * (m1 + m2) * l1 - p1 * m2 * l2 * cos) / (m2 * l1 * l2 * l2 * den),
            -(m1 + m2) * g * l1 * a1.sin() - a_1 + a_2,
            -m2 * g * l2 * a2.sin() + a_1 - a_2,
        ]
    }
}

fn kernel(steps: u32) -> [f64; 4] {
    let pendulum = pendulum();
    let mut state = State::at_rest(ANGLES[0], ANGLES[1]);
    for _ in 0..steps {
        state = pendulum.step(&state, DT);
    }
    state.into()
}

/// The same equations for either library.
struct Problem<E>(E);

impl<E: Equations> System<f64, Vector4<f64>> for Problem<E> {
    fn system(&self, _t: f64, z: &Vector4<f64>, dz: &mut Vector4<f64>) {
        *dz = self.0.derivatives(&[z[0], z[1], z[2], z[3]]).into();
    }
}

impl<E: Equations> ODE<f64, [f64; 4]> for Problem<E> {
    fn diff(&self, _t: f64, z: &[f64; 4], dz: &mut [f64; 4]) {
        *dz = self.0.derivatives(z);
    }
}

fn ode_solvers_rk4(equations: impl Equations, steps: u32) -> [f64; 4] {
    let start = Vector4::new(ANGLES[0], ANGLES[1], 0.0, 0.0);
    let mut stepper = Rk4::new(Problem(equations), 0.0, start, f64::from(steps) * DT, DT);
    match stepper.integrate() {
        Ok(_) => stepper.y_out().last().map_or([f64::NAN; 4], |z| [z[0], z[1], z[2], z[3]]),
        Err(error) => panic!("{error}"),
    }
}

fn differential_rk4(equations: impl Equations, steps: u32) -> [f64; 4] {
    let start = [ANGLES[0], ANGLES[1], 0.0, 0.0];
    let problem = Problem(equations);
    let method = ExplicitRungeKutta::rk4(DT).max_steps(usize::MAX);
    match IVP::ode(&problem, 0.0, f64::from(steps) * DT, start).method(method).solve() {
        Ok(solution) => solution.last().map_or([f64::NAN; 4], |(_, z)| *z),
        Err(error) => panic!("{error:?}"),
    }
}
