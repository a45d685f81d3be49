//! The equal-rod form of the source page ("Double Pendulum", math24.net) with its misprint, for
//! comparison only.

/// Returns the rates of (a1, a2, p1, p2) by the equal-rod equations exactly as printed, for m1 = 1
/// kg and m2 = `mu` kg. The denominator of the second equation lacks the factor mu. Unless mu = 1,
/// they are not Hamilton's equations of any system, and they lose or gain energy.
pub fn misprinted_equal_rods(mu: f64, l: f64, g: f64, &[a1, a2, p1, p2]: &[f64; 4]) -> [f64; 4] {
    // The page's own expressions, in its order.
    let (sin_d, cos_d) = libm::sincos(a1 - a2);
    let den = 1.0 + mu * sin_d * sin_d;
    let term_a1 = p1 * p2 * sin_d / (l * l * den);
    let bracket = p1 * p1 * mu - 2.0 * p1 * p2 * mu * cos_d + p2 * p2 * (1.0 + mu);
    let term_a2 = bracket * libm::sin(2.0 * (a1 - a2)) / (2.0 * l * l * den * den);
    [
        (p1 - p2 * cos_d) / (l * l * den),
        (p2 * (1.0 + mu) - p1 * mu * cos_d) / (l * l * den),
        -(1.0 + mu) * g * l * libm::sin(a1) - term_a1 + term_a2,
        -mu * g * l * libm::sin(a2) + term_a1 - term_a2,
    ]
}
