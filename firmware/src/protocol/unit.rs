//! Units that a value may be given in.

use super::Field;
use super::choice::choice;

choice! {
    /// A unit.
    Unit {
        /// A pure number.
        One = 0, "1";
        /// A hundredth.
        Percent = 1, "%";
        /// Kilogram.
        Kilogram = 2, "kg";
        /// Gram.
        Gram = 3, "g";
        /// Metre.
        Metre = 4, "m";
        /// Centimetre.
        Centimetre = 5, "cm";
        /// Metre per second squared.
        MetrePerSecondSquared = 6, "m/s2";
        /// Degree.
        Degree = 7, "deg";
        /// Radian.
        Radian = 8, "rad";
        /// Radian per second.
        RadianPerSecond = 9, "rad/s";
        /// Degree per second.
        DegreePerSecond = 10, "deg/s";
    }
}

impl Unit {
    /// The unit that a field is kept in; `None` for what is not a quantity.
    pub fn of(field: Field) -> Option<Self> {
        Some(match field {
            Field::M1 | Field::M2 => Self::Kilogram,
            Field::L1 | Field::L2 => Self::Metre,
            Field::G => Self::MetrePerSecondSquared,
            Field::A1 | Field::A2 | Field::Angle => Self::Degree,
            Field::W1 | Field::W2 => Self::RadianPerSecond,
            Field::MassRatio | Field::Speed | Field::Method => Self::One,
            _ => return None,
        })
    }

    /// `value` of this unit in another; `None` if the two do not measure the same thing.
    pub fn convert(self, value: f64, to: Self) -> Option<f64> {
        let ((base, factor), (to_base, to_factor)) = (self.base(), to.base());
        if self == to { Some(value) } else { (base == to_base).then_some(value * factor / to_factor) }
    }

    /// The unit that stands for all that measure the same thing, and how much of it this one is.
    fn base(self) -> (Self, f64) {
        match self {
            Self::One | Self::Kilogram | Self::Metre => (self, 1.0),
            Self::MetrePerSecondSquared | Self::Radian | Self::RadianPerSecond => (self, 1.0),
            Self::Percent => (Self::One, 0.01),
            Self::Gram => (Self::Kilogram, 0.001),
            Self::Centimetre => (Self::Metre, 0.01),
            Self::Degree => (Self::Radian, core::f64::consts::PI / 180.0),
            Self::DegreePerSecond => (Self::RadianPerSecond, core::f64::consts::PI / 180.0),
        }
    }
}
