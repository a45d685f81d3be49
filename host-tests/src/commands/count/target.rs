//! A board with the program that measures.

use std::path::PathBuf;

use anyhow::{Result, ensure};

use super::Image;
use crate::emulator::boards::{BOARDS, Board, Core};
use crate::emulator::toolchain::Toolchain;

const PROGRAM: &str = "measure";

/// An emulated board and a program built for it.
#[derive(Debug)]
pub struct Target {
    pub board: &'static Board,
    pub(super) qemu: PathBuf,
    pub(super) elf: PathBuf,
    image: Image,
}

impl Target {
    pub fn build(toolchain: &Toolchain, board: &'static Board) -> Result<Self> {
        Self::of(toolchain, board, toolchain.build(PROGRAM, board.target)?)
    }

    /// Another program. One that takes the same requests makes its steps in a function called `counted_steps`.
    pub fn of(toolchain: &Toolchain, board: &'static Board, elf: PathBuf) -> Result<Self> {
        let image = Image::read(&elf)?;
        Ok(Self { board, qemu: toolchain.qemu().to_owned(), elf, image })
    }

    /// One board for each kind of core: the same machine with a Cortex-M3, a Cortex-M4F and a Cortex-M0+.
    pub fn build_all(toolchain: &Toolchain) -> Result<Vec<Self>> {
        BOARDS.iter().filter(|board| board.has_panel).map(|board| Self::build(toolchain, board)).collect()
    }

    pub fn image(&self) -> &Image {
        &self.image
    }

    pub fn core(&self) -> Core {
        self.board.core()
    }

    /// Refuses a program that is not where the board looks for its vectors: it would never run.
    pub(super) fn check_memory(&self) -> Result<()> {
        let (vectors, board) = (self.board.flash(), self.board.name);
        ensure!(
            self.image.holds(vectors),
            "never called: the program has nothing at {vectors:#x}, where {board} reads its vectors; see --on"
        );
        Ok(())
    }
}
