// A panel at the chip's I2C0, and the time that its bus takes.

const ADDRESS = 0x3c;
const PAGES = 8;
/** Columns that are seen. */
const WIDTH = 128;
/** Columns of the memory, and the first that is seen; the SH1106 lets its memory be read. */
const KINDS = {
  ssd1306: { columns: 128, left: 0, returnsMemory: false },
  sh1106: { columns: 132, left: 2, returnsMemory: true },
};
const DISPLAY_OFF = 1 << 6;
/** Commands that are followed by so many bytes. */
const ARGUMENTS = { 0x20: 1, 0x81: 1, 0x8d: 1, 0xa8: 1, 0xad: 1, 0xd3: 1, 0xd5: 1, 0xd9: 1, 0xda: 1, 0xdb: 1 };
/** Time of a byte with its acknowledgement, ns: measured on boards with 4.7 kOhm. A ninth of it is a start or a stop. */
const BYTE = 26000;
/** Registers of the bus, and the interrupt that says that few bytes are left to send. */
const [TARGET, INTERRUPT_MASK, ENABLE] = [0x04, 0x30, 0x6c];
const FEW_LEFT = 1 << 4;
/** The state of the bus after its reset (RP2040 data sheet, 4.3.17). */
const AFTER_RESET = {
  state: 0,
  busy: false,
  stop: false,
  pendingRestart: false,
  enable: 0,
  control: 0x65,
  targetAddress: 0x55,
  fsClockHighPeriod: 0x06,
  fsClockLowPeriod: 0x0d,
  spikelen: 0x07,
  rxThreshold: 0,
  txThreshold: 0,
  intRaw: 0,
  intEnable: 0x8ff,
};
/** The device that holds others in reset, and its bit of this bus. */
const [RESETS, HELD] = [0x4000c, 1 << 3];

export class Panel {
  constructor() {
    this.byte = BYTE;
    /** Whether a device holds the clock low, and what waits for it. */
    this.isHeld = false;
    this.stalled = undefined;
    this.plug('ssd1306', 6);
  }

  /** A panel of this kind with these status bits, dark as it is when power comes; no kind is no panel. */
  plug(kind, status) {
    this.kind = KINDS[kind];
    this.status = status;
    this.memory = new Uint8Array((this.kind?.columns ?? 0) * PAGES);
    this.on = false;
    [this.column, this.page] = [0, 0];
    this.reads = 0;
  }

  connect({ i2c, clock, peripherals }) {
    const bus = i2c[0];
    this.addInterrupts(bus);
    this.addReset(bus, peripherals[RESETS]);
    const after = (nanos, act) => {
      const { age } = bus;
      const alarm = clock.createAlarm(() => {
        if (bus.age !== age) return; // a reset has ended the transfer
        if (this.isHeld) {
          this.stalled = () => (act(), bus.level());
          return;
        }
        act();
        bus.level();
      });
      alarm.schedule(nanos);
    };
    bus.onStart = () => after(this.byte / 9, () => bus.completeStart());
    bus.onConnect = (address) => after(this.byte, () => bus.completeConnect(this.begin(address)));
    bus.onWriteByte = (byte) => after(this.byte, () => bus.completeWrite(this.take(byte)));
    bus.onReadByte = () => after(this.byte, () => bus.completeRead(this.read()));
    bus.onStop = () => after(this.byte / 9, () => bus.completeStop());
  }

  /** A device holds the bus's clock low, or lets it go; the transfer waits meanwhile. */
  hold(isHeld) {
    this.isHeld = isHeld;
    if (isHeld) return;
    this.stalled?.();
    this.stalled = undefined;
  }

  /**
   * What the emulated bus lacks: its interrupts can be enabled, and the first of them says that few
   * bytes are left to send. The bus cannot be disabled, nor take an address, during a transfer that
   * does not end (RP2040 data sheet, 4.3.10.3).
   */
  addInterrupts(bus) {
    const write = bus.writeUint32.bind(bus);
    bus.level = () => {
      const few = bus.enable & 1 && bus.txFIFO.itemCount <= bus.txThreshold;
      bus.intRaw = few ? bus.intRaw | FEW_LEFT : bus.intRaw & ~FEW_LEFT;
      bus.checkInterrupts();
    };
    bus.writeUint32 = (offset, value) => {
      const isIgnored = this.stalled && (offset === TARGET || (offset === ENABLE && !(value & 1)));
      if (offset === INTERRUPT_MASK) bus.intEnable = value;
      else if (!isIgnored) write(offset, value);
      bus.level();
    };
  }

  /** What the emulated bus lacks: its reset. */
  addReset(bus, resets) {
    bus.age = 0;
    const write = resets.writeUint32.bind(resets);
    resets.writeUint32 = (offset, value) => {
      write(offset, value);
      if (offset !== 0 || !(value & HELD)) return;
      Object.assign(bus, AFTER_RESET);
      bus.age += 1;
      bus.txFIFO.reset();
      bus.rxFIFO.reset();
      this.stalled = undefined;
      bus.checkInterrupts();
    };
  }

  /** The first byte of a message is a control byte; a read goes on from the last one. */
  begin(address) {
    this.isControl = true;
    this.command = [];
    this.reads = 0;
    return this.kind !== undefined && address === ADDRESS;
  }

  /** A byte of a message; whether it is acknowledged. A control byte with bit 7 is for the one byte after it. */
  take(byte) {
    if (this.isControl) {
      this.control = byte;
      this.isControl = false;
      return this.kind !== undefined;
    }
    if (this.control & 0x40) this.draw(byte);
    else {
      this.command.push(byte);
      if (this.command.length > (ARGUMENTS[this.command[0]] ?? 0)) this.obey(...this.command.splice(0));
    }
    this.isControl = (this.control & 0x80) !== 0;
    return this.kind !== undefined;
  }

  obey(command) {
    if (command === 0xae || command === 0xaf) this.on = command === 0xaf;
    if (command < 0x10) this.column = (this.column & 0xf0) | command;
    else if (command < 0x20) this.column = (this.column & 0x0f) | ((command & 0x0f) << 4);
    if ((command & 0xf8) === 0xb0) this.page = command & 7;
  }

  /** Data goes to the right. */
  draw(byte) {
    if (this.kind) this.memory[this.page * this.kind.columns + this.column++] = byte;
  }

  /** The status; or of a memory that can be read a dummy and the byte at the place. */
  read() {
    if (!this.kind) return 0xff;
    if (!(this.control & 0x40) || !this.kind.returnsMemory) return this.status | (this.on ? 0 : DISPLAY_OFF);
    return this.reads++ === 0 ? 0x55 : this.memory[this.page * this.kind.columns + this.column++];
  }

  shown() {
    if (!this.on) return [];
    const { columns, left } = this.kind;
    return this.memory.filter((_, at) => at % columns >= left && at % columns < left + WIDTH);
  }
}
