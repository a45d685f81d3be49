//! `cargo count`: the cost of a step of each method on the target.

use anyhow::{anyhow, bail};
use clap::Parser;
use double_pendulum::{Error, Method, Parameter, Parameters};
use firmware::job::Request;
use rayon::prelude::*;

use super::application::{prices, write_prices};
use super::minimal::write_table;
use super::trace::one_of_each_core;
use super::{Minimal, MinimalPrices, StepCost, Target, affordable_cost, step_cost};
use boards::console::cli::{self, Refused, say};
use boards::toolchain::{self, Toolchain};
use boards::{BOARDS, Board};
use cycles::ERROR_BAR;

/// The gravity of the report's regular scene, m/s^2, so that the figures agree with it.
const GRAVITY: f32 = 9.81;
/// Every executed instruction is logged, so a much larger number would take hours.
const MOST_STEPS: i64 = 65_536;

const EXAMPLES: &str = "Examples:
  cargo count                                             every method on a Cortex-M3
  cargo count fixed32 --board lm3s6965evb,lm3s6965evb-m4,lm3s6965evb-m0
  cargo count --minimal                                   Run::advance in a crate outside";

/// Counts executed instructions (exact) and Cortex-M cycles (an estimate from the published
/// instruction timings).
#[derive(Debug, Parser)]
#[command(name = "cargo count", after_help = EXAMPLES)]
pub struct CountOptions {
    /// The method of this name, or all methods whose name contains it
    #[arg(default_value = "")]
    method: String,
    /// The boards, with commas between them [default: lm3s6965evb, a Cortex-M3; with --minimal one
    /// of each core]
    #[arg(
        long = "board",
        alias = "on",
        alias = "target",
        value_name = "NAME",
        value_delimiter = ',',
        value_parser = cli::choice_with_aliases(&BOARDS, Board::names),
    )]
    on: Vec<&'static Board>,
    /// Number of steps to average over, 1 to 65536 [default: 256, fewer for an expensive method]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_STEPS))]
    steps: Option<u32>,
    /// The mass of bob 2, kg; bob 1 has 1 kg
    #[arg(long, value_name = "KG", default_value_t = 1.0)]
    m2: f64,
    /// The length of rod 2, m; rod 1 has 1 m
    #[arg(long, value_name = "M", default_value_t = 1.0)]
    l2: f64,
    /// Both starting angles, rad (see --degrees); the start is at rest, and gravity is 9.81 m/s^2
    #[arg(long, value_name = "A", default_value_t = 0.5)]
    angle: f64,
    /// Read the angle in degrees
    #[arg(long, requires = "angle")]
    degrees: bool,
    /// The step is 1/2^K s
    #[arg(
        long,
        value_name = "K",
        default_value_t = 8,
        value_parser = clap::value_parser!(u8).range(0..=30),
    )]
    halvings: u8,
    /// Count the public function Run::advance in the programs of kernel/minimal, a crate outside
    /// this workspace, instead: a step, a call on top of its steps, and the program's flash
    #[arg(
        long,
        conflicts_with_all = [
            "method", "steps", "m2", "l2", "angle", "halvings", "write_prices",
        ],
    )]
    minimal: bool,
    /// With --minimal: write its prices, of one board for each core, into the kernel's README, too
    #[arg(long, requires = "minimal", conflicts_with = "on")]
    readme: bool,
    /// Count the prices of plans on each kind of core, and write them into
    /// kernel/src/plan/prices.rs
    #[arg(
        long,
        conflicts_with_all = [
            "method", "on", "steps", "m2", "l2", "angle", "halvings",
        ],
    )]
    write_prices: bool,
}

/// Prints a row for each method and board. A method that does not accept the pendulum is left out.
pub fn run(options: &CountOptions) -> anyhow::Result<()> {
    if options.write_prices {
        let toolchain = toolchain::set_up()?;
        let file = write_prices(&prices(&toolchain)?)?;
        return Ok(say(format_args!("wrote {}", file.display()))?);
    }
    if options.minimal {
        return count_minimal(&toolchain::set_up()?, options);
    }
    let requests = options.requests().map_err(Refused::because)?;
    let boards = if options.on.is_empty() {
        vec![&BOARDS[0]]
    } else {
        options.on.clone()
    };
    let toolchain = toolchain::set_up()?;

    for (place, board) in boards.into_iter().enumerate() {
        let target = Target::build(&toolchain, board)?;

        // The heading is printed after the first build, which may fail.
        if place == 0 {
            say(options.setting())?;
            say(ERROR_BAR)?;
            say(line(TITLES.map(str::to_owned)))?;
        }
        for requests in requests.chunks(rayon::current_num_threads()) {
            let rows = requests.par_iter().map(|request| {
                let given = options.steps.map(|stride| Request { stride, ..*request });
                let cost = given.map_or_else(
                    || affordable_cost(&target, request),
                    |given| step_cost(&target, &given),
                );
                Ok(row(request.method, board, &cost?))
            });
            rows.collect::<anyhow::Result<Vec<_>>>()?
                .iter()
                .try_for_each(say)?;
        }
    }

    Ok(())
}

impl CountOptions {
    /// The host checks the requests before anything is built or printed.
    fn requests(&self) -> anyhow::Result<Vec<Request>> {
        let Self { m2, l2, .. } = *self;
        let angle = if self.degrees {
            self.angle.to_radians()
        } else {
            self.angle
        };
        let request = |method| Request {
            parameters: Parameters {
                m1: 1.0,
                m2,
                l1: 1.0,
                l2,
                g: GRAVITY.into(),
            },
            angles: [angle; 2],
            dt: f64::powi(0.5, self.halvings.into()),
            samples: 1,
            ..Request::on_any_core(method)
        };
        let check = |request| {
            Request {
                stride: 1,
                samples: 1,
                ..request
            }
            .crc()
            .map(|_| request)
        };

        let is_name = Method::ALL
            .iter()
            .any(|method| method.name() == self.method);
        let methods = Method::ALL.iter().filter(|method| {
            if is_name {
                method.name() == self.method
            } else {
                method.name().contains(&self.method)
            }
        });
        let checked: Vec<_> = methods.map(|&method| check(request(method))).collect();

        if checked.is_empty() {
            let names = Method::ALL
                .iter()
                .map(|method| method.name())
                .collect::<Vec<_>>()
                .join(", ");
            bail!("{}: no such method; choose from {names}", self.method)
        }

        if checked.iter().all(Result::is_err) {
            let requests = checked.into_iter().collect::<Result<_, _>>();
            return requests.map_err(|error| anyhow!("{}{error}", option_of(&error)));
        }
        Ok(checked.into_iter().flatten().collect())
    }

    /// Returns all that the counts depend on: software arithmetic takes different paths for
    /// different numbers.
    fn setting(&self) -> String {
        let Self {
            m2,
            l2,
            angle,
            halvings,
            degrees,
            ..
        } = self;
        let unit = if *degrees { "degrees" } else { "rad" };
        format!(
            "one step of 2^-{halvings} s, averaged over the first steps from rest at {angle} \
             {unit}; masses 1,{m2} kg, lengths 1,{l2} m, gravity {GRAVITY} m/s^2 (as an f32); \
             instructions are counted"
        )
    }
}

fn option_of(error: &Error) -> &'static str {
    match error.parameter() {
        Parameter::M2 => "--m2: ",
        Parameter::L2 => "--l2: ",
        Parameter::A1 | Parameter::A2 => "--angle: ",
        Parameter::Dt => "--halvings: ",
        _ => "",
    }
}

#[rustfmt::skip]
const TITLES: [&str; 9] = [
    "method", "board", "steps", "instructions", "cycles (estimate)", "stalls",
    "hot bytes", "code bytes", "stack bytes",
];

fn line(
    [
        method,
        board,
        steps,
        instructions,
        cycles,
        stalls,
        hot,
        code,
        stack,
    ]: [String; 9],
) -> String {
    let counts = format!("{steps:>5} {instructions:>12} {cycles:>17} {stalls:>8}");
    format!("{method:>29} {board:>16} {counts} {hot:>9} {code:>10} {stack:>11}")
}

fn row(method: Method, board: &Board, cost: &StepCost) -> String {
    let StepCost {
        steps,
        instructions,
        cycles,
        stalls,
        hot_bytes,
        code_bytes,
        stack_bytes,
    } = cost;
    let [instructions, cycles, stalls] =
        [instructions, cycles, stalls].map(|count| format!("{count:.1}"));
    let [steps, hot, code, stack] = [steps, hot_bytes, code_bytes, stack_bytes].map(u32::to_string);
    line([
        method.to_string(),
        board.name.to_owned(),
        steps,
        instructions,
        cycles,
        stalls,
        hot,
        code,
        stack,
    ])
}

fn count_minimal(toolchain: &Toolchain, options: &CountOptions) -> anyhow::Result<()> {
    let boards = if options.on.is_empty() {
        one_of_each_core().collect()
    } else {
        options.on.clone()
    };

    let mut all = Vec::new();
    for (place, board) in boards.into_iter().enumerate() {
        let counted = MinimalPrices::count(toolchain, board)?;
        if place == 0 {
            say(
                "Run::advance in the programs of kernel/minimal: a step of 2^-8 s from rest at \
                 0.5 rad, rods of 1 m, bobs of 1 kg; a call is on top of its steps; flash is \
                 beyond that of a program without a motion",
            )?;
            say(ERROR_BAR)?;
            let titles = ["steps", "cycles (estimate)", "a call", "flash bytes"];
            say(minimal_line("type", "board", titles.map(str::to_owned)))?;
        }
        for price in &counted.prices {
            let Minimal {
                program,
                steps,
                step,
                call,
                flash,
            } = price;
            let numbers = [
                steps.to_string(),
                format!("{step:.1}"),
                call.to_string(),
                flash.to_string(),
            ];
            say(minimal_line(&program.to_string(), board.name, numbers))?;
        }
        let numbers = [
            String::new(),
            String::new(),
            String::new(),
            counted.start_up.to_string(),
        ];
        say(minimal_line("no motion", board.name, numbers))?;
        all.push(counted);
    }

    if options.readme {
        write_table(&all)?;
        say("wrote kernel/README.md")?;
    }
    Ok(())
}

fn minimal_line(form: &str, board: &str, [steps, step, call, flash]: [String; 4]) -> String {
    format!("{form:>30} {board:>16} {steps:>5} {step:>17} {call:>8} {flash:>11}")
}

#[test]
fn a_full_name_counts_that_method_alone() {
    for (name, methods) in [
        ("rk4-f32-direction", 1),
        ("direction", 2),
        ("", Method::ALL.len()),
    ] {
        let options = CountOptions::try_parse_from(["count", name]);
        let requests = options.map(|options| options.requests().map(|requests| requests.len()));
        assert_eq!(requests.ok().and_then(Result::ok), Some(methods), "{name}");
    }
}
