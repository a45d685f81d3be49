//! Every method computes the bits in `golden/bits.csv`, and the change log names that file.

use std::format;
use std::fs;
use std::string::{String, ToString};
use std::vec::Vec;

use double_pendulum::golden::{FNV_OFFSET, Golden, HEADER, Line, MOTIONS, fnv_1a};
use double_pendulum::{
    ClosedFormF32, ClosedFormF64, DirectionF32, DirectionF32Plain, ExtrapolationF64, Fixed32,
    Fixed64, Form, HamiltonF32, HamiltonF64, Method,
};

/// Computes a line of the file.
type ComputeLine = fn(Method, &Golden) -> String;

/// The methods of this crate, with their types.
const METHODS: [(Method, ComputeLine); 13] = [
    (Method::Rk4F64, line::<HamiltonF64>),
    (Method::Rk4F32, line::<HamiltonF32>),
    (Method::Rk4F32Direction, line::<DirectionF32>),
    (Method::Rk4F32DirectionPlain, line::<DirectionF32Plain>),
    (Method::Rk4Fixed32, line::<Fixed32>),
    (Method::Extrapolation8Fixed64, line::<Fixed64<8>>),
    (Method::Extrapolation10Fixed64, line::<Fixed64<10>>),
    (Method::Extrapolation12Fixed64, line::<Fixed64<12>>),
    (Method::Extrapolation16Fixed64, line::<Fixed64<16>>),
    (Method::Extrapolation12F64, line::<ExtrapolationF64<12>>),
    (Method::Extrapolation16F64, line::<ExtrapolationF64<16>>),
    (Method::ClosedFormF64, line::<ClosedFormF64>),
    (Method::ClosedFormF32, line::<ClosedFormF32>),
];
/// The methods of the table whose types are in the firmware. The firmware's tests compare them with
/// the same file.
const ELSEWHERE: [Method; 2] = [Method::Rk4F32Micromath, Method::TextbookF32];
/// The method that exists in these tests only.
const OF_TESTS: Method = Method::Rk4F64Lagrange;

fn line<F: Form>(method: Method, motion: &Golden) -> String {
    match motion.bits::<F>() {
        Ok(bits) => Line(method, motion, bits).to_string(),
        Err(error) => panic!("{method}, {}: {error}", motion.name),
    }
}

/// Returns the text of a file of this package.
fn read(file: &str) -> String {
    let path = format!("{}/{file}", env!("CARGO_MANIFEST_DIR"));
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

#[test]
fn every_method_computes_the_golden_bits() {
    let file = read("golden/bits.csv");
    let golden: Vec<&str> = file.lines().skip(1).collect();
    let of = |method: Method| {
        let start = format!("{method},");
        let lines = golden.iter().filter(move |line| line.starts_with(&*start));
        lines.copied().collect::<Vec<_>>()
    };

    for (method, line) in METHODS {
        let here = MOTIONS.map(|motion| line(method, &motion));
        assert_eq!(
            of(method),
            here,
            "{method} computes other bits. If they are meant to change: `BLESS=1 cargo test -p host-tests --test kernel golden::`"
        );
    }

    assert_eq!(file.lines().next(), Some(HEADER));
    let listed = METHODS.iter().map(|(method, _)| *method).chain(ELSEWHERE);
    assert!(
        Method::ALL
            .iter()
            .filter(|method| **method != OF_TESTS)
            .copied()
            .eq(listed),
        "these tests miss a method of the table"
    );
    assert_eq!(
        golden.len(),
        (METHODS.len() + ELSEWHERE.len()) * MOTIONS.len()
    );
}

/// The change log has an entry that contains the checksum of the file.
#[test]
fn golden_bits_have_an_entry_in_the_change_log() {
    let checksum = fnv_1a(FNV_OFFSET, read("golden/bits.csv").as_bytes());
    let name = format!("`golden/bits.csv` {checksum:016x}");
    assert!(
        read("CHANGELOG.md").contains(&name),
        "the golden bits have changed: say in kernel/CHANGELOG.md which and why, in an entry that contains {name}"
    );
}
