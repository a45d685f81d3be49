//! What may be computed, and what a step of it costs where it is computed.

use double_pendulum::{Equations, Integrator, Method, Numbers};
use firmware::config::Processor;
use firmware::job::ON_BOARDS;

use super::{Place, SimulateOptions};

/// What the options leave open, what a step of it costs, and in what: by the place's prices or, where it has none for any of it,
/// by the evaluations of the equations.
pub(super) fn candidates(options: &SimulateOptions) -> (&'static str, Vec<(Method, f64)>) {
    let left = || methods(options.place).filter(|method| options.method.is_none_or(|asked| asked == *method));
    let price = |method| options.place.map_or(on_host(method), |board| on_board(method, &board.processor()));
    let priced: Vec<_> = left().filter_map(|method| Some((method, price(method)?))).collect();
    match options.place {
        Some(_) if !priced.is_empty() => ("cycles (estimate)", priced),
        None if !priced.is_empty() => ("evaluations of the equations", priced),
        _ => ("evaluations of the equations", left().map(|method| (method, evaluations(method))).collect()),
    }
}

/// What is computed at a place.
pub(super) fn methods(place: Place) -> impl Iterator<Item = Method> {
    let methods = if place.is_none() { Method::ALL } else { ON_BOARDS };
    methods.iter().copied()
}

/// A processor of the host computes in `f64` as fast as in anything else: the evaluations count. `None` of what is no frontier:
/// something else is as good and costs less.
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
