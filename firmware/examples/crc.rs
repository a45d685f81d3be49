//! Prints [`Request::crc`] of a motion for each method, one a line, as this machine computes it. The
//! tests build this program with other compiler settings.
//!
//! The arguments are the numbers of the [`Request`] in their order, without the method: m1, m2, l1,
//! l2, g, a1, a2, w1, w2, the step size, and as integers the stride and the number of samples. Ends
//! with an error if there are more or fewer, if one is no such number, or if a method cannot compute
//! the motion.

use std::env;
use std::error::Error;

use double_pendulum::{Method, Parameters};
use firmware::job::Request;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let Some((numbers, [stride, samples])) = arguments.split_last_chunk() else {
        return Err("12 numbers are needed".into());
    };
    let numbers: Result<Vec<f64>, _> = numbers.iter().map(|number| number.parse()).collect();
    let &[m1, m2, l1, l2, g, a1, a2, w1, w2, dt] = &numbers?[..] else {
        return Err("12 numbers are needed".into());
    };
    let stride = stride.parse()?;
    let samples = samples.parse()?;

    for &method in Method::ALL {
        let request = Request {
            method,
            parameters: Parameters { m1, m2, l1, l2, g },
            angles: [a1, a2],
            velocities: [w1, w2],
            dt,
            stride,
            samples,
        };
        println!("{:08x}", request.crc()?);
    }
    Ok(())
}
