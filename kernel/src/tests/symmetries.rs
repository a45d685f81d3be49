//! Time reversal, mirror image and scaling laws. All except the return to the start are
//! bit-identical.

use double_pendulum::{Parameters, Pendulum, Real, State};

use super::{assert_near, random, tolerances};

fn run<R: Real>(parameters: &Parameters<R>, start: State<R>, dt: R) -> State<R> {
    let pendulum = Pendulum::new(parameters).expect("valid parameters");
    (0..256).fold(start, |state, _| pendulum.step(&state, dt))
}

fn stronger<R: Real>(State { a1, a2, p1, p2 }: State<R>, by: R) -> State<R> {
    State {
        a1,
        a2,
        p1: p1 * by,
        p2: p2 * by,
    }
}

fn hold<R: Real>() {
    let [two, four, eight] = [2.0, 4.0, 8.0].map(R::from_f64);
    for (pendulum, start) in random::pendulums::<R>(3, 200) {
        // Reversed momenta reverse the velocities, but not the forces.
        let [w1, w2, f1, f2] = pendulum.derivatives(&start.into());
        assert_eq!(
            pendulum.derivatives(&stronger(start, -R::ONE).into()),
            [-w1, -w2, f1, f2]
        );

        // The step is so short that neither rod can turn by more than a twentieth of a radian.
        let bounds = pendulum.bounds(&start);
        let dt = R::from_f64(0.05) / (bounds.w1 + bounds.w2);
        let parameters @ &Parameters { m1, m2, l1, l2, g } = pendulum.parameters();
        let end = run(parameters, start, dt);
        let mirrored = |state: State<R>| State::from(<[R; 4]>::from(state).map(|x| -x));
        assert_eq!(run(parameters, mirrored(start), dt), mirrored(end));

        // The scaling laws.
        let longer = Parameters {
            l1: l1 * four,
            l2: l2 * four,
            ..*parameters
        };
        assert_eq!(
            run(&longer, stronger(start, eight), dt * two),
            stronger(end, eight)
        );
        let heavier = Parameters {
            g: g * four,
            ..*parameters
        };
        assert_eq!(
            run(&heavier, stronger(start, two), dt * R::HALF),
            stronger(end, two)
        );
        let bigger = Parameters {
            m1: m1 * two,
            m2: m2 * two,
            ..*parameters
        };
        assert_eq!(run(&bigger, stronger(start, two), dt), stronger(end, two));
    }
}

#[test]
fn symmetries_hold_in_either_precision() {
    hold::<f32>();
    hold::<f64>();
}

#[test]
fn reversed_momenta_return_to_the_start() {
    for (pendulum, start) in random::pendulums::<f64>(1, 200) {
        let parameters = pendulum.parameters();
        let bounds = pendulum.bounds(&start);
        let dt = 0.002 / bounds.w1.max(bounds.w2);
        let back = stronger(
            run(parameters, stronger(run(parameters, start, dt), -1.0), dt),
            -1.0,
        );

        for (name, back, start, scale) in [
            ("a1", back.a1, start.a1, 1.0),
            ("a2", back.a2, start.a2, 1.0),
            ("p1", back.p1, start.p1, bounds.p1),
            ("p2", back.p2, start.p2, bounds.p2),
        ] {
            assert_near(name, back, start, scale, tolerances::RETURN, parameters);
        }
    }
}
