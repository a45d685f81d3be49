// The serial adapter at the chip's UART0, and the time that bytes take: the emulated UART sends them at once.

const [DATA, FLAGS] = [0x00, 0x18];
const [BUSY, FULL, EMPTY] = [1 << 3, 1 << 5, 1 << 7];
const SENT_HALF = 1 << 5;
const [BYTES, HALF] = [32, 16];
const BITS = 10;

export function addTime(uart, clock, sent) {
  const [read, write] = [uart.readUint32.bind(uart), uart.writeUint32.bind(uart)];
  const waiting = [];
  const line = clock.createAlarm(() => {
    sent(waiting.shift());
    if (waiting.length === HALF) uart.interruptStatus |= SENT_HALF;
    if (waiting.length) sendNext();
    uart.checkInterrupts();
  });
  const sendNext = () => line.schedule((BITS * 1e9) / uart.baudRate);
  uart.checkInterrupts = () => uart.rp2040.setInterrupt(uart.irq, !!(uart.interruptStatus & uart.interruptMask));
  uart.readUint32 = (offset) => {
    if (offset !== FLAGS) return read(offset);
    return (read(offset) & ~EMPTY) | (waiting.length ? BUSY : EMPTY) | (waiting.length < BYTES ? 0 : FULL);
  };
  uart.writeUint32 = (offset, value) => {
    if (offset !== DATA) return write(offset, value);
    if (waiting.length === BYTES) return; // lost
    if (waiting.push(value & 255) === 1) sendNext();
    if (waiting.length > HALF) uart.interruptStatus &= ~SENT_HALF;
    uart.checkInterrupts();
  };
}
