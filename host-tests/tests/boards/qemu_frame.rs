//! The panel shows both bobs where the streamed state puts them.

use crate::support::{application, settings, toolchain};
use firmware::config::{PIVOT, REACH};
use firmware::protocol::Frame;
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::qemu::{HEIGHT, Lockstep, QemuError, Screenshot, WIDTH};

/// The distance a bob may be off, pixels: it is drawn to a fraction of one, and the pixels that are bright enough to
/// count are whole ones.
const TOLERANCE: f32 = 1.0;
/// Bobs are white; rods, trail and text are not brighter than 11.
const BRIGHT: u8 = 13;
/// White pixels of a bob of radius 3, at least: half of pi 3^2.
const FEWEST: usize = 14;
/// Bobs that overlap have no centres to be found; 2 radii and a soft edge.
const APART: f32 = 8.0;
/// Moments looked at: often enough to see both bobs everywhere.
const EVERY: usize = 15;
const MOMENTS: usize = 30;

#[test]
fn bobs_are_where_the_state_puts_them() -> Result<(), QemuError> {
    BOARDS.iter().filter(|board| board.has_panel).try_for_each(bobs_are_in_place)
}

fn bobs_are_in_place(board: &Board) -> Result<(), QemuError> {
    let (toolchain, elf) = (toolchain(), application(board));
    let mut machine = Lockstep::start(&settings(&toolchain, board, &elf))?;
    let mut looked_at = 0;
    for _ in 0..MOMENTS {
        for _ in 1..EVERY {
            machine.next_frame()?;
        }
        let frame = machine.next_frame()?;
        let expected = bobs(&frame);
        if distance(expected[0], expected[1]) < APART {
            continue;
        }
        let screenshot = machine.screenshot()?;
        for (bob, (found, expected)) in centres(&screenshot, expected).into_iter().zip(expected).enumerate() {
            let error = distance(found, expected);
            assert!(
                error <= TOLERANCE,
                "{}: bob {} of {frame:?} is {error} pixels off\n{screenshot:?}",
                board.name,
                bob + 1
            );
        }
        looked_at += 1;
    }
    assert!(looked_at > MOMENTS / 2, "the bobs overlap most of the time");
    Ok(())
}

/// The centres of the bobs, pixels from the top left corner: both rods are of one length and together reach `REACH`.
fn bobs(frame: &Frame) -> [(f32, f32); 2] {
    let [a1, a2, ..] = frame.state;
    let rod = REACH / 2.0;
    let first = (PIVOT.0 + rod * a1.sin(), PIVOT.1 + rod * a1.cos());
    [first, (first.0 + rod * a2.sin(), first.1 + rod * a2.cos())]
}

/// The means of the white pixels, each of which belongs to the bob that should be nearer.
fn centres(screenshot: &Screenshot, expected: [(f32, f32); 2]) -> [(f32, f32); 2] {
    let white = (0..WIDTH * HEIGHT).filter(|index| screenshot.greys()[*index] >= BRIGHT);
    let points = white.map(|index| ((index % WIDTH) as f32 + 0.5, (index / WIDTH) as f32 + 0.5));
    let (first, second): (Vec<_>, Vec<_>) =
        points.partition(|point| distance(*point, expected[0]) < distance(*point, expected[1]));
    [first, second].map(|points| {
        let count = points.len();
        assert!(count >= FEWEST, "a bob is missing\n{screenshot:?}");
        let sum = points.into_iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0, sum.1 + point.1));
        (sum.0 / count as f32, sum.1 / count as f32)
    })
}

fn distance(a: (f32, f32), b: (f32, f32)) -> f32 {
    (a.0 - b.0).hypot(a.1 - b.1)
}
