// A Raspberry Pi Pico that does what it is told, line by line: see `commands`. Each is answered by what has come of it, a line
// each, and at the end by `done`. Its clock stands still in between, so a run is repeatable to the bit.

import { readFileSync, writeSync } from 'node:fs';
import { createInterface } from 'node:readline';
import { Board } from './board.js';

const say = (word, bytes) => writeSync(1, `${word} ${Buffer.from(bytes ?? []).toString('hex')}\n`);
const [, , file, panel] = process.argv;
const board = new Board(readFileSync(file), say, panel);

const commands = {
  /** Lets so many microseconds pass. */
  run: (micros) => board.run(Number(micros)),
  /** Gives the board bytes, over USB or through the UART. */
  usb: (hex) => board.usb.send(Buffer.from(hex, 'hex')),
  /** Opens the port over USB at this speed, or closes it: 0. */
  port: (baud) => board.usb.open(Number(baud)),
  /** The USB host stops reading: 0; or reads again: 1. */
  listen: (is) => board.usb.read(is === '1'),
  /** A long control transfer of the USB host's, which it breaks off after its first packet. */
  breakOff: () => board.usb.breakOff(),
  /** Begins (1) or ends (0) a long reset of the bus. From then on the chip is of its older revision. */
  resetBus: (is) => board.resetBus(is === '1'),
  /** The board's device descriptor, as the USB host has read it; nothing if no board is there. */
  descriptor: () => say('descriptor', board.usb.device),
  uart: (hex) => Buffer.from(hex, 'hex').forEach((byte) => board.chip.uart[0].feedByte(byte)),
  /** The panel's memory, or the colours of a colour panel; nothing while it is off. */
  panel: () => say('panel', (board.lcd ?? board.panel).shown()),
  /** Plugs a panel of this kind with these status bits in, or pulls it: none. */
  plug: (kind, status) => board.panel.plug(kind, Number(status)),
  /** A device holds the clock of the panel's bus low: 1; or lets it go: 0. */
  hold: (is) => board.panel.hold(is === '1'),
  /** The panel's bus: the counts of its low and high clock, cycles, and the number of its resets. */
  i2c: () => {
    const { fsClockLowPeriod, fsClockHighPeriod, age } = board.chip.i2c[0];
    say('i2c', [fsClockLowPeriod, fsClockHighPeriod, age]);
  },
  /** The time of a byte on the panel's bus, ns. */
  bus: (nanos) => (board.panel.byte = Number(nanos)),
  /** A button between this pin and ground: 1 is pressed. */
  button: (pin, is) => board.press(Number(pin), is === '1'),
  /** A circle where the processor is, until the next start. */
  hang: () => board.hang(),
  /** A fault where the processor is. */
  fault: () => board.fault(),
  /** The function where the processor is gets a stack frame that is larger by so many bytes. */
  enlargeFrame: (bytes) => board.enlargeFrame(Number(bytes)),
  /** Resets it: 1 after a download, 0 as a debugger does. */
  reset: (isDownload) => board.reset(isDownload === '1'),
  /** The board's memory, from an address on. */
  read: (address, length) => say('memory', board.memory(address, length)),
  fill: (address, length, byte) => board.memory(address, length).fill(Number(byte)),
};

for await (const line of createInterface({ input: process.stdin })) {
  const [name, ...rest] = line.split(' ');
  commands[name](...rest);
  say('done');
}
