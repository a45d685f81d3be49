//! A row of the table by its words, and the row that a user's words mean.

use core::fmt;

use super::{Arithmetic, Formulation, Integrator, Model};
use crate::protocol::Field;

/// What a motion is computed with: the words of one row of the [table](super::ROWS).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// The numbers.
    pub arithmetic: Arithmetic,
    /// The equations.
    pub model: Model,
    /// What is stepped.
    pub form: Formulation,
    /// How.
    pub integrator: Integrator,
    /// The order of the integrator; 0 for the closed form.
    pub order: u8,
}

impl Row {
    /// The general model in classical steps.
    pub const fn rk4(arithmetic: Arithmetic, form: Formulation) -> Self {
        Self { arithmetic, model: Model::General, form, integrator: Integrator::Rk4, order: 4 }
    }
}

/// The row's name: its words in order, joined by hyphens. Some go without saying: the general model and the
/// canonical form of the others, classical steps and the closed form, and that extrapolation steps directions; that says its
/// order, for it has many.
impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { arithmetic, model, form, integrator, order } = self;
        f.write_str(arithmetic.name())?;
        if *model != Model::General {
            write!(f, "-{}", model.name())?;
        }
        let is_canonical = *model != Model::General && *form == Formulation::Canonical;
        if !is_canonical && *integrator != Integrator::Extrapolation {
            write!(f, "-{}", form.name())?;
        }
        match integrator {
            Integrator::Rk4 | Integrator::ClosedForm => Ok(()),
            Integrator::Extrapolation => write!(f, "-{}-{order}", integrator.name()),
        }
    }
}

/// What is asked of a row; `None` leaves it to the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// The numbers.
    pub arithmetic: Option<Arithmetic>,
    /// The equations.
    pub model: Option<Model>,
    /// What is stepped.
    pub form: Option<Formulation>,
    /// How.
    pub integrator: Option<Integrator>,
    /// The order of the integrator.
    pub order: Option<u8>,
}

impl Wanted {
    /// What can be asked for, in the order in which it counts.
    const FIELDS: [Field; 5] = [Field::Arithmetic, Field::Model, Field::Form, Field::Integrator, Field::Order];

    /// The first of `rows` that has all that is asked for; else the first field with which none goes any more that has
    /// what is asked of the fields before it.
    pub fn first_of(&self, rows: &[Row]) -> Result<Row, Field> {
        let had = |row: &Row| {
            let Row { arithmetic, model, form, integrator, order } = *row;
            let has = [
                self.arithmetic.is_none_or(|asked| asked == arithmetic),
                self.model.is_none_or(|asked| asked == model),
                self.form.is_none_or(|asked| asked == form),
                self.integrator.is_none_or(|asked| asked == integrator),
                self.order.is_none_or(|asked| asked == order),
            ];
            has.into_iter().take_while(|has| *has).count()
        };
        let found = rows.iter().find(|row| had(row) == Self::FIELDS.len()).copied();
        let most = rows.iter().map(had).max().unwrap_or(0);
        found.ok_or_else(|| Self::FIELDS.get(most).copied().unwrap_or(Field::Arithmetic))
    }
}

/// All of a row is asked for.
impl From<Row> for Wanted {
    fn from(Row { arithmetic, model, form, integrator, order }: Row) -> Self {
        Self {
            arithmetic: Some(arithmetic),
            model: Some(model),
            form: Some(form),
            integrator: Some(integrator),
            order: Some(order),
        }
    }
}
