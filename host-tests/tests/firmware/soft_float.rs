//! Sums and products by integer arithmetic against this processor's own, to the bit.

use std::fmt::Debug;
use std::hint::black_box;
use std::ops::{Add, Mul, Sub};

use fastrand::Rng;
use firmware::soft_float::{Word, add, multiply, negative};

/// Pairs of numbers, of every kind that is drawn.
const PAIRS: u32 = 3_000_000;

/// A floating-point number and its bits.
trait Number: Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    type Bits: Word + Debug + std::fmt::LowerHex;
    fn of(bits: Self::Bits) -> Self;
    fn bits(self) -> Self::Bits;
    fn is_nan(self) -> bool;
    fn any(rng: &mut Rng) -> Self::Bits;
}

impl Number for f32 {
    type Bits = u32;
    fn of(bits: u32) -> Self {
        f32::from_bits(bits)
    }
    fn bits(self) -> u32 {
        self.to_bits()
    }
    fn is_nan(self) -> bool {
        f32::is_nan(self)
    }
    fn any(rng: &mut Rng) -> u32 {
        rng.u32(..)
    }
}

impl Number for f64 {
    type Bits = u64;
    fn of(bits: u64) -> Self {
        f64::from_bits(bits)
    }
    fn bits(self) -> u64 {
        self.to_bits()
    }
    fn is_nan(self) -> bool {
        f64::is_nan(self)
    }
    fn any(rng: &mut Rng) -> u64 {
        rng.u64(..)
    }
}

/// Compares the three operations on a and b.
fn compare<N: Number>(a: N::Bits, b: N::Bits) {
    let (x, y) = black_box((N::of(a), N::of(b)));
    for (name, soft, hard) in [("+", add(a, b), x + y), ("-", add(a, negative(b)), x - y), ("*", multiply(a, b), x * y)]
    {
        let same = if hard.is_nan() { N::of(soft).is_nan() } else { soft == hard.bits() };
        assert!(same, "{x:?} {name} {y:?} = {hard:?}, not {:?} ({a:x}, {b:x}: {soft:x})", N::of(soft));
    }
}

/// The exponent `exponent` with the sign and fraction of `bits`.
fn with_exponent<W: Word>(bits: W, exponent: u32) -> W {
    let field = W::from(W::SPECIAL) << W::FRACTION;
    bits & !field | W::from(exponent) << W::FRACTION & field
}

/// Numbers at which something changes: the first and last fractions, and those about a half, of exponents at both ends and
/// about 1.
fn corners<N: Number>() -> Vec<N::Bits> {
    let (one, zero) = (N::Bits::ONE, N::Bits::ZERO);
    let all = (one << N::Bits::FRACTION).wrapping_sub(one);
    let half = one << (N::Bits::FRACTION - 1);
    let fractions = [zero, one, one << 1, half.wrapping_sub(one), half, half | one, all.wrapping_sub(one), all];
    let (bias, special) = (N::Bits::BIAS, N::Bits::SPECIAL);
    let digits = N::Bits::FRACTION;
    let about = |exponent: u32| exponent - 2..=exponent + 2;
    let exponents = (0..4).chain(about(digits)).chain(about(bias / 2)).chain(about(bias - digits)).chain(about(bias));
    let exponents = exponents.chain(about(bias + digits)).chain(about(bias + bias / 2)).chain(special - 3..=special);
    let numbers = exponents.flat_map(|exponent| fractions.map(|fraction| with_exponent(fraction, exponent)));
    numbers.flat_map(|number| [number, number | N::Bits::SIGN]).collect()
}

fn corners_are_right<N: Number>() {
    let corners = corners::<N>();
    for &a in &corners {
        corners.iter().for_each(|&b| compare::<N>(a, b));
    }
}

#[test]
fn every_pair_of_corners_is_right() {
    corners_are_right::<f32>();
    corners_are_right::<f64>();
}

/// Bits that are lost in both halves of a word, and alike, are not taken for none: they break a tie.
#[test]
fn lost_bits_that_are_alike_break_a_tie() {
    for (exponent, place) in (33..60).flat_map(|exponent| (0..20).map(move |place| (exponent, place))) {
        let small = with_exponent(1_u64 << place | 1 << (place + 32), u64::BIAS);
        for fraction in [0, 1] {
            compare::<f64>(with_exponent(fraction, u64::BIAS + exponent), small);
        }
    }
}

/// Any bits; exponents so near to each other that digits cancel or are shifted out; and few bits set, so that ties are met.
fn pairs_are_right<N: Number>() {
    let mut rng = Rng::with_seed(4);
    for _ in 0..PAIRS {
        let (a, b) = (N::any(&mut rng), N::any(&mut rng));
        compare::<N>(a, b);
        let exponent = rng.u32(1..N::Bits::SPECIAL);
        let near = exponent.saturating_add_signed(rng.i32(-60..60)).min(N::Bits::SPECIAL - 1);
        compare::<N>(with_exponent(a, exponent), with_exponent(b, near));
        let few = |bits: N::Bits, rng: &mut Rng| bits & N::any(rng) & N::any(rng) & N::any(rng);
        let (a, b) = (few(a, &mut rng), few(b, &mut rng));
        compare::<N>(with_exponent(a, exponent), with_exponent(b, near));
    }
}

#[test]
fn millions_of_pairs_are_right() {
    pairs_are_right::<f32>();
    pairs_are_right::<f64>();
}
