//! The image that is flashed also runs in the emulator, which has no clock control, no panel and no
//! button.

use crate::support::{address, application, on};
use boards::STM32F405;
use boards::qemu::Machine;

#[test]
fn the_image_sets_its_vectors_and_runs_without_a_panel() -> anyhow::Result<()> {
    const VTOR: u32 = 0xe000_ed08;
    /// Enough for several searches for the panel.
    const FRAMES: u32 = 300;

    // The chip's own loader starts the program while the ROM is at address 0, so the program must
    // set the address of the vectors.
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

    // The line about the plan is logged as soon as the plan is found.
    let log: Vec<_> = machine
        .lines()
        .into_iter()
        .map(|line| line.text)
        .filter(|text| !text.starts_with("plan: "))
        .collect();
    assert_eq!(
        log,
        [
            "boot: stm32f405, 168000000 Hz",
            "panel: absent: the bus hangs"
        ]
    );

    machine.next_frame().map(drop)
}
