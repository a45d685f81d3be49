//! Time reversal, mirror image and the scaling laws. All but the first hold bit for bit.

use double_pendulum::{Parameters, Pendulum, Real, State};
use fastrand::Rng;

use super::{assert_near, random, tolerances};

const STEPS: usize = 256;

/// Random pendulums with a start each.
fn each_motion<R: Real>(seed: u64, mut check: impl FnMut(&Parameters<R>, State<R>)) {
    let mut rng = Rng::with_seed(seed);
    for _ in 0..200 {
        let parameters = random::parameters(&mut rng);
        let state = random::state(&mut rng, &parameters);
        check(&parameters.cast(), state.cast());
    }
}

fn run<R: Real>(parameters: &Parameters<R>, start: State<R>, dt: R) -> State<R> {
    let pendulum = Pendulum::new(parameters).expect("valid parameters");
    (0..STEPS).fold(start, |state, _| pendulum.step(&state, dt))
}

/// A step in which neither rod can turn by more than a twentieth of a radian.
fn short_step<R: Real>(parameters: &Parameters<R>, start: &State<R>) -> R {
    let bounds = Pendulum::new(parameters).expect("valid parameters").bounds(start);
    R::from_f64(0.05) / (bounds.w1 + bounds.w2)
}

fn reversed<R: Real>(State { a1, a2, p1, p2 }: State<R>) -> State<R> {
    State { a1, a2, p1: -p1, p2: -p2 }
}

#[test]
fn reversed_momenta_bring_the_start_back() {
    each_motion(1, |parameters, start: State<f64>| {
        let pendulum = Pendulum::new(parameters).expect("valid parameters");
        let bounds = pendulum.bounds(&start);
        let dt = 0.002 / bounds.w1.max(bounds.w2);
        let back = reversed(run(parameters, reversed(run(parameters, start, dt)), dt));
        let near =
            |name: &str, back, start, scale| assert_near(name, back, start, scale, tolerances::RETURN, parameters);
        near("a1", back.a1, start.a1, 1.0);
        near("a2", back.a2, start.a2, 1.0);
        near("p1", back.p1, start.p1, bounds.p1);
        near("p2", back.p2, start.p2, bounds.p2);
    });
}

fn reversal_of_the_derivatives<R: Real>() {
    each_motion::<R>(2, |parameters, state| {
        let pendulum = Pendulum::new(parameters).expect("valid parameters");
        let [w1, w2, f1, f2] = pendulum.derivatives(&state.into());
        assert_eq!(pendulum.derivatives(&reversed(state).into()), [-w1, -w2, f1, f2]);
    });
}

fn mirror_image<R: Real>() {
    each_motion::<R>(3, |parameters, start| {
        let mirrored = |state: State<R>| {
            let z: [R; 4] = state.into();
            State::from(z.map(|x| -x))
        };
        let dt = short_step(parameters, &start);
        assert_eq!(run(parameters, mirrored(start), dt), mirrored(run(parameters, start, dt)));
    });
}

/// Lengths x 4: time x 2, momenta x 8. Gravity x 4: time / 2, momenta x 2. Masses x 2: momenta x 2.
fn scaling_laws<R: Real>() {
    each_motion::<R>(4, |parameters, start| {
        let &Parameters { m1, m2, l1, l2, g } = parameters;
        let [two, four, eight] = [2.0, 4.0, 8.0].map(R::from_f64);
        let dt = short_step(parameters, &start);
        let end = run(parameters, start, dt);
        let stronger = |State { a1, a2, p1, p2 }: State<R>, by: R| State { a1, a2, p1: p1 * by, p2: p2 * by };

        let longer = Parameters { l1: l1 * four, l2: l2 * four, ..*parameters };
        assert_eq!(run(&longer, stronger(start, eight), dt * two), stronger(end, eight));
        let heavier = Parameters { g: g * four, ..*parameters };
        assert_eq!(run(&heavier, stronger(start, two), dt * R::HALF), stronger(end, two));
        let bigger = Parameters { m1: m1 * two, m2: m2 * two, ..*parameters };
        assert_eq!(run(&bigger, stronger(start, two), dt), stronger(end, two));
    });
}

fn all<R: Real>() {
    reversal_of_the_derivatives::<R>();
    mirror_image::<R>();
    scaling_laws::<R>();
}

#[test]
fn symmetries_in_either_precision() {
    all::<f32>();
    all::<f64>();
}
