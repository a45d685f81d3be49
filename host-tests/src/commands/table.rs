//! A table, in two notations.

/// Headings of the columns, with units, and rows of as many cells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    pub columns: Vec<&'static str>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Comma-separated; no cell contains a comma or a quote.
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

/// `page` with something else between its two marks, if it has them.
pub fn between(page: &str, [start, end]: [&str; 2], text: &str) -> Option<String> {
    let (head, rest) = page.split_once(start)?;
    let (_, tail) = rest.split_once(end)?;
    Some(format!("{head}{start}{text}{end}{tail}"))
}

/// An error or a drift: two digits, or what it is not.
pub fn small(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.1e}")
    } else {
        String::from("none")
    }
}

#[test]
fn what_stands_between_the_marks_is_replaced() {
    let [old, new] = ["old", "new"].map(|text| format!("before [{text}] after"));
    assert_eq!(between(&old, ["[", "]"], "new"), Some(new));
    assert_eq!(between("before ] after [", ["[", "]"], "new"), None);
}
