//! The image that is flashed runs in the emulator as well, where it finds neither clock control nor panel nor button.

use crate::support::{address, application, on};
use firmware::config::MOST_MEASURED_STEPS;
use firmware::job::{ON_BOARDS, Request};
use firmware::protocol::{Answer, Command};
use host_tests::emulator::boards::STM32F405;
use host_tests::emulator::qemu::Machine;

#[test]
fn it_starts_from_anywhere_goes_on_without_a_panel_and_steps_in_flash_and_in_memory()
-> anyhow::Result<()> {
    const VTOR: u32 = 0xe000_ed08;
    /// Long enough for the panel to be looked for again, several times.
    const FRAMES: u32 = 300;
    // The chip's own loader starts the program while its ROM stands at address 0: the processor must be told where the vectors are.
    let mut probe = on(&STM32F405, Machine::halted)?;
    assert_eq!(probe.read(VTOR..VTOR + 4)?, [0; 4]);
    probe.run_to(address(&application(&STM32F405), "clock::cycles"))?;
    assert_eq!(probe.read(VTOR..VTOR + 4)?, 0x0800_0000_u32.to_le_bytes());
    let machine = probe.run()?;
    for sequence in 0..FRAMES {
        let frame = machine.next_frame()?;
        assert_eq!(
            (frame.sequence, frame.dropped),
            (sequence, 0),
            "looking for the panel holds up nothing"
        );
        assert_eq!(
            frame.report.step,
            u64::from(sequence) + 1,
            "a line that reads low for ever presses no button"
        );
    }
    // The plan's line comes as soon as it is found.
    let log: Vec<_> = machine
        .lines()
        .into_iter()
        .map(|line| line.text)
        .filter(|text| !text.starts_with("plan: "))
        .collect();
    assert_eq!(
        log,
        ["boot: stm32f405, 168000000 Hz", "panel: Absent(Other)"]
    );
    // Every method's from its copy in memory: a branch into nowhere would end the application.
    for (&method, request) in ON_BOARDS.iter().zip(0..) {
        let motion = Request {
            samples: 0,
            ..Request::on_any_core(method)
        };
        machine.send(request, Command::Simulate(motion))?;
        machine.next_answer()?;
        for in_ram in [false, true] {
            machine.send(
                request,
                Command::Measure {
                    steps: MOST_MEASURED_STEPS,
                    in_ram,
                },
            )?;
            // QEMU counts none.
            let measured = Answer::Measured {
                steps: MOST_MEASURED_STEPS,
                cycles: 0,
            };
            assert_eq!(machine.next_answer()?, (request, measured));
        }
    }
    machine.next_frame().map(drop)
}
