//! `cargo web`: the application as a page for a browser, in one file that needs no network.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{bail, ensure};
use clap::Parser;
use double_pendulum::Method;
use firmware::config::{MASS_RATIOS, TICK_RATE};
use firmware::graphics::{Format, PanelName};
use firmware::scenes::{LEAST_ENERGY_ERROR, SceneName};
use serde_json::{Value, json};

use boards::console::cli::{Refused, say};
use boards::out_file::{self, OutFile};
use boards::process;
use boards::toolchain::{self, find, target};
use boards::{Board, LM3S6965EVB, LM3S6965EVB_M4, PICO, STM32F405, every_board};
use demo::{KEYS, SPEEDS, palette, scene_key, shows};

pub const FILE: &str = "double-pendulum.html";
const TEMPLATE: &str = include_str!("../../firmware/web/page.html");

/// The boards that the page offers, each with a description. Links name them as `--board` does.
/// The first one is the default.
pub const OFFERED: [(&Board, &str); 4] = [
    (&PICO, "Raspberry Pi Pico (Cortex-M0+)"),
    (&LM3S6965EVB, "LM3S6965EVB (Cortex-M3 at 50 MHz)"),
    (&LM3S6965EVB_M4, "Cortex-M4F at 25 MHz"),
    (&STM32F405, "STM32F405 (Cortex-M4F at 168 MHz)"),
];
pub const PANELS: [PanelName; 5] = [
    PanelName::Lcd13,
    PanelName::Lcd2,
    PanelName::Display2,
    PanelName::Display,
    PanelName::Oled,
];

/// The options for no window, also for root, and no requests of its own.
pub const HEADLESS: &str = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
    --disable-background-networking --disable-component-update --disable-sync --hide-scrollbars";
const PICTURE: &str = "--window-size=1000,1100 --virtual-time-budget=60000";
const PICTURE_LIMIT: Duration = Duration::from_secs(120);
/// A clock for the picture: 8.5 s in frames of 1/60 s, independent of the speed of the machine. The
/// module is compiled at once, because the virtual time does not wait for a compilation, and a page
/// that had not started was photographed.
const CLOCK: &str = "<script>WebAssembly.compile = async (bytes) => new WebAssembly.Module(bytes);
  WebAssembly.instantiate = async (module) => new WebAssembly.Instance(module); let frames = 0; window.requestAnimationFrame = (frame) =>
  frames++ < 510 && setTimeout(() => frame(frames * 1000 / 60));</script>";

/// Writes target/double-pendulum.html: the panel of a board in a browser. The page is one file,
/// opens without a server, and makes no request.
#[derive(Debug, Parser)]
#[command(name = "cargo web", after_help = "Example: cargo web --open")]
pub struct WebOptions {
    /// Open the page in the browser
    #[arg(long)]
    open: bool,
    /// Save a picture of the page, which Chromium makes, as this PNG file
    #[arg(long, value_name = "FILE.png")]
    picture: Option<PathBuf>,
}

/// Writes the page, and makes the picture and opens the page if the options demand it. If the
/// picture cannot be written or Chromium is missing, this is refused before the build.
pub fn run(options: &WebOptions) -> anyhow::Result<()> {
    let picture = options.picture.as_deref();
    let picture = picture.map(|path| OutFile::create("--picture", path));
    let picture = picture.transpose()?;
    let chromium = picture.as_ref().map(|_| toolchain::set_up_chromium());
    let chromium = chromium.transpose()?;

    let page = write_page()?;
    say(format_args!("wrote {}", page.display()))?;
    if let Some((chromium, picture)) = chromium.zip(picture) {
        let path = picture.path().to_owned();
        picture.write_whole(&take_picture(&chromium, &page)?)?;
        say(format_args!("wrote {}", path.display()))?;
    }
    if options.open {
        Command::new(opener()?)
            .arg(page)
            .stdin(Stdio::null())
            .spawn()?;
    }
    Ok(())
}

fn opener() -> Result<PathBuf, Refused> {
    find("xdg-open").or_else(|| find("open")).ok_or_else(|| {
        Refused::because(
            "--open: neither xdg-open nor open is installed; open the page in a browser",
        )
    })
}

pub fn write_page() -> anyhow::Result<PathBuf> {
    let module = fs::read(toolchain::set_up_web()?.build_web()?)?;
    let page = TEMPLATE
        .replace("{facts}", &facts().to_string())
        .replace("{module}", &digits(&module));
    let file = target().join(FILE);
    out_file::write("the page", &file, page)?;
    Ok(file)
}

pub fn digits(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Returns the tables of the firmware and of the terminal that the page uses.
fn facts() -> Value {
    let scenes = SceneName::ALL.iter().enumerate().map(|(index, &scene)| {
        json!({
            "id": scene,
            "name": scene.name(),
            "key": scene_key(index).to_string(),
            "shows": shows(scene),
            "first": scene.first_settings(),
            "hasAngles": scene.has_angles(),
            "isLinear": scene.is_linear(),
        })
    });
    let named = |method: &Method| json!({"id": method, "name": method.name()});

    // In a browser, Tab moves the focus, the help is one page, and the user closes the page.
    let keys = KEYS
        .iter()
        .filter(|(key, _)| !["?", "q, ctrl-C"].contains(key))
        .map(|(key, text)| [key.replace("tab, ", ""), text.replace("shift-tab, ", "")]);
    json!({
        "rate": TICK_RATE,
        "palette": palette().chunks(3).collect::<Vec<_>>(),
        "scenes": scenes.collect::<Vec<_>>(),
        "boards": OFFERED.map(|(board, text)| {
            let code = board.processor().code;
            let same = every_board().filter(|board| board.processor().code == code);
            json!({
                "name": board.name,
                "names": same.flat_map(Board::names).collect::<Vec<_>>(),
                "text": text,
                "code": code,
            })
        }),
        "panels": PANELS.map(|panel| {
            let Format { width, height, .. } = panel.format();
            json!({
                "name": panel.name(),
                "text": panel.text(),
                "code": panel as usize,
                "width": width,
                "height": height,
            })
        }),
        "methods": Method::ALL.iter().map(named).collect::<Vec<_>>(),
        "drawn": Method::DRAWN.iter().map(named).collect::<Vec<_>>(),
        "massRatios": MASS_RATIOS.to_vec(),
        "speeds": SPEEDS,
        "leastEnergyError": LEAST_ENERGY_ERROR,
        "keys": keys.collect::<Vec<_>>(),
    })
}

fn take_picture(chromium: &Path, page: &Path) -> anyhow::Result<Vec<u8>> {
    let folder = tempfile::tempdir()?;
    let timed = folder.path().join(FILE);
    let taken = folder.path().join("picture.png");
    fs::write(&timed, format!("{CLOCK}{}", fs::read_to_string(page)?))?;
    let mut chromium = Command::new(chromium);
    chromium
        .args(HEADLESS.split(' ').chain(PICTURE.split(' ')))
        .arg(format!("--user-data-dir={}", folder.path().display()))
        .arg(format!("--screenshot={}", taken.display()))
        .arg(timed);
    let output = process::run(&mut chromium, PICTURE_LIMIT)?;
    ensure!(output.status.success(), "Chromium: {}", output.stderr);

    // Chromium can also end with success without a picture.
    fs::read(&taken).or_else(|_| bail!("Chromium wrote no picture: {}", output.stderr))
}

#[cfg(test)]
mod tests {
    use std::fs::Permissions;
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    const WRITES: &str = "#!/bin/sh
for option; do
    case $option in --screenshot=*) printf new > \"${option#*=}\" ;; esac
done
";

    #[test]
    fn a_picture_that_was_not_written_is_an_error() -> anyhow::Result<()> {
        let folder = tempfile::tempdir()?;
        let page = folder.path().join("page.html");
        fs::write(&page, "")?;
        let taken = take_picture(Path::new("true"), &page);
        let error = taken.expect_err("no picture").to_string();
        assert!(error.contains("wrote no picture"), "{error}");

        let chromium = folder.path().join("chromium");
        fs::write(&chromium, WRITES)?;
        fs::set_permissions(&chromium, Permissions::from_mode(0o755))?;
        assert_eq!(take_picture(&chromium, &page)?, b"new");
        Ok(())
    }
}
