//! The kernel's sine and cosine, compared with the standard library in `f64`, whose error is less
//! than 0.6 ulp.
//!
//! A test of every float in [-pi, pi] takes 2 minutes: `cargo test --release --package
//! double-pendulum-kernel --lib -- --ignored`.

use double_pendulum::{radians, sin_cos};

/// On [-pi, pi]. Half an ulp comes from the rounding of the reduced argument, half an ulp from the
/// last addition, and a little from the terms between (measured: 8.56e-8).
const NEAR: f64 = 9e-8;
/// For |x| <= 1e4, with a margin, because fewer floats are tested.
const FAR: f64 = 1e-7;
/// One for the reduced argument, and one for the polynomial, less the error of the reference.
const ULPS: f64 = 2.0 - 0.6;

fn error(x: f32) -> f64 {
    let (sine, cosine) = sin_cos(x);
    let (true_sine, true_cosine) = f64::from(x).sin_cos();
    (f64::from(sine) - true_sine)
        .abs()
        .max((f64::from(cosine) - true_cosine).abs())
}

fn largest_error(limit: f32, stride: usize) -> f64 {
    let positive = (0..=limit.to_bits()).step_by(stride).map(f32::from_bits);
    positive.fold(0.0, |worst: f64, x| worst.max(error(x)).max(error(-x)))
}

fn ulps(value: f64, truth: f64) -> f64 {
    let one = f64::from_bits(truth.abs().to_bits() + 1) - truth.abs();
    (value - truth).abs() / one
}

#[test]
fn own_f32_is_within_its_bounds_on_a_stride_of_the_floats() {
    for (limit, stride, bound) in [(core::f32::consts::PI, 1009, NEAR), (1e4, 251, FAR)] {
        let error = largest_error(limit, stride);
        assert!(error <= bound, "{error:.3e} to {limit}");
    }
}

#[test]
#[ignore = "two minutes: every float of [-pi, pi]"]
fn own_f32_is_within_its_bound_on_every_float_to_pi() {
    let error = largest_error(core::f32::consts::PI, 1);
    std::println!("largest error on [-pi, pi]: {error:.4e}");
    assert!(error <= NEAR, "{error:.3e}");
}

#[test]
fn own_f32_is_within_its_bound_near_multiples_of_half_pi() {
    for k in 1..=6366 {
        let nearest = (f64::from(k) * core::f64::consts::FRAC_PI_2) as f32;
        for x in [
            nearest.to_bits() - 1,
            nearest.to_bits(),
            nearest.to_bits() + 1,
        ]
        .map(f32::from_bits)
        {
            assert!(error(x) <= FAR, "{x:e}: {:e}", error(x));
        }
    }
}

fn next(x: f64) -> f64 {
    f64::from_bits(x.to_bits() + 1)
}

#[test]
fn own_f64_is_within_two_units_of_the_last_place() {
    let mut worst = 0.0_f64;
    let uniform = (-2_000_000..=2_000_000).map(|i| f64::from(i) * 8.1e-7);
    let huge = (0..200_000).map(|i| f64::from(i) * 8.235_490_1);
    let every_size =
        (0..4_000_000).map(|i| f64::from_bits(0x3c00_0000_0000_0000 + i * 0x12_4000_0000));
    // The quarter turns themselves are the next test's.
    let cancelling = (1..1_000_000).map(|k| next(f64::from(k) * core::f64::consts::FRAC_PI_2));
    for x in uniform.chain(huge).chain(every_size).chain(cancelling) {
        let (sine, cosine) = sin_cos(x);
        let (true_sine, true_cosine) = x.sin_cos();
        worst = worst
            .max(ulps(sine, true_sine))
            .max(ulps(cosine, true_cosine));
    }

    std::println!("largest error: {worst:.3} ulp");
    assert!(worst <= ULPS, "{worst:.3}");
}

#[test]
fn quarter_turns_have_exact_directions() {
    const AROUND: [(f64, f64); 4] = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)];
    for quarters in -1_000_000_i32..=1_000_000 {
        let expected = AROUND[quarters.rem_euclid(4) as usize];
        assert_eq!(sin_cos(radians(90.0 * f64::from(quarters))), expected);
    }

    let pi = core::f64::consts::PI;
    assert_eq!(radians(180.0), pi);
    for angle in [pi, -pi] {
        let (sine, cosine) = sin_cos(angle);
        assert_eq!(libm::atan2(sine, cosine), angle);
    }
    assert!(sin_cos(next(pi)).0 < 0.0);
}

#[test]
fn degrees_become_the_nearest_radians() {
    for (degrees, expected) in [
        (1.0, 0.017453292519943295),
        (120.0, 2.0943951023931957),
        (120.3, 2.0996310901491784),
        (171.0, 2.9845130209103035),
        (179.0, 3.12413936106985),
        (179.99999, 3.141592479056868),
        (0.1, 0.0017453292519943296),
        (1e-09, 1.7453292519943298e-11),
        (359.0, 6.265732014659643),
        (1234.5, 21.54608961587),
        (224.244610160293, 3.9138067771482423),
        (129.072784232122, 2.2527450595667498),
        (339.282102159738, 5.921589775775192),
        (234.731410831489, 4.096835976860964),
        (10.441882, 0.18224522100473053),
        (279.35, 4.87557726544616),
        (233.63, 4.077612731434352),
        (40.754147, 0.7112940489917695),
        (312.640365, 5.456603743886841),
        (195.753909324935, 3.416550241370546),
        (89.759057199367, 1.5665910816148747),
        (78.022728, 1.3617534949879704),
    ] {
        assert_eq!(radians(degrees), expected, "{degrees}");
        assert_eq!(radians(-degrees), -expected);
    }
}

#[test]
fn every_bit_pattern_has_a_defined_result() {
    for x in (0..=u32::MAX).step_by(65_521).map(f32::from_bits) {
        let (sine, cosine) = sin_cos(x);
        let is_small = sine.abs() <= 1.0 + f32::EPSILON && cosine.abs() <= 1.0 + f32::EPSILON;
        let is_direction = (sine * sine + cosine * cosine - 1.0).abs() <= 3.0 * f32::EPSILON;
        assert!(
            if x.is_finite() {
                is_small && is_direction
            } else {
                sine.is_nan() && cosine.is_nan()
            },
            "{x:e}"
        );
    }

    assert_eq!(sin_cos(12_868.0_f32), libm::sincosf(12_868.0));
    // The angles themselves are known to half a unit in the last place.
    for x in [1_647_100.0, 1e7, 1e9, 1e12, 1e15, 1e200, f64::MAX] {
        let (sine, cosine) = sin_cos(x);
        assert!((sine * sine + cosine * cosine - 1.0).abs() <= 3.0 * f64::EPSILON);
        let (true_sine, true_cosine) = x.sin_cos();
        let error = (sine * true_cosine - cosine * true_sine).abs();
        assert!(error <= 0.5 * (next(x) - x), "{x:e}: {error:e}");
    }

    for x in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let (sine, cosine) = sin_cos(x);
        assert!(sine.is_nan() && cosine.is_nan());
    }

    for x in [0.0, -0.0, 1e-45, -1e-45, 1e-30, 1e-10_f32] {
        assert_eq!(sin_cos(x), (x, 1.0), "small arguments pass through");
    }
}
