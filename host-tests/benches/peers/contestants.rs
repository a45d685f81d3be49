//! Who takes part: this kernel and two integration libraries, each in f64 and each keeping what it always keeps.

use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};
use double_pendulum::form::{DirectionForm, ExtrapolatedForm, Form, Plain, Stepper};
use double_pendulum::{Motion, State};
use host_tests::oracle::reference::Reference;
use host_tests::oracle::trials::largest_difference;
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, Rk4, System, Vector4};

use crate::equations::{Book, Equations, PARAMETERS, Pendulum};

/// A motion from rest.
pub struct Scene {
    pub name: &'static str,
    /// Both angles, rad.
    angle: f64,
    /// s.
    seconds: u32,
}

pub const SCENES: [Scene; 2] =
    [Scene { name: "regular", angle: 0.5, seconds: 10 }, Scene { name: "chaotic", angle: 2.0, seconds: 5 }];

/// A scene is followed in parts, so that errors can be taken within it.
pub const PARTS: u32 = 8;

impl Scene {
    /// So many parts of the scene, s.
    fn time(&self, parts: u32) -> f64 {
        f64::from(self.seconds * parts) / f64::from(PARTS)
    }

    fn start(&self) -> [f64; 4] {
        [self.angle, self.angle, 0.0, 0.0]
    }

    /// The step that divides a part by `steps`, s.
    fn step(&self, steps: u32) -> f64 {
        self.time(1) / f64::from(steps)
    }

    /// Steps of RK4 in a part: 256 a second.
    pub fn classical_steps(&self) -> u32 {
        256 * self.seconds / PARTS
    }

    /// The exact states after each of the last parts, counted.
    pub fn exact(&self) -> Vec<(u32, State<f64>)> {
        let mut reference = Reference::new(&PARAMETERS, &Motion::at_rest(self.angle, self.angle));
        let mut at = |parts| {
            reference.advance_to(self.time(parts));
            (parts, reference.state())
        };
        (PARTS / 2 + 1..=PARTS).map(&mut at).collect()
    }
}

/// One way to follow a scene.
pub struct Contestant {
    pub name: &'static str,
    /// This kernel, not a peer.
    pub own: bool,
    /// The greatest effort worth trying.
    pub most: u32,
    /// The state after so many parts of a scene. The effort, the last argument, is the number of steps to a part, or for
    /// an integrator that chooses its steps a tolerance of 10^(-effort/8).
    pub run: Run,
}

impl Contestant {
    /// The largest error of an angle at the `exact` states, rad.
    pub fn error(&self, scene: &Scene, exact: &[(u32, State<f64>)], effort: u32) -> f64 {
        let errors = exact.iter().map(|&(parts, exact)| {
            let state = (self.run)(scene, parts, effort).into();
            largest_difference(&[state], &[exact])
        });
        errors.fold(0.0, f64::max)
    }
}

type Run = fn(&Scene, u32, u32) -> [f64; 4];

const fn own(name: &'static str, run: Run) -> Contestant {
    Contestant { name, own: true, most: 8192, run }
}

const fn peer(name: &'static str, run: Run) -> Contestant {
    Contestant { name, own: false, most: 8192, run }
}

/// A peer that chooses its steps; below a tolerance of 1e-16 there is nothing.
const fn adaptive(name: &'static str, run: Run) -> Contestant {
    Contestant { name, own: false, most: 128, run }
}

/// Classical RK4; this kernel's plain step first.
pub const CLASSICAL: &[Contestant] = &[
    own("double-pendulum", own_step),
    own("double-pendulum, direction form", form::<DirectionForm<f64, Plain>>),
    own("double-pendulum, direction form compensated", form::<DirectionForm<f64>>),
    peer("ode_solvers, the book's equations", |scene, parts, steps| ode_solvers_rk4(Book, scene, parts, steps)),
    peer("ode_solvers, this kernel's equations", |scene, parts, steps| {
        ode_solvers_rk4(pendulum(), scene, parts, steps)
    }),
    peer("differential-equations, the book's equations", |scene, parts, steps| {
        differential_rk4(Book, scene, parts, steps)
    }),
    peer("differential-equations, this kernel's", |scene, parts, steps| {
        differential_rk4(pendulum(), scene, parts, steps)
    }),
];

/// For tight errors: order 16, and this kernel's RK4 beside it.
pub const TIGHT: &[Contestant] = &[
    own("double-pendulum, direction form extrapolated to order 16", form::<ExtrapolatedForm<16>>),
    own("double-pendulum, direction form of RK4", form::<DirectionForm<f64>>),
    adaptive("ode_solvers DOP853, the book's equations", |scene, parts, effort| {
        ode_solvers_dop853(Book, scene, parts, effort)
    }),
    adaptive("ode_solvers DOP853, this kernel's equations", |scene, parts, effort| {
        ode_solvers_dop853(pendulum(), scene, parts, effort)
    }),
    adaptive("differential-equations DOP853, the book's equations", |scene, parts, effort| {
        differential_dop853(Book, scene, parts, effort)
    }),
    adaptive("differential-equations DOP853, this kernel's", |scene, parts, effort| {
        differential_dop853(pendulum(), scene, parts, effort)
    }),
];

fn pendulum() -> Pendulum {
    Pendulum::with_trig(PARAMETERS).unwrap_or_else(|error| panic!("{error}"))
}

fn own_step(scene: &Scene, parts: u32, steps: u32) -> [f64; 4] {
    let (pendulum, dt) = (pendulum(), scene.step(steps));
    (0..parts * steps).fold(scene.start().into(), |state, _| pendulum.step(&state, dt)).into()
}

fn form<F: Form<f64>>(scene: &Scene, parts: u32, steps: u32) -> [f64; 4] {
    let end = || {
        let mut motion = Stepper::<f64, F>::new(&PARAMETERS, &scene.start().into(), scene.step(steps))?;
        motion.advance(parts * steps);
        Ok::<_, double_pendulum::Error>(motion.state().into())
    };
    end().unwrap_or_else(|error| panic!("{error}"))
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

fn ode_solvers_rk4(equations: impl Equations, scene: &Scene, parts: u32, steps: u32) -> [f64; 4] {
    let start = Vector4::from(scene.start());
    let mut stepper = Rk4::new(Problem(equations), 0.0, start, scene.time(parts), scene.step(steps));
    stepper.integrate().unwrap_or_else(|error| panic!("{error}"));
    stepper.y_out().last().map_or(LOST, |&z| z.into())
}

fn differential_rk4(equations: impl Equations, scene: &Scene, parts: u32, steps: u32) -> [f64; 4] {
    let problem = Problem(equations);
    let method = ExplicitRungeKutta::rk4(scene.step(steps)).max_steps(usize::MAX);
    match IVP::ode(&problem, 0.0, scene.time(parts), scene.start()).method(method).solve() {
        Ok(solution) => solution.last().map_or(LOST, |(_, z)| *z),
        Err(error) => panic!("{error:?}"),
    }
}

/// What an integrator has found that gives up, as some do at tolerances near the resolution of f64.
const LOST: [f64; 4] = [f64::NAN; 4];

fn tolerance(effort: u32) -> f64 {
    10_f64.powf(-f64::from(effort) / 8.0)
}

fn ode_solvers_dop853(equations: impl Equations, scene: &Scene, parts: u32, effort: u32) -> [f64; 4] {
    let (start, end, tolerance) = (Vector4::from(scene.start()), scene.time(parts), tolerance(effort));
    let mut stepper = Dop853::new(Problem(equations), 0.0, end, end, start, tolerance, tolerance);
    stepper.set_output(OutputType::Sparse);
    match stepper.integrate() {
        Ok(_) => stepper.y_out().last().map_or(LOST, |&z| z.into()),
        Err(_) => LOST,
    }
}

fn differential_dop853(equations: impl Equations, scene: &Scene, parts: u32, effort: u32) -> [f64; 4] {
    let (problem, tolerance) = (Problem(equations), tolerance(effort));
    let method = ExplicitRungeKutta::dop853().rtol(tolerance).atol(tolerance);
    match IVP::ode(&problem, 0.0, scene.time(parts), scene.start()).method(method).solve() {
        Ok(solution) => solution.last().map_or(LOST, |(_, z)| *z),
        Err(_) => LOST,
    }
}
