//! The outcomes of [requests](firmware::measure::Request) on this machine, line by line: for builds with other settings.

use std::error::Error;
use std::io::{self, BufRead};

use firmware::measure::Request;

fn main() -> Result<(), Box<dyn Error>> {
    for line in io::stdin().lock().lines() {
        println!("{}", Request::parse(&line?)?.outcome()?);
    }
    Ok(())
}
