//! What the check of a message detects.

use std::collections::HashSet;

use firmware::protocol::{
    Decoder, Frame, Identity, LinkError, MAX_FIELDS, MAX_WIRE, Message, Planned, Request, Sample, Simulate, Status,
    frame,
};

/// What the decoder says of a wire.
fn decoded(wire: &[u8]) -> Option<Result<(u8, Vec<u8>), LinkError>> {
    let mut decoder = Decoder::default();
    let own = |message: Result<(u8, &[u8]), LinkError>| message.map(|(kind, fields)| (kind, fields.to_vec()));
    wire.iter().fold(None, |last, &byte| decoder.push(byte).map(own).or(last))
}

fn wire(kind: u8, fields: &[u8]) -> Vec<u8> {
    frame(kind, fields, &mut [0; MAX_WIRE]).to_vec()
}

/// The four bytes of the check, found by what the decoder takes: the body is version, kind, fields, CRC.
fn crc(kind: u8, fields: &[u8]) -> u32 {
    let mut body = wire(kind, fields).split_off(1);
    let length = cobs::decode_in_place(&mut body).expect("a COBS encoding");
    let (_, crc) = body[..length].split_last_chunk().expect("a body");
    u32::from_le_bytes(*crc)
}

/// Every change of up to four bits of a body is detected, in the longest message and so in every shorter one.
///
/// A CRC is linear: the change that a flipped bit makes in it does not depend on the message. Four flips go unseen if their
/// changes cancel, that is if two pairs of flips make the same change, or a single one that of three.
#[test]
fn every_change_of_four_bits_is_detected() {
    let bits = 8 * (MAX_FIELDS + 2);
    let clean = crc(0, &[0; MAX_FIELDS]);
    // The longest message there is has 94 bytes of fields, so that its version lies where a flip here still reaches. A flip
    // in the CRC changes one bit of it.
    let mut changes: Vec<u32> = (8..bits)
        .map(|bit| {
            let mut message = [0; MAX_FIELDS + 1];
            message[(bit - 8) / 8] ^= 1 << (bit % 8);
            crc(message[0], &message[1..]) ^ clean
        })
        .collect();
    changes.extend((0..32).map(|bit| 1_u32 << bit));
    let mut pairs = HashSet::new();
    for (index, one) in changes.iter().enumerate() {
        assert_ne!(*one, 0);
        assert!(changes[..index].iter().all(|other| pairs.insert(one ^ other)), "two pairs of flips cancel");
    }
    assert!(changes.iter().all(|one| !pairs.contains(one)), "three flips cancel");
    assert!(!pairs.contains(&0), "two flips cancel");
}

/// Each single flipped bit on the wire, delimiters included, costs the message and nothing else: most leave the framing right, and
/// it is the check that finds them.
#[test]
fn every_flipped_bit_on_the_wire_is_detected() {
    let (kind, fields) = (0x82, [7, 0, 0, 255, 0, 1, 2, 0, 0, 3]);
    let (good, next) = (wire(kind, &fields), wire(3, &[9; 96]));
    assert_eq!(decoded(&good), Some(Ok((kind, fields.to_vec()))));
    let mut by_check = 0;
    for bit in 0..8 * good.len() {
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        let found = decoded(&bad);
        assert!(!matches!(found, Some(Ok(_))), "bit {bit}");
        by_check += usize::from(found == Some(Err(LinkError::Checksum)));
        assert_eq!(decoded(&[bad, next.clone()].concat()), Some(Ok((3, vec![9; 96]))), "after bit {bit}");
    }
    assert!(by_check > 4 * good.len(), "{by_check} by the check");
}

/// The longest messages, their whole numbers as large as they can be.
#[test]
fn every_message_fits() {
    let (request, u16, u32) = (u16::MAX, u16::MAX, u32::MAX);
    let frame = Frame { sequence: u32, dropped: u32, lost: u32, step: u32, way_steps: u16, ..Frame::default() };
    let identity = Identity { request, hertz: u32, processor: u32, chip: [u32; 4], ..Identity::default() };
    let motion = Request { stride: u32, samples: u32, ..Request::default() };
    let lengths = [
        length(Frame { scene_cycles: u32, busy_cycles: u32, ..frame }),
        length(Identity { image: u32, image_bytes: u32, ..identity }),
        length(Simulate { request, motion }),
        length(Planned { request, steps: u32, ..Planned::default() }),
        length(Sample { request, index: u32, ..Sample::default() }),
        length(Status { request, steps: u32, way_steps: u32, ..Status::default() }),
    ];
    assert_eq!(lengths, [77, 44, 94, 63, 64, 67]);
}

fn length<M: Message + PartialEq + std::fmt::Debug>(message: M) -> usize {
    let mut fields = [0; MAX_FIELDS];
    let fields = message.write(&mut fields);
    assert_eq!(M::read(fields), Some(message));
    fields.len()
}
