//! Hamilton's equations as the book prints them ("Double Pendulum", math24.net).

use double_pendulum::Parameters;

/// The right-hand side in the page's form, and what it is made of.
#[derive(Clone, Copy, Debug)]
pub struct PageForm {
    /// The derivatives of a1, a2, p1, p2.
    pub derivatives: [f64; 4],
    /// The largest magnitude among the terms that each derivative is a sum of: the page's own, where nothing within a
    /// term is allowed to cancel, neither A2's bracket nor sin D = sin a1 cos a2 - cos a1 sin a2 and cos D likewise.
    pub largest_terms: [f64; 4],
}

/// Hamilton's equations for any masses and lengths, with the page's A1 and A2.
pub fn general_form(parameters: &Parameters<f64>, z: &[f64; 4]) -> PageForm {
    let &[a1, a2, p1, p2] = z;
    let (sin_d, cos_d) = (a1 - a2).sin_cos();
    let den = parameters.m1 + parameters.m2 * sin_d * sin_d;
    let ((s1, c1), (s2, c2)) = (a1.sin_cos(), a2.sin_cos());
    let largest = |terms: &[f64]| terms.iter().fold(0.0, |largest: f64, term| largest.max(term.abs()));

    // with this sign of cos D every term of the bracket is positive
    let uncancelled = [largest(&[s1 * c2, c1 * s2]), -largest(&[c1 * c2, s1 * s2])];
    let magnitudes = terms(parameters, &[a1, a2, p1.abs(), p2.abs()], den, uncancelled);
    PageForm {
        derivatives: terms(parameters, z, den, [sin_d, cos_d]).map(|terms| terms.iter().sum()),
        largest_terms: magnitudes.map(|terms| largest(&terms)),
    }
}

/// The terms of each derivative, given den = m1 + m2 sin^2 D and [sin D, cos D].
fn terms(
    &Parameters { m1, m2, l1, l2, g }: &Parameters<f64>,
    &[a1, a2, p1, p2]: &[f64; 4],
    den: f64,
    [sin_d, cos_d]: [f64; 2],
) -> [[f64; 3]; 4] {
    let w1 = [p1 * l2, -p2 * l1 * cos_d, 0.0].map(|term| term / (l1 * l1 * l2 * den));
    let w2 = [p2 * (m1 + m2) * l1, -p1 * m2 * l2 * cos_d, 0.0].map(|term| term / (m2 * l1 * l2 * l2 * den));
    let term_a1 = p1 * p2 * sin_d / (l1 * l2 * den);
    let bracket = p1 * p1 * m2 * l2 * l2 - 2.0 * p1 * p2 * m2 * l1 * l2 * cos_d + p2 * p2 * (m1 + m2) * l1 * l1;
    let sin_2d = 2.0 * sin_d * cos_d;
    let term_a2 = bracket * sin_2d / (2.0 * l1 * l1 * l2 * l2 * den * den);
    let p1_rate = [-(m1 + m2) * g * l1 * a1.sin(), -term_a1, term_a2];
    let p2_rate = [-m2 * g * l2 * a2.sin(), term_a1, -term_a2];
    [w1, w2, p1_rate, p2_rate]
}
