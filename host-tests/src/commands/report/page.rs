//! The page that shows it all.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;

use super::flips;
use crate::commands::count::ERROR_BAR;
use crate::commands::table::{Table, escaped};

const HEAD: &str = r#"<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<title>Double pendulum: speed against error</title>
<style>
body { font: 15px/1.5 sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }
table { border-collapse: collapse; font-size: 13px }
th, td { border: 1px solid #ccc; padding: 2px 8px; text-align: right }
th:first-child, td:first-child { text-align: left }
svg { max-width: 100%; height: auto }
</style>
<h1>Double pendulum: speed against error</h1>
<p>Costs are counted on emulated boards, errors are computed against the reference; no chip was measured here.</p>
"#;

/// The map of flips as `cargo flips` made it, and the panel's.
const PICTURES: [&[u8]; 2] =
    [include_bytes!("../../../pictures/figures/flips.png"), include_bytes!("../../../pictures/panel/flips.png")];

/// The page: the advice, the frames, then the tables. It needs no other file.
pub fn html(advice: &[String], tables: &[Table], charts: &[(String, String)]) -> String {
    let mut page = format!("{HEAD}<p>{ERROR_BAR}</p>\n<ul>\n");
    advice.iter().for_each(|sentence| page.push_str(&format!("<li>{}</li>\n", escaped(&sentence.replace('`', "")))));
    page.push_str("</ul>\n");
    for (_, svg) in charts {
        page.push_str(svg);
    }
    for table in tables {
        page.push_str(&table.html());
        for picture in PICTURES.iter().filter(|_| table.name == flips::NAME) {
            let data = BASE64_STANDARD.encode(picture);
            page.push_str(&format!("<img alt=\"map of flips\" src=\"data:image/png;base64,{data}\">\n"));
        }
    }
    page.push_str("</html>\n");
    page
}
