// Compares the faster instructions of `fast.js` with the emulator's own:
//
//     node compare.js FIRMWARE.uf2 INSTRUCTIONS
//
// The first difference ends it with an error. Without one, it prints the numbers of instructions.

import { readFileSync } from 'node:fs';
import { RP2040 } from 'rp2040js';
import { Board, NOWHERE } from './board.js';
import { fast } from './fast.js';

/** The microseconds between two comparisons of a run: in its first hundredth, and later. */
const [FIRST_SLICE, SLICE] = [10, 1000];
/** The microseconds after each event, and of a hang. */
const [EVENT, HANG] = [20_000, 50_000];
/** The restarts by the fault and by the reset. */
const RESTARTS = 2;
/** The pin of a button. */
const BUTTON = 10;
/** The share of the firmware's instructions that the emulator may execute itself. */
const LEFT = 0.01;

/** The address of the single instructions, and places in memory and in flash that they access. */
const [PLACE, MEMORY, MEMORY_END, FLASH] = [0x20000100, 0x20001000, 0x20042000, 0x10000200];
/** The number of times that each opcode is executed, with other registers. */
const TIMES = 8;
/**
 * The smallest number of opcodes that must be fast, of all that are no first half of two. The
 * others are breakpoints, waits and the like, and those that use the program counter.
 */
const FAST_OPCODES = 52_000;
/** The link register of a handler. */
const EXCEPTION_RETURN = 0xfffffff9;
/** The opcodes from here on are the first half of two; BL begins with one of those in `BL`. */
const WIDE = 0xe800;
const [BL, SECONDS] = [[0xf000, 0xf3ff, 0xf400, 0xf7ff], [0xd000, 0xf800, 0xffff, 0x8f5f, 0xc000]];

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

/** A board that counts the instructions that the emulator executes, also after a restart. */
class Counting extends Board {
  start(...reason) {
    super.start(...reason);
    this.left ??= 0;
    if (this.isPlain) this.fast = () => 0;
    const { core } = this.chip;
    const { executeInstruction } = core;
    core.executeInstruction = () => {
      this.left += 1;
      return executeInstruction.call(core);
    };
  }
}

/** A board on which the emulator executes all instructions, also each jump of a hang. */
class Plain extends Counting {
  get isPlain() {
    return true;
  }

  hang() {
    super.hang();
    this.hungAt = NOWHERE;
  }
}

/**
 * Runs two boards from the start, through events, a hang and restarts. Everything that they send,
 * and at the end all memory, must be the same.
 */
function run() {
  const sent = [[], []];
  const image = readFileSync(file);
  const quick = new Counting(image, (...said) => sent[0].push(said));
  const plain = new Plain(image, (...said) => sent[1].push(said));
  const both = (act) => [quick, plain].forEach(act);

  const step = (micros) => {
    both((board) => board.run(micros));
    compare(quick.chip.core, plain.chip.core, `after ${plain.left} instructions`);
    if (quick.chip.clock.nanos !== plain.chip.clock.nanos) throw new Error('the clocks differ');
  };
  while (plain.left < instructions) step(plain.left < instructions / 100 ? FIRST_SLICE : SLICE);
  const [left, all] = [quick.left, plain.left];
  if (left > LEFT * all) throw new Error(`${left} of ${all} instructions are not fast`);

  const events = [
    (board) => board.press(BUTTON, true),
    (board) => board.press(BUTTON, false),
    (board) => board.usb.send(Buffer.from([0, 1, 2, 0, 255])),
    (board) => board.chip.uart[0].feedByte(0),
    (board) => {
      // A processor that waits has no fault.
      while (board.chip.core.waiting) board.run(FIRST_SLICE);
      board.fault();
    },
    (board) => board.reset(false),
  ];
  for (const event of events) {
    both(event);
    step(EVENT);
  }
  both((board) => board.hang());
  step(HANG);

  if (Buffer.compare(quick.chip.sram, plain.chip.sram)) throw new Error('the memories differ');
  if (JSON.stringify(sent[0]) !== JSON.stringify(sent[1])) throw new Error('they sent differently');
  const restarts = sent[0].filter(([word]) => word === 'restarted').length;
  if (restarts !== RESTARTS) throw new Error(`${restarts} restarts`);
  return all;
}

/** Executes every opcode on two chips from random registers; the results must be the same. */
function single() {
  const [quick, plain] = [new RP2040(), new RP2040()];
  const step = fast(quick);
  let state = 1;
  const random = (most) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * most);
  };
  // A number of all bits, a small one, or an address, mostly of a whole word.
  const kinds = [
    () => random(2 ** 32),
    () => random(64),
    () => MEMORY + 4 * random(64),
    () => MEMORY + random(256),
    () => MEMORY_END - 4 * random(8),
    () => FLASH + 4 * random(64),
  ];
  for (const chip of [quick, plain]) {
    chip.logger = { debug() {}, info() {}, warn() {}, error() {} };
    for (let i = 0; i < 1024; i += 1) chip.flash[i] = i * 167;
  }

  /** Executes an instruction on both, and returns whether it is fast. */
  const execute = (first, second) => {
    for (let i = 0; i < 13; i += 1) plain.core.registers[i] = kinds[random(kinds.length)]();
    plain.core.SP = kinds[2 + 2 * random(2)]();
    plain.core.LR = random(2) ? EXCEPTION_RETURN : random(2 ** 32);
    [plain.core.PC, plain.core.APSR] = [PLACE, random(2 ** 32)];
    plain.core.currentMode = random(2); // thread or handler
    quick.core.registers.set(plain.core.registers);
    [quick.core.APSR, quick.core.currentMode] = [plain.core.APSR, plain.core.currentMode];
    for (const chip of [quick, plain]) {
      chip.writeUint16(PLACE, first);
      chip.writeUint16(PLACE + 2, second);
      chip.core.interruptsUpdated = false;
    }

    const cycles = step(1);
    if (cycles === 0) return false;
    const place = `${first.toString(16)} ${second.toString(16)}`;
    if (plain.core.executeInstruction() !== cycles) throw new Error(`${place}: ${cycles} cycles`);
    compare(quick.core, plain.core, place);
    return true;
  };

  let [executed, opcodes] = [0, 0];
  for (let opcode = 0; opcode < WIDE; opcode += 1) {
    let times = 0;
    for (let i = 0; i < TIMES; i += 1) times += execute(opcode, 0);
    executed += times;
    opcodes += times > 0;
  }
  if (opcodes < FAST_OPCODES) throw new Error(`only ${opcodes} opcodes are fast`);
  const calls = BL.flatMap((first) => SECONDS.map((second) => execute(first, second)));
  executed += calls.filter((is) => is).length;
  if (Buffer.compare(quick.sram, plain.sram)) throw new Error('the memories differ');
  return executed;
}

console.log(`${run()} instructions of the firmware and ${single()} single ones are the same`);
