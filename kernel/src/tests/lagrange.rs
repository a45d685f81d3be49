//! The Lagrangian form, the Legendre transformation and the geometry, each against another road to the same number.

use double_pendulum::{Motion, Parameters, Pendulum, Real, State};
use fastrand::Rng;

use super::{assert_near, random, tolerances};

/// Random pendulums in motion.
fn each_motion<R: Real>(seed: u64, mut check: impl FnMut(&Pendulum<R>, &Motion<R>)) {
    let mut rng = Rng::with_seed(seed);
    for _ in 0..20_000 {
        let parameters = random::parameters(&mut rng).cast();
        let motion = [0; 4].map(|_| R::from_f64(6.0 * random::symmetric(&mut rng)));
        check(&Pendulum::new(&parameters).expect("valid parameters"), &motion.into());
    }
}

#[track_caller]
fn assert_same<R: Real>(name: &str, value: R, exact: R, scale: R, motion: &Motion<R>) {
    assert_near(name, value, exact, scale, tolerances::FORMULAS.of::<R>(), motion);
}

/// T and V of two bobs, from where they are and how fast.
fn geometry_gives_the_energies<R: Real>() {
    each_motion::<R>(4, |pendulum, motion| {
        let &Parameters { m1, m2, l1, l2, g } = pendulum.parameters();
        let [bob1, bob2] = pendulum.positions(motion.angles());
        let [v1, v2] = pendulum.velocities(motion);
        let heights = m1 * g * bob1.y + m2 * g * bob2.y;
        assert_same("V", pendulum.potential_energy(motion.angles()), heights, (m1 + m2) * g * l1 + m2 * g * l2, motion);
        let kinetic = R::HALF * (m1 * (v1.x * v1.x + v1.y * v1.y) + m2 * (v2.x * v2.x + v2.y * v2.y));
        let speeds = l1 * motion.w1.abs() + l2 * motion.w2.abs();
        assert_same("T", pendulum.kinetic_energy(motion), kinetic, (m1 + m2) * speeds * speeds, motion);
    });
}

/// p = (dL/dw1, dL/dw2), and w -> p -> w. L is quadratic in w, so that a central difference of any step is exact.
fn legendre_transformation<R: Real>() {
    each_motion::<R>(1, |pendulum, motion| {
        let state = pendulum.to_state(motion);
        let &Parameters { m1, m2, l1, l2, .. } = pendulum.parameters();
        let slope =
            |plus: Motion<R>, minus: Motion<R>| R::HALF * (pendulum.lagrangian(&plus) - pendulum.lagrangian(&minus));
        let Motion { w1, w2, .. } = *motion;
        let one = R::ONE;
        let p1 = slope(Motion { w1: w1 + one, ..*motion }, Motion { w1: w1 - one, ..*motion });
        let p2 = slope(Motion { w2: w2 + one, ..*motion }, Motion { w2: w2 - one, ..*motion });
        let [torque1, torque2] = [pendulum.stiffness()[0][0], pendulum.stiffness()[1][1]];
        let scale = pendulum.kinetic_energy(motion) + torque1 + torque2 + (m1 + m2) * l1 * l1 + m2 * l2 * l2;
        let scale = scale * R::from_f64(8.0);
        assert_same("p1 beside dL/dw1", state.p1, p1, scale, motion);
        assert_same("p2 beside dL/dw2", state.p2, p2, scale, motion);

        let back = pendulum.to_motion(&state);
        let speed = (motion.w1.abs() + motion.w2.abs()) * (m1 + m2) / m1 * (l1 / l2 + l2 / l1);
        assert_same("w1 of (p1, p2)", back.w1, motion.w1, speed, motion);
        assert_same("w2 of (p1, p2)", back.w2, motion.w2, speed * (m1 + m2) / m2, motion);
    });
}

/// H = T + V = K + min V, and w.p = 2 T.
fn energies<R: Real>() {
    each_motion::<R>(2, |pendulum, motion| {
        let state = pendulum.to_state(motion);
        let kinetic = pendulum.kinetic_energy(motion);
        let potential = pendulum.potential_energy(motion.angles());
        let &Parameters { m1, m2, .. } = pendulum.parameters();
        let (above, least) = (pendulum.energy_above_rest(&state), pendulum.least_energy());
        let scale = (above - least) * (m1 + m2) * (R::ONE / m1 + R::ONE / m2);
        assert_same("H", pendulum.energy(&state), kinetic + potential, scale, motion);
        let directions = motion.angles().map(|a| [a.to_f64().sin(), a.to_f64().cos()].map(R::from_f64));
        let from_directions = pendulum.energy_at(directions, [state.p1, state.p2]);
        assert_same("H of directions", from_directions, kinetic + potential, scale, motion);
        assert_same("K", above, kinetic + potential - least, scale, motion);
        assert_same("L", pendulum.lagrangian(motion), kinetic - potential, scale, motion);
        let action = motion.w1 * state.p1 + motion.w2 * state.p2;
        assert_same("w.p", action, R::TWO * kinetic, scale, motion);
    });
}

/// Lagrange's accelerations against Hamilton's forces: M w' + M' w = p', the time derivative of p = M w.
fn accelerations<R: Real>() {
    each_motion::<R>(3, |pendulum, motion| {
        let state = pendulum.to_state(motion);
        let [_, _, force1, force2] = pendulum.derivatives(&state.into());
        let [acceleration1, acceleration2] = pendulum.accelerations(motion);
        let d = (motion.a1 - motion.a2).to_f64();
        let [[m11, m12], [m21, m22]] = pendulum.mass_matrix(R::from_f64(d.cos()));
        let &Parameters { m1, m2, l1, l2, .. } = pendulum.parameters();
        let m12_rate = -m2 * l1 * l2 * R::from_f64(d.sin()) * (motion.w1 - motion.w2);
        let p1_rate = m11 * acceleration1 + m12 * acceleration2 + m12_rate * motion.w2;
        let p2_rate = m21 * acceleration1 + m22 * acceleration2 + m12_rate * motion.w1;
        let magnitude = (m11 + m12.abs()) * acceleration1.abs() + (m22 + m12.abs()) * acceleration2.abs();
        let square = (motion.w1.abs() + motion.w2.abs()) * (motion.w1.abs() + motion.w2.abs());
        let scale = magnitude + (m11 + m22) * square + force1.abs() + force2.abs();
        let scale = scale * (m1 + m2) * (R::ONE / m1 + R::ONE / m2);
        assert_same("p1' by Pendulum::accelerations, beside derivatives,", p1_rate, force1, scale, motion);
        assert_same("p2' by Pendulum::accelerations, beside derivatives,", p2_rate, force2, scale, motion);
    });
}

/// Each of these trusts those before it.
fn all<R: Real>() {
    geometry_gives_the_energies::<R>();
    legendre_transformation::<R>();
    energies::<R>();
    accelerations::<R>();
}

#[test]
fn lagrange_in_either_precision() {
    all::<f32>();
    all::<f64>();
}

#[test]
fn bobs_are_where_the_rods_point() {
    let parameters = Parameters { m1: 1.0, m2: 2.0, l1: 3.0, l2: 4.0, g: 9.8 };
    let pendulum = Pendulum::new(&parameters).expect("valid parameters");
    let quarter = core::f64::consts::FRAC_PI_2;
    let near = |x: f64, y: f64| (x - y).abs() < tolerances::FORMULAS.double;
    let [bob1, bob2] = pendulum.positions([0.0, quarter]); // down, then right
    assert!(near(bob1.x, 0.0) && near(bob1.y, -3.0) && near(bob2.x, 4.0) && near(bob2.y, -3.0), "{bob1:?} {bob2:?}");
    let [v1, v2] = pendulum.velocities(&Motion { a1: 0.0, a2: quarter, w1: 1.0, w2: 2.0 });
    assert!(near(v1.x, 3.0) && near(v1.y, 0.0) && near(v2.x, 3.0) && near(v2.y, 8.0), "{v1:?} {v2:?}");
}

#[test]
fn at_rest_both_ways() {
    let parameters = Parameters { m1: 1.0, m2: 2.0, l1: 3.0, l2: 4.0, g: 9.8 };
    let pendulum = Pendulum::new(&parameters).expect("valid parameters");
    assert_eq!(pendulum.to_state(&Motion::at_rest(1.0, 2.0)), State::at_rest(1.0, 2.0));
    assert_eq!(pendulum.to_motion(&State::at_rest(1.0, 2.0)), Motion::at_rest(1.0, 2.0));
}
