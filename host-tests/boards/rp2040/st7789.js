// A colour panel with an ST7789 at an SPI block of the chip, and the time that its bus takes.

const [RESET, SLEEP_OUT, INVERT, ON, COLUMNS, ROWS, WRITE, ADDRESS_MODE] =
  [0x01, 0x11, 0x21, 0x29, 0x2a, 0x2b, 0x2c, 0x36];
/** The bits of the address mode. */
const [MIRROR_Y, MIRROR_X, SWAP] = [0x80, 0x40, 0x20];
/** The address mode in which these panels are mounted. */
const MOUNTED = 0x70;
/** The memory of the controller. */
const [WIDTH, HEIGHT] = [240, 320];
/** Pixels after power comes. */
const NOISE = 0xa55a;
/** The number of words whose time is waited for at once. */
const BATCH = 8;
/** The device that holds others in reset, and its bits of DMA and of both SPI blocks. */
const [RESETS, DMA, SPI] = [0x4000c, 1 << 2, [1 << 16, 1 << 17]];

const WAVESHARE = { spi: 1, dc: 8, cs: 9, reset: 12, light: 13 };
const PIMORONI = { spi: 0, dc: 16, cs: 17, light: 20 };
/** The panels by their names: pins, size, and place in the memory of the controller. */
export const PANELS = {
  'lcd-1.3': { ...WAVESHARE, size: [240, 240], at: [0, 0], keys: [2, 18, 16, 20, 3, 15, 17, 19, 21] },
  'lcd-2': { ...WAVESHARE, size: [320, 240], at: [0, 0], keys: [15, 17, 2, 3] },
  'display-2': { ...PIMORONI, size: [320, 240], at: [0, 0], keys: [12, 13, 14, 15] },
  display: { ...PIMORONI, size: [240, 135], at: [40, 53], keys: [12, 13, 14, 15] },
};

/** Returns the place of a pixel in the memory. */
function place(mode, x, y) {
  let [column, row] = mode & SWAP ? [y, x] : [x, y];
  if (mode & MIRROR_X) column = WIDTH - 1 - column;
  if (mode & MIRROR_Y) row = HEIGHT - 1 - row;
  return row * WIDTH + column;
}

export class St7789 {
  constructor(panel) {
    this.panel = panel;
    this.memory = new Uint16Array(WIDTH * HEIGHT).fill(NOISE);
    this.restart();
  }

  restart() {
    this.window = [0, WIDTH - 1, 0, HEIGHT - 1];
    [this.mode, this.on, this.inverted, this.awake] = [0, false, false, false];
    [this.command, this.args] = [0, []];
  }

  connect(chip) {
    const { clock, gpio, peripherals } = chip;
    this.gpio = gpio;
    const spi = chip.spi[this.panel.spi];
    this.addReset(chip, spi, peripherals[RESETS]);
    // Words are taken at once, and the time of several is waited for together: an alarm for each
    // would make the emulator several times slower.
    let [count, nanos] = [0, 0];
    const done = clock.createAlarm(() => spi.completeTransmit(0));
    spi.onTransmit = (value) => {
      if (!gpio[this.panel.cs].outputValue) this.word(value, spi.dataBits, gpio[this.panel.dc].outputValue);
      nanos += (spi.dataBits * 1e9) / spi.clockFrequency;
      count += 1;
      if (count < BATCH) return spi.completeTransmit(0);
      done.schedule(nanos);
      [count, nanos] = [0, 0];
    };
  }

  /** The reset of the emulated blocks, which the emulator lacks. */
  addReset({ dma }, spi, resets) {
    const write = resets.writeUint32.bind(resets);
    resets.writeUint32 = (offset, value) => {
      write(offset, value);
      if (offset !== 0) return;
      if (value & DMA) dma.channels.forEach((channel) => channel.abort());
      if (!(value & SPI[this.panel.spi])) return;
      [spi.control0, spi.control1, spi.dmaControl, spi.clockDivisor] = [0, 0, 0, 0];
      spi.busy = false;
      spi.txFIFO.reset();
      spi.rxFIFO.reset();
    };
  }

  word(value, bits, isData) {
    if (bits > 8) this.byte(value >> 8, isData);
    this.byte(value & 255, isData);
  }

  byte(byte, isData) {
    if (isData) return this.command === WRITE ? this.pixel(byte) : this.argument(byte);
    [this.command, this.args] = [byte, []];
    if (byte === RESET) this.restart();
    if (byte === SLEEP_OUT) this.awake = true;
    if (byte === ON) this.on = this.awake;
    if (byte === INVERT) this.inverted = true;
    if (byte === WRITE) [this.x, this.y, this.high] = [this.window[0], this.window[2], undefined];
  }

  argument(byte) {
    this.args.push(byte);
    const [a, b, c, d] = this.args;
    if (this.command === ADDRESS_MODE) this.mode = a;
    if (d === undefined) return;
    if (this.command === COLUMNS) this.window.splice(0, 2, (a << 8) | b, (c << 8) | d);
    if (this.command === ROWS) this.window.splice(2, 2, (a << 8) | b, (c << 8) | d);
  }

  pixel(byte) {
    if (this.high === undefined) return (this.high = byte);
    this.memory[place(this.mode, this.x, this.y)] = (this.high << 8) | byte;
    this.high = undefined;
    const [left, right, top, bottom] = this.window;
    this.x += 1;
    if (this.x <= right) return;
    this.x = left;
    this.y = this.y === bottom ? top : this.y + 1;
  }

  /** The colours that are seen, 16 bits each, low byte first; nothing while the panel is dark. */
  shown() {
    const { size: [width, height], at: [left, top], light } = this.panel;
    if (!this.on || !this.gpio[light].outputValue) return [];
    const colours = new Uint16Array(width * height);
    for (let i = 0; i < colours.length; i += 1) {
      const colour = this.memory[place(MOUNTED, (i % width) + left, Math.floor(i / width) + top)];
      // The pixels of these panels are inverted.
      colours[i] = this.inverted ? colour : ~colour;
    }
    return new Uint8Array(colours.buffer);
  }
}
