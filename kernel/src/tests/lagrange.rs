//! The Lagrangian form, the Legendre transformation and the geometry, each compared with another
//! way to compute the same number.

use double_pendulum::{Motion, Parameters, Pendulum, Real, State};
use fastrand::Rng;

use super::{assert_near, random, tolerances};

/// Each paragraph relies on the paragraphs before it.
fn all<R: Real>() {
    let one = R::ONE;
    let half = R::HALF;
    let mut rng = Rng::with_seed(4);
    for _ in 0..20_000 {
        let parameters @ Parameters { m1, m2, l1, l2, g } =
            random::parameters(&mut rng).cast::<R>();
        let motion: Motion<R> = [0; 4]
            .map(|_| R::from_f64(6.0 * random::symmetric(&mut rng)))
            .into();
        let Motion { a1, a2, w1, w2 } = motion;
        let pendulum = Pendulum::new(&parameters).expect("valid parameters");
        let same = |name: &str, value: R, exact: R, scale: R| {
            assert_near(
                name,
                value,
                exact,
                scale,
                tolerances::FORMULAS.of::<R>(),
                &(parameters, motion),
            );
        };

        let kinetic = pendulum.kinetic_energy(&motion);
        let potential = pendulum.potential_energy([a1, a2]);
        let [bob1, bob2] = pendulum.positions([a1, a2]);
        let [v1, v2] = pendulum.velocities(&motion);
        same(
            "V",
            potential,
            m1 * g * bob1.y + m2 * g * bob2.y,
            (m1 + m2) * g * l1 + m2 * g * l2,
        );

        let squares = half * (m1 * (v1.x * v1.x + v1.y * v1.y) + m2 * (v2.x * v2.x + v2.y * v2.y));
        let speeds = l1 * w1.abs() + l2 * w2.abs();
        same("T", kinetic, squares, (m1 + m2) * speeds * speeds);

        // The momenta are (dL/dw1, dL/dw2), and w -> p -> w gives the same w. L is quadratic in w,
        // so that a central difference of any step is exact.
        let state @ State { p1, p2, .. } = pendulum.to_state(&motion);
        let lagrangian = |w1: R, w2: R| pendulum.lagrangian(&Motion { w1, w2, ..motion });
        let slope1 = half * (lagrangian(w1 + one, w2) - lagrangian(w1 - one, w2));
        let slope2 = half * (lagrangian(w1, w2 + one) - lagrangian(w1, w2 - one));
        let [torque1, torque2] = [pendulum.stiffness()[0][0], pendulum.stiffness()[1][1]];
        let scale = kinetic + torque1 + torque2 + (m1 + m2) * l1 * l1 + m2 * l2 * l2;
        same(
            "p1 compared with dL/dw1",
            p1,
            slope1,
            R::from_f64(8.0) * scale,
        );
        same(
            "p2 compared with dL/dw2",
            p2,
            slope2,
            R::from_f64(8.0) * scale,
        );

        let back = pendulum.to_motion(&state);
        let speed = (w1.abs() + w2.abs()) * (m1 + m2) / m1 * (l1 / l2 + l2 / l1);
        same("w1 of (p1, p2)", back.w1, w1, speed);
        same("w2 of (p1, p2)", back.w2, w2, speed * (m1 + m2) / m2);

        assert_eq!(
            pendulum.to_state(&Motion::at_rest(a1, a2)),
            State::at_rest(a1, a2)
        );
        assert_eq!(
            pendulum.to_motion(&State::at_rest(a1, a2)),
            Motion::at_rest(a1, a2)
        );

        let above = pendulum.energy_above_rest(&state);
        let least = pendulum.least_energy();
        let unlike = (m1 + m2) * (one / m1 + one / m2);
        let scale = (above - least) * unlike;
        same("H", pendulum.energy(&state), kinetic + potential, scale);
        let directions = [a1, a2].map(|a| [a.to_f64().sin(), a.to_f64().cos()].map(R::from_f64));
        same(
            "H of directions",
            pendulum.energy_at(directions, [p1, p2]),
            kinetic + potential,
            scale,
        );

        same("K", above, kinetic + potential - least, scale);
        same(
            "L",
            pendulum.lagrangian(&motion),
            kinetic - potential,
            scale,
        );

        same("w.p", w1 * p1 + w2 * p2, R::TWO * kinetic, scale);

        // Lagrange's accelerations agree with Hamilton's forces: M w' + M' w = p', the time
        // derivative of p = M w.
        let [_, _, force1, force2] = pendulum.derivatives(&state.into());
        let [acceleration1, acceleration2] = pendulum.accelerations(&motion);
        let elbow = (a1 - a2).to_f64();
        let (sin_d, cos_d) = elbow.sin_cos();
        let [[m11, m12], [m21, m22]] = pendulum.mass_matrix(R::from_f64(cos_d));
        let m12_rate = -m2 * l1 * l2 * R::from_f64(sin_d) * (w1 - w2);

        let p1_rate = m11 * acceleration1 + m12 * acceleration2 + m12_rate * w2;
        let p2_rate = m21 * acceleration1 + m22 * acceleration2 + m12_rate * w1;
        let magnitude =
            (m11 + m12.abs()) * acceleration1.abs() + (m22 + m12.abs()) * acceleration2.abs();
        let square = (w1.abs() + w2.abs()) * (w1.abs() + w2.abs());
        let scale = (magnitude + (m11 + m22) * square + force1.abs() + force2.abs()) * unlike;
        same(
            "p1' by Pendulum::accelerations, compared with derivatives,",
            p1_rate,
            force1,
            scale,
        );

        same(
            "p2' by Pendulum::accelerations, compared with derivatives,",
            p2_rate,
            force2,
            scale,
        );
    }
}

#[test]
fn lagrangian_formulas_agree_in_either_precision() {
    all::<f32>();
    all::<f64>();
}

#[test]
fn bobs_follow_the_directions_of_the_rods() {
    let pendulum = Pendulum::new(&Parameters {
        m1: 1.0,
        m2: 2.0,
        l1: 3.0,
        l2: 4.0,
        g: 9.8,
    })
    .expect("valid parameters");

    let motion = Motion {
        a1: 0.0,
        a2: core::f64::consts::FRAC_PI_2,
        w1: 1.0,
        w2: 2.0,
    };

    let [bob1, bob2] = pendulum.positions(motion.angles());
    let [v1, v2] = pendulum.velocities(&motion);

    // Bob 1 is 3 m below the pivot. Bob 2 moves with bob 1, and turns about it.
    let exact = [
        (bob1, [0.0, -3.0]),
        (bob2, [4.0, -3.0]),
        (v1, [3.0, 0.0]),
        (v2, [3.0, 8.0]),
    ];

    for (vector, [x, y]) in exact {
        let off = (vector.x - x).abs().max((vector.y - y).abs());
        assert!(
            off < tolerances::FORMULAS.double,
            "{vector:?} instead of ({x}, {y})"
        );
    }
}
