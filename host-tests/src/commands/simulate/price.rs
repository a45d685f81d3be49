//! What may be computed, and what a step of it costs where it is computed.

use std::fmt;

use double_pendulum::plan::ORDER;
use firmware::config::Processor;
use firmware::job::{Arithmetic, Formulation, Integrator, Model, ON_BOARDS, ROWS, Row};

use super::{Options, Place};

impl Place {
    /// What a step of `row` costs; `None` of what is no frontier there: something else is as good and costs less.
    fn price(self, row: Row) -> Option<f64> {
        match self {
            Place::Host => on_host(row),
            Place::Board(board) => on_board(row, &board.processor()),
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
pub(super) fn candidates(options: &Options) -> (Unit, Vec<(Row, f64)>) {
    let (wanted, place) = (options.wanted(), options.place);
    let left: Vec<_> = rows(place).filter(|row| wanted.first_of(&[*row]).is_ok()).collect();
    let priced: Vec<_> = left.iter().filter_map(|&row| Some((row, place.price(row)?))).collect();
    match place {
        Place::Board(_) if !priced.is_empty() => (Unit::Cycles, priced),
        Place::Host if !priced.is_empty() => (Unit::Evaluations, priced),
        _ => (Unit::Evaluations, left.into_iter().map(|row| (row, evaluations(row))).collect()),
    }
}

/// What is computed at a place, double precision before single.
pub(super) fn rows(place: Place) -> impl Iterator<Item = Row> {
    let rows = match place {
        Place::Host => ROWS,
        Place::Board(_) => ON_BOARDS,
    };
    let of = |single| rows.iter().copied().filter(move |row| row.arithmetic.is_single() == single);
    of(false).chain(of(true))
}

/// A processor of the host computes in `f64` as fast as in anything else: the evaluations count.
fn on_host(row: Row) -> Option<f64> {
    match row {
        Row { arithmetic: Arithmetic::F64, model: Model::Linear, .. }
        | Row { arithmetic: Arithmetic::F64, form: Formulation::Direction, integrator: Integrator::Rk4, .. }
        | Row { arithmetic: Arithmetic::F64Compensated, integrator: Integrator::Extrapolation, .. } => {
            Some(evaluations(row))
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
        Row { arithmetic: Arithmetic::Fixed64, .. } => {
            let priced = Row { order: ORDER as u8, ..row };
            return Some(f64::from(costs.fixed64) * evaluations(row) / evaluations(priced));
        }
        _ => return None,
    };
    Some(f64::from(price))
}

/// Of the equations, in a step; extrapolation of order 2 K takes K^2 + 1
/// ([`Extrapolation`](double_pendulum::extrapolation::Extrapolation)).
fn evaluations(row: Row) -> f64 {
    match row.integrator {
        Integrator::ClosedForm => 0.0,
        Integrator::Rk4 => 4.0,
        Integrator::Extrapolation => f64::from(row.order / 2).powi(2) + 1.0,
    }
}
