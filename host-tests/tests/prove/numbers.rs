//! The arithmetic.

use fastrand::Rng;
use host_tests::oracle::random::symmetric;
use reference::enclosure::{Ball, Fixed, Number, sin_cos};

/// Sums, products and quotients whose exact results are known: inside, and not without the allowance for rounding.
#[test]
fn what_is_rounded_is_counted() {
    let mut rng = Rng::with_seed(1);
    for _ in 0..1000 {
        let [a, b] = [(); 2].map(|()| symmetric(&mut rng) * 8.0);
        let [x, y] = [a, b].map(Fixed::of);
        let products = (x + y) * (x - y) - x * x + y * y;
        assert!(products.ball().holds_zero(), "{a} {b}");
        let quotient = y * y.inverse() - Fixed::ONE;
        assert!(quotient.ball().holds_zero() && quotient.ball().size() < 1e-30, "{b}");
        let rounded = (x * y.inverse()).split().0 * y - x;
        assert!(b.abs() < 0.1 || rounded.split().0.ball().size() < 1e-30);
        let [sin, cos] = sin_cos(x);
        let one = (sin * sin + cos * cos - Fixed::ONE).ball();
        assert!(one.holds_zero() && one.size() < 1e-31, "{a}");
        assert!((sin.ball() - Ball::about(libm::sin(a), 1e-15)).holds_zero());
        let [p, q] = [a, b].map(Ball::exact);
        assert!(((p + q) * (p - q) - p * p + q * q).holds_zero());
        assert!((q * q.inverse() - Ball::exact(1.0)).holds_zero());
    }
    let third = Fixed::ONE.over(3);
    let without = third.split().0 * Fixed::of(3.0).split().0 - Fixed::ONE;
    assert!((third * Fixed::of(3.0) - Fixed::ONE).ball().holds_zero() && without.split().0 != Fixed::ZERO);
    assert_eq!((third - Fixed::fraction(1, 3, 0)).split().0, Fixed::ZERO);
    assert!((Fixed::fraction(-1000, 3, 9) * Fixed::of(512.0).over(4) + Fixed::of(1000.0).over(12)).ball().holds_zero());
}

#[test]
fn nothing_is_known_of_what_leaves_the_range_or_is_divided_by_what_may_be_zero() {
    let large = Fixed::of(200.0);
    let small = Fixed::fraction(1, 1000, 0);
    for unknown in [large + large, large * large, large << 1, Fixed::of(1e9), Fixed::fraction(1 << 100, 1, 0)] {
        assert_eq!(unknown.ball().radius, f64::INFINITY, "{unknown:?}");
    }
    assert_eq!(small.inverse().ball().radius, f64::INFINITY);
    assert_eq!(Fixed::ZERO.wider(1e-30).inverse().ball().radius, f64::INFINITY);
    assert_eq!(Ball { middle: 0.5, radius: 0.5 }.inverse().radius, f64::INFINITY);
}
