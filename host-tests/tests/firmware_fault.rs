//! A fault's registers in words.

use firmware::fault::Fault;

fn fault(cfsr: u32, hfsr: u32) -> Fault {
    Fault { pc: 0x456, lr: 0x1234, xpsr: 0x0100_0000, cfsr, hfsr, bfar: 0 }
}

#[test]
fn names_the_cause() {
    for (cfsr, hfsr, cause) in [
        (0x0001_0000, 0x4000_0000, "undefined instruction"),
        (0x0200_0000, 0x4000_0000, "division by zero"),
        (0x0008_0000, 0x4000_0000, "no such coprocessor (floating-point unit off?)"),
        (0x0000_8200, 0x4000_0000, "bus fault on a data access"),
        (0x0000_0092, 0x4000_0000, "data access refused by the memory protection unit"),
        (0, 0x0000_0002, "vector table could not be read"),
        (0, 0x8000_0000, "breakpoint without a debugger"),
        (0, 0, "unknown cause"),
    ] {
        assert_eq!(fault(cfsr, hfsr).cause(), cause);
    }
}

#[test]
fn reads_well() {
    assert_eq!(
        fault(0x0001_0000, 0x4000_0000).to_string(),
        "HARDFAULT: undefined instruction\n  \
         pc 0x00000456  lr 0x00001234  xpsr 0x01000000  \
         cfsr 0x00010000  hfsr 0x40000000  bfar 0x00000000"
    );
}
