//! Requests over the serial link, answered by the very application that runs on the boards.

use std::f64::consts::PI;

use double_pendulum::{Equations, Integrator, Method, Parameters};
use firmware::app::{Received, Service};
use firmware::job::{Job, JobError, ON_BOARDS, Reading, Request};
use firmware::protocol::{Field, LinkError, MAX_WIRE, Refused, Sample, Simulate, StepTooLong, encode, method_code};
use host_tests::oracle::tolerances;

const REQUEST: Request = Request {
    method: Method::Rk4F32,
    parameters: Parameters { m1: 1.0, m2: 2.75, l1: 1.0, l2: 0.5, g: 9.8 },
    angles: [2.0, -1.0],
    velocities: [0.5, 0.25],
    dt: 1.0 / 1024.0,
    stride: 16,
    samples: 5,
};

fn send(service: &mut Service, message: &Simulate) -> Vec<Received> {
    let mut wire = [0; MAX_WIRE];
    encode(message, &mut wire).iter().filter_map(|&byte| service.receive(byte)).collect()
}

fn samples(service: &mut Service) -> Vec<Sample> {
    std::iter::from_fn(|| service.is_busy().then(|| service.work()))
        .flatten()
        .map(|sample| sample.expect("a finite motion"))
        .collect()
}

fn readings(request: &Request) -> Vec<Reading> {
    let mut job: Job = Job::new(request).unwrap_or_else(|error| panic!("{error}"));
    std::iter::from_fn(|| (!job.is_finished()).then(|| job.advance().expect("a finite motion"))).flatten().collect()
}

/// One step at a time or all at once: the same readings from the same method, whoever asks.
#[test]
fn every_method_of_the_boards_is_answered_in_full_with_what_the_host_computes() {
    for &method in ON_BOARDS {
        let parameters = Parameters { l2: 1.0, ..REQUEST.parameters };
        let request = Request { method, parameters, ..REQUEST };
        let mut at_once = Vec::new();
        let done = request.readings(|reading| {
            at_once.push(*reading);
            Ok::<_, JobError>(())
        });
        let readings = readings(&request);
        assert_eq!((done, &at_once), (Ok(()), &readings), "{method}");
        let mut service = Service::default();
        assert_eq!(send(&mut service, &request.message(7)), [Received::Accepted]);
        let samples = samples(&mut service);
        assert_eq!(samples.iter().map(|sample| sample.index).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
        for (sample, reading) in samples.iter().zip(readings) {
            assert_eq!(sample.request, 7);
            let &Sample { state, velocities, energy, .. } = sample;
            assert_eq!(Reading { state, velocities, energy }, reading);
        }
    }
}

/// Every method of Hamilton's equations, the page's form too, goes where the canonical one does, whole turns of either rod
/// included.
#[test]
fn every_method_moves_alike() {
    let turning = Request { velocities: [14.0, -9.0], dt: 1.0 / 8192.0, stride: 1024, samples: 8, ..REQUEST };
    let states = |method: Method| {
        let mut states = Vec::new();
        let request = Request { method, ..turning };
        request.readings::<JobError>(|reading| {
            states.push(reading.state);
            Ok(())
        })?;
        Ok::<_, JobError>(states)
    };
    let canonical = states(Method::Rk4F64).expect("a pendulum");
    let last = canonical.last().expect("a sample");
    assert!(last[0].abs() > PI && last[1].abs() > PI, "both rods turn over: {last:?}");
    let is_general = |method: &&Method| method.equations() != Equations::Linear;
    for &method in Method::ALL.iter().filter(is_general) {
        let [double, single, micromath] = tolerances::TURNING;
        let near = match method {
            Method::Rk4F32Micromath => micromath,
            Method::Rk4Fixed32 => single,
            _ if method.is_single() => single,
            _ => double,
        };
        let mut farthest = 0.0_f64;
        for (state, exact) in states(method).unwrap_or_else(|error| panic!("{method}: {error}")).iter().zip(&canonical)
        {
            farthest = state.iter().zip(exact).map(|(x, y)| (x - y).abs()).fold(farthest, f64::max);
        }
        println!("{method}: {farthest:e}");
        assert!(farthest < near, "{method}: {farthest:e}");
    }
}

#[test]
fn a_request_comes_through_its_text_unchanged() {
    for &method in Method::ALL {
        let request = Request { method, ..REQUEST };
        assert_eq!(Request::parse(&request.to_string()), Ok(request));
        assert_eq!(method.order() == 0, method.integrator() == Integrator::ClosedForm, "{method}");
    }
    let text = REQUEST.to_string();
    for broken in ["", &text[2..], &text.replace('0', "g"), &text.replacen("0001", "00ff", 1), "\u{e4}\u{e4}"] {
        assert!(Request::parse(broken).is_err(), "{broken}");
    }
}

#[test]
fn a_step_too_long_for_the_energy_is_obeyed_and_told() {
    let lively = Request { parameters: Parameters { m2: 1000.0, ..REQUEST.parameters }, ..REQUEST };
    let mut service = Service::default();
    let answer = send(&mut service, &lively.message(4));
    let [Received::StepTooLong(StepTooLong { request: 4, admissible_step })] = answer[..] else { panic!("{answer:?}") };
    assert_eq!(Some(admissible_step), lively.admissible_step());
    assert!(admissible_step < lively.dt / 10.0);
    assert_eq!(samples(&mut service).len(), 6);
    let fine = Request { dt: admissible_step, ..lively };
    assert_eq!(send(&mut service, &fine.message(5)), [Received::Accepted]);
    let closed_form = Request { method: Method::ClosedFormF64, ..lively };
    assert_eq!(send(&mut service, &closed_form.message(6)), [Received::Accepted]);
}

#[test]
fn a_refusal_names_the_field_and_leaves_the_work_alone() {
    let good = REQUEST.message(1);
    for (message, field) in [
        (Simulate { method: 0xFF, ..good }, Field::Method),
        (Simulate { method: method_code(Method::TextbookF32), ..good }, Field::Method),
        (Simulate { parameters: [0.0, 1.0, 1.0, 1.0, 9.8], ..good }, Field::M1),
        (Simulate { parameters: [1.0, -1.0, 1.0, 1.0, 9.8], ..good }, Field::M2),
        (Simulate { parameters: [1.0, 1.0, f64::NAN, 1.0, 9.8], ..good }, Field::L1),
        (Simulate { parameters: [1.0, 1.0, 1.0, f64::INFINITY, 9.8], ..good }, Field::L2),
        (Simulate { parameters: [1.0, 1.0, 1.0, 1.0, -9.8], ..good }, Field::G),
        (Simulate { angles: [f64::NAN, 0.0], ..good }, Field::A1),
        (Simulate { velocities: [0.0, f64::INFINITY], ..good }, Field::W2),
        (Simulate { dt: 0.0, ..good }, Field::Dt),
        (Simulate { dt: 9.0, ..good }, Field::Dt),
    ] {
        let mut service = Service::default();
        send(&mut service, &good);
        let answer = send(&mut service, &Simulate { request: 2, ..message });
        assert_eq!(answer, [Received::Refused(Refused { request: 2, field: field.code() })]);
        let samples = samples(&mut service);
        assert_eq!(samples.len(), 6, "{field:?}");
        assert!(samples.iter().all(|sample| sample.request == 1));
    }
}

#[test]
fn a_new_request_replaces_the_one_under_way() {
    let mut service = Service::default();
    send(&mut service, &REQUEST.message(1));
    service.work();
    send(&mut service, &REQUEST.message(2));
    assert!(samples(&mut service).iter().all(|sample| sample.request == 2));
}

#[test]
fn damage_is_reported_and_the_next_request_is_answered() {
    let mut wire = [0; MAX_WIRE];
    let mut damaged = encode(&REQUEST.message(1), &mut wire).to_vec();
    damaged[3] ^= 0x10; // the kind
    let mut service = Service::default();
    let received: Vec<_> = damaged.iter().filter_map(|&byte| service.receive(byte)).collect();
    assert_eq!(received, [Received::Damaged(LinkError::Checksum)]);
    assert!(!service.is_busy());
    assert_eq!(send(&mut service, &REQUEST.message(3)), [Received::Accepted]);
}
