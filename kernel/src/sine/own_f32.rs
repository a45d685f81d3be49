//! Sine and cosine of an `f32` in `f32` adds and multiplies only.
//!
//! The constants are made by `host-tests/generate/sine_polynomials.py`.

/// 2/pi.
const TWO_OVER_PI: f32 = core::f32::consts::FRAC_2_PI;

/// pi/2 in three parts. The first two hold 11 bits each, so that k times them is exact for every k up to 2^13.
pub const PI_OVER_TWO: [f32; 3] = [1.5703125, 0.0004837513, 0.0000000754979];

/// Adding this, 3 * 2^22, rounds to a whole number, which then stands in the low bits of the sum.
const ROUNDER: f32 = 12_582_912.0;

/// Up to here, rad, k stays below 2^13.
const LARGEST: f32 = 12_867.0;

/// (sin r - r)/r^3 in powers of r^2, for abs r <= pi/4; error of the fit 2.0e-9.
const SINE: [f32; 3] = [-0.1666665, 0.008331901, -0.00019485931];

/// (cos r - 1 + r^2/2)/r^4 in powers of r^2, for abs r <= pi/4; error of the fit 1.1e-10.
const COSINE: [f32; 3] = [0.041666646, -0.0013887301, 0.00002443067];

/// (sin x - x)/x^3 in powers of x^2, for abs x <= 0.06; error of the fit 8.5e-10.
const SMALL_SINE: [f32; 1] = [-0.1666406];

/// (tan(x/2) - x/2)/x^3 in powers of x^2, for abs x <= 0.06; error of the fit 4.2e-10.
const SMALL_TANGENT: [f32; 1] = [0.041679706];

/// Marks k pi/32 + offset, k = 0..8: (offset, sin, cos). Each offset is chosen so that the sine and the cosine given are
/// right to 1.1e-10; made by `host-tests/generate/accurate_marks.py`.
pub const MARKS: [[f32; 3]; 9] = [
    [0.0, 0.0, 1.0],
    [-0.0002001971, 0.097817905, 0.9952043],
    [0.0025167167, 0.19755806, 0.9802912],
    [-0.0012434274, 0.28909457, 0.95730054],
    [-0.0008780658, 0.38187206, 0.9242152],
    [0.0021073818, 0.47325423, 0.8809259],
    [-0.002364114, 0.553603, 0.8327807],
    [-3.632903e-05, 0.6343652, 0.7730335],
    [-0.0016527474, 0.70593715, 0.7082745],
];

/// (sin `x`, cos `x`).
#[must_use]
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    if x.abs() <= LARGEST { reduced(x) } else { huge(x) }
}

/// Subtracts the nearest multiple of pi/2 and turns the pair of what is left by as many quarter turns.
#[inline]
fn reduced(x: f32) -> (f32, f32) {
    let rounded = x * TWO_OVER_PI + ROUNDER;
    let k = rounded - ROUNDER;
    let r = ((x - k * PI_OVER_TWO[0]) - k * PI_OVER_TWO[1]) - k * PI_OVER_TWO[2];
    super::by_quarters(first_octant(r), rounded.to_bits())
}

/// (sin `r`, cos `r`) for abs r <= pi/4, and a hair beyond.
#[inline]
fn first_octant(r: f32) -> (f32, f32) {
    let z = r * r;
    let sine = r + r * z * (SINE[0] + z * (SINE[1] + z * SINE[2]));
    let cosine = 1.0 - z * (0.5 - z * (COSINE[0] + z * (COSINE[1] + z * COSINE[2])));
    (sine, cosine)
}

/// The vector (s, c) for an angle `by` further on: a rotation as three shears, tan(`by`/2), sin `by` and tan(`by`/2) again.
#[must_use]
#[inline(always)]
pub fn turned([s, c]: [f32; 2], by: f32) -> [f32; 2] {
    let z = by * by;
    let tangent = by * (0.5 + z * SMALL_TANGENT[0]);
    let sine = by + by * (z * SMALL_SINE[0]);
    let c = c - tangent * s;
    let s = s + sine * c;
    [s, c - tangent * s]
}

/// The sum of the turns' squares, rad^2: what costs least where the squares are computed anyway.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reach(f32);

/// (0.0735 rad)^2. The polynomials err by 1e-8 there, and by next to nothing at half of it.
const SMALL: f32 = 0.0054;

impl Reach {
    #[must_use]
    #[inline(always)]
    pub fn with(self, [a, b]: [f32; 2]) -> Self {
        Self(self.0 + (a * a + b * b))
    }
    #[must_use]
    #[inline(always)]
    pub fn is_small(self) -> bool {
        self.0 <= SMALL
    }
}

/// Beyond the range of the reduction, by that of double precision; also NaN.
#[cold]
#[inline(never)]
fn huge(x: f32) -> (f32, f32) {
    let (s, c) = super::own_f64::sin_cos(x.into());
    (s as f32, c as f32)
}
