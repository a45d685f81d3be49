//! Where the instructions and cycles of the counted function go.

use std::collections::{BTreeMap, BTreeSet};

use firmware::measure::Request;

use super::image::{Function, Image};
use super::instruction::Instruction;
use super::pipeline::{Cost, Pipeline};
use super::trace::Registers;
use super::{COUNTED, CountError, Target};

/// An instruction of the program and what all its executions together cost.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// The instruction.
    pub instruction: Instruction,
    /// How often it was executed and what that cost.
    pub cost: Cost,
}

/// What one run of the counted function executed.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    spots: BTreeMap<u32, Spot>,
    stack_bytes: u32,
}

impl Profile {
    /// Runs `request` on `target` and profiles the counted function, all calls of it together.
    pub fn of(target: &Target, request: &Request) -> Result<Self, CountError> {
        let image = target.image();
        let entries: BTreeSet<_> = image.functions_named(COUNTED).map(|function| function.address).collect();
        let mut profile = Self::default();
        let mut call: Option<Call> = None;
        target.trace(request, |registers| {
            match &mut call {
                Some(running) => {
                    profile.execute(running, registers.pc)?;
                    profile.stack_bytes = profile.stack_bytes.max(running.caller.sp.saturating_sub(registers.sp));
                    if running.has_returned(registers) {
                        call = None;
                    } else {
                        running.next = (registers.pc, image.instruction_at(registers.pc)?);
                    }
                }
                None if entries.contains(&registers.pc) => {
                    let first = (registers.pc, image.instruction_at(registers.pc)?);
                    call = Some(Call { caller: registers, next: first, pipeline: Pipeline::new(target.core()) });
                }
                None => {}
            }
            Ok(())
        })?;
        if profile.spots.is_empty() { Err(CountError::NotReached) } else { Ok(profile) }
    }

    /// The pending instruction of `call` has been executed and led to `pc`.
    fn execute(&mut self, call: &mut Call, pc: u32) -> Result<(), CountError> {
        let (address, instruction) = call.next;
        let branches = pc != address + instruction.size();
        let cost = call.pipeline.execute(instruction, branches);
        let spot = self.spots.entry(address).or_insert(Spot { instruction, cost: Cost::default() });
        spot.cost += cost;
        Ok(())
    }

    /// The cost of it all.
    pub fn cost(&self) -> Cost {
        let mut total = Cost::default();
        self.spots.values().for_each(|spot| total += spot.cost);
        total
    }

    /// Every instruction executed, by address.
    pub fn spots(&self) -> impl Iterator<Item = (u32, &Spot)> {
        self.spots.iter().map(|(address, spot)| (*address, spot))
    }

    /// The functions entered.
    pub fn functions<'a>(&self, image: &'a Image) -> impl Iterator<Item = &'a Function> {
        let functions: BTreeSet<_> = self.spots.keys().filter_map(|&address| image.function_at(address)).collect();
        functions.into_iter()
    }

    /// Bytes of the distinct instructions executed.
    pub fn hot_bytes(&self) -> u32 {
        self.spots.values().map(|spot| spot.instruction.size()).sum()
    }

    /// The deepest the stack pointer went below where the caller had it.
    pub fn stack_bytes(&self) -> u32 {
        self.stack_bytes
    }
}

/// A call of the counted function that is going on.
struct Call {
    /// The registers at its entry.
    caller: Registers,
    /// The instruction about to be executed.
    next: (u32, Instruction),
    pipeline: Pipeline,
}

impl Call {
    fn has_returned(&self, registers: Registers) -> bool {
        registers.pc == self.caller.lr & !1 && registers.sp == self.caller.sp
    }
}
