//! A table that can be written as CSV and as Markdown.

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    pub columns: Vec<&'static str>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    pub fn csv(&self) -> String {
        let lines = std::iter::once(self.columns.join(","))
            .chain(self.rows.iter().map(|row| row.join(",")));
        lines.map(|line| line + "\n").collect()
    }

    pub fn markdown(&self) -> String {
        let heads = [
            self.columns.join(" | "),
            vec!["---"; self.columns.len()].join(" | "),
        ];
        let lines = heads
            .into_iter()
            .chain(self.rows.iter().map(|row| row.join(" | ")));
        lines.map(|cells| format!("| {cells} |\n")).collect()
    }
}

/// Returns `page` with `text` in place of everything between two marks.
pub fn between(page: &str, [start, end]: [&str; 2], text: &str) -> Option<String> {
    let (head, rest) = page.split_once(start)?;
    let (_, tail) = rest.split_once(end)?;
    Some(format!("{head}{start}{text}{end}{tail}"))
}

/// Rounds to two digits in exponent form, such as 1.5e-7.
pub fn small(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.1e}")
    } else {
        String::from("none")
    }
}

/// Returns a bound of two digits that is greater than the positive `value`.
pub fn at_most(value: f64) -> String {
    let rounded = format!("{value:.1e}");

    // A decimal may be below the `f64` that it is parsed to, by half a unit of its last place.
    let is_enough = |text: &str| text.parse::<f64>().is_ok_and(|bound| bound > value);
    if value == 0.0 || !value.is_finite() || is_enough(&rounded) {
        return rounded;
    }

    let more = value * 1.1;
    let unit = 10_f64.powi(value.log10().floor() as i32 - 1);
    [value + 0.5 * unit, value + unit, more]
        .map(|bound| format!("{bound:.1e}"))
        .into_iter()
        .find(|text| is_enough(text))
        .unwrap_or_else(|| format!("{:.1e}", 2.0 * value))
}

#[test]
fn bounds_are_rounded_up() {
    for (value, text) in [
        (0.0, "0.0e0"),
        (1.0, "1.1e0"),
        (1.5429e-7, "1.6e-7"),
        (1.81e-4, "1.9e-4"),
        (9.91e-33, "1.0e-32"),
        (9.9999e5, "1.0e6"),
        (1.01e-300, "1.1e-300"),
        (f64::INFINITY, "inf"),
    ] {
        assert_eq!(at_most(value), text, "{value:e}");
    }
}

#[test]
fn text_between_the_marks_is_replaced() {
    let [old, new] = ["old", "new"].map(|text| format!("before [{text}] after"));
    assert_eq!(between(&old, ["[", "]"], "new"), Some(new));
    assert_eq!(between("before ] after [", ["[", "]"], "new"), None);
}
