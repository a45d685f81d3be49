//! What a plan's steps cost on each kind of core, masses and lengths alike, and the preparation that costs most: estimated
//! cycles, as `cargo count --write-prices` writes them and test `count` holds them to 3 %.

use double_pendulum::plan::Costs;

// made by cargo count --write-prices
/// A Cortex-M3.
pub const CORTEX_M3: Costs = Costs {
    closed_form: 8153.2,
    direction_plain: 13021.2,
    direction: 14827.4,
    fixed32: 671.0,
    fixed64: 21520.0,
    preparation: 157331.0,
};
/// A Cortex-M4F.
pub const CORTEX_M4F: Costs = Costs {
    closed_form: 1552.6,
    direction_plain: 160.2,
    direction: 206.1,
    fixed32: 630.7,
    fixed64: 13866.0,
    preparation: 155798.0,
};
/// A Cortex-M0+.
pub const CORTEX_M0PLUS: Costs = Costs {
    closed_form: 14502.8,
    direction_plain: 22434.3,
    direction: 25566.4,
    fixed32: 2147.8,
    fixed64: 77988.0,
    preparation: 386028.0,
};
// so far
