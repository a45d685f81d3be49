//! Requests over the serial link, answered by the very application that runs on the boards.

use std::f64::consts::PI;

use double_pendulum::Parameters;
use firmware::app::service::{Received, Service};
use firmware::job::{
    Arithmetic, Formulation, Integrator, Job, JobError, Model, ON_BOARDS, ROWS, Reading, Request, Row,
};
use firmware::protocol::Field;
use firmware::protocol::{LinkError, MAX_WIRE, Refused, Sample, Simulate, StepTooLong, encode};
use host_tests::oracle::tolerances;

const REQUEST: Request = Request {
    row: Row::rk4(Arithmetic::F32, Formulation::Canonical),
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

#[test]
fn every_row_of_the_boards_is_answered_in_full() {
    for &row in ON_BOARDS {
        let parameters = Parameters { l2: 1.0, ..REQUEST.parameters };
        let request = Request { row, parameters, ..REQUEST };
        let mut service = Service::default();
        assert_eq!(send(&mut service, &request.message(7)), [Received::Accepted]);
        let samples = samples(&mut service);
        assert_eq!(samples.iter().map(|sample| sample.index).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
        for (sample, reading) in samples.iter().zip(readings(&request)) {
            assert_eq!(sample.request, 7);
            assert_eq!(
                (sample.state, sample.velocities, sample.energy),
                (reading.state, reading.velocities, reading.energy)
            );
        }
    }
}

/// One step at a time or all at once: the same readings from the same row, whoever asks.
#[test]
fn the_host_computes_what_the_service_answers() {
    for &row in ON_BOARDS {
        let parameters = Parameters { l2: 1.0, ..REQUEST.parameters };
        let request = Request { row, parameters, ..REQUEST };
        let mut at_once = Vec::new();
        let done = request.readings(|reading| {
            at_once.push(*reading);
            Ok::<_, JobError>(())
        });
        assert_eq!((done, at_once), (Ok(()), readings(&request)), "{row}");
    }
}

/// Every row of the general motion, the page's form too, goes where the canonical one does, whole turns of either rod
/// included.
#[test]
fn every_row_of_the_table_moves_alike() {
    let turning = Request { velocities: [14.0, -9.0], dt: 1.0 / 8192.0, stride: 1024, samples: 8, ..REQUEST };
    let states = |row: Row| {
        let mut states = Vec::new();
        let request = Request { row, ..turning };
        request.readings::<JobError>(|reading| {
            states.push(reading.state);
            Ok(())
        })?;
        Ok::<_, JobError>(states)
    };
    let canonical = states(Row::rk4(Arithmetic::F64, Formulation::Canonical)).expect("a pendulum");
    let last = canonical.last().expect("a sample");
    assert!(last[0].abs() > PI && last[1].abs() > PI, "both rods turn over: {last:?}");
    for &row in ROWS.iter().filter(|row| matches!(row.model, Model::General | Model::Textbook)) {
        let [double, single, micromath] = tolerances::TURNING;
        let near = match row.arithmetic {
            Arithmetic::F32Micromath => micromath,
            Arithmetic::F64 | Arithmetic::F64Compensated | Arithmetic::F64Libm | Arithmetic::Fixed64 => double,
            _ => single,
        };
        let mut farthest = 0.0_f64;
        for (state, exact) in states(row).unwrap_or_else(|error| panic!("{row}: {error}")).iter().zip(&canonical) {
            farthest = state.iter().zip(exact).map(|(x, y)| (x - y).abs()).fold(farthest, f64::max);
        }
        println!("{row}: {farthest:e}");
        assert!(farthest < near, "{row}: {farthest:e}");
    }
}

/// The name of a row is its words, so no two are alike, and a request comes through its text unchanged.
#[test]
fn rows_and_requests_are_what_their_text_says() {
    for (index, &row) in ROWS.iter().enumerate() {
        let name = row.to_string();
        assert!(name.starts_with(row.arithmetic.name()), "{name}");
        assert!(ROWS[..index].iter().all(|other| *other != row && other.to_string() != name), "{name} twice");
        let request = Request { row, ..REQUEST };
        assert_eq!(Request::parse(&request.to_string()), Ok(request));
        assert!(row.order > 0 || row.integrator == Integrator::ClosedForm, "{name}");
    }
    let text = REQUEST.to_string();
    for broken in ["", &text[2..], &text.replace('0', "g"), &text.replacen("32", "ff", 1), "\u{e4}\u{e4}"] {
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
    let row = Row { model: Model::Linear, integrator: Integrator::ClosedForm, order: 0, ..lively.row };
    let closed_form = Request { row, ..lively };
    assert_eq!(send(&mut service, &closed_form.message(6)), [Received::Accepted]);
}

#[test]
fn a_refusal_names_the_field_and_leaves_the_work_alone() {
    let good = REQUEST.message(1);
    for (message, field) in [
        (Simulate { arithmetic: 0xFF, ..good }, Field::Arithmetic),
        (Simulate { model: 0xFF, ..good }, Field::Model),
        (Simulate { form: 0xFF, ..good }, Field::Form),
        (Simulate { integrator: 0xFF, ..good }, Field::Integrator),
        (Simulate { order: 5, ..good }, Field::Order),
        (Simulate { integrator: Integrator::Extrapolation.code(), order: 8, ..good }, Field::Integrator),
        (Simulate { arithmetic: Arithmetic::F32Compensated.code(), ..good }, Field::Form),
        (Simulate { arithmetic: Arithmetic::F32Libm.code(), ..good }, Field::Arithmetic),
        (Simulate { model: Model::Textbook.code(), ..good }, Field::Model),
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
