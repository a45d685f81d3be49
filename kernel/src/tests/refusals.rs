//! What the kernel refuses, by name and value.

use std::string::ToString;

use double_pendulum::{Error, Modes, Motion, Parameter, Parameters, Pendulum, State};

const GOOD: Parameters<f64> = Parameters { m1: 1.0, m2: 2.0, l1: 3.0, l2: 4.0, g: 9.8 };

fn refusal(parameters: Parameters<f64>) -> Error {
    Pendulum::new(&parameters).expect_err("these parameters must be refused")
}

#[test]
fn parameters() {
    let parameter = Parameter::L1;
    assert_eq!(refusal(Parameters { l1: 0.0, ..GOOD }), Error::NotPositive { parameter, value: 0.0 });
    assert_eq!(refusal(Parameters { l1: -1.0, ..GOOD }), Error::NotPositive { parameter, value: -1.0 });
    assert_eq!(refusal(Parameters { l1: f64::INFINITY, ..GOOD }), Error::NotFinite { parameter, value: f64::INFINITY });
    assert!(matches!(
        refusal(Parameters { m2: f64::NAN, ..GOOD }),
        Error::NotFinite { parameter: Parameter::M2, value } if value.is_nan()
    ));
    assert_eq!(
        refusal(Parameters { g: -9.8, ..GOOD }),
        Error::TooSmall { parameter: Parameter::G, value: -9.8, limit: 0.0 }
    );
    assert_eq!(
        refusal(Parameters { m1: 1e300, l1: 1e200, ..GOOD }),
        Error::OutOfRange { parameter: Parameter::M1, value: 1e300 }
    );
    assert!(Pendulum::new(&Parameters { g: 0.0, ..GOOD }).is_ok());
}

#[test]
fn modes_need_gravity() {
    let error = Error::NotPositive { parameter: Parameter::G, value: 0.0 };
    assert_eq!(Modes::new(&Parameters { g: 0.0, ..GOOD }), Err(error));
}

#[test]
fn states_and_motions() {
    let parameter = Parameter::A2;
    let value = f64::INFINITY;
    assert_eq!(State::at_rest(0.0, value).check(), Err(Error::NotFinite { parameter, value }));
    assert_eq!(Motion::at_rest(0.0, value).check(), Err(Error::NotFinite { parameter, value }));
    assert_eq!(State::at_rest(1.0, 2.0).check(), Ok(()));
    assert_eq!(Motion::at_rest(1.0, 2.0).check(), Ok(()));
}

#[test]
fn one_line_each() {
    let line = |error: Error| error.to_string();
    assert_eq!(line(refusal(Parameters { l1: 0.0, ..GOOD })), "l1 = 0.0: must be greater than zero");
    let step = Error::TooLarge { parameter: Parameter::Dt, value: 2.0, limit: 0.5 };
    assert_eq!(line(step), "dt = 2.0: must not exceed 0.5");
    assert_eq!(line(Error::UnequalRods { l1: 3.0, l2: 4.0 }), "l2 = 4.0: the equal-rod form needs l2 = l1 = 3.0");
}
