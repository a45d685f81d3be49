//! Random input for everything that takes input from outside. Nothing may panic or hang, accepted
//! input is valid, and refused input changes nothing. `PROPTEST_CASES=1000000 cargo test -p
//! host-tests --test commands random_input::` runs more cases.

use boards::console::number::Number;
use boards::host::canvas;
use boards::link::Inbox;
use clap::Parser;
use double_pendulum::plan::{Budget, Limit, Problem, Search, Stepping};
use double_pendulum::{Error, Method, Modes, Motion, Parameters, Pendulum, Real, State};
use exact::trials;
use firmware::app::{App, NoButtons};
use firmware::config::CORTEX_M4F;
use firmware::display::NoDisplay;
use firmware::graphics::Format;
use firmware::job::{BoardMotion, Job, ON_BOARDS, Request};
use firmware::motion::Settings;
use firmware::protocol::{
    Answer, Command, Decoder, Field, MAX_MESSAGE, MAX_WIRE, ToHost, decode_command, encode_command,
    frame,
};
use firmware::scenes::SceneName;
use host_tests::simulate::{SimulateOptions, plan};
use proptest::array::{uniform2, uniform4, uniform5};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::RngSeed;

/// The same cases in every run, and more of them on request.
fn cases(least: u32) -> ProptestConfig {
    let usual = ProptestConfig::default();
    let cases = if usual.cases == 256 {
        least
    } else {
        usual.cases
    };
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..usual
    }
}

/// Returns any bit pattern, and numbers as users type them.
fn number() -> impl Strategy<Value = f64> {
    const USUAL: &[f64] = &[
        0.0,
        1.0,
        0.5,
        2.0,
        9.81,
        1.0 / 256.0,
        1.0 / 60.0,
        1e3,
        1e-3,
        1e30,
    ];
    prop_oneof![
        1 => any::<u64>().prop_map(f64::from_bits),
        4 => select(USUAL),
        4 => -10.0..10.0,
        4 => 0.01..10.0,
    ]
}

fn parameters() -> impl Strategy<Value = Parameters<f64>> {
    uniform5(number()).prop_map(|[m1, m2, l1, l2, g]| Parameters { m1, m2, l1, l2, g })
}

fn intact(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut decoder = Decoder::default();
    bytes
        .iter()
        .filter_map(|&byte| Some(decoder.push(byte)?.ok()?.to_vec()))
        .collect()
}

fn wire(message: &[u8]) -> Vec<u8> {
    frame(message, &mut [0; MAX_WIRE]).to_vec()
}

/// Returns a part of a stream, and the message in it if it is intact.
fn part() -> impl Strategy<Value = (Vec<u8>, Option<Vec<u8>>)> {
    let noise = vec(any::<u8>(), 0..200).prop_map(|noise| (noise, None));
    let changes = vec((any::<Index>(), any::<u8>()), 0..4);
    let sent = (vec(any::<u8>(), 0..=MAX_MESSAGE), changes).prop_map(|(message, changes)| {
        let mut sent = wire(&message);
        // Some bytes may change to their old value.
        for (at, change) in changes {
            let at = at.index(sent.len());
            sent[at] ^= change;
        }
        let is_intact = sent == wire(&message);
        (sent, is_intact.then_some(message))
    });
    prop_oneof![1 => noise, 4 => sent]
}

fn command() -> impl Strategy<Value = Vec<u8>> {
    let set = (select(Field::ALL), number()).prop_map(|(field, value)| {
        encode_command(1, Command::Set { field, value }, &mut [0; MAX_WIRE]).to_vec()
    });
    let short = (0..20_u8, vec(any::<u8>(), 0..9))
        .prop_map(|(kind, fields)| wire(&[&[0x80, 1, kind], &fields[..]].concat()));
    let any = vec(any::<u8>(), 0..=MAX_MESSAGE).prop_map(|message| wire(&message));
    prop_oneof![4 => set, 4 => short, 1 => any]
}

fn stepped(
    method: Method,
    parameters: &Parameters<f64>,
    dt: f64,
    start: &State<f64>,
) -> Result<(), Error> {
    let mut run = trials::run(method, parameters, start, dt)?;
    for _ in 0..12 {
        run.advance(1)?;
        assert_eq!(run.state().check(), Ok(()));
        let numbers = run.directions();
        assert!(
            numbers
                .as_flattened()
                .iter()
                .all(|number| number.is_finite()),
            "{numbers:?}"
        );
    }
    Ok(())
}

fn constructed<R: Real>(
    parameters: Parameters<f64>,
    dt: f64,
    state: State<f64>,
) -> Result<(), Error> {
    let parameters = parameters.cast::<R>();
    let state = state.cast::<R>();

    if let Ok(modes) = Modes::new(&parameters) {
        let frequencies = [modes.fast.frequency, modes.slow.frequency];
        assert!(
            frequencies.iter().all(|w| w.is_finite() && *w > R::ZERO),
            "{frequencies:?} of {parameters:?}"
        );
    }

    let pendulum = Pendulum::new(&parameters)?;

    let still = State::at_rest(R::ZERO, R::ZERO);
    assert_eq!(
        pendulum.derivatives(&still.into()),
        [R::ZERO; 4],
        "{parameters:?}"
    );

    let _ = (
        pendulum.bounds(&state),
        pendulum.energy(&state),
        pendulum.to_motion(&state),
        pendulum.modes(),
    );
    let _ = (
        pendulum.positions(state.angles()),
        pendulum.cannot_turn_over(&state),
        pendulum.turnover_energy(),
    );
    pendulum.check_step(dt)?;
    state.finite()?;
    pendulum.step(&state, R::from_f64(dt)).finite().map(drop)
}

proptest! {
    #![proptest_config(cases(1000))]

    #[test]
    fn intact_messages_are_received_and_nothing_else(stream in vec(part(), 0..40)) {
        let (bytes, messages): (Vec<_>, Vec<_>) = stream.into_iter().unzip();
        let messages: Vec<_> = messages.into_iter().flatten().collect();
        prop_assert_eq!(intact(&bytes.concat()), messages);
    }

    /// A request may be answered later, and a message that is no command has no answer.
    #[test]
    fn every_command_is_answered(commands in vec(command(), 1..3)) {
        let mut panel = NoDisplay;
        let mut app = App::new(CORTEX_M4F, canvas(Format::OLED), &mut panel, Vec::new(), NoButtons);
        app.player.play(SceneName::Page, Settings::default()).expect("good settings");
        for (tick, bytes) in (1..).zip(commands) {
            let status = app.player.status();
            let sent = app.link.len();
            app.receive(bytes.iter().copied(), |_| ());
            let mut inbox = Inbox::default();
            let new = app.link[sent..].iter();
            let answers: Vec<_> = new.filter_map(|&byte| inbox.take(byte)).collect();
            prop_assert_eq!(inbox.damage, None);
            let asked = intact(&bytes).first().and_then(|message| decode_command(message));
            let is_silent = matches!(asked, None | Some((_, Some(Command::Simulate(_)))));
            let is_one = matches!(*answers, [_]) && asked.is_some();
            prop_assert!(is_one || answers.is_empty() && is_silent, "{answers:?} to {asked:?}");
            if let [ToHost::Answer(_, Answer::Refused(_))] = *answers {
                prop_assert_eq!(app.player.status(), status, "{:?}", asked);
            }

            app.run_to(tick, |_| ());
            app.work(|_| ());
            prop_assert_eq!(app.player.report.state.check(), Ok(()));
        }
    }

    #[test]
    fn requests_are_refused_or_computed(
        (method, parameters) in (select(ON_BOARDS), parameters()),
        (angles, velocities) in (uniform2(number()), uniform2(number())),
        (dt, stride, samples) in (number(), any::<u8>(), any::<u32>()),
    ) {
        let request = Request {
            method,
            parameters,
            angles,
            velocities,
            dt,
            stride: stride.into(),
            samples,
        };
        let run = BoardMotion::start(&request);
        let Ok(mut job) = run.and_then(|run| Job::new(run, &request)) else { return Ok(()) };
        for _ in 0..24 {
            let Ok(reading) = job.advance() else {
                prop_assert!(job.is_finished());
                break;
            };
            let finite = reading.iter().all(|reading| {
                let mut numbers = reading.state.iter().chain(&reading.velocities);
                reading.energy.is_finite() && numbers.all(|x| x.is_finite())
            });
            prop_assert!(finite, "{reading:?}");
        }
    }

    #[test]
    fn the_kernel_refuses_or_stays_finite(
        parameters in parameters(),
        dt in number(),
        state in uniform4(number()),
    ) {
        let state = State::from(state);
        let constructed = [
            constructed::<f32>(parameters, dt, state),
            constructed::<f64>(parameters, dt, state),
        ];
        let stepped = Method::ALL.iter().map(|&method| stepped(method, &parameters, dt, &state));
        for error in constructed.into_iter().chain(stepped).filter_map(Result::err) {
            prop_assert!(!error.to_string().is_empty());
        }
    }

    /// A plan is within its budget and its scene, or is refused with a reason. The steps of a piece
    /// of the search together cost no more than allowed, or the piece is a single step.
    #[test]
    fn a_plan_is_within_its_budget(
        (pendulum, [a1, a2, w1, w2]) in (parameters(), uniform4(number())),
        rate in prop_oneof![Just(60), any::<u16>()],
        ([tolerance, duration, frame, planning, piece], steps) in (uniform5(number()), 0..200_u32),
        asked in prop::option::of(select(Method::ALL)),
    ) {
        let start = Motion { a1, a2, w1, w2 };
        let scene = Problem {
            pendulum,
            start,
            tolerance: tolerance.abs(),
            duration: duration.abs(),
            rate,
        };
        let [frame, planning, piece] =
            [frame * 1e4, planning * 1e5, piece * 1e5].map(|number| number.abs() as f32);
        let costs = CORTEX_M4F.costs;
        let budget = Budget { frame, planning };
        let search = match asked {
            Some(method) => Search::of(Stepping { method, steps }, &scene, &costs, &budget),
            None => Search::new(&scene, &costs, &budget),
        };
        let Ok(mut search) = search else { return Ok(()) };

        // Each piece of the search stays within its limit.
        for _ in 0..60 {
            let before = search.spent();
            let most = search.next_piece(piece);
            let found = search.advance(piece);
            let spent = search.spent();
            prop_assert!(spent - before <= most + 1e-6 * spent, "{before} {spent}");
            // The search ends with an error, or with a plan that meets all limits.
            match found {
                Err(error) => {
                    let has_reason = !error.to_string().is_empty();
                    let most = planning.max(costs.preparation);
                    prop_assert!(has_reason && spent <= most, "{error:?} {spent}");
                    break;
                }
                Ok(None) => {}
                Ok(Some(plan)) => {
                    let longest = duration.abs().max(1.0 / f64::from(rate));
                    prop_assert!((0.0..=longest).contains(&plan.horizon), "{plan:?}");
                    prop_assert!(plan.spent <= planning, "{plan:?}");
                    prop_assert!(plan.cost > 0.0 && plan.error <= 1.0, "{plan:?}");
                    let is_useful = plan.cost <= frame && plan.horizon > 0.0;
                    prop_assert!(asked.is_some() || is_useful, "{plan:?}");
                    prop_assert!(plan.dt.is_finite() && plan.dt >= 0.0, "{plan:?}");
                    let is_whole = plan.horizon >= duration.abs();
                    prop_assert!((plan.limit == Limit::End) <= is_whole, "{plan:?}");
                    let is_asked = asked.is_none_or(|method| method == plan.method);
                    prop_assert!(is_asked, "{plan:?} for {asked:?}");
                    break;
                }
            }
        }
    }

    #[test]
    fn numbers_are_read_as_they_are_shown(
        text in "[-+]?[0-9]{0,4}\\.?[0-9]{0,4}(e-?[0-9]{1,4})?(/[0-9]{1,3})?|\\PC{0,8}",
    ) {
        if let Ok(number) = text.parse::<Number>() {
            prop_assert!(number.value().is_finite(), "{number}");
            prop_assert_eq!(number.to_string().parse::<Number>().ok(), Some(number));
        }
    }

    #[test]
    fn command_lines_are_refused_or_good(
        words in vec(
            prop_oneof![
                "--(angles|velocities|masses|lengths)=-?[0-9.]{1,4},-?[0-9/.]{1,4}",
                "--(step|until|every|gravity|tolerance)=-?[0-9]{1,3}(/[0-9]{1,4}|e-?[0-9])?",
                "--(method|on)=(rk4-f32|rk4-fixed32|closed-form-f64|\
                extrapolation8-fixed64|lm3s6965evb)",
                "\\PC{0,8}",
            ],
            0..6,
        ),
    ) {
        let line = std::iter::once(String::from("simulate")).chain(words);
        let options = SimulateOptions::try_parse_from(line);
        if let Ok((request, rows)) = options.map_err(drop).and_then(|options| plan(&options).map_err(drop)) {
            prop_assert!(rows.time(1) > 0.0 && request.dt > 0.0);
        }
    }
}
