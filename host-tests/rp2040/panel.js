// An SSD1306 at the chip's I2C0, and the time that its bus takes.

const ADDRESS = 0x3c;
const WIDTH = 128;
/** Commands that are followed by so many bytes. */
const ARGUMENTS = { 0x20: 1, 0x21: 2, 0x22: 2, 0x81: 1, 0x8d: 1, 0xa8: 1, 0xd3: 1, 0xd5: 1, 0xd9: 1, 0xda: 1, 0xdb: 1 };
/** At 400,000 bits a second: a byte with its acknowledgement, and a start or a stop. */
const [BYTE, CONDITION] = [22500, 2500];
const [INTERRUPT_MASK, FEW_LEFT] = [0x30, 1 << 4];

export class Panel {
  constructor() {
    this.memory = new Uint8Array(WIDTH * 8);
    this.present = true;
    this.on = false;
    this.columns = [0, WIDTH - 1];
    this.pages = [0, 7];
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
    return this.present && address === ADDRESS;
  }

  /** A byte of a message; whether it is acknowledged. */
  take(byte) {
    if (this.kind === null) this.kind = byte;
    else if (this.kind === 0x40) this.draw(byte);
    else {
      this.command.push(byte);
      if (this.command.length > (ARGUMENTS[this.command[0]] ?? 0)) this.obey(...this.command.splice(0));
    }
    return this.present;
  }

  obey(command, first, last) {
    if (command === 0xae || command === 0xaf) this.on = command === 0xaf;
    if (command === 0x21) [this.columns, this.column] = [[first, last], first];
    if (command === 0x22) [this.pages, this.page] = [[first, last], first];
  }

  /** Data goes to the right, then to the next page of the window. */
  draw(byte) {
    this.memory[this.page * WIDTH + this.column] = byte;
    if (this.column++ < this.columns[1]) return;
    this.column = this.columns[0];
    this.page = this.page < this.pages[1] ? this.page + 1 : this.pages[0];
  }

  shown() {
    return this.on ? this.memory : [];
  }
}
