//! Reads [requests](firmware::job::Request), one a line, and prints the CRC of each as this machine
//! computes it: for builds with other settings. Ends with an error at a line that is no request, or
//! at a request that cannot be computed.

use std::error::Error;
use std::io::{self, BufRead};

use firmware::job::Request;

fn main() -> Result<(), Box<dyn Error>> {
    for line in io::stdin().lock().lines() {
        println!("{:08x}", Request::parse(&line?).ok_or("no request")?.crc()?);
    }
    Ok(())
}
