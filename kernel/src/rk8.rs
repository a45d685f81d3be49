//! An explicit Runge-Kutta step of order 8, for any system of first-order equations: where an error of 1e-9 or less is
//! wanted, far cheaper than order 4.

use crate::real::Real;

/// One step of order 8 for z' = f(z): the state a time `dt` after `z`.
///
/// ki = f(z + dt sum_j a_ij kj) for i = 1 .. 12, j < i, and z' = z + dt sum_i b_i ki: the twelve stages of DOP853, after
/// J. R. Dormand and P. J. Prince (`[Hairer I]`, II.5 and the code in its appendix). For the same error of a double
/// pendulum, 1e-9 or 1e-12, the eleven stages of G. J. Cooper and J. H. Verner need 1.1 to 1.7 times the evaluations.
///
/// The error of one step is O(dt^9), of a fixed interval O(dt^8); a negative `dt` steps backwards. Made for `f64`: the
/// coefficients are converted at each use, and reach 43, by which they enlarge the roundings of `f`. Twelve evaluations
/// of `f`, 12 N numbers of stack.
///
/// Tested: all 200 order conditions, each coefficient, and the order in f64.
#[must_use]
#[inline]
pub fn step<R: Real, const N: usize>(f: impl Fn(&[R; N]) -> [R; N], z: &[R; N], dt: R) -> [R; N] {
    let change = increment(f, z, dt);
    core::array::from_fn(|n| z[n] + change[n])
}

/// What [`step`] adds to `z`, for those who carry the rounding error of that addition along.
#[must_use]
#[inline]
pub fn increment<R: Real, const N: usize>(f: impl Fn(&[R; N]) -> [R; N], z: &[R; N], dt: R) -> [R; N] {
    increment_by(&STAGES, &WEIGHTS, f, z, dt)
}

/// One row of the matrix a, or the weights b: a coefficient for the first slope, then zeros, then the coefficients of the
/// latest slopes.
#[derive(Clone, Copy)]
struct Row<'a> {
    first: f64,
    latest: &'a [f64],
}

/// The matrix a but for its first row, which is empty.
#[rustfmt::skip]
const STAGES: [Row; 11] = [
    Row { first: 0.05260015195876773, latest: &[] },
    Row { first: 0.0197250569845379, latest: &[0.0591751709536137] },
    Row { first: 0.02958758547680685, latest: &[0.08876275643042054] },
    Row { first: 0.2413651341592667, latest: &[-0.8845494793282861, 0.924834003261792] },
    Row { first: 1.0 / 27.0, latest: &[0.17082860872947386, 0.12546768756682242] },
    Row { first: 19.0 / 512.0, latest: &[0.17025221101954405, 0.06021653898045596, -9.0 / 512.0] },
    Row { first: 0.03709200011850479, latest: &[0.17038392571223998, 0.10726203044637328, -0.015319437748624402,
        0.008273789163814023] },
    Row { first: 0.6241109587160757, latest: &[-3.3608926294469414, -0.868219346841726, 27.59209969944671,
        20.154067550477894, -43.48988418106996] },
    Row { first: 0.47766253643826434, latest: &[-2.4881146199716677, -0.590290826836843, 21.230051448181193,
        15.279233632882423, -33.28821096898486, -0.020331201708508627] },
    Row { first: -0.9371424300859873, latest: &[5.186372428844064, 1.0914373489967295, -8.149787010746927,
        -18.52006565999696, 22.739487099350505, 2.4936055526796523, -3.0467644718982196] },
    Row { first: 2.273310147516538, latest: &[-10.53449546673725, -2.0008720582248625, -17.9589318631188,
        27.94888452941996, -2.8589982771350235, -8.87285693353063, 12.360567175794303, 0.6433927460157636] },
];

/// The weights b.
#[rustfmt::skip]
const WEIGHTS: Row = Row { first: 0.054293734116568765, latest: &[4.450312892752409, 1.8915178993145003,
    -5.801203960010585, 0.3111643669578199, -0.1521609496625161, 0.20136540080403034, 0.04471061572777259] };

#[inline(always)]
fn increment_by<R: Real, const N: usize>(
    stages: &[Row; 11],
    weights: &Row,
    f: impl Fn(&[R; N]) -> [R; N],
    z: &[R; N],
    dt: R,
) -> [R; N] {
    let mut slopes = [[R::ZERO; N]; 12];
    let mut latest = f(z);
    for (i, row) in stages.iter().enumerate() {
        slopes[i] = latest;
        let slope = row.of(&slopes, i, &latest);
        latest = f(&core::array::from_fn(|n| z[n] + dt * slope[n]));
    }
    weights.of(&slopes, 11, &latest).map(|slope| dt * slope)
}

impl Row<'_> {
    /// The weighted sum of the first `count` slopes and the `latest`, which is not looked up among them: a processor would
    /// wait for it to come back from memory.
    #[inline(always)]
    fn of<R: Real, const N: usize>(&self, slopes: &[[R; N]; 12], count: usize, latest: &[R; N]) -> [R; N] {
        let first = R::from_f64(self.first);
        let Some((&last, middle)) = self.latest.split_last() else {
            return latest.map(|slope| first * slope);
        };
        let mut sum = slopes[0].map(|slope| first * slope);
        let zeros = count.saturating_sub(middle.len());
        for (&coefficient, slope) in middle.iter().zip(slopes.iter().skip(zeros)) {
            let coefficient = R::from_f64(coefficient);
            for n in 0..N {
                sum[n] += coefficient * slope[n];
            }
        }
        let last = R::from_f64(last);
        core::array::from_fn(|n| sum[n] + last * latest[n])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The order of the method, and of the largest trees.
    const ORDER: usize = 8;

    /// How far a condition may be off: coefficients up to 43 are multiplied and cancel (measured: 2.2e-15).
    const ROUNDING: f64 = 1e-14;

    /// A rooted tree: the level of each vertex below the root, a vertex's branches following it.
    #[derive(Clone, Copy, Debug)]
    struct Tree {
        levels: [usize; ORDER],
        order: usize,
    }

    impl Tree {
        /// The tree without branching, the first one of its order.
        fn tall(order: usize) -> Self {
            Self { levels: core::array::from_fn(|vertex| vertex), order }
        }

        /// The next tree of this order. (T. Beyer, S. M. Hedetniemi, "Constant time generation of rooted trees", SIAM J.
        /// Comput. 9, 1980.)
        fn next(mut self) -> Option<Self> {
            let last = (0..self.order).rfind(|&vertex| self.levels[vertex] > 1)?;
            let parent = self.parent(last)?;
            for vertex in last..self.order {
                self.levels[vertex] = self.levels[vertex - (last - parent)];
            }
            Some(self)
        }

        fn parent(&self, vertex: usize) -> Option<usize> {
            (0..vertex).rfind(|&other| self.levels[other] + 1 == self.levels[vertex])
        }

        /// The factor gamma: the product of the orders of all subtrees.
        fn density(&self) -> f64 {
            let mut sizes = [1.0; ORDER];
            for vertex in (0..self.order).rev() {
                if let Some(parent) = self.parent(vertex) {
                    sizes[parent] += sizes[vertex];
                }
            }
            sizes[..self.order].iter().product()
        }

        /// The system in which each vertex changes at the product of its branches: for the root, that leaves of all
        /// elementary differentials the one of this tree.
        fn slopes(&self, z: &[f64; ORDER]) -> [f64; ORDER] {
            let mut slopes = [1.0; ORDER];
            for (vertex, branch) in z.iter().enumerate().take(self.order) {
                if let Some(parent) = self.parent(vertex) {
                    slopes[parent] *= branch;
                }
            }
            slopes
        }

        /// sum_i b_i Phi_i(t) - 1/gamma(t): by how much the order condition of this tree is missed.
        fn missed(&self, step: impl Fn(&Self) -> [f64; ORDER]) -> f64 {
            (step(self)[0] - 1.0 / self.density()).abs()
        }
    }

    fn trees(order: usize) -> impl Iterator<Item = Tree> {
        core::iter::successors(Some(Tree::tall(order)), |tree| tree.next())
    }

    /// The largest miss of the conditions up to `order`.
    fn worst(order: usize, step: impl Fn(&Tree) -> [f64; ORDER]) -> f64 {
        (1..=order).flat_map(trees).map(|tree| tree.missed(&step)).fold(0.0, f64::max)
    }

    #[test]
    fn there_are_as_many_trees_as_the_book_says() {
        // [Hairer I], table II.2.3
        let counts: [usize; ORDER] = core::array::from_fn(|i| trees(i + 1).count());
        assert_eq!(counts, [1, 1, 2, 4, 9, 20, 48, 115]);
    }

    #[test]
    fn every_order_condition_up_to_order_8_holds() {
        for tree in (1..=ORDER).flat_map(trees) {
            let missed = tree.missed(|tree| step(|z| tree.slopes(z), &[0.0; ORDER], 1.0));
            assert!(missed <= ROUNDING, "{missed:e} for {tree:?}");
        }
    }

    /// Each coefficient matters: changed in its seventh digit, the conditions fail (measured: by 6e-13 for a_21, on which
    /// they depend least, by more than 1e-11 for the others but one).
    #[test]
    fn no_coefficient_may_change() {
        const CHANGE: f64 = 1.0 + 1e-7;
        let miss = |stages: &[Row; 11], weights: &Row| {
            worst(ORDER, |tree| increment_by(stages, weights, |z| tree.slopes(z), &[0.0; ORDER], 1.0))
        };
        assert!(miss(&STAGES, &WEIGHTS) <= ROUNDING);
        for (i, row) in STAGES.iter().chain([&WEIGHTS]).enumerate() {
            for changed in 0..=row.latest.len() {
                let mut buffer = [0.0; 11];
                let latest = &mut buffer[..row.latest.len()];
                latest.copy_from_slice(row.latest);
                let mut first = row.first;
                *latest.get_mut(changed).unwrap_or(&mut first) *= CHANGE;
                let (mut stages, mut weights) = (STAGES, WEIGHTS);
                *stages.get_mut(i).unwrap_or(&mut weights) = Row { first, latest };
                let missed = miss(&stages, &weights);
                assert!(missed > 10.0 * ROUNDING, "row {i}, coefficient {changed}: {missed:e}");
            }
        }
    }

    /// The trees tell orders apart: those of order 4 are met by the classical method, those of order 5 are not.
    #[test]
    fn the_classical_method_has_order_4() {
        let classical = |tree: &Tree| crate::rk4::step(|z| tree.slopes(z), &[0.0; ORDER], 1.0);
        assert!(worst(4, classical) <= f64::EPSILON);
        assert!(trees(5).any(|tree| tree.missed(classical) > 1e-3));
    }

    #[test]
    fn order_9_is_not_reached() {
        let [end, ..] = step(|&[_, fourth, c]| [fourth * fourth, 4.0 * c * c * c, 1.0], &[0.0; 3], 1.0_f64);
        assert!((end - 1.0 / 9.0).abs() > 1e-6, "{end}"); // sum_i b_i (sum_j 4 a_ij c_j^3)^2
    }

    #[test]
    fn backwards_is_forwards_undone() {
        let spiral = |&[x, y]: &[f64; 2]| [y - 0.1 * x, -x];
        let [x, y] = step(spiral, &step(spiral, &[1.0, 0.5], 0.1), -0.1);
        assert!((x - 1.0).abs().max((y - 0.5).abs()) < 1e-12);
    }
}
