//! What comes over the serial link: raw bytes, intact messages of any content, and requests computed.

use double_pendulum::Parameters;
use firmware::app::App;
use firmware::app::controls::NoButtons;
use firmware::display::NoDisplay;
use firmware::graphics::frame_buffers::FrameBuffers;
use firmware::job::{Arithmetic, Formulation, Job, ON_BOARDS, Request, Row};
use firmware::motion::settings::Settings;
use firmware::protocol::Field;
use firmware::protocol::{
    Ask, AskPlan, Choose, Decoder, Frame, Identify, LinkError, MAX_FIELDS, MAX_WIRE, Measure, Message, Pause, Press,
    Restart, Set, Simulate, Step, frame,
};
use firmware::scenes::SceneName;

use super::Outcome;
use crate::link::Received;

/// Steps of a request that are computed, so that an execution stays short.
const MOST_STEPS: u32 = 24;

/// The messages in a stream, or why they are none.
fn received(decoder: &mut Decoder, bytes: &[u8]) -> Vec<Result<Received, LinkError>> {
    let mut all = Vec::new();
    for &byte in bytes {
        if let Some(message) = decoder.push(byte) {
            all.push(message.map(|(kind, fields)| Received { kind, fields: fields.to_vec() }));
        }
    }
    all
}

/// Any bytes, and then an intact message, which must be recovered.
pub fn decoder(input: &[u8]) -> Outcome {
    let mut decoder = Decoder::default();
    let messages = received(&mut decoder, input);
    for Received { kind, fields } in messages.iter().flatten() {
        assert!(fields.len() <= MAX_FIELDS, "kind {kind}");
        let again = received(&mut Decoder::default(), frame(*kind, fields, &mut [0; MAX_WIRE]));
        assert_eq!(again, [Ok(Received { kind: *kind, fields: fields.clone() })]);
    }
    let good = frame(Ask::KIND, &[1, 2], &mut [0; MAX_WIRE]).to_vec();
    let after = received(&mut decoder, &good);
    assert_eq!(after.last(), Some(&Ok(Received { kind: Ask::KIND, fields: vec![1, 2] })), "after {input:02x?}");
    messages.iter().take(3).fold(0, |outcome, message| {
        outcome << 4
            | match message {
                Ok(_) => 1,
                Err(LinkError::TooLong) => 2,
                Err(LinkError::Malformed) => 3,
                Err(LinkError::Checksum) => 4,
                Err(LinkError::Version(_)) => 5,
            }
    })
}

/// Intact messages of any content to the application, which plays on: each is answered, a refused one changes nothing.
/// The input is a kind, the length of the fields, the fields, and the next.
pub fn commands(input: &[u8]) -> Outcome {
    let mut sheets = FrameBuffers::default();
    let app = App::new(Settings::default(), &mut sheets, NoDisplay, Vec::new(), NoButtons);
    let mut app = app.unwrap_or_else(|error| panic!("{error}"));
    let (mut rest, mut tick, mut outcome) = (input, 0, 0);
    for _ in 0..2 {
        let [kind, length, fields @ ..] = rest else { break };
        let (fields, next) = fields.split_at(usize::from(*length).min(fields.len()).min(MAX_FIELDS));
        rest = next;
        let (status, sent) = (app.player().status(0), app.link().len());
        app.receive(frame(*kind, fields, &mut [0; MAX_WIRE]).iter().copied(), |_| ());
        let answers = received(&mut Decoder::default(), &app.link()[sent..]);
        let is_request = *kind == Simulate::KIND && fields.len() == Simulate::SIZE;
        let answer = match &*answers {
            [Ok(answer)] => answer.kind,
            [] if is_request => 0,
            others => panic!("{others:?} to kind {kind} {fields:02x?}"),
        };
        const REFUSED: u8 = firmware::protocol::Refused::KIND;
        if answer == REFUSED {
            assert_eq!(app.player().status(0), status, "kind {kind} {fields:02x?}");
        }
        let field = if answer == REFUSED { answers[0].as_ref().map_or(0, |answer| answer.fields[2]) } else { 0 };
        outcome = (u32::from(*kind) & 7) << 9 | u32::from(answer) << 5 | u32::from(field);
        for _ in 0..2 {
            tick += 1;
            app.run_to(tick, |_| ());
            app.work(|_| ());
        }
        assert_eq!(app.player().report().state.check(), Ok(()));
    }
    outcome
}

/// A request as it comes, and some of its steps: every reading is finite.
pub fn requests(input: &[u8]) -> Outcome {
    let mut fields = [0; Simulate::SIZE];
    fields.iter_mut().zip(input).for_each(|(place, byte)| *place = *byte);
    let Some(message) = Simulate::read(&fields) else { panic!("of the right length") };
    let request = match Request::from_message(&message) {
        Ok(request) => request,
        Err(field) => return u32::from(field.code()),
    };
    let row = ON_BOARDS.iter().zip(1..).find(|(row, _)| **row == request.row).map_or(0, |(_, number)| number << 8);
    let mut job: Job = match Job::new(&request) {
        Ok(job) => job,
        Err(error) => return row + 0x20 + u32::from(Field::from(error).code()),
    };
    for _ in 0..MOST_STEPS {
        match job.advance() {
            Ok(reading) => {
                let finite = |reading: &firmware::job::Reading| {
                    reading.energy.is_finite() && reading.state.iter().chain(&reading.velocities).all(|x| x.is_finite())
                };
                assert!(reading.iter().all(finite), "{reading:?}");
            }
            Err(error) => {
                assert!(job.is_finished());
                return row + 0x40 + error.parameter() as u32;
            }
        }
    }
    row
}

/// A message's fields.
fn fields<M: Message>(message: &M) -> Vec<u8> {
    let mut bytes = [0; MAX_FIELDS];
    assert!(message.write(&mut &mut bytes[..]).is_some());
    bytes[..M::SIZE].to_vec()
}

fn request() -> Request {
    Request {
        row: Row::rk4(Arithmetic::F64, Formulation::Canonical),
        parameters: Parameters { m1: 1.0, m2: 2.0, l1: 1.0, l2: 1.0, g: 9.8 },
        angles: [2.0, -1.0],
        velocities: [0.5, 0.25],
        dt: 1.0 / 256.0,
        stride: 4,
        samples: 5,
    }
}

/// Streams: each message as it goes over the wire, and two of them.
pub fn wires() -> Vec<Vec<u8>> {
    let wire = |kind, fields: &[u8]| frame(kind, fields, &mut [0; MAX_WIRE]).to_vec();
    let messages =
        [wire(Frame::KIND, &fields(&Frame::default())), wire(Simulate::KIND, &fields(&request().message(1)))];
    let both = messages.concat();
    messages.into_iter().chain([both, vec![0; 3], vec![1; 200]]).collect()
}

/// Every request that can be computed.
pub fn request_seeds() -> Vec<Vec<u8>> {
    ON_BOARDS.iter().map(|&row| fields(&Request { row, ..request() }.message(1))).collect()
}

/// Every command.
pub fn commands_seeds() -> Vec<Vec<u8>> {
    let one = |kind: u8, fields: Vec<u8>| [vec![kind, fields.len() as u8], fields].concat();
    let set = |field, unit, value| one(Set::KIND, fields(&Set { request: 1, field, unit, value }));
    let sets = (0..20).flat_map(|field| (0..8).map(move |unit| set(field, unit, 0.5)));
    let scenes = SceneName::ALL.iter().map(|name| fields(&Choose { request: 2, scene: name.code() }));
    let scenes = scenes.map(|fields| one(Choose::KIND, fields));
    let others = [
        one(Press::KIND, fields(&Press { request: 9, key: 3 })),
        one(Identify::KIND, fields(&Identify { request: 10 })),
        one(Measure::KIND, fields(&Measure { request: 11, steps: 2, in_ram: 1 })),
        one(Restart::KIND, fields(&Restart { request: 3 })),
        one(Pause::KIND, fields(&Pause { request: 4, paused: 1 })),
        one(Step::KIND, fields(&Step { request: 5, ticks: 3 })),
        one(Ask::KIND, fields(&Ask { request: 6 })),
        one(AskPlan::KIND, fields(&AskPlan { request: 8 })),
        one(Simulate::KIND, fields(&request().message(7))),
    ];
    sets.chain(scenes).chain(others).collect()
}
