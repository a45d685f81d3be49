//! The price lists of the cores: the estimated cycles of a step by each method of a plan, and of
//! the most expensive preparation. They hold for all masses and lengths.
//!
//! `cargo count --write-prices` writes them, and the test `count` verifies them to 3 %.

use double_pendulum::plan::Costs;

// made by cargo count --write-prices
/// A Cortex-M3.
pub const CORTEX_M3: Costs = Costs {
    closed_form: 10928.2,
    direction_plain: 13012.0,
    direction: 14828.2,
    fixed32: 662.2,
    fixed64: 20060.0,
    preparation: 156107.0,
};
/// A Cortex-M4F.
pub const CORTEX_M4F: Costs = Costs {
    closed_form: 1780.2,
    direction_plain: 161.3,
    direction: 206.1,
    fixed32: 622.3,
    fixed64: 13444.0,
    preparation: 153270.0,
};
/// A Cortex-M0+.
pub const CORTEX_M0PLUS: Costs = Costs {
    closed_form: 19129.6,
    direction_plain: 22401.3,
    direction: 25551.9,
    fixed32: 2128.6,
    fixed64: 75407.0,
    preparation: 387363.0,
};
// so far
