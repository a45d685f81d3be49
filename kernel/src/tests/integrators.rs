//! The order conditions of every integrator (`[Hairer I]`, II.2).
//!
//! The weights are read off from a step for equations whose slopes at the stages are unit vectors,
//! so that the points and the end of the step show each weight by itself.

use core::any::type_name;
use core::cell::Cell;
use core::iter::zip;
use std::format;
use std::string::String;
use std::vec::Vec;

use double_pendulum::parts::{Rk4, RungeKutta};
use double_pendulum::{Extrapolation, Integrator, Method};

/// More than the 65 stages of extrapolation of order 16.
const N: usize = 72;

const DT: f64 = 0.5;

/// The weights of extrapolation are as large as 6, and cancel.
const ROUNDING: f64 = 1e-12;

/// The weights of an explicit method, in the notation of the book.
#[derive(Clone)]
struct Tableau {
    /// The weight a(i, j) of slope j in the point of stage i, for j < i.
    a: Vec<Vec<f64>>,
    /// The weight b(i) of slope i in the step.
    b: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Weight {
    A(usize, usize),
    B(usize),
}

impl Tableau {
    fn of(step: impl FnOnce(&dyn Fn(&[f64; N]) -> [f64; N], &[f64; N]) -> [f64; N]) -> Self {
        let points = Cell::new(Vec::new());
        let start = [1.0; N];
        let weights = |z: &[f64; N]| z.map(|z| (z - 1.0) / DT);
        let slopes = |z: &[f64; N]| {
            let mut seen = points.take();
            let stage = seen.len();
            seen.push(weights(z));
            points.set(seen);
            core::array::from_fn(|i| if i == stage { 1.0 } else { 0.0 })
        };
        let end = weights(&step(&slopes, &start));

        let a = points.take();
        let stages = a.len();
        assert!(end[stages..].iter().all(|rest| *rest == 0.0));
        let a = a.into_iter().enumerate().map(|(i, row)| {
            assert!(row[i..].iter().all(|rest| *rest == 0.0));
            row[..i].to_vec()
        });
        Self {
            a: a.collect(),
            b: end[..stages].to_vec(),
        }
    }

    fn times(&self, x: &[f64]) -> Vec<f64> {
        let row = |row: &Vec<f64>| zip(row, x).map(|(a, x)| a * x).sum();
        self.a.iter().map(row).collect()
    }

    /// Returns the name, the sum and the required value of each condition: all of order 4 or less,
    /// and those of quadrature above.
    fn conditions(&self, order: u32) -> Vec<(String, f64, f64)> {
        let one = std::vec![1.0; self.b.len()];
        let c = self.times(&one);
        let product = |x: &[f64], y: &[f64]| zip(x, y).map(|(x, y)| x * y).collect::<Vec<_>>();
        let square = product(&c, &c);
        let ac = self.times(&c);

        let of_trees = [
            (3, "sum b A c", ac.clone(), 6.0),
            (4, "sum b c A c", product(&c, &ac), 8.0),
            (4, "sum b A c^2", self.times(&square), 12.0),
            (4, "sum b A A c", self.times(&ac), 24.0),
        ];

        let of_quadrature = (1..=order).map(|order| {
            let power: Vec<_> = c.iter().map(|c| c.powi(order as i32 - 1)).collect();
            let name = format!("sum b c^{}", order - 1);
            (order, name, power, f64::from(order))
        });
        let of_trees = of_trees.map(|(order, name, x, parts)| (order, name.into(), x, parts));
        of_quadrature
            .chain(of_trees)
            .filter(|condition| condition.0 <= order)
            .map(|(_, name, x, parts)| {
                let sum = zip(&self.b, x).map(|(b, x)| b * x).sum();
                (name, sum, 1.0 / parts)
            })
            .collect()
    }

    fn errors(&self, order: u32) -> Vec<f64> {
        let conditions = self.conditions(order).into_iter();
        conditions.map(|(_, sum, value)| sum - value).collect()
    }

    fn is_of_order(&self, order: u32) -> bool {
        self.errors(order)
            .iter()
            .all(|error| error.abs() <= ROUNDING)
    }

    fn weights(&self) -> Vec<Weight> {
        let stages = 1..=self.b.len();
        let a = stages
            .clone()
            .flat_map(|i| (1..i).map(move |j| Weight::A(i, j)));
        a.chain(stages.map(Weight::B)).collect()
    }

    fn weight(&mut self, weight: Weight) -> &mut f64 {
        match weight {
            Weight::A(i, j) => &mut self.a[i - 1][j - 1],
            Weight::B(i) => &mut self.b[i - 1],
        }
    }

    /// Returns the value of a weight that meets all conditions, by the method of Gauss and Newton.
    fn repaired(&self, weight: Weight, order: u32) -> Option<f64> {
        let mut trial = self.clone();
        let now = *trial.weight(weight);

        [now, 0.0, 0.5, 1.0, -1.0].into_iter().find_map(|start| {
            *trial.weight(weight) = start;
            for _ in 0..30 {
                const STEP: f64 = 1e-6;
                let errors = trial.errors(order);
                *trial.weight(weight) += STEP;
                let slopes =
                    zip(trial.errors(order), &errors).map(|(next, now)| (next - now) / STEP);
                let slopes: Vec<_> = slopes.collect();

                // A weight without influence is only restored.
                let square: f64 = slopes.iter().map(|slope| slope * slope).sum();
                let descent: f64 = zip(&slopes, &errors)
                    .map(|(slope, error)| slope * error)
                    .sum();
                *trial.weight(weight) -= STEP + if square > 0.0 { descent / square } else { 0.0 };
            }
            trial.is_of_order(order).then_some(*trial.weight(weight))
        })
    }

    fn check(&self, order: u32) -> Result<(), String> {
        let mut conditions = self.conditions(order).into_iter();
        let fails = |(_, sum, value): &(String, f64, f64)| (sum - value).abs() > ROUNDING;
        let Some((name, sum, value)) = conditions.find(fails) else {
            return Ok(());
        };

        let mut message = format!("not of order {order}: {name} = {sum}, not {value}");
        for weight in self.weights() {
            if let Some(value) = self.repaired(weight, order) {
                let now = *self.clone().weight(weight);
                message += &format!("; {weight:?} = {now} should be {value:.9}");
            }
        }
        Err(message)
    }

    /// Returns the growth factor of an oscillation.
    fn growth(&self, phase: f64) -> f64 {
        let mut slopes: Vec<[f64; 2]> = Vec::new();
        let advanced = |weights: &[f64], slopes: &[[f64; 2]]| {
            let sum = |part: usize| -> f64 { zip(weights, slopes).map(|(a, k)| a * k[part]).sum() };
            [1.0 + phase * sum(0), phase * sum(1)]
        };
        for row in &self.a {
            let [re, im] = advanced(row, &slopes);
            slopes.push([-im, re]);
        }
        let [re, im] = advanced(&self.b, &slopes);
        re.hypot(im)
    }
}

fn tableau<I: RungeKutta>() -> Tableau {
    Tableau::of(|f, z| I::step(f, z, DT))
}

fn check<I: RungeKutta>(order: u32) {
    let integrator = type_name::<I>();
    assert_eq!(I::ORDER, order, "{integrator}");
    assert!(
        order <= 4,
        "{integrator}: the conditions above order 4 are missing here"
    );
    let tableau = tableau::<I>();
    tableau
        .check(order)
        .unwrap_or_else(|error| panic!("{integrator}: {error}"));

    // The limit of stability must be safe, and not lower than it could be.
    for i in 1..=100 {
        let phase = I::STABLE * f64::from(i) / 100.0;
        let growth = tableau.growth(phase);
        assert!(
            growth <= 1.0 + ROUNDING,
            "{integrator}: {growth} at {phase} rad"
        );
    }
    assert!(
        tableau.growth(1.01 * I::STABLE) > 1.0,
        "{integrator}: stable in longer steps"
    );
}

/// For extrapolation the conditions are those of quadrature and all of order 4 or less.
#[test]
fn every_integrator_meets_its_order_conditions() {
    for method in Method::ALL {
        match method.integrator() {
            Integrator::Rk4 => check::<Rk4>(method.order()),
            Integrator::Extrapolation => {
                let extrapolation = Extrapolation::new(method.order()).expect("an even order");
                let tableau = Tableau::of(|f, z| extrapolation.step(f, z, DT));
                let checked = tableau.check(method.order());
                checked.unwrap_or_else(|error| panic!("{method}: {error}"));
            }
            Integrator::ClosedForm => {} // It has no steps.
        }
    }
}

/// A test of the test: the message names the weight that was changed, and its right value.
#[test]
fn a_single_wrong_weight_is_named() {
    let right = tableau::<Rk4>();
    for weight in right.weights() {
        for change in [0.25, -0.25] {
            let mut wrong = right.clone();
            *wrong.weight(weight) += change;
            let error = wrong.check(4).expect_err("one weight is wrong");
            let now = *wrong.weight(weight);
            let value = *right.clone().weight(weight);

            let named = format!("; {weight:?} = {now} should be {value:.9}");
            assert!(
                error
                    .replace("-0.000000000", "0.000000000")
                    .ends_with(&named)
                    && error.matches(" should be ").count() == 1,
                "{weight:?} = {now}: {error}"
            );
        }
    }
}
