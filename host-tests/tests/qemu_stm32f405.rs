//! The image that is flashed runs in the emulator as well, where it finds neither clock control nor panel nor button.

mod support;

use firmware::protocol::Frame;
use host_tests::emulator::boards::STM32F405;
use host_tests::emulator::qemu::{Machine, QemuError};
use object::{Object, ObjectSegment};
use support::{application, settings, toolchain};

#[test]
fn the_image_is_for_the_chips_memory() -> Result<(), Box<dyn std::error::Error>> {
    let bytes = std::fs::read(application(&STM32F405))?;
    let image = object::File::parse(&*bytes)?;
    let (flash, ram) = (0x0800_0000..0x0810_0000, 0x2000_0000..0x2002_0000);
    let mut starts = image.segments().map(|segment| segment.address()).filter(|address| flash.contains(address));
    assert_eq!(starts.next(), Some(flash.start), "the vector table");
    assert!(image.segments().all(|part| flash.contains(&part.address()) || ram.contains(&part.address())));
    assert!(flash.contains(&image.entry()));
    Ok(())
}

#[test]
fn without_a_panel_it_says_so_and_goes_on() -> Result<(), QemuError> {
    /// Long enough for the panel to be looked for again, several times.
    const FRAMES: u32 = 300;
    let (toolchain, elf) = (toolchain(), application(&STM32F405));
    let mut machine = Machine::start(&settings(&toolchain, &STM32F405, &elf))?;
    for sequence in 0..FRAMES {
        let Some(frame) = machine.serial.next::<Frame>() else { return Err(machine.silence()) };
        assert_eq!((frame.sequence, frame.dropped), (sequence, 0), "looking for the panel holds up nothing");
        assert_eq!(frame.step, sequence + 1, "a line that reads low for ever presses no button");
    }
    // The plan's line comes as soon as it is found.
    let log: Vec<_> = machine.log.arrived().map(|line| line.text).filter(|text| !text.starts_with("plan: ")).collect();
    let expected = ["boot: stm32f405, 168000000 Hz, Emulator", "panel: Absent(Other)"];
    assert_eq!(log, expected);
    machine.quit()
}
