//! Hamilton's equations for the libraries: as the book prints them, and this kernel's.

use double_pendulum::Parameters;
use double_pendulum::trig::Own;

pub const PARAMETERS: Parameters<f64> = Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81 };

/// This kernel's equations.
pub type Pendulum = double_pendulum::Pendulum<f64, Own>;

/// Right-hand sides in the order a1, a2, p1, p2.
pub trait Equations {
    fn derivatives(&self, z: &[f64; 4]) -> [f64; 4];
}

impl Equations for Pendulum {
    fn derivatives(&self, z: &[f64; 4]) -> [f64; 4] {
        Pendulum::derivatives(self, z)
    }
}

/// The equations as the book prints them, with the standard library's sine and cosine: what a user would write.
pub struct Book;

impl Equations for Book {
    fn derivatives(&self, &[a1, a2, p1, p2]: &[f64; 4]) -> [f64; 4] {
        let Parameters { m1, m2, l1, l2, g } = PARAMETERS;
        let (sin, cos) = ((a1 - a2).sin(), (a1 - a2).cos());
        let den = m1 + m2 * sin * sin;
        let squares = p1 * p1 * m2 * l2 * l2 - 2.0 * p1 * p2 * m2 * l1 * l2 * cos + p2 * p2 * (m1 + m2) * l1 * l1;
        let a_1 = p1 * p2 * sin / (l1 * l2 * den);
        let a_2 = squares * (2.0 * (a1 - a2)).sin() / (2.0 * l1 * l1 * l2 * l2 * den * den);
        [
            (p1 * l2 - p2 * l1 * cos) / (l1 * l1 * l2 * den),
            (p2 * (m1 + m2) * l1 - p1 * m2 * l2 * cos) / (m2 * l1 * l2 * l2 * den),
            -(m1 + m2) * g * l1 * a1.sin() - a_1 + a_2,
            -m2 * g * l2 * a2.sin() + a_1 - a_2,
        ]
    }
}
