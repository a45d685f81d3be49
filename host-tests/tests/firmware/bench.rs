//! The application as it runs on the boards, without panel and buttons, what it sends, and the places of a frame.

use std::fmt::Debug;

use embedded_io::Write;
use firmware::app::{App, Buttons, NoButtons};
use firmware::display::{Display, NoDisplay};
use firmware::graphics::{HEIGHT, WIDTH};
use firmware::motion::Settings;
use firmware::protocol::{Decoder, LinkError, MAX_WIRE, Message, encode};
use host_tests::emulator::host::sheets;

pub type Plain = App<'static, NoDisplay, Vec<u8>, NoButtons>;

pub fn app() -> Plain {
    starting_with(Settings::default())
}

pub fn starting_with(settings: Settings) -> Plain {
    App::new(settings, sheets(), NoDisplay, Vec::new(), NoButtons).expect("good settings")
}

/// The application with such devices.
pub fn of<P: Display, L: Write, K: Buttons>(panel: P, link: L, keys: K) -> App<'static, P, L, K> {
    App::new(Settings::default(), sheets(), panel, link, keys).expect("good settings")
}

pub fn wire<M: Message>(message: &M) -> Vec<u8> {
    encode(message, &mut [0; MAX_WIRE]).to_vec()
}

/// The messages in a stream, kind and fields, or what is wrong with them.
pub fn messages(bytes: &[u8]) -> Vec<Result<(u8, Vec<u8>), LinkError>> {
    let mut decoder = Decoder::default();
    let mut messages = Vec::new();
    for &byte in bytes {
        messages.extend(decoder.push(byte).map(|message| message.map(|(kind, fields)| (kind, fields.to_vec()))));
    }
    messages
}

/// Those of one kind in a stream of undamaged ones.
pub fn all<M: Message + Debug>(bytes: &[u8]) -> Vec<M> {
    let undamaged = messages(bytes).into_iter().map(|message| message.expect("undamaged"));
    let own = undamaged.filter(|(kind, _)| *kind == M::KIND);
    own.map(|(_, fields)| M::read(&fields).expect("all fields")).collect()
}

/// All pixels of the frame, row by row.
pub fn places() -> impl Iterator<Item = (i32, i32)> {
    (0..HEIGHT as i32).flat_map(|y| (0..WIDTH as i32).map(move |x| (x, y)))
}
