//! The CRCs of [requests](firmware::job::Request) on this machine, line by line: for builds with other settings.

use std::error::Error;
use std::io::{self, BufRead};

use firmware::job::{JobError, Request};

fn main() -> Result<(), Box<dyn Error>> {
    for line in io::stdin().lock().lines() {
        let request = Request::parse(&line?).map_err(JobError::Malformed)?;
        println!("{:08x}", request.crc()?);
    }
    Ok(())
}
