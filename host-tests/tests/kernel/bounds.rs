//! Bounds from the energy: no motion exceeds them and some state reaches each; and the certificate
//! that no rod turns over.

use std::f64::consts::PI;

use double_pendulum::parts::DirectionF64;
use double_pendulum::{Bounds, Error, Motion, Parameters, Pendulum, Real, State};
use exact::optimised::Step;
use exact::taylor::Reference;
use exact::trials::apart;
use exact::{random, tolerances};
use fastrand::Rng;

/// The excess over the bounds from the energy along 100 steps of RK4, in which no rod turns by more
/// than 0.05 rad each, relative to each bound: the energy error of the steps (measured: no excess
/// at all).
const BOUNDS_DRIFT: f64 = 1e-6;

/// The error of one admissible step, divided by the fastest rate times dt, which is 1/4: rad in an
/// angle, and in units of the fastest rate in a velocity. The first value is for RK4 in angles
/// (`Pendulum::step`), the second for the direction form. They were measured for the worst motions
/// that a search found over masses 1e-6..1e6 and lengths 1:100..100:1: 2.8e-5 and 7.7e-5.
const ADMISSIBLE: [f64; 2] = [3e-5, 8e-5];

fn shares<R: Real>(pendulum: &Pendulum<R>, bounds: &Bounds<R>, state: &State<R>) -> [f64; 7] {
    let motion = pendulum.to_motion(state);
    let [v1, v2] = pendulum
        .velocities(&motion)
        .map(|v| (v.x * v.x + v.y * v.y).sqrt());
    let bending = (motion.w1 - motion.w2).abs();
    let reached = [
        motion.w1.abs(),
        motion.w2.abs(),
        bending,
        state.p1.abs(),
        state.p2.abs(),
        v1,
        v2,
    ];

    let Bounds {
        w1,
        w2,
        elbow,
        p1,
        p2,
        v1,
        v2,
    } = *bounds;

    let bounds = [w1, w2, elbow, p1, p2, v1, v2];
    std::array::from_fn(|i| (reached[i] / bounds[i]).to_f64())
}

fn hold<R: Step>() -> Result<(), Error> {
    let in_f64 = random::pendulums::<f64>(1, 10_000);
    for ((pendulum, start), (exact, start_in_f64)) in random::pendulums::<R>(1, 10_000).zip(in_f64)
    {
        let bounds = pendulum.bounds(&start);
        let dt = R::from_f64(0.05) / (bounds.w1 + bounds.w2);
        let mut state = start;
        for _ in 0..100 {
            state = R::step(&pendulum, &state, dt);
            let shares = shares(&pendulum, &bounds, &state);
            let are_kept = shares.iter().all(|share| *share <= 1.0 + BOUNDS_DRIFT);
            assert!(
                are_kept,
                "{shares:?} for {:?} from {start:?}",
                pendulum.parameters()
            );
        }

        let step = pendulum.admissible_step(&start)?.to_f64();
        let error = (step / exact.admissible_step(&start_in_f64)? - 1.0).abs();
        assert!(
            error <= tolerances::FORMULAS.of::<R>(),
            "{error:e} for {:?} from {start:?}",
            pendulum.parameters()
        );
    }

    // Special cases: nothing moves, or there is no gravity.
    let free = Pendulum::new(&Parameters::equal_rods(R::ONE, R::ONE, R::ZERO))?;
    let hanging = State::at_rest(R::ZERO, R::ZERO);
    assert!(!free.admissible_step(&hanging)?.is_finite());
    let [once, twice] = [R::ONE, R::TWO].map(|p1| free.admissible_step(&State { p1, ..hanging }));
    assert_eq!(once?, twice? + twice?);
    let hung = Pendulum::new(&Parameters::equal_rods(R::ONE, R::ONE, R::from_f64(9.81)))?;
    assert!(hung.admissible_step(&hanging)? < hung.modes()?.step_limit());
    Ok(())
}

#[test]
fn bounds_and_admissible_steps_hold_in_either_precision() -> Result<(), Error> {
    hold::<f32>()?;
    hold::<f64>()
}

/// The pendulum hangs straight and is pushed such that a quantity takes the largest value that its
/// energy allows.
#[test]
fn each_bound_is_reached_by_some_state() {
    for (pendulum, _) in random::pendulums::<f64>(2, 1000) {
        let &Parameters { m1, m2, l1, l2, .. } = pendulum.parameters();

        // Bob 2 is at rest: w1 and v1 reach their bounds.
        let still2 = Motion {
            w1: 1.0,
            w2: -l1 / l2,
            ..Motion::default()
        };

        // p1 = 0: w2 reaches its bound.
        let opposed = Motion {
            w1: -m2 * l2 / ((m1 + m2) * l1),
            w2: 1.0,
            ..Motion::default()
        };

        // Both bobs have the same velocity: p1 reaches its bound.
        let straight = Motion {
            w1: 1.0,
            w2: 0.0,
            ..Motion::default()
        };

        // Bob 1 is at rest: p2 and v2 reach their bounds.
        let lower = Motion {
            w1: 0.0,
            w2: 1.0,
            ..Motion::default()
        };

        // p1 + p2 = 0: w1 - w2 reaches its bound.
        let bending = Motion {
            w1: m2 * l2 * (l1 + l2),
            w2: -l1 * (m2 * l2 + (m1 + m2) * l1),
            ..Motion::default()
        };

        let motions = [
            (still2, [0, 5]),
            (opposed, [1, 1]),
            (bending, [2, 2]),
            (straight, [3, 3]),
            (lower, [4, 6]),
        ];

        for (motion, reached) in motions {
            let state = pendulum.to_state(&motion);
            let shares = shares(&pendulum, &pendulum.bounds(&state), &state);
            for i in reached {
                let error = (shares[i] - 1.0).abs() * m1 / (m1 + m2);
                assert!(error < tolerances::FORMULAS.double, "bound {i}: {shares:?}");
            }
        }
    }
}

#[test]
fn certified_motions_do_not_turn_over() {
    let mut certified = 0;
    for (pendulum, State { a1, a2, .. }) in random::pendulums::<f64>(3, 2000) {
        let start = State::at_rest(0.5 * a1, 0.5 * a2);
        if pendulum.cannot_turn_over(&start) {
            certified += 1;
            let bounds = pendulum.bounds(&start);
            let dt = 0.05 / (bounds.w1 + bounds.w2);
            let mut state = start;
            for _ in 0..2000 {
                state = f64::step(&pendulum, &state, dt);
                assert!(
                    state.a1.abs() < PI && state.a2.abs() < PI,
                    "{:?} from {start:?}",
                    pendulum.parameters()
                );
            }
        }
    }

    assert!(certified > 200, "only {certified} of 2000 certified");
}

#[test]
fn certificate_ends_at_the_energy_of_the_saddle() {
    for (pendulum, _) in random::pendulums::<f64>(4, 10_000) {
        let &Parameters { m1, m2, l1, l2, .. } = pendulum.parameters();
        let first = usize::from(m2 * l2 < (m1 + m2) * l1);
        let limit = pendulum.turnover_energy();
        // The rod that turns over first is at `angle`, and its kinetic energy is `share` of the
        // limit.
        let at = |angle: f64, share: f64| {
            let mut motion = [0.0; 4];
            motion[first] = angle;
            motion[2 + first] =
                (2.0 * limit * share / pendulum.mass_matrix(-1.0)[first][first]).sqrt();
            pendulum.to_state(&motion.into())
        };
        assert!(
            (pendulum.energy_above_rest(&at(PI, 0.0)) / limit - 1.0).abs()
                < tolerances::FORMULAS.double
        );
        assert!(
            !pendulum.cannot_turn_over(&at(PI, 1e-6)),
            "past the saddle, yet certified"
        );
        assert!(
            pendulum.cannot_turn_over(&at(PI - 1e-3, 0.0)),
            "short of the saddle, yet not certified"
        );
    }
}

/// A known limit: with momenta and a heavy bob 2, the certificate in `f32` can be wrong, because
/// terms of the kinetic energy cancel.
#[test]
fn certificate_of_a_heavy_moving_bob_has_the_documented_error() -> Result<(), Error> {
    let parameters = Parameters::equal_rods(1e4_f32, 1.0, 9.81);
    let state = State {
        a1: 0.453_992_46_f32,
        a2: 0.447_248_34,
        p1: -37_276.973,
        p2: -37_830.71,
    };

    let exact = Pendulum::new(&parameters.cast::<f64>())?;
    let excess = exact.energy_above_rest(&state.cast()) / exact.turnover_energy() - 1.0;
    let allowed = f64::from(f32::EPSILON) * 10_001.0_f64.sqrt();
    assert!(3e-6 < excess && excess < allowed, "{excess}");

    assert!(Pendulum::new(&parameters)?.cannot_turn_over(&state));
    assert!(!exact.cannot_turn_over(&state.cast()));
    Ok(())
}

fn extreme_parameters(rng: &mut Rng) -> Parameters<f64> {
    let [m1, ratio, l1, l2] = [(0.1, 10.0), (1e-6, 1e6), (0.1, 10.0), (0.1, 10.0)]
        .map(|(low, high)| random::log_uniform(rng, low, high));
    Parameters {
        m1,
        m2: m1 * ratio,
        l1,
        l2,
        g: if rng.u8(..4) == 0 { 0.0 } else { 9.81 },
    }
}

/// Returns a random motion. In half of the motions the rods are almost straight, because a light
/// bob 1 is fastest there.
fn fast_motion(rng: &mut Rng, &Parameters { m1, m2, l1, l2, .. }: &Parameters<f64>) -> Motion<f64> {
    let a1 = PI * random::symmetric(rng);
    let snap = if rng.bool() {
        (m1 / (m1 + m2)).sqrt()
    } else {
        PI
    };

    // Speeds span four decades around the pendulum's own scale, sqrt(g (l1 + l2)).
    let speed = random::log_uniform(rng, 0.01, 100.0) * (9.81 * (l1 + l2)).sqrt();
    let w1 = speed / l1 * random::symmetric(rng);
    let w2 = if rng.bool() {
        -w1 * l1 / l2
    } else {
        speed / l2 * random::symmetric(rng)
    };
    Motion {
        a1,
        a2: a1 - snap * random::symmetric(rng),
        w1,
        w2,
    }
}

fn miss(
    pendulum: &Pendulum<f64>,
    start: &Motion<f64>,
    next: &State<f64>,
    dt: f64,
    rate: f64,
) -> f64 {
    let mut reference = Reference::new(pendulum.parameters(), start);
    reference.advance_to(dt);
    let exact = reference.motion();
    let next = pendulum.to_motion(next);
    let [w1, w2] = [next.w1 - exact.w1, next.w2 - exact.w2].map(f64::abs);
    apart(next.a1, exact.a1)
        .max(apart(next.a2, exact.a2))
        .max(w1 / rate)
        .max(w2 / rate)
}

/// The largest error of RK4 in angles that is known: 7.1e-6 rad.
fn worst_case() -> Result<(Parameters<f64>, Motion<f64>), Error> {
    let parameters = Parameters {
        m1: 1.0,
        m2: 3.731703647185122,
        l1: 1.0,
        l2: 1e-4,
        g: 0.0,
    };
    let start = State {
        a1: 7.3603636468515985,
        a2: 7.31492386032851,
        p1: -0.12881001036381462,
        p2: 1.4811132778578745e-5,
    };
    Ok((parameters, Pendulum::new(&parameters)?.to_motion(&start)))
}

/// The largest error must reach a third of the bound, otherwise the steps would be too short.
#[test]
fn an_admissible_step_resolves_every_motion() -> Result<(), Error> {
    let mut rng = Rng::with_seed(5);
    let mut largest = [0.0_f64; 2];
    let mut cases = vec![worst_case()?];
    for _ in 0..3000 {
        let parameters = extreme_parameters(&mut rng);
        let start = fast_motion(&mut rng, &parameters);
        cases.push((parameters, start));
    }

    for (parameters, start) in cases {
        let pendulum = Pendulum::new(&parameters)?;
        let state = pendulum.to_state(&start);
        let dt = pendulum.admissible_step(&state)?;
        let rate = 0.25 / dt;

        let mut direction = pendulum.run::<DirectionF64>(&state, dt)?;
        direction.advance(1)?;
        let after = [pendulum.step(&state, dt), direction.state()];
        for (i, next) in after.iter().enumerate() {
            let miss = miss(&pendulum, &start, next, dt, rate) / (rate * dt);
            assert!(
                miss <= ADMISSIBLE[i],
                "form {i}: {miss:e} for {parameters:?} from {start:?}"
            );
            largest[i] = largest[i].max(miss);
        }
    }

    println!("classical step and direction form miss at most {largest:?}");
    for (largest, allowed) in largest.into_iter().zip(ADMISSIBLE) {
        assert!(
            largest >= allowed / 3.0,
            "never above {largest:e}: the limit is timid"
        );
    }

    Ok(())
}
