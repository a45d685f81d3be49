//! What a plan's steps cost on each kind of core, masses and lengths alike, and the preparation that costs most: estimated
//! cycles, as `cargo count --write-prices` writes them and test `count` holds them to 3 %.

use double_pendulum::plan::Costs;

// made by cargo count --write-prices
/// A Cortex-M3.
pub const CORTEX_M3: Costs = Costs {
    closed_form: 8309.5,
    direction_plain: 13064.7,
    direction: 14897.4,
    fixed32: 671.0,
    fixed64: 21520.0,
    preparation: 158221.0,
};
/// A Cortex-M4F.
pub const CORTEX_M4F: Costs = Costs {
    closed_form: 1674.0,
    direction_plain: 160.2,
    direction: 206.1,
    fixed32: 622.8,
    fixed64: 13866.0,
    preparation: 155537.0,
};
/// A Cortex-M0+.
pub const CORTEX_M0PLUS: Costs = Costs {
    closed_form: 14931.9,
    direction_plain: 22583.3,
    direction: 25947.6,
    fixed32: 2128.6,
    fixed64: 77988.0,
    preparation: 388441.0,
};
// so far
