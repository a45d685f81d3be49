// A computer at the board's USB socket: enumerates it and opens its serial port.

const [IN, STANDARD, CLASS] = [0x80, 0x00, 0x21];
const [DEVICE, CONFIGURATION, ENDPOINT] = [1, 2, 5];
/** 460,800 baud, 8N1: as a terminal program sets it. */
const LINE = [0x00, 0x08, 0x07, 0x00, 0, 0, 8];

export class UsbHost {
  constructor(usb, received) {
    this.usb = usb;
    this.received = received;
    this.waiting = [];
    /** The numbers of the endpoints that bytes come from and go to. */
    this.ends = {};
    /** The next request comes when the last has wholly arrived. */
    this.later = usb.rp2040.clock.createAlarm(() => this.next());
    usb.onUSBEnabled = () => usb.resetDevice();
    usb.onResetReceived = () => this.enumerate();
    usb.onEndpointRead = (end) => this.wanted(end);
    usb.onEndpointWrite = (end, bytes) => this.given(end, bytes);
  }

  enumerate() {
    this.wants = new Set();
    this.requests = [
      [IN, 6, DEVICE << 8, 0, 18],
      [STANDARD, 5, 1, 0, 0],
      [IN, 6, CONFIGURATION << 8, 0, 255],
      [STANDARD, 9, 1, 0, 0],
      [CLASS, 0x20, 0, 0, LINE.length],
      [CLASS, 0x22, 3, 0, 0],
    ];
    this.next();
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
    const [type, , , , length] = this.request ?? [IN];
    if (end === 0 && type === CLASS && length) this.usb.endpointReadDone(0, new Uint8Array(LINE));
    if (end === this.ends.out) this.flush();
  }

  /** The board has sent bytes. */
  given(end, bytes) {
    if (end === this.ends.in) return this.received(bytes);
    if (end !== 0 || !this.request) return;
    const [type, , value, , length] = this.request;
    this.data.push(...bytes);
    if (type === IN) {
      if (value >> 8 === DEVICE) this.packet = this.data[7];
      if (bytes.length === this.packet && this.data.length < length) return;
      if (value >> 8 === CONFIGURATION) this.learn();
      this.usb.endpointReadDone(0, new Uint8Array(0));
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
    if (this.request || !this.waiting.length || !this.wants?.delete(this.ends.out)) return;
    this.usb.endpointReadDone(this.ends.out, new Uint8Array(this.waiting.splice(0, 64)));
  }
}
