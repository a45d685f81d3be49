//! The host sends more than the board reads, or stops the emulator.

use std::thread::sleep;
use std::time::Duration;

use crate::support::on;
use boards::qemu::{Clock, Machine, MachineSettings};
use boards::{BOARDS, STM32F405};
use firmware::config::TICK_RATE;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use rayon::prelude::*;

/// The board's clock does not advance while QEMU is stopped.
#[test]
fn a_board_whose_emulator_pauses_does_not_take_it_for_a_hang() -> anyhow::Result<()> {
    /// The duration of a stop. It is longer than the watchdog's two stages.
    const PAUSE: Duration = Duration::from_millis(2500);
    const FRAMES: usize = 20;
    BOARDS
        .par_iter()
        .filter(|board| **board != STM32F405)
        .try_for_each(|board| {
            let mut machine = on(board, |settings| {
                Machine::start(&MachineSettings {
                    clock: Clock::Real,
                    ..*settings
                })
            })?;
            let emulator = Pid::from_raw(machine.id().cast_signed());
            for pause in [true, false] {
                for _ in 0..FRAMES {
                    machine.next_frame()?;
                }
                if pause {
                    kill(emulator, Signal::SIGSTOP)?;
                    sleep(PAUSE);
                    kill(emulator, Signal::SIGCONT)?;
                }
            }
            let log = machine.log_text();
            assert!(
                !log.contains("HANG") && !log.contains("restarted"),
                "{}: {log}",
                board.name
            );
            Ok(())
        })
}

#[test]
fn received_bytes_that_are_lost_are_counted() -> anyhow::Result<()> {
    // Broken messages of a byte each. A board reads at most four of them in a tick, and they are
    // many times the size of its queue.
    let flood = [0, 1].repeat(10_000);
    for board in &BOARDS {
        // The log uses another channel than the frames. It may arrive later, and a line of it may
        // be lost. On a busy host the bytes may arrive so slowly that the board reads them all. In
        // both cases they are sent again, after a while to another machine.
        let mut lost = 0;
        let mut sent = 0;
        let mut log = String::new();
        let start = || {
            let mut machine = on(board, Machine::start)?;
            assert_eq!(machine.next_frame()?.lost, 0, "{}", board.name);
            anyhow::Ok(machine)
        };
        let mut machine = start()?;
        for frame in 1.. {
            if frame % (20 * TICK_RATE) == 0 {
                machine = start()?;
                sent = 0;
                log.clear();
            }
            if frame % TICK_RATE == 1 {
                machine.send_bytes(&flood)?;
                sent += flood.len() as u32;
            }
            lost = machine.next_frame()?.lost;
            log += &machine.log_text();
            if lost > 0 && log.contains("received bytes lost") {
                break;
            }
        }
        assert!(lost < sent, "{}: {lost} of {sent}", board.name);

        assert!(log.contains("boot: "), "{}: {log}", board.name);
    }
    Ok(())
}
