//! The CRCs of [requests](firmware::job::Request) on this machine, line by line: for builds with
//! other settings.

use std::error::Error;
use std::io::{self, BufRead};

use firmware::job::Request;

fn main() -> Result<(), Box<dyn Error>> {
    for line in io::stdin().lock().lines() {
        println!("{:08x}", Request::parse(&line?).ok_or("no request")?.crc()?);
    }
    Ok(())
}
