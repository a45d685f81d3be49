//! Prints the CRC of all states of a motion by each method, one a line, as this machine computes
//! it: for builds with other settings.
//!
//! The arguments are the numbers of the [`Request`] in their order, without the method: m1, m2, l1,
//! l2, g, a1, a2, w1, w2, the step size, the stride and the number of samples. Ends with an error
//! if there are more or fewer, or if the motion cannot be computed.

use std::env;
use std::error::Error;

use double_pendulum::{Method, Parameters};
use firmware::job::Request;

fn main() -> Result<(), Box<dyn Error>> {
    let numbers: Result<Vec<f64>, _> = env::args().skip(1).map(|number| number.parse()).collect();
    let &[m1, m2, l1, l2, g, a1, a2, w1, w2, dt, stride, samples] = &numbers?[..] else {
        return Err("12 numbers are needed".into());
    };
    for &method in Method::ALL {
        let request = Request {
            method,
            parameters: Parameters { m1, m2, l1, l2, g },
            angles: [a1, a2],
            velocities: [w1, w2],
            dt,
            stride: stride as u32,
            samples: samples as u32,
        };
        println!("{:08x}", request.crc()?);
    }
    Ok(())
}
