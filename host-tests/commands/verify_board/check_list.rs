//! The check list of a new board: properties that no emulator has and no message reports.

use firmware::protocol::Restarted;

use super::Section;
use boards::link::{Port, describe_restart};

/// A manual check that the README of `firmware/boards-measured` describes.
pub struct Check {
    pub name: &'static str,
    /// All boards if the list is empty.
    boards: &'static [&'static str],
}

const fn check(name: &'static str, boards: &'static [&'static str]) -> Check {
    Check { name, boards }
}

const WITH_I2C: &[&str] = &["pico", "stm32f405"];
const WITH_USB: &[&str] = &["pico"];

/// In the order of a new board's first use.
pub const CHECKS: &[Check] = &[
    check("enumeration at the first try", WITH_USB),
    check("control packets of 64 bytes", WITH_USB),
    check("SCL frequency and rise time", WITH_I2C),
    check("status byte after power-on", WITH_I2C),
    check("status byte after a reset", WITH_I2C),
    check("panel pulled for 10 s while playing", WITH_I2C),
    check("SDA alone pulled", WITH_I2C),
    check("SCL at ground for 2 s", WITH_I2C),
    check("forced crash, at a root port", &[]),
    check("forced crash, behind a hub", WITH_USB),
    check("boot loader by `cargo pico` alone", WITH_USB),
    check("port opened and closed 50 times", &[]),
    check("computer suspended", WITH_USB),
    check("host killed in the middle of a transfer", &[]),
    check("probe attached late, detached, flashing", &[]),
    check("a night's run", &[]),
];

pub const BLANK: &str = "(fill in)";

/// Returns the check list of the board `name`. A restart during the comparison is a fault. A later
/// one is not, because the person at the board may have caused it.
pub fn section(port: &Port, name: &str, compared: u64) -> Section {
    let note = "The board reports its restarts itself. Please fill in the other rows as the check \
                list in `firmware/boards-measured/README.md` describes; leave rows that do not \
                apply.";
    let mut section = Section::new("Check list", note, &["what", "found"]);
    let during = "restarts during the comparison";
    let fault = (compared > 0).then(|| format!("{during}: {compared}"));
    section.add(vec![during.to_owned(), compared.to_string()], fault);
    for (what, found) in restarts(port.inbox.counts.restarts, port.restarted.as_ref()) {
        section.add(vec![what.to_owned(), found], None);
    }
    let is_for = |check: &&Check| check.boards.is_empty() || check.boards.contains(&name);
    for check in CHECKS.iter().filter(is_for) {
        section.add(vec![check.name.to_owned(), BLANK.to_owned()], None);
    }
    section
}

fn restarts(count: u64, last: Option<&Restarted>) -> [(&'static str, String); 2] {
    [
        ("restarts during this verification", count.to_string()),
        (
            "last unplanned restart",
            last.map_or("none since power-on".to_owned(), describe_restart),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use boards::toolchain::workspace;

    #[test]
    fn the_readme_describes_every_check() {
        let page = workspace().join("firmware/boards-measured/README.md");
        let page = std::fs::read_to_string(page).expect("a page");
        let page = page.split_whitespace().collect::<Vec<_>>().join(" ");
        for check in CHECKS {
            assert!(page.contains(check.name), "{} is not described", check.name);
        }
    }

    #[test]
    fn restarts_are_counted_and_named() {
        let end = Restarted::default();
        let [(_, count), (_, last)] = restarts(3, Some(&end));
        assert_eq!((&*count, last), ("3", describe_restart(&end)));
    }
}
