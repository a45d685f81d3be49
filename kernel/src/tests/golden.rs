//! Every method computes the bits in `golden/bits.csv`.

use std::format;
use std::fs;
use std::string::{String, ToString};
use std::vec::Vec;

use double_pendulum::golden::{Golden, HEADER, Line, MOTIONS};
use double_pendulum::{Form, FormVisitor, Method};

/// Their types are in the firmware, whose tests compare them with the same file.
const ELSEWHERE: [Method; 2] = [Method::Rk4F32Micromath, Method::TextbookF32];

struct ComputedLine<'a>(Method, &'a Golden);

impl FormVisitor for ComputedLine<'_> {
    type Output = String;

    fn visit<F: Form>(self) -> String {
        let Self(method, motion) = self;
        match motion.bits::<F>() {
            Ok(bits) => Line(method, motion, bits).to_string(),
            Err(error) => panic!("{method}, {}: {error}", motion.name),
        }
    }
}

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

    for &method in Method::ALL {
        let here: Vec<String> = MOTIONS
            .iter()
            .filter_map(|motion| method.visit(ComputedLine(method, motion)))
            .collect();
        if ELSEWHERE.contains(&method) {
            assert!(here.is_empty() && of(method).len() == MOTIONS.len());
        } else {
            assert_eq!(
                of(method),
                here,
                "{method} computes other bits. If they are meant to change: \
                `BLESS=1 cargo test -p host-tests --test kernel golden::`"
            );
        }
    }

    assert_eq!(file.lines().next(), Some(HEADER));
    assert_eq!(golden.len(), Method::ALL.len() * MOTIONS.len());
}
