//! The table of methods.

use std::fmt::Write;

use double_pendulum::Method;
use firmware::job::ON_BOARDS;

/// A line for each method: name, equations, numbers, integrator, order, and where it runs.
pub fn list() -> String {
    let mut text = line(["method", "equations", "numbers", "integrator", "order", "runs on"]);
    for method in Method::ALL {
        let [equations, numbers, integrator, order] = [
            method.equations().to_string(),
            method.numbers().to_string(),
            method.integrator().to_string(),
            method.order().to_string(),
        ];
        let mut places = String::from("host");
        if ON_BOARDS.contains(method) {
            places.push_str(", boards");
        }
        if Method::DRAWN.contains(method) {
            places.push_str(", scenes");
        }
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{}", line([method.name(), &equations, &numbers, &integrator, &order, &places]));
    }
    text
}

fn line([method, equations, numbers, integrator, order, places]: [&str; 6]) -> String {
    format!("{method:24} {equations:11} {numbers:15} {integrator:14} {order:>5}  {places}")
}
