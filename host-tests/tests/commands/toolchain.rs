//! The real tools on this machine build the firmware. Before `cargo setup` this fails and says so.

use host_tests::emulator::boards::BOARDS;
use host_tests::emulator::toolchain;

#[test]
fn every_board_has_its_firmware() {
    let toolchain = toolchain::ready().unwrap_or_else(|error| panic!("{error}"));
    for board in &BOARDS {
        let elf = toolchain.build_for(board).unwrap_or_else(|error| panic!("{error}"));
        let bytes = std::fs::read(&elf).expect("the built file can be read");
        // ELF, 32 bits, little endian; machine 40 is ARM.
        assert_eq!((&bytes[..6], bytes[18]), (&b"\x7fELF\x01\x01"[..], 40), "{}", elf.display());
    }
}
