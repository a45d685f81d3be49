// The part of the chip's boot ROM that the firmware calls: the search for a function, which knows
// one, and that function, which restarts the chip in its boot loader. (RP2040 data sheet, 2.8.3.)

/** Where the ROM says where its table of functions and the search are. */
const [TABLE, SEARCH] = [0x14, 0x18];
const [TABLE_AT, SEARCH_AT, BOOT_AT] = [0x20, 0x40, 0x60];
/** `UB`, the name of the function. */
const NAME = 0x4255;
/** The breakpoint at its beginning, by which the emulator knows that it is called. */
export const BOOT = 0x42;

const CODE = [
  [TABLE, TABLE_AT],
  [SEARCH, SEARCH_AT | 1],
  [SEARCH_AT, 0x4a03], // ldr r2, [pc, #12]
  [SEARCH_AT + 2, 0x2000], // movs r0, #0
  [SEARCH_AT + 4, 0x4291], // cmp r1, r2
  [SEARCH_AT + 6, 0xd100], // bne 1f
  [SEARCH_AT + 8, 0x2000 | BOOT_AT | 1], // movs r0, #...
  [SEARCH_AT + 10, 0x4770], // 1: bx lr
  [SEARCH_AT + 16, NAME],
  [BOOT_AT, 0xbe00 | BOOT], // bkpt
  [BOOT_AT + 2, 0xe7fe], // b .
];

export function addRom({ bootrom }) {
  for (const [at, half] of CODE) bootrom[at >> 2] |= half << (8 * (at & 2));
}
