//! The errors that the check of a message detects.

use std::collections::HashSet;
use std::fmt::Debug;

use crate::snapshot;
use double_pendulum::plan::{Limit, Plan, PlanError, Stepping};
use double_pendulum::{Error, Method};
use firmware::app::Record;
use firmware::display::{BusFault, By, Controller, Found, PanelOptions, PanelReport, PanelState};
use firmware::graphics::PanelName;
use firmware::job::{CRC, Reading, Request};
use firmware::motion::{Horizon, PlanResult, Planned, Settings};
use firmware::protocol::{
    Answer, BoardName, Cause, Command, Decoder, Field, Frame, LinkError, MAX_MESSAGE, MAX_WIRE,
    PlayState, Restarted, Status, ToHost, VERSION, decode_command, encode, encode_command, frame,
    read,
};
use firmware::scenes::{Report, SceneName};

use crate::bench::messages;

fn decoded(wire: &[u8]) -> Option<Result<Vec<u8>, LinkError>> {
    let mut decoder = Decoder::default();
    wire.iter().fold(None, |last, &byte| {
        decoder
            .push(byte)
            .map(|message| message.map(<[u8]>::to_vec))
            .or(last)
    })
}

fn wire(message: &[u8]) -> Vec<u8> {
    frame(message, &mut [0; MAX_WIRE]).to_vec()
}

/// The body is version, message, CRC.
fn crc(message: &[u8]) -> u32 {
    let mut body = wire(message).split_off(1);
    let length = cobs::decode_in_place(&mut body).expect("a COBS encoding");
    let (_, crc) = body[..length].split_last_chunk().expect("a body");
    u32::from_le_bytes(*crc)
}

#[test]
fn a_message_longer_than_the_longest_is_malformed() {
    let longest = wire(&[9; MAX_MESSAGE]);
    assert_eq!(longest.len(), MAX_WIRE);
    assert_eq!(decoded(&longest), Some(Ok(vec![9; MAX_MESSAGE])));

    // No encoder makes this message, so its bytes are written here.
    let mut body = vec![VERSION];
    body.extend([9; MAX_MESSAGE + 1]);
    body.extend(CRC.checksum(&body).to_le_bytes());
    let mut longer = [0; MAX_WIRE];
    let encoded = cobs::encode(&body, &mut longer);
    assert_eq!(
        decoded(&longer[..=encoded]),
        Some(Err(LinkError::Malformed))
    );
}

#[test]
fn every_error_of_a_message_has_its_words() {
    let errors = [
        LinkError::Malformed,
        LinkError::Checksum,
        LinkError::Version(VERSION - 1),
    ];
    assert_eq!(
        errors.map(LinkError::name),
        [
            "malformed",
            "wrong checksum",
            "another version of the protocol"
        ]
    );
}

/// A CRC is linear: the change that a flipped bit makes in it does not depend on the message. Four
/// flips are not detected if their changes cancel, that is if two pairs of flips make the same
/// change, or a single flip makes the change of three.
#[test]
fn every_change_of_four_bits_is_detected() {
    let clean = crc(&[0; MAX_MESSAGE]);

    // The version cannot be changed here, but a flip here reaches the version of a shorter message.
    // A flip in the CRC changes one bit of it.
    let mut changes: Vec<u32> = (0..8 * MAX_MESSAGE)
        .map(|bit| {
            let mut message = [0; MAX_MESSAGE];
            message[bit / 8] ^= 1 << (bit % 8);
            crc(&message) ^ clean
        })
        .collect();
    changes.extend((0..32).map(|bit| 1_u32 << bit));

    let mut pairs = HashSet::new();

    for (index, one) in changes.iter().enumerate() {
        assert_ne!(*one, 0);
        assert!(
            changes[..index]
                .iter()
                .all(|other| pairs.insert(one ^ other)),
            "two pairs of flips cancel"
        );
    }

    assert!(
        changes.iter().all(|one| !pairs.contains(one)),
        "three flips cancel"
    );
    assert!(!pairs.contains(&0), "two flips cancel");
}

#[test]
fn every_flipped_bit_on_the_wire_is_detected() {
    let message = [0x82, 7, 0, 0, 255, 0, 1, 2, 0, 0, 3];

    let good = wire(&message);
    let next = wire(&[9; MAX_MESSAGE]);
    assert_eq!(decoded(&good), Some(Ok(message.to_vec())));
    let mut by_check = 0;
    for bit in 0..8 * good.len() {
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        let found = decoded(&bad);
        assert!(!matches!(found, Some(Ok(_))), "bit {bit}");
        by_check += usize::from(found == Some(Err(LinkError::Checksum)));
        assert_eq!(
            decoded(&[bad, next.clone()].concat()),
            Some(Ok(vec![9; MAX_MESSAGE])),
            "after bit {bit}"
        );
    }
    assert!(by_check > 4 * good.len(), "{by_check} by the check");
}

#[test]
fn every_message_fits() {
    let method = Method::TextbookF32;
    let steps = u32::MAX;
    let number = u32::MAX;
    let step = u64::MAX;
    let report = Report {
        step,
        stepping: Some(Stepping { method, steps }),
        horizon: Horizon::Until(1.0),
        ..Report::default()
    };
    let counts = Frame {
        sequence: number,
        dropped: number,
        lost: number,
        report,
        ..Frame::default()
    };
    let frame = Frame {
        scene_cycles: number,
        busy_cycles: number,
        ..counts
    };

    let dt = 1.0;
    let horizon = 1.0;
    let error = 1.0;
    let cost = 1.0;
    let spent = 1.0;
    let limit = Limit::End;
    let found = Some(Ok(Plan {
        method,
        steps,
        dt,
        error,
        cost,
        horizon,
        limit,
        spent,
    }));
    let planned = Planned {
        found,
        height: 1.0,
        duration: 1.0,
        frame: 1.0,
        planning: 1.0,
    };

    let sample = Answer::Sample {
        index: number,
        reading: Reading::default(),
    };
    let answers =
        [Answer::Planned(Some(planned)), sample].map(|answer| ToHost::Answer(u16::MAX, answer));
    assert_eq!(
        [ToHost::Frame(frame), answers[0], answers[1]].map(length),
        [94, 71, 74]
    );

    let cause = Some(Cause::Fault);
    let scene = SceneName::Flips;
    let end = Restarted {
        cause,
        restarts: u8::MAX,
        pc: number,
        lr: number,
        cfsr: number,
        scene,
        step,
    };
    assert_eq!(
        (
            ToHost::Restarted(end).restarted(),
            ToHost::Frame(frame).restarted()
        ),
        (Some(end), None)
    );
    let settings = Settings::default();
    let method = Some(method);
    let panel = PanelReport {
        name: PanelName::Lcd13,
        state: PanelState::Shown(Found {
            controller: Controller::Sh1107,
            by: By::Choice,
            status: Some(u8::MAX),
        }),
        chosen: PanelOptions {
            controller: Some(Controller::Sh1107),
            is_turned: true,
            stays_bright: true,
        },
        shown: u8::MAX,
    };
    let played = Status {
        scene,
        settings,
        method,
        processor: 0,
        state: PlayState::Paused,
        steps,
        speed: 1.0,
        panel,
    };
    assert_eq!(
        Record::read(&Record { played, end }.write()),
        Some(Record { played, end })
    );

    let command = Command::Simulate(Request {
        stride: number,
        samples: number,
        ..Request::on_any_core(Method::Rk4F64)
    });
    let message = decoded(encode_command(u16::MAX, command, &mut [0; MAX_WIRE]))
        .expect("a message")
        .expect("intact");
    assert_eq!(
        (message.len(), decode_command(&message)),
        (96, Some((u16::MAX, Some(command))))
    );
}

fn variants<T: Debug>(read: fn(&[u8]) -> Option<T>) -> String {
    let zeros =
        |number: u8| (0..MAX_MESSAGE).map(move |count| [vec![number], vec![0; count]].concat());
    let values = (0..=u8::MAX).map_while(|number| zeros(number).find_map(|bytes| read(&bytes)));
    let line = |(number, value)| format!("{number:>2} {value:?}\n");
    (0..)
        .zip(values)
        .map(line)
        .chain(["\n".to_owned()])
        .collect()
}

/// A change of a number's meaning requires a new version, by which the two sides recognise each
/// other.
#[test]
fn numbers_keep_their_meaning_within_a_version() -> Result<(), String> {
    let messages = variants(read::<ToHost>)
        + &variants(read::<Answer>)
        + &variants(read::<Command>)
        + &variants(read::<Field>);
    let plans =
        variants(read::<PlanResult>) + &variants(read::<PlanError>) + &variants(read::<Error>);
    assert_eq!(
        variants(read::<Method>)
            .lines()
            .filter(|line| !line.is_empty())
            .count(),
        Method::ALL.len(),
        "a method is missing in Method::ALL"
    );

    let values = variants(read::<Method>)
        + &variants(read::<SceneName>)
        + &variants(read::<BoardName>)
        + &variants(read::<PlayState>)
        + &variants(read::<Horizon>)
        + &variants(read::<Cause>);

    let panels = variants(read::<PanelState>)
        + &variants(read::<Controller>)
        + &variants(read::<By>)
        + &variants(read::<BusFault>);
    snapshot::check_lines(
        &format!("firmware/src/protocol/wire-{VERSION}.txt"),
        &(messages + &plans + &values + &variants(read::<Limit>) + &panels),
    )
}

fn length(message: ToHost) -> usize {
    let mut wire = [0; MAX_WIRE];
    let wire = encode(&message, &mut wire);
    assert_eq!(messages(wire), [message]);
    wire.len()
}

#[test]
fn a_frame_has_the_documented_bytes() {
    let frame = Frame {
        sequence: 300,
        scene: SceneName::Flips,
        mass_ratio: 2.5,
        report: Report {
            step: 1,
            time: 1.0 / 60.0,
            horizon: Horizon::Until(7.0),
            stepping: Some(Stepping {
                method: Method::Rk4Fixed32,
                steps: 128,
            }),
            ..Report::default()
        },
        busy_cycles: 5,
        ..Frame::default()
    };
    let mut wire = [0; MAX_WIRE];
    let bytes = decoded(encode(&ToHost::Frame(frame), &mut wire));

    // The expected bytes are written field by field, independently of the encoder.
    let mut expected = vec![0, 0xAC, 0x02, 0, 0, 12, 0];
    expected.extend(2.5_f32.to_le_bytes());
    expected.extend(0.0_f32.to_le_bytes());
    expected.push(1);
    expected.extend((1.0_f64 / 60.0).to_le_bytes());
    expected.extend([0; 20]);
    expected.push(3);
    expected.extend(7.0_f32.to_le_bytes());
    expected.extend([1, 4, 0x80, 0x01]);
    expected.extend([0, 5]);
    assert_eq!(bytes, Some(Ok(expected)));
}
