//! The application that runs on the boards, without panel and buttons, its messages, and the places
//! of a frame.

use boards::host::canvas;
use boards::link::Inbox;
use embedded_io::Write;
use firmware::app::{App, Buttons, NoButtons};
use firmware::config::PROCESSOR;
use firmware::display::{Display, NoDisplay};
use firmware::graphics::{Canvas, Format};
use firmware::motion::Settings;
use firmware::protocol::{Answer, Command, Frame, MAX_WIRE, ToHost, encode_command};
use firmware::scenes::SceneName;

pub type Plain = App<'static, NoDisplay, Vec<u8>, NoButtons>;

pub fn of<P: Display + 'static, L: Write, K: Buttons>(
    panel: P,
    link: L,
    keys: K,
) -> App<'static, P, L, K> {
    let panel = Box::leak(Box::new(panel));
    let mut app = App::new(PROCESSOR, blank(), panel, link, keys);
    app.player
        .play(SceneName::Page, Settings::default())
        .expect("good settings");
    app
}

pub fn app() -> Plain {
    of(NoDisplay, Vec::new(), NoButtons)
}

pub fn starting_with(settings: Settings) -> Plain {
    let mut app = app();
    app.player
        .play(SceneName::Page, settings)
        .expect("good settings");
    app
}

pub fn wire(request: u16, command: Command) -> Vec<u8> {
    encode_command(request, command, &mut [0; MAX_WIRE]).to_vec()
}

pub fn messages(bytes: &[u8]) -> Vec<ToHost> {
    let mut inbox = Inbox::default();
    let messages = bytes.iter().filter_map(|&byte| inbox.take(byte)).collect();
    assert_eq!(inbox.damage, None);
    messages
}

pub fn frames(bytes: &[u8]) -> Vec<Frame> {
    messages(bytes)
        .into_iter()
        .filter_map(ToHost::frame)
        .collect()
}

pub fn answers(bytes: &[u8]) -> Vec<(u16, Answer)> {
    messages(bytes)
        .into_iter()
        .filter_map(ToHost::answer)
        .collect()
}

pub fn blank() -> Canvas<'static> {
    canvas(Format::OLED)
}

pub fn places() -> impl Iterator<Item = (i32, i32)> {
    let Format { width, height, .. } = Format::OLED;
    (0..height.into()).flat_map(move |y| (0..width.into()).map(move |x| (x, y)))
}
