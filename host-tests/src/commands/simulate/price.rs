//! What may be computed, and what a step of it costs where it is computed.

use double_pendulum::plan::ORDER;
use firmware::config::Processor;
use firmware::job::{Arithmetic, Formulation, Integrator, Model, ON_BOARDS, ROWS, Row};

use super::{Options, Place};

impl Place {
    /// What is computed there.
    pub(super) fn rows(self) -> &'static [Row] {
        match self {
            Place::Host => ROWS,
            Place::Board(_) => ON_BOARDS,
        }
    }

    /// In what its prices are.
    pub(super) fn unit(self) -> &'static str {
        match self {
            Place::Host => "evaluations of the equations",
            Place::Board(_) => "cycles (estimate)",
        }
    }

    /// What a step of `row` costs; `None` of what is no frontier there: something else is as good and costs less.
    fn price(self, row: Row) -> Option<f64> {
        match self {
            Place::Host => on_host(row),
            Place::Board(board) => on_board(row, &board.processor()),
        }
    }
}

/// What the options leave open, and what a step of it costs. If they name what has no price, it alone, at any.
pub(super) fn candidates(options: &Options, named: Row) -> Vec<(Row, f64)> {
    let wanted = options.wanted();
    let left = options.place.rows().iter().filter(|row| wanted.first_of(std::slice::from_ref(row)).is_ok());
    let priced: Vec<_> = left.filter_map(|&row| Some((row, options.place.price(row)?))).collect();
    if priced.is_empty() { vec![(named, 1.0)] } else { priced }
}

/// A processor of the host computes in `f64` as fast as in anything else: the evaluations count.
fn on_host(row: Row) -> Option<f64> {
    match row {
        Row { arithmetic: Arithmetic::F64, model: Model::Linear, .. } => Some(0.0),
        Row { arithmetic: Arithmetic::F64, form: Formulation::Direction, integrator: Integrator::Rk4, .. } => Some(4.0),
        Row { arithmetic: Arithmetic::F64Compensated, integrator: Integrator::Extrapolation, order, .. } => {
            Some(evaluations(order))
        }
        _ => None,
    }
}

/// By the board's own prices; a step of another order than theirs costs as its evaluations do.
fn on_board(row: Row, Processor { costs, .. }: &Processor) -> Option<f64> {
    let price = match row {
        Row { arithmetic: Arithmetic::F32, model: Model::Linear, .. } => costs.closed_form,
        Row { arithmetic: Arithmetic::F32, form: Formulation::Direction, .. } => costs.direction_plain,
        Row { arithmetic: Arithmetic::F32Compensated, form: Formulation::Direction, .. } => costs.direction,
        Row { arithmetic: Arithmetic::Fixed32, .. } => costs.fixed32,
        Row { arithmetic: Arithmetic::Fixed64, order, .. } => {
            return Some(f64::from(costs.fixed64) * evaluations(order) / evaluations(ORDER as u8));
        }
        _ => return None,
    };
    Some(f64::from(price))
}

/// Of the equations, in a step of extrapolation: K^2 + 1 for order 2 K
/// ([`Extrapolation`](double_pendulum::extrapolation::Extrapolation)).
fn evaluations(order: u8) -> f64 {
    let half = f64::from(order) / 2.0;
    half * half + 1.0
}
