// Compares the faster `executeInstruction` of `dispatch.js` with the emulator's own:
//
//     node compare.js FIRMWARE.uf2 INSTRUCTIONS
//
// The first difference ends it with an error. Without one, it prints the number of instructions.

import { readFileSync } from 'node:fs';
import { Board, NOWHERE } from './board.js';
import { withTable } from './dispatch.js';

/** The microseconds between two comparisons of a run. */
const SLICE = 10;
/** Second halfwords: of BL, DMB, DSB, ISB, MRS, MSR, UDF, and of no instruction. */
const SECONDS = [0xf800, 0xd000, 0x8f5f, 0x8f4f, 0x8f6f, 0x8010, 0x8809, 0xa000, 0x8ff0, 0xc000];
/** The microseconds of a hang. */
const HANG = 50_000;
/** The address of the single instructions, in memory. */
const PLACE = 0x20000100;

const [file, instructions] = process.argv.slice(2);

/** Throws an error if two processors differ in a register, a flag, a count or another number. */
function compare(fast, plain, place) {
  for (const name of Object.keys(plain)) {
    const [one, other] = [fast[name], plain[name]];
    const isNumber = typeof other === 'number' || typeof other === 'boolean';
    if (isNumber && one !== other) throw new Error(`${place}: ${name} is ${one}, not ${other}`);
  }
  for (const [index, other] of plain.registers.entries()) {
    const one = fast.registers[index];
    if (one !== other) throw new Error(`${place}: r${index} is ${one}, not ${other}`);
  }
}

/** Runs two boards from the start; all memory and everything that they send must be the same. */
function run() {
  const sent = [[], []];
  const image = readFileSync(file);
  const [fast, plain] = sent.map((list) => new Board(image, (...said) => list.push(said)));

  // Without its own function, the processor has that of its class.
  const { core } = plain.chip;
  const { executeInstruction } = Object.getPrototypeOf(core);
  let executed = 0;
  core.executeInstruction = () => {
    executed += 1;
    return executeInstruction.call(core);
  };
  if (fast.chip.core.executeInstruction === executeInstruction) throw new Error('it is not faster');

  const both = (micros) => {
    [fast, plain].forEach((board) => board.run(micros));
    compare(fast.chip.core, core, `after ${executed} instructions`);
    if (fast.chip.clock.nanos !== plain.chip.clock.nanos) throw new Error('the clocks differ');
  };
  while (executed < instructions) both(SLICE);

  // A hang, in which the plain board executes every jump.
  [fast, plain].forEach((board) => board.hang());
  plain.hungAt = NOWHERE;
  both(HANG);
  if (Buffer.compare(fast.chip.sram, plain.chip.sram)) throw new Error('the memories differ');
  if (JSON.stringify(sent[0]) !== JSON.stringify(sent[1])) throw new Error('they sent differently');
  return executed;
}

/** Executes every opcode once, from random registers; all accesses to memory must be the same. */
function single() {
  const { core } = new Board(readFileSync(file), () => {}).chip;
  const Core = core.constructor;
  let state = 1;
  const random = () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0);

  // A memory that records accesses. The first halfwords that are read are the instruction.
  let [halves, accesses] = [[], []];
  const note = (name) => (...values) => void accesses.push(name, ...values);
  const memory = {
    readUint32: (address) => (accesses.push('word', address), Math.imul(address, 0x9e3779b1) >>> 0),
    readUint16: (address) => (accesses.push('half', address), halves.shift() ?? address & 0xffff),
    readUint8: (address) => (accesses.push('byte', address), address & 0xff),
    logger: { info: note('info'), warn: note('warn') },
    onBreak: note('break'),
  };
  for (const name of ['writeUint32', 'writeUint16', 'writeUint8']) memory[name] = note(name);
  const plain = new Core(memory);
  const fast = new Core(memory);
  fast.executeInstruction = withTable(plain.executeInstruction);

  let executed = 0;
  const execute = (...instruction) => {
    plain.registers.forEach((_, index) => (plain.registers[index] = random()));
    plain.PC = PLACE;
    plain.APSR = random();
    fast.registers.set(plain.registers);
    fast.APSR = plain.APSR;

    const [ours, own] = [fast, plain].map((core) => {
      [halves, accesses] = [[...instruction], []];
      const cycles = core.executeInstruction();
      return [cycles, ...accesses].join();
    });
    const place = instruction.map((half) => half.toString(16)).join(' ');
    compare(fast, plain, place);
    if (ours !== own) throw new Error(`${place}: ${ours} instead of ${own}`);
    executed += 1;
  };
  for (let opcode = 0; opcode < 1 << 16; opcode += 1) {
    if (opcode < 0xe800) execute(opcode);
    else SECONDS.forEach((second) => execute(opcode, second));
  }
  return executed;
}

console.log(`${run()} instructions of the firmware and ${single()} single ones are the same`);
