//! A table of the report, in two notations.

/// Columns with their headings, rows of as many cells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// File name without ending.
    pub name: &'static str,
    /// Heading.
    pub title: String,
    /// What the columns mean and where the numbers come from.
    pub note: String,
    /// Headings of the columns, with units.
    pub columns: Vec<&'static str>,
    /// Cells.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Comma-separated; no cell contains a comma or a quote.
    pub fn csv(&self) -> String {
        let mut text = self.columns.join(",");
        text.push('\n');
        for row in &self.rows {
            text.push_str(&row.join(","));
            text.push('\n');
        }
        text
    }

    /// With heading and note.
    pub fn markdown(&self) -> String {
        format!("## {}\n\n{}\n\n{}", self.title, self.note, self.markdown_rows())
    }

    /// The columns' headings and the rows.
    pub fn markdown_rows(&self) -> String {
        let line = |cells: String| format!("| {cells} |\n");
        let mut text = String::new();
        text.push_str(&line(self.columns.join(" | ")));
        text.push_str(&line(vec!["---"; self.columns.len()].join(" | ")));
        self.rows.iter().for_each(|row| text.push_str(&line(row.join(" | "))));
        text
    }
}

/// An error or a drift: two digits, or what it is not.
pub fn small(value: f64) -> String {
    if value.is_finite() { format!("{value:.1e}") } else { String::from("none") }
}
