//! What a plan's steps cost on each kind of core, masses and lengths alike, and the preparation that costs most: estimated
//! cycles, as `cargo count --write-prices` writes them and test `count` holds them to 3 %.

use double_pendulum::plan::Costs;

// made by cargo count --write-prices
/// A Cortex-M3.
pub const CORTEX_M3: Costs = Costs {
    closed_form: 8198.3,
    direction_plain: 13019.9,
    direction: 14824.0,
    fixed32: 668.1,
    fixed64: 21540.0,
    preparation: 155488.0,
};
/// A Cortex-M4F.
pub const CORTEX_M4F: Costs = Costs {
    closed_form: 1681.0,
    direction_plain: 160.2,
    direction: 205.1,
    fixed32: 622.2,
    fixed64: 13866.0,
    preparation: 153997.0,
};
/// A Cortex-M0+.
pub const CORTEX_M0PLUS: Costs = Costs {
    closed_form: 14975.0,
    direction_plain: 22436.3,
    direction: 25567.4,
    fixed32: 2141.6,
    fixed64: 77988.0,
    preparation: 383743.0,
};
// so far
