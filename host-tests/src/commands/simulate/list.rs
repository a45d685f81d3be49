//! The table of methods.

use double_pendulum::Method;
use firmware::job::ON_BOARDS;

/// A line for each method: name, equations, numbers, integrator, order, and where it runs.
pub fn list() -> String {
    let line = |[method, equations, numbers, integrator, order, places]: [&str; 6]| {
        format!("{method:24} {equations:11} {numbers:15} {integrator:14} {order:>5}  {places}")
    };
    let mut lines = vec![line(["method", "equations", "numbers", "integrator", "order", "runs on"])];
    for method in Method::ALL {
        let (equations, numbers) = (method.equations().to_string(), method.numbers().to_string());
        let (integrator, order) = (method.integrator().to_string(), method.order().to_string());
        let boards = if ON_BOARDS.contains(method) { ", boards" } else { "" };
        let scenes = if Method::DRAWN.contains(method) { ", scenes" } else { "" };
        let places = format!("host{boards}{scenes}");
        lines.push(line([method.name(), &equations, &numbers, &integrator, &order, &places]));
    }
    lines.join("\n")
}
