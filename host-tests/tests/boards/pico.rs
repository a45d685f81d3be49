//! The file that `cargo pico` makes, in an emulated Raspberry Pi Pico with a panel, buttons, a USB
//! host and a serial adapter.

use std::process::Command as Program;
use std::time::Duration;

use crate::support::{LIMIT, application, show};
use anyhow::Context;
use boards::flash::image::{flash_image, uf2};
use boards::link::BAUD_OF_BOOT_LOADER;
use boards::pico::PicoMachine;
use boards::process;
use boards::scratch::Scratch;
use boards::toolchain::{self, workspace};
use boards::{BOARDS, PICO};
use cycles::Core;
use double_pendulum::Method;
use firmware::app::Key;
use firmware::config::{
    BAUD, HOLD_TICKS, MOST_MEASURED_STEPS, RECEIVE_QUEUE, TICK_RATE, WATCHDOG_SECONDS,
};
use firmware::display::{BusFault, By, Controller, Found, PanelReport, PanelState};
use firmware::graphics::{Bitmap, PanelName};
use firmware::job::{CRC, Request};
use firmware::protocol::{
    Answer, BoardName, Cause, Command, Field, Frame, MAX_WIRE, Restarted, ToHost, encode_command,
};
use firmware::scenes::SceneName;
use host_tests::count::{FULL_CYCLE, Target, affordable_steps, step_cost};

const PICTURE: Duration = Duration::from_millis(50);
/// Finding the changes on the panel and handing over a frame takes 1.3 ms; waiting for the UART
/// would take 0.9 ms more.
const SHOWING: u32 = 200_000;
const TICK: Duration = Duration::from_nanos(1_000_000_000 / TICK_RATE as u64);

/// The watchdog's time, and the time of the host to find the board again.
const RESTART: Duration = Duration::from_millis(2000 * WATCHDOG_SECONDS as u64 + 400);
const QUICK_RESTART: Duration = Duration::from_millis(800);

fn board() -> anyhow::Result<PicoMachine> {
    let mut board = switched_on()?;
    board.next_frame()?;
    Ok(board)
}

fn switched_on() -> anyhow::Result<PicoMachine> {
    let emulator = toolchain::ready_for_pico().unwrap_or_else(|missing| panic!("{missing}"));
    PicoMachine::start(&emulator, &application(&PICO), PanelName::Oled, LIMIT)
}

fn request(method: Method, samples: u32) -> Request {
    Request {
        angles: [0.5; 2],
        stride: 1,
        samples,
        ..Request::on_any_core(method)
    }
}

#[test]
fn the_file_is_for_the_chips_flash_and_its_boot_rom() -> anyhow::Result<()> {
    let (start, image) = flash_image(&std::fs::read(application(&PICO))?)?;
    assert_eq!(start, 0x1000_0000);

    // The ROM does not start a program without this checksum.
    let (boot, sum) = image[..256].split_at(252);
    let bit = |crc: u32, _| crc << 1 ^ if crc >> 31 == 0 { 0 } else { 0x04c1_1db7 };
    let crc = boot.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte) << 24, bit)
    });
    assert_eq!(crc, u32::from_le_bytes(sum.try_into()?));
    Ok(())
}

const COMPARED: u32 = 8_000_000;

#[test]
fn faster_execution_has_the_results_of_the_emulators_own() -> anyhow::Result<()> {
    let node = toolchain::ready_for_pico().unwrap_or_else(|missing| panic!("{missing}"));
    let (start, image) = flash_image(&std::fs::read(application(&PICO))?)?;
    let folder = Scratch::new()?;
    let file = folder.path().join("pico.uf2");
    std::fs::write(&file, uf2(start, &image))?;

    let mut compare = Program::new(node);
    compare
        .arg("--single-threaded")
        .arg(workspace().join("host-tests/boards/rp2040/compare.js"))
        .arg(&file)
        .arg(COMPARED.to_string());
    let output = process::run(&mut compare, LIMIT)?;
    assert!(output.status.success(), "{}", output.stderr);
    assert!(
        output.stdout.ends_with("single ones are the same\n"),
        "{}",
        output.stdout
    );
    Ok(())
}

/// Neither link delays a frame. A flood of bytes over USB loses nothing, because the host waits.
#[test]
fn usb_and_uart_carry_the_hosts_bits_and_every_command() -> anyhow::Result<()> {
    const FRAMES: u32 = 240;
    const SAMPLES: u32 = 200;
    let mut board = switched_on()?;
    let mut show = show(&PICO, SceneName::Page);
    let mut sent = vec![board.next_frame()?];

    // The earlier frames were not received, because the host needs time to find the board.
    let first = sent[0].sequence;
    assert!((6..12).contains(&first), "{first}");

    for sequence in first + 1..first + FRAMES {
        let frame = board.next_frame()?;
        assert_eq!(
            (frame.sequence, frame.dropped, frame.report.step),
            (sequence, 0, u64::from(sequence) + 1)
        );
        assert_eq!(frame, show.expected(&frame));
        sent.push(frame);
    }

    board.run(TICK / 4)?;
    let through_uart: Vec<Frame> = board
        .heard_by_uart()
        .into_iter()
        .filter_map(ToHost::frame)
        .skip(first as usize)
        .collect();
    assert_eq!(through_uart, sent);

    let showing = sent
        .windows(2)
        .map(|frames| frames[1].busy_cycles - frames[0].scene_cycles)
        .max();
    assert!(showing < Some(SHOWING), "{showing:?}");

    assert!(
        board
            .lines()
            .iter()
            .any(|line| line.text == "boot: pico, 125000000 Hz")
    );

    let (_, image) = flash_image(&std::fs::read(application(&PICO))?)?;
    board.send(1, Command::Identify)?;
    let [(1, Answer::Identity(identity))] = answers(board.run(4 * TICK)?)[..] else {
        panic!("no answer")
    };
    assert_eq!(
        (identity.board, identity.hertz),
        (BoardName::Pico, PICO.hertz)
    );
    let program = &image[256..][..identity.image_bytes as usize];
    assert_eq!(identity.image, CRC.checksum(program));
    assert!(image.len() - 256 - program.len() < 256, "nearly all of it");

    // Samples that are computed faster than the UART sends them arrive completely.
    board.heard_by_uart();
    board.send(1, Command::Simulate(request(Method::Rk4Fixed32, SAMPLES)))?;
    board.run(60 * TICK)?;
    let indices = answers(board.heard_by_uart())
        .into_iter()
        .map(|answer| match answer {
            (1, Answer::Sample { index, .. }) => index,
            other => panic!("{other:?}"),
        });
    assert!(indices.eq(0..=SAMPLES));

    board.send(1, Command::Choose(SceneName::Butterfly))?;
    let mut messages = board.run(4 * TICK)?;
    board.send_through_uart(
        2,
        Command::Set {
            field: Field::M2,
            value: 2.5,
        },
    )?;
    messages.extend(board.run(4 * TICK)?);
    for heard in [messages, board.heard_by_uart()] {
        assert_eq!(answers(heard), [(1, Answer::Done), (2, Answer::Done)]);
    }
    let frame = board.next_frame()?;
    assert_eq!((frame.scene, frame.mass_ratio), (SceneName::Butterfly, 2.5));

    let mut flood = vec![1; 5 * RECEIVE_QUEUE];
    for request in 0..100 {
        flood.extend_from_slice(encode_command(request, Command::Ask, &mut [0; MAX_WIRE]));
    }
    board.send_bytes(&flood)?;
    assert!(
        answers(board.run(60 * TICK)?)
            .into_iter()
            .map(|(request, _)| request)
            .eq(0..100)
    );
    let frame = board.next_frame()?;
    assert_eq!((frame.lost, frame.dropped), (0, 0));
    assert_eq!(
        board.counts().map(|counts| counts.damaged + counts.lost),
        [0; 2]
    );
    Ok(())
}

/// The board's motion does not wait for the host. The frames that are lost are missing as a whole.
#[test]
fn a_host_that_stops_reading_loses_frames_and_nothing_else() -> anyhow::Result<()> {
    let mut board = board()?;
    let mut show = show(&PICO, SceneName::Page);
    board.tell("listen 0")?;
    assert!(board.run(TICK * TICK_RATE)?.is_empty());
    board.tell("listen 1")?;
    let messages = board.run(TICK * TICK_RATE)?;

    let frames: Vec<_> = messages.into_iter().filter_map(ToHost::frame).collect();
    for frame in &frames {
        assert_eq!(
            (frame.report.step, frame.dropped),
            (u64::from(frame.sequence) + 1, 0)
        );
        assert_eq!(*frame, show.expected(frame));
    }
    let [usb, uart] = board.counts();
    let missing = frames
        .windows(2)
        .map(|two| two[1].sequence - two[0].sequence - 1);
    let missing: u32 = missing.sum();
    println!("{} frames, {missing} lost", frames.len());
    assert!((TICK_RATE / 2..TICK_RATE).contains(&missing), "{missing}");
    assert_eq!((usb.lost, usb.damaged), (missing.into(), 0));
    assert_eq!((uart.lost, uart.damaged), (0, 0));
    Ok(())
}

fn answers(messages: Vec<ToHost>) -> Vec<(u16, Answer)> {
    messages.into_iter().filter_map(ToHost::answer).collect()
}

fn measured(board: &mut PicoMachine) -> anyhow::Result<u32> {
    board.send(2, Command::Measure(MOST_MEASURED_STEPS))?;
    match answers(board.run(4 * TICK)?)[..] {
        [(2, Answer::Measured { cycles, .. })] => Ok(cycles),
        ref others => panic!("{others:?}"),
    }
}

/// The emulator counts cycles on its own, so that it verifies `cargo count` independently of QEMU.
#[test]
fn the_emulators_cycles_agree_with_the_estimate() -> anyhow::Result<()> {
    // Found: 0.5 % more, 2.6 % less, 0.1 % less.
    const APART: f64 = 0.04;
    let mut board = board()?;
    board.run(PICTURE)?;
    let [single, fixed64] = [Method::Rk4F32DirectionPlain, Method::Extrapolation8Fixed64];
    let emulated = BOARDS
        .iter()
        .find(|board| board.core() == Core::M0Plus)
        .expect("QEMU's");
    let target = Target::build(&toolchain::ready()?, emulated)?;

    for method in [single, fixed64, Method::Rk4Fixed32] {
        board.send(1, Command::Simulate(request(method, 0)))?;
        board.run(4 * TICK)?;
        let steps = FULL_CYCLE / MOST_MEASURED_STEPS;
        let cycles = (0..steps)
            .map(|_| measured(&mut board))
            .sum::<Result<u32, _>>()?;
        let counted = f64::from(cycles) / f64::from(FULL_CYCLE);

        let request = request(method, 1);
        let request = Request {
            stride: affordable_steps(&target, &request)?,
            ..request
        };
        let estimated = step_cost(&target, &request)?.cycles;
        assert!(
            (counted / estimated - 1.0).abs() < APART,
            "{method}: {counted} counted, {estimated} estimated"
        );
    }

    Ok(())
}

fn stand_still(board: &mut PicoMachine) -> anyhow::Result<Frame> {
    board.send(9, Command::Pause(true))?;
    board.run(PICTURE)?;
    board.next_frame()
}

/// The status bytes are no evidence of the controller.
#[test]
fn every_kind_of_panel_shows_the_hosts_picture_after_it_is_plugged_in() -> anyhow::Result<()> {
    let mut board = switched_on()?;
    board.tell("plug none")?;
    board.run(Duration::from_millis(300))?;
    assert!(board.tell("panel")?.is_empty(), "it is off");
    assert!(board.lines().iter().any(|line| {
        line.text
            .starts_with("panel: absent: no answer at 0x3C and 0x3D")
    }));
    assert_eq!(
        panel_report(&mut board)?.state,
        PanelState::Absent(BusFault::NoAnswer)
    );
    let [ssd1306, sh1106] = [
        "panel: ssd1306, by reading its memory back, status ",
        "panel: sh1106, by reading its memory back, status ",
    ];

    for (name, panel, found) in [
        (SceneName::Page, "ssd1306 6", ssd1306),
        (SceneName::Figure7, "none", ""),
        // It has the status byte of the other controller.
        (SceneName::Butterfly, "sh1106 6", sh1106),
        // Its power fails for a moment.
        (SceneName::Flips, "sh1106 8", sh1106),
        (SceneName::Page, "ssd1306 0", ssd1306),
    ] {
        board.send(1, Command::Choose(name))?;
        board.send(2, Command::Pause(false))?;
        board.tell("plug none")?;
        board.run(4 * TICK)?;
        board.tell(&format!("plug {panel}"))?;

        // A new panel is found within a second, and receives the missing data in one more.
        board.run(if panel == "none" {
            4 * PICTURE
        } else {
            Duration::from_millis(2000)
        })?;
        let frame = stand_still(&mut board)?;

        let lines = board.lines();
        let reported = lines
            .iter()
            .find(|line| line.text.starts_with("panel: s"))
            .map(|line| &line.text[..]);
        assert!(
            reported.unwrap_or_default().starts_with(found)
                && reported.is_some() != found.is_empty(),
            "{}: {reported:?}",
            name.name()
        );

        let is_present = matches!(panel_report(&mut board)?.state, PanelState::Shown(_));
        assert_eq!(is_present, panel != "none", "{}", name.name());

        let mut show = show(&PICO, name);
        (0..frame.report.step).for_each(|_| show.tick());
        show.player.draw();
        let canvas = &mut show.player.canvas;
        firmware::graphics::text::pause_mark(canvas);
        let shown = board.tell("panel")?;
        let picture = Bitmap::from(&*canvas);
        let expected = if panel == "none" {
            &[]
        } else {
            picture.pages.as_flattened()
        };
        assert!(
            shown == expected,
            "{}: {:?}",
            name.name(),
            board.screenshot()?
        );
    }

    Ok(())
}

fn panel_report(board: &mut PicoMachine) -> anyhow::Result<PanelReport> {
    board.send(7, Command::Ask)?;
    match answers(board.run(4 * TICK)?)[..] {
        [(7, Answer::Status(status))] => Ok(status.panel),
        ref others => panic!("{others:?}"),
    }
}

const CLOCK_COUNTS: [u8; 2] = [175, 108];

/// A panel whose power fails holds the clock low. A transfer does not end while the clock is low,
/// and the controller of the bus cannot be disabled; only its reset ends every transfer.
#[test]
fn a_panel_that_holds_the_clock_low_shows_the_picture_when_it_lets_go() -> anyhow::Result<()> {
    let mut board = switched_on()?;
    board.run(PICTURE)?;
    let resets = board.tell("i2c")?[2];
    board.tell("hold 1")?;
    board.run(Duration::from_secs(1))?;
    assert!(matches!(
        panel_report(&mut board)?.state,
        PanelState::Absent(_)
    ));
    let while_held = board.tell("i2c")?[2];
    assert!(while_held > resets);

    board.tell("hold 0")?;
    board.run(Duration::from_secs(2))?;
    let frame = stand_still(&mut board)?;
    let mut show = show(&PICO, SceneName::Page);
    (0..frame.report.step).for_each(|_| show.tick());
    show.player.draw();
    let canvas = &mut show.player.canvas;
    firmware::graphics::text::pause_mark(canvas);
    assert!(board.tell("panel")? == Bitmap::from(&*canvas).pages.as_flattened());
    assert_eq!(board.tell("i2c")?[..2], CLOCK_COUNTS);
    Ok(())
}

#[test]
fn choices_for_the_panel_outlast_a_restart() -> anyhow::Result<()> {
    let chosen = Some(Controller::Sh1106);
    let mut board = board()?;
    board.run(8 * PICTURE)?;
    board.send(1, Command::Panel(chosen))?;
    board.send(1, Command::Turn(true))?;
    assert_eq!(answers(board.run(8 * PICTURE)?), [(1, Answer::Done); 2]);
    let is_driven = |report: PanelReport| {
        matches!(
            report.state,
            PanelState::Shown(Found { by: By::Choice, .. })
        ) && report.chosen.controller == chosen
            && report.chosen.is_turned
    };
    assert!(is_driven(panel_report(&mut board)?));

    board.tell("hang")?;
    board.run(Duration::from_secs(u64::from(WATCHDOG_SECONDS) * 2) + 8 * PICTURE)?;
    assert!(is_driven(panel_report(&mut board)?));
    board.tell("reset 0")?;
    board.run(8 * PICTURE)?;
    assert!(is_driven(panel_report(&mut board)?));

    board.send(2, Command::Panel(None))?;
    board.run(8 * PICTURE)?;
    let report = panel_report(&mut board)?;
    assert_eq!(report.chosen.controller, None);
    assert!(matches!(
        report.state,
        PanelState::Shown(Found { by: By::Memory, .. })
    ));
    Ok(())
}

#[test]
fn every_button_has_its_effect() -> anyhow::Result<()> {
    let mut board = board()?;
    board.run(10 * TICK)?;
    let mut show = show(&PICO, SceneName::Page);
    let [up, right] = [
        (Key::Up, Command::Heavier),
        (Key::Right, Command::TurnRight),
    ];
    let [down, left] = [
        (Key::Down, Command::Lighter),
        (Key::Left, Command::TurnLeft),
    ];

    for (key, command) in [up, up, left, right, right, down] {
        board.set_key(key, true)?;
        board.run(6 * TICK)?;
        board.set_key(key, false)?;
        board.run(6 * TICK)?;
        show.player.execute(command).expect("within its range");
        let frame = board.next_frame()?;
        let here = show.player.frame();
        assert_eq!(
            (frame.mass_ratio, frame.start_angle),
            (here.mass_ratio, here.start_angle),
            "{}",
            key.name()
        );
    }

    board.set_key(Key::Select, true)?;
    board.run(TICK * (u32::from(HOLD_TICKS) + 6))?;
    assert_eq!(board.next_frame()?.scene, SceneName::Page.next());
    Ok(())
}

#[test]
fn the_watchdog_restarts_the_board_in_its_scene() -> anyhow::Result<()> {
    let mut board = board()?;
    board.send(1, Command::Choose(SceneName::Butterfly))?;
    board.send(2, Command::Heavier)?;
    board.run(10 * TICK)?;
    let before = board.next_frame()?;
    board.run(TICK / 4)?;
    board.tell("hang")?;

    board.run(RESTART)?;

    let restarted = board
        .heard_by_uart()
        .into_iter()
        .find_map(ToHost::restarted);
    let Restarted {
        cause,
        restarts,
        scene,
        step,
        ..
    } = restarted.expect("a report of the restart");
    assert_eq!((cause, restarts), (Some(Cause::Hang), 1));
    assert_eq!((scene, step), (before.scene, before.report.step));
    let frame = board.next_frame()?;
    assert_eq!(
        (frame.scene, frame.mass_ratio),
        (before.scene, before.mass_ratio)
    );
    assert_eq!(
        (frame.report.step, frame.dropped),
        (u64::from(frame.sequence) + 1, 0),
        "from its start, and all frames since"
    );

    // After a reset from outside the board starts from its defaults. It must not be mistaken for
    // the watchdog's earlier reset, nor for the reset at the end of a download by the boot ROM.
    for after_download in [false, true, false] {
        board.tell(&format!("reset {}", u8::from(after_download)))?;
        let messages = board.run(8 * PICTURE)?;
        assert!(
            messages.iter().all(|message| message.restarted().is_none()),
            "{after_download}"
        );
        assert_eq!(board.next_frame()?.scene, SceneName::Page);
        board.send(3, Command::Choose(SceneName::Butterfly))?;
        board.run(4 * TICK)?;
        assert_eq!(last_restart(&mut board)?, None, "{after_download}");
    }

    Ok(())
}

fn last_restart(board: &mut PicoMachine) -> anyhow::Result<Option<Restarted>> {
    board.send(4, Command::AskRestart)?;
    match answers(board.run(4 * TICK)?)[..] {
        [(4, Answer::Restart(end))] => Ok(end),
        ref others => panic!("{others:?}"),
    }
}

/// A fault resets only the processor, a hang the whole chip. A stack frame that is larger than the
/// memory below it locks the processor up, which is a hang. All end the connection, and the message
/// about the restart is lost.
#[test]
fn a_host_that_opens_the_port_late_receives_the_cause_of_the_restart() -> anyhow::Result<()> {
    let mut board = board()?;
    assert_eq!(last_restart(&mut board)?, None);
    board.send(1, Command::Choose(SceneName::Butterfly))?;
    board.run(10 * TICK)?;

    let ends = [
        ("fault", Cause::Fault),
        ("hang", Cause::Hang),
        ("enlargeFrame 100000", Cause::Hang),
    ];
    for (number, (end, cause)) in (1..).zip(ends) {
        // The port is closed while the board crashes, and opened long after its restart.
        let before = board.next_frame()?;
        board.set_port(0)?;
        // A frame may be received shortly before or after the next tick begins.
        board.run(2 * TICK)?;
        board.tell(end)?;
        let silence = board.run(RESTART + Duration::from_secs(1))?;
        assert!(silence.is_empty(), "the port is closed");
        board.set_port(BAUD)?;
        let first = board.next_frame()?;
        assert!(first.sequence > TICK_RATE, "{end}: it is late");

        let restarted = last_restart(&mut board)?.expect("it has restarted");
        assert_eq!((restarted.cause, restarted.restarts), (Some(cause), number));
        assert_eq!(restarted.scene, SceneName::Butterfly);
        assert!(restarted.step > before.report.step, "{end}");

        // The chip's watchdog has no interrupt, so the place of a hang is unknown.
        let is_place_known = restarted.pc > 0x1000_0000;
        assert_eq!(is_place_known, cause == Cause::Fault, "{restarted:?}");
    }

    Ok(())
}

/// The host keeps the port open. It must notice that the board disconnects; otherwise it continues
/// to use an address that the board has forgotten.
#[test]
fn every_restart_disconnects_the_board() -> anyhow::Result<()> {
    let mut board = board()?;
    for end in ["fault", "hang", "reset 0", "reset 1"] {
        board.run(10 * TICK)?;
        let before = board.next_frame()?.sequence;
        board.tell(end)?;
        // The sequence numbers begin again after the restart.
        let time = if end == "hang" {
            RESTART
        } else {
            QUICK_RESTART
        };
        let frames = board.run(time)?.into_iter().filter_map(ToHost::frame);
        let sequences: Vec<_> = frames.map(|frame| frame.sequence).collect();
        assert!(
            sequences.first().is_some_and(|first| *first < before),
            "{end}: {sequences:?}"
        );
    }
    Ok(())
}

/// The libraries do not read the first packet of a transfer that is too long for them, and the
/// controller's interrupt is level-triggered.
#[test]
fn a_broken_off_control_transfer_does_not_stop_the_board() -> anyhow::Result<()> {
    let mut board = board()?;
    let largest = board.tell("descriptor")?[7];
    assert_eq!(largest, 64, "the largest packet of the endpoint, bytes");

    let before = board.next_frame()?;
    board.tell("breakOff")?;
    board.run(TICK * TICK_RATE)?;
    let after = board.next_frame()?;
    let frames = after.sequence - before.sequence;
    assert_eq!((after.dropped, after.lost), (0, 0));
    assert!(frames.abs_diff(TICK_RATE) < 4, "{frames}");
    let counts = board.counts()[0];
    assert_eq!((counts.damaged, counts.lost, counts.restarts), (0, 0, 0));

    board.set_port(0)?;
    assert!(board.run(10 * TICK)?.len() < 3);
    board.set_port(BAUD)?;
    board.next_frame().map(drop)
}

/// The library leaves the reset pending, and the controller's interrupt is level-triggered.
#[test]
fn a_reset_of_the_bus_that_lasts_does_not_stop_the_board() -> anyhow::Result<()> {
    let mut board = board()?;
    let before = board.next_frame()?;
    board.heard_by_uart();
    board.tell("resetBus 1")?;
    board.run(TICK * TICK_RATE)?;
    let after = board
        .heard_by_uart()
        .into_iter()
        .rev()
        .find_map(ToHost::frame)
        .context("no frame by the UART")?;
    let steps = after.report.step - before.report.step;
    println!("{} ticks without a frame", after.dropped);
    assert!(steps.abs_diff(TICK_RATE.into()) < 4, "{steps}");
    assert!((1..TICK_RATE / 5).contains(&after.dropped), "{after:?}");

    board.tell("resetBus 0")?;
    let again = board.next_frame()?;
    assert_eq!(again.dropped, after.dropped);
    assert_eq!(board.counts()[0].restarts, 0);
    Ok(())
}

#[test]
fn closing_the_port_starts_the_boot_loader_at_1200_baud_only() -> anyhow::Result<()> {
    let mut board = board()?;
    for (baud, is_it) in [(BAUD, false), (BAUD_OF_BOOT_LOADER, true)] {
        board.set_port(baud)?;
        board.run(10 * TICK)?;
        assert!(!board.is_in_boot_loader(), "it is still open");
        board.set_port(0)?;
        board.run(10 * TICK)?;
        assert_eq!(board.is_in_boot_loader(), is_it, "{baud}");
    }
    Ok(())
}
