//! What a user types for `cargo simulate`: numbers, and whole command lines.

use clap::Parser;
use firmware::job::Row;

use super::Outcome;
use crate::commands::simulate::{Number, NumberError, Options, plan};

/// A number, with or without a fraction.
pub fn numbers(input: &[u8]) -> Outcome {
    match String::from_utf8_lossy(input).parse::<Number>() {
        Ok(number) => {
            assert!(number.value().is_finite(), "{number}");
            let again = number.to_string().parse::<Number>();
            assert_eq!(again.as_ref(), Ok(&number), "what is shown can be typed");
            0x10 + u32::from(number.is_negative()) + 2 * u32::from(number.whole_multiple_of(&number) == Some(1))
        }
        Err(NumberError::NotANumber) => 1,
        Err(NumberError::NotFinite) => 2,
        Err(NumberError::ZeroDenominator) => 3,
    }
}

/// A command line, one word a line.
pub fn options(input: &[u8]) -> Outcome {
    let text = String::from_utf8_lossy(input);
    let words = std::iter::once("simulate").chain(text.lines());
    match Options::try_parse_from(words) {
        Ok(options) => match plan(&options) {
            Ok(plan) => {
                assert!(plan.every.is_positive() && plan.request.dt > 0.0, "{text}");
                let Row { arithmetic, model, .. } = plan.request.row;
                0x200 + u32::from(arithmetic.code()) * 4 + u32::from(model.code())
            }
            // The option it names: the first word of the refusal.
            Err(refusal) => 0x100 + refusal.to_string().bytes().take(5).map(u32::from).sum::<u32>(),
        },
        Err(error) => error.kind() as u32,
    }
}

pub fn number_seeds() -> Vec<Vec<u8>> {
    ["0.25", "1e-3", "-1/256", "+.5", "5.", "1e308", "1/0", "nan", "1e999", "0e-99999"].map(Vec::from).to_vec()
}

pub fn option_seeds() -> Vec<Vec<u8>> {
    [
        "",
        "--angles\n171,171\n--degrees\n--masses\n1,2.75\n--step\n1/4096\n--until\n5\n--every\n1",
        "--arithmetic\nf32\n--model\nequal-rods\n--lengths\n2,2\n--gravity\n9.81",
        "--model\nlinear\n--velocities\n-1,1/3\n--bits",
        "--on\nlm3s6965evb\n--step\n1",
        "--until\n-1",
        "--help",
    ]
    .map(Vec::from)
    .to_vec()
}
