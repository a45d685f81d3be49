//! Axes about which a set is measured.

use std::array::from_fn;

use super::ball::{Ball, largest, up};
use super::number::Number;

/// Row by row.
pub type Matrix<T> = [[T; 6]; 6];

/// The unit matrix.
pub const IDENTITY: Matrix<f64> = {
    let mut identity = [[0.0; 6]; 6];
    let mut i = 0;
    while i < 6 {
        identity[i][i] = 1.0;
        i += 1;
    }
    identity
};

/// The columns of `moved`, made to unit vectors at right angles as nearly as `f64` can, the one that makes a set with `radii` longest first
/// (Gram and Schmidt, twice).
pub fn orthonormal(moved: &Matrix<Ball>, radii: &[f64; 6]) -> Matrix<f64> {
    let mut columns: Matrix<f64> = from_fn(|j| from_fn(|i| moved[i][j].middle));
    let dot = |a: &[f64; 6], b: &[f64; 6]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let length = |j: usize| dot(&columns[j], &columns[j]).sqrt() * radii[j];
    let mut order = [0, 1, 2, 3, 4, 5];
    order.sort_by(|&a, &b| length(b).total_cmp(&length(a)));
    columns = order.map(|j| columns[j]);
    for j in [0, 1, 2, 3, 4, 5].repeat(2) {
        let (done, rest) = columns.split_at_mut(j);
        for one in done {
            let along = dot(one, &rest[0]);
            rest[0].iter_mut().zip(one).for_each(|(x, one)| *x -= along * *one);
        }
        let size = dot(&rest[0], &rest[0]).sqrt();
        rest[0].iter_mut().for_each(|x| *x /= size);
    }
    from_fn(|i| from_fn(|j| columns[j][i]))
}

/// The largest row sum of |I - Q'Q|, at most.
pub fn defect(axes: &Matrix<f64>) -> f64 {
    let entry = |i: usize, j: usize| {
        let product = (0..6).fold(Ball::ZERO, |sum, l| sum + Ball::exact(axes[l][i]) * Ball::exact(axes[l][j]));
        (product - Ball::exact(IDENTITY[i][j])).size()
    };
    largest((0..6).map(|i| up((0..6).map(|j| entry(i, j)).sum::<f64>())))
}
