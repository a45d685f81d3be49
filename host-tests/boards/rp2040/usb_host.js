// A computer at the board's USB socket: sees the board come and go, enumerates it and opens its
// serial port.

const [IN, STANDARD, CLASS] = [0x80, 0x00, 0x21];
const [DEVICE, CONFIGURATION, ENDPOINT] = [1, 2, 5];
const [SET_ADDRESS, GET_DESCRIPTOR, SET_CONFIGURATION] = [5, 6, 9];
const [SET_LINE_CODING, SET_CONTROL_LINE_STATE] = [0x20, 0x22];
/** The lines DTR and RTS, which say that a program has the port open. */
const OPEN = 3;
/** As a terminal program sets the port: 460,800 bits a second. */
const BAUD = 460_800;
/** Where the controller's pull-up is switched, and by which bit. */
const [SIE_CTRL, PULL_UP] = [0x4c, 1 << 16];
/** The controller's status: a reset of the bus, a connection, and the levels of the lines, which are low in a reset or idle. */
const [BUS_RESET, CONNECTED, LINES, IDLE] = [1 << 19, 1 << 16, 3 << 2, 1 << 2];
/** The device that holds the controller in reset, and its bit. */
const [RESETS, HELD] = [0x4000c, 1 << 24];
/**
 * A shorter absence goes unnoticed, nanoseconds: hubs report a change when they are asked, every
 * few milliseconds.
 */
const NOTICED = 10e6;
/** So long the board must be there before it is reset (USB 2.0, 7.1.7.3: at least 100 ms). */
const DEBOUNCE = 100e6;
/** A control transfer that is longer than the board has room for, and its first packet. */
const [TOO_LONG, PACKET] = [200, 64];
/** Where the words about the buffers of the endpoints are. */
const BUFFERS = 0x80;

export class UsbHost {
  constructor(received) {
    this.received = received;
    this.waiting = [];
    /** The speed at which a program has the port open; 0 is closed. */
    this.baud = BAUD;
    /** When the pull-up was switched off; null while it is on. */
    this.absentSince = -Infinity;
    /** Whether the host fetches what the board has sent. */
    this.isReading = true;
    this.forget();
  }

  /** The board is gone, or begins anew. */
  forget() {
    /** The numbers of the endpoints that bytes come from and go to. */
    this.ends = {};
    this.wants = new Set();
    this.requests = [];
    this.request = undefined;
    this.isConfigured = false;
    this.device = [];
    this.unread = undefined;
  }

  /**
   * The socket is that of this chip: a new one, or the same after a reset. A reset of the processor
   * alone leaves the pull-up as it was.
   */
  attach(chip, isWholeReset) {
    const { usbCtrl: usb, clock } = chip;
    [this.usb, this.clock] = [usb, clock];
    this.forget();
    if (isWholeReset) this.pull(false);
    /** The next request comes when the last has wholly arrived. */
    this.later = clock.createAlarm(() => this.next());
    this.seen = clock.createAlarm(() => usb.resetDevice());
    const resets = chip.peripherals[RESETS];
    const [control, hold] = [usb.writeUint32.bind(usb), resets.writeUint32.bind(resets)];
    usb.writeUint32 = (offset, value) => {
      control(offset, value);
      if (offset === SIE_CTRL) this.pull((value & PULL_UP) !== 0);
    };
    resets.writeUint32 = (offset, value) => {
      hold(offset, value);
      if (offset === 0 && value & HELD) this.pull(false);
    };
    usb.onUSBEnabled = () => {};
    usb.onResetReceived = () => this.enumerate();
    usb.onEndpointRead = (end) => this.wanted(end);
    usb.onEndpointWrite = (end, bytes) => this.given(end, bytes);
    const fetch = usb.DPRAMUpdated.bind(usb);
    usb.DPRAMUpdated = (offset, value) => {
      const isUnread = !this.isReading && offset === BUFFERS + 8 * this.ends.in;
      if (isUnread) this.unread = () => fetch(offset, value);
      else fetch(offset, value);
    };
  }

  /**
   * The board's pull-up is on or off. A board that was not away for long enough is taken for the
   * one that the host knows, which has an address.
   */
  pull(isOn) {
    const isPresent = this.absentSince === null;
    if (isOn === isPresent) return;
    const now = this.clock.nanos;
    if (!isOn) {
      this.absentSince = now;
      this.seen?.cancel();
      this.forget();
      return;
    }
    const absence = now - this.absentSince;
    this.absentSince = null;
    if (absence < NOTICED) return;
    this.waiting = []; // what was for the port that is gone
    this.seen.schedule(DEBOUNCE);
  }

  /** Holds both lines low, or lets them go. The emulator's own resets end at once. */
  reset(is) {
    if (is) this.forget();
    this.usb.sieStatus &= ~(CONNECTED | LINES);
    this.usb.sieStatus |= is ? BUS_RESET : IDLE;
    this.usb.sieStatusUpdated();
  }

  enumerate() {
    this.forget();
    this.ask(
      [IN, GET_DESCRIPTOR, DEVICE << 8, 0, 18],
      [STANDARD, SET_ADDRESS, 1, 0, 0],
      [IN, GET_DESCRIPTOR, CONFIGURATION << 8, 0, 255],
      [STANDARD, SET_CONFIGURATION, 1, 0, 0],
    );
  }

  /** A program opens the port at this speed, or closes it: 0. The speed stays when it is closed. */
  open(baud) {
    this.baud = baud;
    if (this.isConfigured) this.ask(...this.opening());
  }

  opening() {
    if (!this.baud) return [[CLASS, SET_CONTROL_LINE_STATE, 0, 0, 0]];
    const { baud } = this;
    const line = [baud & 255, (baud >> 8) & 255, (baud >> 16) & 255, baud >>> 24, 0, 0, 8];
    return [
      [CLASS, SET_LINE_CODING, 0, 0, line.length, line],
      [CLASS, SET_CONTROL_LINE_STATE, OPEN, 0, 0],
    ];
  }

  /** Stops fetching what the board sends, or fetches it again. */
  read(is) {
    this.isReading = is;
    if (!is) return;
    this.unread?.();
    this.unread = undefined;
  }

  /** A transfer that the host breaks off. */
  breakOff() {
    this.ask([CLASS, 0, 0, 0, TOO_LONG, Array(PACKET).fill(0)]);
  }

  ask(...requests) {
    this.requests.push(...requests);
    if (!this.request) this.next();
  }

  next() {
    this.request = this.requests.shift();
    this.data = [];
    if (!this.request) return this.flush();
    const [type, request, value, index, length] = this.request;
    this.wants.delete(0);
    this.usb.sendSetupPacket(
      new Uint8Array([type, request, value & 255, value >> 8, index & 255, index >> 8, length & 255, length >> 8]));
  }

  /** The board is ready to take bytes. */
  wanted(end) {
    this.wants.add(end);
    const [type, , , , length, bytes] = this.request ?? [IN];
    if (end === 0 && type === CLASS && length) {
      this.usb.endpointReadDone(0, new Uint8Array(bytes));
      if (bytes.length < length) this.request = undefined; // broken off
    }
    if (end === this.ends.out) this.flush();
  }

  /** The board has sent bytes. */
  given(end, bytes) {
    if (end === this.ends.in) return this.received(bytes);
    if (end !== 0 || !this.request) return;
    const [type, request, value, , length] = this.request;
    this.data.push(...bytes);
    if (type === IN) {
      if (value >> 8 === DEVICE) this.packet = this.data[7];
      if (bytes.length === this.packet && this.data.length < length) return;
      if (value >> 8 === DEVICE) this.device = this.data;
      if (value >> 8 === CONFIGURATION) this.learn();
      this.usb.endpointReadDone(0, new Uint8Array(0));
    }
    if (type === STANDARD && request === SET_CONFIGURATION) {
      this.isConfigured = true;
      if (this.baud) this.requests.push(...this.opening());
    }
    this.later.schedule(50_000);
  }

  /** Where the bulk endpoints are, as the configuration says. */
  learn() {
    for (let at = 0; at < this.data.length; at += this.data[at]) {
      const [, kind, address, attributes] = this.data.slice(at);
      if (kind === ENDPOINT && attributes === 2) this.ends[address & IN ? 'in' : 'out'] = address & 15;
    }
  }

  send(bytes) {
    this.waiting.push(...bytes);
    this.flush();
  }

  flush() {
    if (this.request || !this.waiting.length || !this.wants.delete(this.ends.out)) return;
    this.usb.endpointReadDone(this.ends.out, new Uint8Array(this.waiting.splice(0, 64)));
  }
}
