// The chip with all that is wired to it, and its restarts.

import { RP2040 } from 'rp2040js';
import { fast } from './fast.js';
import { Panel } from './panel.js';
import { PANELS, St7789 } from './st7789.js';
import { BOOT, addRom } from './rom.js';
import { addTime } from './uart.js';
import { UsbHost } from './usb_host.js';
import { flashed } from './uf2.js';

const FLASH = 0x10000000;
const RAM = 0x20000000;
/** Where the vector table is: behind the 256 bytes that the boot ROM runs first, of which there is none here. */
const VECTORS = FLASH + 0x100;
const BUTTONS = [10, 11, 12, 13, 14];
/** What the watchdog says of a reset of its own, and the register in which the boot ROM says what it wants of such a reset. */
const BY_TIMER = 1;
const WISH = 4;
/** Where the watchdog is, and the device that holds others in their reset; which of these the boot ROM lets go. */
const [WATCHDOG, RESETS] = [0x40058, 0x4000c];
const [ALL, BY_ROM] = [0x1ffffff, (1 << 6) | (1 << 9) | (1 << 21)];
/** The newer revision of the chip, B2, and the older one, B1, whose reset of USB may not end. */
const [CHIP_ID, OLD_CHIP_ID] = [0x20002927, 0x10002927];
/** The number of the exception. */
const HARD_FAULT = 3;
/** The instruction `b .`, a jump to itself, and its cycles. */
const [SELF_JUMP, JUMP_CYCLES] = [0xe7fe, 2];
/** More than the rounding error of a quotient of times, and less than a cycle. */
const ROUNDING = 1e-6;
/** No address of an instruction. */
export const NOWHERE = -1;
/** Registers of the processor that the emulator lacks: reset (bit 2), what protects memory, and whether a debugger is there. */
const [AIRCR, MPU_TYPE, MPU_LAST, DHCSR] = [0xd0c, 0xd90, 0xda0, 0xdf0];

export class Board {
  /** Without the name of a colour panel, the panel is an OLED. */
  constructor(uf2, say, panel) {
    this.lcd = PANELS[panel] && new St7789(PANELS[panel]);
    this.image = flashed(uf2, FLASH);
    this.say = say;
    this.panel = new Panel();
    this.isOld = false;
    this.pressed = new Set();
    this.usb = new UsbHost((bytes) => this.say('usb', bytes));
    this.start();
  }

  /**
   * Starts a new chip, for the emulator's cannot be reset; `before` is the one whose memory it goes on with. The watchdog resets
   * all but its own scratch registers; without it, the processor alone is reset.
   */
  start(before, reason = 0) {
    const chip = new RP2040();
    this.chip = chip;
    chip.logger = { debug() {}, info() {}, warn() {}, error: (from, text) => console.error(`${from}: ${text}`) };
    chip.flash.set(this.image);
    if (before) {
      chip.sram.set(before.sram);
      chip.clock.nanosCounter = before.clock.nanos;
    }
    chip.peripherals[0x40000].readUint32 = (offset) => (offset ? 0 : this.isOld ? OLD_CHIP_ID : CHIP_ID);
    const [watchdog, resets] = [WATCHDOG, RESETS].map((at) => chip.peripherals[at]);
    const [watched, held] = [WATCHDOG, RESETS].map((at) => before?.peripherals[at]);
    if (before) watchdog.scratchData.set(watched.scratchData);
    watchdog.reason = reason || (watched?.reason ?? 0);
    resets.reset = (before && !reason ? held.reset : ALL) & ~BY_ROM;
    watchdog.onWatchdogTrigger = () => {
      watchdog.alarm.enable = false; // or it comes again at once
      this.due = watchdog.reason;
    };
    this.addRegisters(chip.ppb);
    this.shortenWrites(chip);
    this.mendEntry(chip.core);
    this.fast = fast(chip);
    this.isInBootLoader = false;
    addRom(chip);
    chip.onBreak = (code) => code === BOOT && this.enterBootLoader();
    this.panel.connect(chip);
    this.lcd?.connect(chip);
    this.usb.attach(chip, !before || reason !== 0);
    this.sent = [];
    addTime(chip.uart[0], chip.clock, (byte) => this.sent.push(byte));
    const buttons = this.lcd?.panel.keys ?? BUTTONS;
    buttons.forEach((pin) => chip.gpio[pin].setInputValue(!this.pressed.has(pin)));
    this.due = null;
    this.hungAt = NOWHERE;
    this.isLocked = false;
    chip.core.VTOR = VECTORS;
    chip.core.reset();
  }

  /** The emulator begins an interrupt at an odd address, from which jump tables are misread. */
  mendEntry(core) {
    const enter = core.exceptionEntry.bind(core);
    core.exceptionEntry = (number) => {
      enter(number);
      core.PC &= ~1;
    };
  }

  /** The emulator looks for a peripheral before it writes to memory. That takes longer than the write. */
  shortenWrites(chip) {
    const write = chip.writeUint32.bind(chip);
    const { sramView } = chip;
    const last = chip.sram.length - 4;
    chip.writeUint32 = (address, value) => {
      const offset = (address >>> 0) - RAM;
      if (offset >= 0 && offset <= last) sramView.setUint32(offset, value, true);
      else write(address, value);
    };
  }

  addRegisters(ppb) {
    const [read, write] = [ppb.readUint32.bind(ppb), ppb.writeUint32.bind(ppb)];
    const isAdded = (offset) => offset === AIRCR || offset === DHCSR || (offset >= MPU_TYPE && offset <= MPU_LAST);
    ppb.readUint32 = (offset) => (isAdded(offset) ? 0 : read(offset));
    ppb.writeUint32 = (offset, value) => {
      if (!isAdded(offset)) write(offset, value);
      else if (offset === AIRCR && value & 4) this.due = 0;
    };
  }

  run(micros) {
    const end = this.chip.clock.nanos + 1000 * micros;
    while (this.chip.clock.nanos < end) {
      const { core, clock, clkSys } = this.chip;
      const cycle = 1e9 / clkSys;
      while (clock.nanos < end && this.due === null) {
        if (this.isInBootLoader) clock.tick(end - clock.nanos);
        else if (this.isLocked) clock.tick(Math.max(1, Math.min(clock.nanosToNextAlarm, end - clock.nanos)));
        else if (!core.waiting) {
          this.skipJumps(end, cycle);
          this.execute(end, cycle);
        }
        else if (core.checkForInterrupts()) core.waiting = false;
        else clock.tick(Math.max(1, Math.min(clock.nanosToNextAlarm, end - clock.nanos)));
        if (this.chip.clkSys !== clkSys) break;
      }
      if (this.due !== null) this.restart();
    }
    this.tell();
  }

  /**
   * Advances the time of a board that hangs to shortly before the next event. Nothing else changes
   * until then, so this has the result of millions of jumps. The sum of their times is exact if a
   * cycle is a whole number of nanoseconds.
   */
  skipJumps(end, cycle) {
    const { core, clock } = this.chip;
    if (core.PC !== this.hungAt || core.interruptsUpdated || !Number.isInteger(cycle)) return;
    const next = Math.min(end, clock.nextAlarm?.nanos ?? end);
    const jumps = Math.floor((next - clock.nanos) / (JUMP_CYCLES * cycle)) - 1;
    if (jumps <= 0) return;
    core.cycles += JUMP_CYCLES * jumps;
    clock.nanosCounter += JUMP_CYCLES * jumps * cycle;
  }

  /** Executes instructions up to an event: an alarm, the end, a sleep, a restart, a hang, another clock. */
  execute(end, cycle) {
    const { chip, hungAt } = this;
    const { core, clock, clkSys } = chip;
    // Sums of times are exact if a cycle is a whole number of nanoseconds. Their difference is not.
    const isWhole = Number.isInteger(cycle);
    do {
      const until = Math.min(clock.nextAlarm?.nanos ?? end, end);
      const left = (until - clock.nanosCounter) / cycle;
      const cycles = isWhole ? this.fast(Math.ceil(left - ROUNDING)) : 0;
      const time = (cycles || core.executeInstruction()) * cycle;
      if (!cycles) this.isLocked = this.hasOverflowed();
      const now = clock.nanosCounter + time;
      const alarm = clock.nextAlarm;
      if (alarm !== null && alarm.nanos <= now) return clock.tick(time);
      clock.nanosCounter = now;
    } while (
      clock.nanosCounter < end &&
      !core.waiting &&
      this.due === null &&
      chip.clkSys === clkSys &&
      !this.isInBootLoader &&
      !this.isLocked &&
      core.PC !== hungAt
    );
  }

  /**
   * Returns true if the stack has left memory. The chip refuses such an access, and then the registers that go onto the stack on
   * the way to the handler of that fault. An M0+ locks up; only a reset ends that. The emulator would go on.
   */
  hasOverflowed() {
    const { core, sram } = this.chip;
    return (core.SP >>> 0) - RAM < 0 || (core.SP >>> 0) - RAM > sram.length;
  }

  /** Makes the stack frame of the present function larger by so many bytes. */
  enlargeFrame(bytes) {
    this.chip.core.SP -= bytes;
  }

  restart() {
    this.tell();
    this.say('restarted', [this.due]);
    this.start(this.chip, this.due);
  }

  /** Passes on what the UART has sent, and the log, as a debug probe does: out of the ring that the chip writes it into. */
  tell() {
    if (this.sent.length) this.say('uart', this.sent.splice(0));
    const { sram, sramView } = this.chip;
    const ring = Buffer.from(sram.buffer).indexOf('SEGGER RTT') + 24;
    if (ring < 24) return;
    const word = (index) => sramView.getUint32(ring + 4 * index, true);
    const [start, size, written, read] = [word(1) - RAM, word(2), word(3), word(4)];
    if (written === read) return;
    const parts = written > read ? [[read, written]] : [[read, size], [0, written]];
    this.say('log', Buffer.concat(parts.map(([from, to]) => sram.subarray(start + from, start + to))));
    sramView.setUint32(ring + 16, written, true);
  }

  /**
   * Begins (true) or ends (false) a long reset of the bus, as by a hub without a host. The chip is
   * then of the older revision.
   */
  resetBus(is) {
    this.isOld = true;
    this.usb.reset(is);
  }

  press(pin, is) {
    this.pressed[is ? 'add' : 'delete'](pin);
    this.chip.gpio[pin].setInputValue(!is);
  }

  /** A reset by a debugger, or by the boot ROM after a download. */
  reset(isDownload) {
    this.due = isDownload ? BY_TIMER : 0;
    if (isDownload) this.chip.peripherals[WATCHDOG].scratchData[WISH] = 0;
    this.restart();
  }

  /** The program has ended; a drive takes the place of its port. */
  enterBootLoader() {
    this.isInBootLoader = true;
    this.usb.pull(false);
    this.say('bootloader');
  }

  /** A fault where the processor is. */
  fault() {
    this.chip.core.exceptionEntry(HARD_FAULT);
  }

  hang() {
    this.hungAt = (this.chip.core.PC & ~1) >>> 0;
    this.chip.writeUint16(this.hungAt, SELF_JUMP);
  }

  memory(address, length) {
    const from = Number(address) - RAM;
    return this.chip.sram.subarray(from, from + Number(length));
  }
}
