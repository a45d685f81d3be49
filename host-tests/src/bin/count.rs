//! `cargo count`: what each arithmetic costs on the target, per step.

use std::process::ExitCode;

use clap::Parser;
use double_pendulum::Parameters;
use firmware::measure::{CLOSED_FORM, Request, SUBJECTS};
use host_tests::commands::count::{CountError, FULL_CYCLE, Profile, StepCost, Target, affordable_steps, step_cost};
use host_tests::console::cli;
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::toolchain;

/// Counts executed instructions (exact) and Cortex-M cycles (an estimate from the published instruction timings).
#[derive(Debug, Parser)]
#[command(name = "cargo count")]
struct Arguments {
    /// Only arithmetics whose name contains this
    #[arg(default_value = "")]
    arithmetic: String,
    /// Only this board
    #[arg(long)]
    board: Option<String>,
    /// Steps to average over; else 256, or fewer if they are dear
    #[arg(long)]
    steps: Option<u32>,
    /// The mass of bob 2, kg; that of bob 1 is 1
    #[arg(long, default_value_t = 1.0)]
    m2: f64,
    /// The length of rod 2, m; that of rod 1 is 1
    #[arg(long, default_value_t = 1.0)]
    l2: f64,
    /// Both starting angles, rad
    #[arg(long, default_value_t = 0.5)]
    angle: f64,
    /// The step is 1/2^K s
    #[arg(long, value_name = "K", default_value_t = 8)]
    halvings: i32,
    /// List every instruction executed, with its cycles
    #[arg(long)]
    listing: bool,
}

fn main() -> ExitCode {
    let arguments = match cli::parse() {
        Ok(arguments) => arguments,
        Err(code) => return code,
    };
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => cli::refuse(format!("{error:#}")),
    }
}

fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (toolchain, _) = toolchain::set_up()?;
    let boards = BOARDS.iter().filter(|board| match &arguments.board {
        Some(name) => board.name == name,
        None => board.has_panel,
    });
    if !arguments.listing {
        println!("per step of 2^-{} s; cycles are estimated from the published timings", arguments.halvings);
        println!(
            "{:25} {:16} {:>12} {:>19} {:>8} {:>9} {:>10} {:>11}",
            "arithmetic",
            "board",
            "instructions",
            "cycles (estimate)",
            "stalls",
            "hot bytes",
            "code bytes",
            "stack bytes"
        );
    }
    for board in boards {
        let target = Target::build(&toolchain, board)?;
        for subject in
            SUBJECTS.iter().chain([&CLOSED_FORM]).filter(|subject| subject.name.contains(&arguments.arithmetic))
        {
            let request = Request {
                subject: subject.name,
                samples: 1,
                steps: FULL_CYCLE,
                parameters: Parameters { m1: 1.0, m2: arguments.m2, l1: 1.0, l2: arguments.l2, g: 9.81 },
                angles: [arguments.angle; 2],
                dt: f64::powi(0.5, arguments.halvings),
            };
            let steps = match arguments.steps {
                Some(steps) => steps,
                None => affordable_steps(&target, &request)?,
            };
            let request = Request { steps, ..request };
            if arguments.listing {
                list(&target, &request)?;
            } else {
                print_row(subject.name, board, &step_cost(&target, &request)?);
            }
        }
    }
    Ok(())
}

fn print_row(name: &str, board: &Board, cost: &StepCost) {
    let cycles = format!("{:.1}..{:.1}", cost.cycles_low, cost.cycles_high);
    println!(
        "{name:25} {:16} {:12.1} {cycles:>19} {:8.1} {:9} {:10} {:11}",
        board.name, cost.instructions, cost.stalls, cost.hot_bytes, cost.code_bytes, cost.stack_bytes
    );
}

/// Every instruction with its share of a step: address, executions, cycles, stalls, kind.
fn list(target: &Target, request: &Request) -> Result<(), CountError> {
    let image = target.image();
    let profile = Profile::of(target, request)?;
    println!("{} on {}: per step, executions, cycles (estimate), stalls", request.subject, target.board.name);
    let mut function = None;
    for (address, spot) in profile.spots() {
        let inside = image.function_at(address);
        if inside != function {
            function = inside;
            println!("{}:", inside.map_or("?", |function| &function.name));
        }
        let per_step = |total: u64| total as f64 / f64::from(request.steps);
        println!(
            "{address:8x} {:9.2} {:9.2} {:7.2}  {}",
            per_step(spot.cost.instructions),
            per_step(spot.cost.cycles_high),
            per_step(spot.cost.stalls),
            spot.instruction.row.name
        );
    }
    Ok(())
}
