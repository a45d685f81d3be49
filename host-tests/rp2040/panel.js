// An SSD1306 or SH1106 at the chip's I2C0, and the time that its bus takes.

const ADDRESS = 0x3c;
/** Columns that are seen, and those of the memory, of which the SH1106 has two more on either side; its status. */
const [WIDTH, COLUMNS, SH1106] = [128, 132, 8];
/** Commands that are followed by so many bytes. */
const ARGUMENTS = { 0x20: 1, 0x81: 1, 0x8d: 1, 0xa8: 1, 0xad: 1, 0xd3: 1, 0xd5: 1, 0xd9: 1, 0xda: 1, 0xdb: 1 };
/** At 400,000 bits a second: a byte with its acknowledgement, and a start or a stop. */
const [BYTE, CONDITION] = [22500, 2500];
const [INTERRUPT_MASK, FEW_LEFT] = [0x30, 1 << 4];

export class Panel {
  constructor() {
    this.plug(6);
  }

  /** A panel of this status, dark as it is when power comes; 0 is none. */
  plug(status) {
    this.status = status;
    this.memory = new Uint8Array(COLUMNS * 8);
    this.on = false;
    [this.column, this.page] = [0, 0];
  }

  connect({ i2c, clock }) {
    const bus = i2c[0];
    this.addInterrupts(bus);
    const after = (nanos, act) => {
      const alarm = clock.createAlarm(() => {
        act();
        bus.level();
      });
      alarm.schedule(nanos);
    };
    bus.onStart = () => after(CONDITION, () => bus.completeStart());
    bus.onConnect = (address) => after(BYTE, () => bus.completeConnect(this.begin(address)));
    bus.onWriteByte = (byte) => after(BYTE, () => bus.completeWrite(this.take(byte)));
    bus.onReadByte = () => after(BYTE, () => bus.completeRead(this.status | (this.on ? 0 : 1 << 6)));
    bus.onStop = () => after(CONDITION, () => bus.completeStop());
  }

  /** What the emulated bus lacks: its interrupts can be let through, and the first of them says that few bytes are left to send. */
  addInterrupts(bus) {
    const write = bus.writeUint32.bind(bus);
    bus.level = () => {
      const few = bus.enable & 1 && bus.txFIFO.itemCount <= bus.txThreshold;
      bus.intRaw = few ? bus.intRaw | FEW_LEFT : bus.intRaw & ~FEW_LEFT;
      bus.checkInterrupts();
    };
    bus.writeUint32 = (offset, value) => {
      if (offset === INTERRUPT_MASK) bus.intEnable = value;
      else write(offset, value);
      bus.level();
    };
  }

  begin(address) {
    this.kind = null;
    this.command = [];
    return this.status !== 0 && address === ADDRESS;
  }

  /** A byte of a message; whether it is acknowledged. */
  take(byte) {
    if (this.kind === null) this.kind = byte;
    else if (this.kind === 0x40) this.draw(byte);
    else {
      this.command.push(byte);
      if (this.command.length > (ARGUMENTS[this.command[0]] ?? 0)) this.obey(...this.command.splice(0));
    }
    return this.status !== 0;
  }

  obey(command) {
    if (command === 0xae || command === 0xaf) this.on = command === 0xaf;
    if (command < 0x10) this.column = (this.column & 0xf0) | command;
    else if (command < 0x20) this.column = (this.column & 0x0f) | ((command & 0x0f) << 4);
    if ((command & 0xf8) === 0xb0) this.page = command & 7;
  }

  /** Data goes to the right. */
  draw(byte) {
    this.memory[this.page * COLUMNS + this.column++] = byte;
  }

  shown() {
    const left = this.status === SH1106 ? 2 : 0;
    return this.on ? this.memory.filter((_, at) => at % COLUMNS >= left && at % COLUMNS < left + WIDTH) : [];
  }
}
