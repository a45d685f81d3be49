//! The registers of a fault in words.

use firmware::fault::{Fault, Stacked, call_size};

fn fault(cfsr: u32, hfsr: u32) -> Fault {
    let stacked = Some(Stacked {
        pc: 0x456,
        lr: 0x1234,
        xpsr: 0x0100_0000,
    });
    Fault {
        stacked,
        sp: 0x2000_0080,
        stack_end: 0x2000_0000,
        last_call: Some(0x788),
        cfsr,
        hfsr,
        bfar: 0,
    }
}

#[test]
fn names_the_cause() {
    for (fault, cause) in [
        (fault(0x0001_0000, 0x4000_0000), "undefined instruction"),
        (fault(0x0200_0000, 0x4000_0000), "division by zero"),
        (
            fault(0x0008_0000, 0x4000_0000),
            "no such coprocessor (floating-point unit off?)",
        ),
        (
            fault(0x0000_8200, 0x4000_0000),
            "bus fault on a data access",
        ),
        (fault(0, 0x0000_0002), "vector table could not be read"),
        (fault(0, 0x8000_0000), "breakpoint without a debugger"),
        (fault(0, 0), "unknown cause (a Cortex-M0+ tells none)"),
    ] {
        assert_eq!(fault.cause(), cause, "{fault:x?}");
        let lost = Fault {
            stacked: None,
            ..fault
        };
        assert_eq!(lost.cause(), "stack overflow", "{lost:x?}");
        let full = Fault {
            sp: fault.stack_end + 127,
            ..fault
        };
        assert_eq!(full.cause(), "stack overflow", "{full:x?}");
    }
}

#[test]
fn the_text_of_a_fault_has_its_cause_place_and_registers() {
    let lost = Fault {
        stacked: None,
        ..fault(0x0000_1000, 0x4000_0000)
    };
    let stacked = "pc 0x00000456  lr 0x00001234  xpsr 0x01000000";
    let registers = |cfsr| format!("  cfsr {cfsr}  hfsr 0x40000000  bfar 0x00000000");

    for (fault, cause, place, registers) in [
        (
            fault(0x0001_0000, 0x4000_0000),
            "undefined instruction",
            stacked,
            registers("0x00010000"),
        ),
        (
            lost,
            "stack overflow",
            "pc and lr are lost; the last call on the stack is at 0x00000788",
            registers("0x00001000"),
        ),
        (
            Fault {
                last_call: None,
                ..lost
            },
            "stack overflow",
            "pc and lr are lost",
            registers("0x00001000"),
        ),
        (
            fault(0, 0),
            "unknown cause (a Cortex-M0+ tells none)",
            stacked,
            String::new(),
        ),
    ] {
        assert_eq!(
            fault.to_string(),
            format!("HARDFAULT: {cause}\n  {place}\n  sp 0x20000080{registers}")
        );
    }

    let stacked = Some(Stacked {
        pc: 0x456,
        lr: 0x1234,
        xpsr: 0,
    });
    assert_eq!(
        Fault {
            stacked,
            ..fault(0, 0)
        }
        .cause(),
        "invalid state (jump to an even address?)"
    );
}

#[test]
fn calls_are_distinguished_from_other_instructions() {
    for (halfwords, size) in [
        ([0xf000, 0xf802], Some(4)), // bl forwards
        ([0xf7ff, 0xfffe], Some(4)), // bl backwards
        ([0xbf00, 0x4798], Some(2)), // nop; blx r3
        ([0xf000, 0xb802], None),    // b.w
        ([0xbf00, 0x4770], None),    // nop; bx lr
        ([0x4798, 0xbf00], None),    // blx r3; nop
        ([0xe92d, 0x4ff0], None),    // push
    ] {
        assert_eq!(call_size(halfwords), size, "{halfwords:x?}");
    }
}

#[test]
fn the_stacked_registers_include_the_floating_point_unit() {
    assert_eq!(
        (Stacked::size(0xffff_fff9), Stacked::size(0xffff_ffe9)),
        (32, 104)
    );
}
