//! The price lists of the processors on which the methods have been counted.
//!
//! The numbers are estimated cycles. `cargo count` of the repository runs each method in QEMU,
//! built with the flags of the repository's `.cargo/config.toml`, and adds the cycles of the
//! executed instructions as the manual of the processor gives them, without wait states of the
//! flash memory. A step is that of a motion from rest at 0.5 rad, on rods of 1 m with equal bobs.
//! The preparation is the most expensive one of any method in the firmware's scenes.
//!
//! `cargo count --write-prices` writes this file, and the repository's test `count` verifies it to
//! 3 %.

use super::Costs;

// made by cargo count --write-prices
impl Costs {
    /// The counted price list of a Cortex-M3, in cycles.
    pub const CORTEX_M3: Costs = Costs {
        closed_form: 10928.2,
        direction_plain: 13012.0,
        direction: 14828.2,
        fixed32: 662.2,
        fixed64: 20060.0,
        preparation: 156107.0,
    };

    /// The counted price list of a Cortex-M4F, in cycles.
    pub const CORTEX_M4F: Costs = Costs {
        closed_form: 1780.2,
        direction_plain: 161.3,
        direction: 206.1,
        fixed32: 622.3,
        fixed64: 13444.0,
        preparation: 153270.0,
    };

    /// The counted price list of a Cortex-M0+, in cycles.
    pub const CORTEX_M0PLUS: Costs = Costs {
        closed_form: 19129.6,
        direction_plain: 22401.3,
        direction: 25551.9,
        fixed32: 2128.6,
        fixed64: 75407.0,
        preparation: 387363.0,
    };
}
// so far
