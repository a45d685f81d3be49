//! What may be computed, and what a step of it costs where it is computed.

use std::fmt;

use double_pendulum::{Equations, Integrator, Method, Numbers};
use firmware::config::Processor;
use firmware::job::ON_BOARDS;

use super::{Options, Place};

impl Place {
    /// What a step by `method` costs; `None` of what is no frontier there: something else is as good and costs less.
    fn price(self, method: Method) -> Option<f64> {
        match self {
            Place::Host => on_host(method),
            Place::Board(board) => on_board(method, &board.processor()),
        }
    }
}

/// In what a price is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    Evaluations,
    Cycles,
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Evaluations => "evaluations of the equations",
            Self::Cycles => "cycles (estimate)",
        })
    }
}

/// What the options leave open, and what a step of it costs: by the place's prices or, where it has none for any of it, by the
/// evaluations of the equations.
pub(super) fn candidates(options: &Options) -> (Unit, Vec<(Method, f64)>) {
    let place = options.place;
    let left: Vec<_> = methods(place).filter(|method| options.method.is_none_or(|asked| asked == *method)).collect();
    let priced: Vec<_> = left.iter().filter_map(|&method| Some((method, place.price(method)?))).collect();
    match place {
        Place::Board(_) if !priced.is_empty() => (Unit::Cycles, priced),
        Place::Host if !priced.is_empty() => (Unit::Evaluations, priced),
        _ => (Unit::Evaluations, left.into_iter().map(|method| (method, evaluations(method))).collect()),
    }
}

/// What is computed at a place.
pub(super) fn methods(place: Place) -> impl Iterator<Item = Method> {
    let methods = match place {
        Place::Host => Method::ALL,
        Place::Board(_) => ON_BOARDS,
    };
    methods.iter().copied()
}

/// A processor of the host computes in `f64` as fast as in anything else: the evaluations count.
fn on_host(method: Method) -> Option<f64> {
    let is_fast = match method.equations() {
        Equations::Directions => matches!(method.numbers(), Numbers::F64 | Numbers::CompensatedF64),
        Equations::Linear => method.numbers() == Numbers::F64,
        _ => false,
    };
    is_fast.then(|| evaluations(method))
}

/// By the board's own prices; a step of another order than theirs costs as its evaluations do.
fn on_board(method: Method, Processor { costs, .. }: &Processor) -> Option<f64> {
    const PRICED: Method = Method::Extrapolation10Fixed64;
    if method.numbers() == Numbers::Fixed64 {
        return Some(f64::from(costs.fixed64) * evaluations(method) / evaluations(PRICED));
    }
    Some(f64::from(costs.of_frame(method, 1))).filter(|cost| cost.is_finite())
}

/// Of the equations, in a step; extrapolation of order 2 K takes K^2 + 1
/// ([`Extrapolation`](double_pendulum::extrapolation::Extrapolation)).
fn evaluations(method: Method) -> f64 {
    match method.integrator() {
        Integrator::ClosedForm => 0.0,
        Integrator::Rk4 => 4.0,
        Integrator::Extrapolation => f64::from(method.order() / 2).powi(2) + 1.0,
    }
}
