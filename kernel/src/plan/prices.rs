//! The price lists of three processors.
//!
//! The numbers are estimated cycles. The repository's `cargo count` runs the methods in an emulator
//! and adds the published timings of the executed instructions, for memory without wait states and,
//! on the Cortex-M0+, for the 1-cycle multiplier; without these a step takes longer. The code is
//! built with all optimisations and the flags of the repository's `.cargo/config.toml`.
//!
//! A step is the average over a motion from rest at 0.5 rad, with equal bobs on rods of 1 m. The
//! price for unlike ones is that with a bob 2 of 30 kg on a rod of 3 m, from 2 rad. The step in 64
//! bits, the preparation and the comparison are those of a plan in the repository's application.
//!
//! `cargo count --write-prices` writes this file, and the repository's test `count` verifies it to
//! 3 %.

use super::Costs;

// made by cargo count --write-prices
impl Costs {
    /// The counted price list of a Cortex-M3, in cycles.
    pub const CORTEX_M3: Costs = Costs {
        closed_form: 10978.1,
        direction_plain: 13045.4,
        direction: 14857.6,
        fixed32: 672.2,
        fixed32_unlike: 905.4,
        fixed64: 21672.0,
        preparation: 195555.0,
        comparison: 70828.0,
    };

    /// The counted price list of a Cortex-M4F, in cycles.
    pub const CORTEX_M4F: Costs = Costs {
        closed_form: 1820.3,
        direction_plain: 161.3,
        direction: 206.1,
        fixed32: 622.3,
        fixed32_unlike: 622.3,
        fixed64: 14306.0,
        preparation: 188606.0,
        comparison: 11395.0,
    };

    /// The counted price list of a Cortex-M0+, in cycles.
    pub const CORTEX_M0PLUS: Costs = Costs {
        closed_form: 19193.8,
        direction_plain: 22403.3,
        direction: 25556.9,
        fixed32: 2128.6,
        fixed32_unlike: 2571.1,
        fixed64: 80289.0,
        preparation: 508984.0,
        comparison: 123442.0,
    };
}
// end of the generated part
