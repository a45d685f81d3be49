//! The arithmetic.

use fastrand::Rng;
use host_tests::oracle::random::symmetric;
use reference::enclosure::{Fixed, sin_cos};

/// Sums, products and quotients whose exact results are known: inside, and not without the allowance for rounding.
#[test]
fn what_is_rounded_is_counted() {
    let mut rng = Rng::with_seed(1);
    for _ in 0..1000 {
        let [a, b] = [(); 2].map(|()| symmetric(&mut rng) * 8.0);
        let [x, y] = [a, b].map(Fixed::of);
        let [sin, cos] = sin_cos(x);
        let products = (x + y) * (x - y) - x * x + y * y;
        let quotient = y * y.inverse() - Fixed::ONE;
        let one = sin * sin + cos * cos - Fixed::ONE;
        for zero in [products, quotient, one] {
            assert!(zero.is_positive().is_none() && zero.size() < 1e-30, "{a} {b}: {zero:?}");
        }
        assert!((sin - Fixed::of(a.sin())).wider(1e-15).is_positive().is_none(), "{a}");
    }
    let (third, three) = (Fixed::ONE.over(3), Fixed::of(3.0));
    assert!((third * three - Fixed::ONE).is_positive().is_none() && (third.middle() * three).middle() != Fixed::ONE);
    assert_eq!((third - Fixed::fraction(1, 3, 0)).middle(), Fixed::ZERO);
    assert!((Fixed::fraction(-1000, 3, -9) * Fixed::of(128.0) + Fixed::of(250.0).over(3)).is_positive().is_none());
    assert_eq!(Fixed::of(-1.5).over(8).decimal(33.0), format!("-0.1875{:0<29}", ""));
    assert_eq!(third.wider(9e-5).decimal(33.0), "0.3333");
}

#[test]
fn nothing_is_known_of_what_leaves_the_range_or_is_divided_by_what_may_be_zero() {
    let (large, wide) = (Fixed::of(200.0), Fixed::ZERO.wider(1e-30));
    let quotients = [wide, Fixed::fraction(1, 1000, 0), Fixed::of(0.5).wider(0.5)].map(Fixed::inverse);
    let outside = [large + large, large * large, Fixed::of(1e9), Fixed::fraction(1 << 60, 1, 0)];
    for unknown in quotients.iter().chain(&outside) {
        assert_eq!(unknown.size(), f64::INFINITY, "{unknown:?}");
    }
}
