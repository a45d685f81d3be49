// The usual instructions of the emulated processor, executed faster than by the emulator itself.
//
// The emulator finds each instruction by a chain of 80 comparisons, and keeps the flags in the
// fields of an object. Here a loop keeps them in variables, and finds the instruction by a jump. It
// executes instructions that only use registers, flash and memory, and stops before any other one,
// which the emulator executes then: an access to a peripheral, an interrupt, a return from an
// exception, a wait, a rare instruction. `compare.js` checks that both do the same.
//
// The bits of instructions are in the ARMv6-M Architecture Reference Manual, A5.2. Cycles are those
// of the emulator.

const [FLASH, RAM] = [0x10000000, 0x20000000];
const [SP, LR, PC] = [13, 14, 15];
/** The limit of the cycles of a call. With it, Node.js computes with small integers. */
const MOST = 1e6;

/** The kinds of access to memory. */
const [NO_ACCESS, LOAD, LOAD_HALF, LOAD_BYTE, LOAD_SIGNED_HALF, LOAD_SIGNED_BYTE] = [0, 1, 2, 3, 4, 5];
const [STORE, STORE_HALF, STORE_BYTE] = [6, 7, 8];
/** The accesses with an address in two registers, by bits 9 to 11 of the instruction. */
const ACCESSES = [
  STORE, STORE_HALF, STORE_BYTE, LOAD_SIGNED_BYTE, LOAD, LOAD_HALF, LOAD_BYTE, LOAD_SIGNED_HALF,
];
/** The number of registers in each list of eight. */
const COUNTS = Uint8Array.from({ length: 256 }, (_, list) => {
  return [0, 1, 2, 3, 4, 5, 6, 7].filter((register) => list & (1 << register)).length;
});

/**
 * Returns a function that executes instructions of this chip until `most` cycles have passed, a
 * million at most, or up to an instruction that it does not know. It returns the cycles, which may
 * be a few more. If it returns 0, it has done nothing.
 */
export function fast(chip) {
  const { core } = chip;
  const registers = new Int32Array(core.registers.buffer);
  const [flash16, flash32] = [new Uint16Array(chip.flash.buffer), new Int32Array(chip.flash.buffer)];
  const flash8 = chip.flash;
  const [ram16, ram32] = [new Uint16Array(chip.sram.buffer), new Int32Array(chip.sram.buffer)];
  const ram8 = chip.sram;

  return (most) => {
    // Here the flags N and Z are those of a result, which is not both negative and zero. A return
    // from an exception may set both.
    if (core.interruptsUpdated || (core.N && core.Z) || registers[PC] & 1) return 0;
    const r = registers;
    const flashSize = flash8.length;
    const ramSize = ram8.length;
    let carry = core.C ? 1 : 0;
    let overflow = core.V ? -1 : 0;
    let result = core.N ? -1 : core.Z ? 0 : 1;
    let pc = registers[PC];
    let cycles = 0;
    const limit = Math.min(most, MOST) | 0;

    next: while (cycles < limit) {
      let code = flash16;
      let place = (pc - FLASH) | 0;
      if (place >>> 0 >= flashSize) {
        code = ram16;
        place = (pc - RAM) | 0;
        if (place >>> 0 >= ramSize) break;
      }
      const opcode = code[place >> 1];
      const low = opcode & 7;
      const middle = (opcode >> 3) & 7;
      let following = pc + 2;
      let spent = 1;
      let access = NO_ACCESS;
      let address = 0;
      let register = low;

      switch (opcode >> 11) {
        // LSLS, LSRS, ASRS by a constant.
        case 0b00000: {
          const input = r[middle];
          const shift = (opcode >> 6) & 31;
          if (shift) carry = (input >>> (32 - shift)) & 1;
          result = r[low] = input << shift;
          break;
        }
        case 0b00001: {
          const input = r[middle];
          const shift = (opcode >> 6) & 31;
          carry = (input >>> (shift ? shift - 1 : 31)) & 1;
          result = r[low] = shift ? input >>> shift : 0;
          break;
        }
        case 0b00010: {
          const input = r[middle];
          const shift = (opcode >> 6) & 31;
          carry = (input >>> (shift ? shift - 1 : 31)) & 1;
          result = r[low] = input >> (shift || 31);
          break;
        }

        // ADDS and SUBS of a register or of three bits; MOVS, CMP, ADDS, SUBS of eight bits.
        case 0b00011: {
          const operand = opcode & (1 << 10) ? (opcode >> 6) & 7 : r[(opcode >> 6) & 7];
          const first = r[middle];
          if (opcode & (1 << 9)) {
            result = (first - operand) | 0;
            carry = first >>> 0 >= operand >>> 0 ? 1 : 0;
            overflow = (first ^ operand) & (first ^ result);
          } else {
            result = (first + operand) | 0;
            carry = result >>> 0 < first >>> 0 ? 1 : 0;
            overflow = (first ^ result) & (operand ^ result);
          }
          r[low] = result;
          break;
        }
        case 0b00100:
          result = r[(opcode >> 8) & 7] = opcode & 255;
          break;
        case 0b00101:
        case 0b00111: {
          const first = r[(opcode >> 8) & 7];
          const operand = opcode & 255;
          result = (first - operand) | 0;
          carry = first >>> 0 >= operand ? 1 : 0;
          overflow = first & ~result;
          if (opcode & (1 << 12)) r[(opcode >> 8) & 7] = result;
          break;
        }
        case 0b00110: {
          const first = r[(opcode >> 8) & 7];
          const operand = opcode & 255;
          result = r[(opcode >> 8) & 7] = (first + operand) | 0;
          carry = result >>> 0 < operand ? 1 : 0;
          overflow = ~first & result;
          break;
        }

        case 0b01000: {
          const first = r[low];
          const operand = r[middle];
          switch ((opcode >> 6) & 31) {
            // ANDS, EORS, TST, ORRS, MULS, BICS, MVNS.
            case 0b00000:
              result = r[low] = first & operand;
              break;
            case 0b00001:
              result = r[low] = first ^ operand;
              break;
            case 0b01000:
              result = first & operand;
              break;
            case 0b01100:
              result = r[low] = first | operand;
              break;
            case 0b01101:
              result = r[low] = Math.imul(first, operand);
              break;
            case 0b01110:
              result = r[low] = first & ~operand;
              break;
            case 0b01111:
              result = r[low] = ~operand;
              break;

            // LSLS, LSRS, ASRS by a register.
            case 0b00010: {
              const shift = operand & 255;
              if (shift) carry = (first >>> (32 - shift)) & 1;
              result = r[low] = shift < 32 ? first << shift : 0;
              break;
            }
            case 0b00011: {
              const shift = operand & 255;
              carry = shift <= 32 ? (first >>> (shift - 1)) & 1 : 0;
              result = r[low] = shift < 32 ? (first >>> shift) | 0 : 0;
              break;
            }
            case 0b00100: {
              const shift = Math.min(operand & 255, 32);
              carry = (first >>> (shift - 1)) & 1;
              result = r[low] = first >> Math.min(shift, 31);
              break;
            }

            // ADCS and SBCS. As in the emulator, the carry is a part of an operand.
            case 0b00101: {
              const sum = (first >>> 0) + (operand >>> 0) + carry;
              const other = (first + carry) | 0;
              result = r[low] = (operand + other) | 0;
              carry = sum > 0xffffffff ? 1 : 0;
              overflow = (operand ^ result) & (other ^ result);
              break;
            }
            case 0b00110: {
              const borrow = 1 - carry;
              const other = (operand + borrow) | 0;
              result = r[low] = (first - other) | 0;
              carry = first >>> 0 >= (operand >>> 0) + borrow ? 1 : 0;
              overflow = (first ^ other) & (first ^ result);
              break;
            }
            // RSBS, CMP, CMN.
            case 0b01001:
              result = r[low] = (0 - operand) | 0;
              carry = operand === 0 ? 1 : 0;
              overflow = operand & result;
              break;
            case 0b01010:
              result = (first - operand) | 0;
              carry = first >>> 0 >= operand >>> 0 ? 1 : 0;
              overflow = (first ^ operand) & (first ^ result);
              break;
            case 0b01011:
              result = (first + operand) | 0;
              carry = result >>> 0 < first >>> 0 ? 1 : 0;
              overflow = (first ^ result) & (operand ^ result);
              break;

            // ADD, CMP and MOV of all registers. The program counter is left to the emulator.
            case 0b10000:
            case 0b10001:
            case 0b10010:
            case 0b10011:
            case 0b10100:
            case 0b10101:
            case 0b10110:
            case 0b10111:
            case 0b11000:
            case 0b11001:
            case 0b11010:
            case 0b11011: {
              const to = low | ((opcode >> 4) & 8);
              const from = (opcode >> 3) & 15;
              if (to === PC || from === PC) break next;
              const kind = (opcode >> 8) & 3;
              if (kind === 1) {
                const one = r[to];
                const other = r[from];
                result = (one - other) | 0;
                carry = one >>> 0 >= other >>> 0 ? 1 : 0;
                overflow = (one ^ other) & (one ^ result);
              } else {
                const value = kind === 0 ? r[to] + r[from] : r[from];
                r[to] = to === SP ? value & ~3 : value;
              }
              break;
            }

            // BX and BLX. A return from an exception is left to the emulator.
            case 0b11100:
            case 0b11101:
            case 0b11110:
            case 0b11111: {
              const from = (opcode >> 3) & 15;
              if (low || from === PC || r[from] >>> 28 === 15) break next;
              const isCall = opcode & (1 << 7);
              if (isCall && from === LR) break next;
              if (isCall) r[LR] = following | 1;
              following = r[from] & ~1;
              spent = 2;
              break;
            }
            default: // RORS
              break next;
          }
          break;
        }

        // Loads and stores.
        case 0b01001:
          access = LOAD;
          register = (opcode >> 8) & 7;
          address = ((pc + 4) & ~3) + ((opcode & 255) << 2);
          break;
        case 0b01010:
        case 0b01011:
          access = ACCESSES[(opcode >> 9) & 7];
          address = (r[middle] + r[(opcode >> 6) & 7]) | 0;
          break;
        case 0b01100:
        case 0b01101:
          access = opcode & (1 << 11) ? LOAD : STORE;
          address = (r[middle] + ((opcode >> 4) & 124)) | 0;
          break;
        case 0b01110:
        case 0b01111:
          access = opcode & (1 << 11) ? LOAD_BYTE : STORE_BYTE;
          address = (r[middle] + ((opcode >> 6) & 31)) | 0;
          break;
        case 0b10000:
        case 0b10001:
          access = opcode & (1 << 11) ? LOAD_HALF : STORE_HALF;
          address = (r[middle] + ((opcode >> 5) & 62)) | 0;
          break;
        case 0b10010:
        case 0b10011:
          access = opcode & (1 << 11) ? LOAD : STORE;
          register = (opcode >> 8) & 7;
          address = (r[SP] + ((opcode & 255) << 2)) | 0;
          break;

        // ADR, and ADD of the stack pointer.
        case 0b10100:
          r[(opcode >> 8) & 7] = (pc & ~3) + 4 + ((opcode & 255) << 2);
          break;
        case 0b10101:
          r[(opcode >> 8) & 7] = r[SP] + ((opcode & 255) << 2);
          break;

        case 0b10110: {
          const kind = (opcode >> 8) & 7;
          if (kind === 0) {
            // ADD and SUB of the stack pointer.
            const size = (opcode & 127) << 2;
            r[SP] = (opcode & (1 << 7) ? r[SP] - size : r[SP] + size) & ~3;
          } else if (kind === 2) {
            // SXTH, SXTB, UXTH, UXTB.
            const input = r[middle];
            const shift = opcode & (1 << 6) ? 24 : 16;
            r[low] = opcode & (1 << 7) ? (input << shift) >>> shift : (input << shift) >> shift;
          } else if (kind === 4 || kind === 5) {
            // PUSH. The stack pointer is always a multiple of four.
            const count = COUNTS[opcode & 255];
            const size = 4 * (count + (kind & 1));
            const to = (r[SP] - size - RAM) | 0;
            if (to >>> 0 > ramSize - size) break next;
            let at = to >> 2;
            for (let list = opcode & 255, i = 0; list; list >>= 1, i += 1) {
              if (list & 1) ram32[at++] = r[i];
            }
            if (kind & 1) ram32[at] = r[LR];
            r[SP] -= size;
            spent = 1 + count;
          } else break next;
          break;
        }
        case 0b10111: {
          // POP. A return from an exception is left to the emulator.
          const kind = (opcode >> 8) & 7;
          if (kind !== 4 && kind !== 5) break next;
          const count = COUNTS[opcode & 255];
          const size = 4 * (count + (kind & 1));
          const from = (r[SP] - RAM) | 0;
          if (from >>> 0 > ramSize - size) break next;
          let at = from >> 2;
          if (kind & 1) {
            const target = ram32[at + count];
            if (target >>> 28 === 15) break next;
            following = target & ~1;
            spent = 3;
          }
          for (let list = opcode & 255, i = 0; list; list >>= 1, i += 1) {
            if (list & 1) r[i] = ram32[at++];
          }
          r[SP] += size;
          spent += count;
          break;
        }

        // STM and LDM.
        case 0b11000:
        case 0b11001: {
          const base = (opcode >> 8) & 7;
          const count = COUNTS[opcode & 255];
          const start = r[base];
          const isLoad = (opcode & (1 << 11)) !== 0;
          let words = ram32;
          let from = (start - RAM) | 0;
          if (from & 3) break next;
          if (from >>> 0 > ramSize - 4 * count) {
            from = (start - FLASH) | 0;
            if (!isLoad || from >>> 0 > flashSize - 4 * count) break next;
            words = flash32;
          }
          let at = from >> 2;
          for (let list = opcode & 255, i = 0; list; list >>= 1, i += 1) {
            if (!(list & 1)) continue;
            if (isLoad) r[i] = words[at++];
            else words[at++] = r[i];
          }
          if (!(opcode & (1 << base))) r[base] = start + 4 * count;
          spent = 1 + count;
          break;
        }

        // B with a condition.
        case 0b11010:
        case 0b11011: {
          let is;
          switch ((opcode >> 9) & 7) {
            case 0:
              is = result === 0;
              break;
            case 1:
              is = carry !== 0;
              break;
            case 2:
              is = result < 0;
              break;
            case 3:
              is = overflow < 0;
              break;
            case 4:
              is = carry !== 0 && result !== 0;
              break;
            case 5:
              is = result < 0 === (overflow < 0);
              break;
            case 6:
              is = result < 0 === (overflow < 0) && result !== 0;
              break;
            default: // UDF, SVC
              break next;
          }
          if (is === ((opcode & (1 << 8)) === 0)) {
            following = pc + 4 + ((opcode << 24) >> 23);
            spent = 2;
          }
          break;
        }

        // B. A jump to itself is left to the emulator: the board may hang there.
        case 0b11100:
          following = pc + 4 + ((opcode << 21) >> 20);
          if (following === pc) break next;
          spent = 2;
          break;

        // BL.
        case 0b11110: {
          const second = code[(place >> 1) + 1];
          if (second >> 14 !== 3 || !(second & (1 << 12))) break next;
          const sign = (opcode >> 10) & 1;
          const first = 1 ^ sign ^ ((second >> 13) & 1);
          const other = 1 ^ sign ^ ((second >> 11) & 1);
          const high = (sign << 24) | (first << 23) | (other << 22) | ((opcode & 1023) << 12);
          r[LR] = (pc + 4) | 1;
          following = pc + 4 + (((high | ((second & 2047) << 1)) << 7) >> 7);
          spent = 3;
          break;
        }
        default:
          break next;
      }

      if (access !== NO_ACCESS) {
        spent = 2;
        const inRam = (address - RAM) | 0;
        if (inRam >>> 0 < ramSize) {
          switch (access) {
            case LOAD:
              if (address & 3) break next;
              r[register] = ram32[inRam >> 2];
              break;
            case LOAD_HALF:
              if (address & 1) break next;
              r[register] = ram16[inRam >> 1];
              break;
            case LOAD_BYTE:
              r[register] = ram8[inRam];
              break;
            case LOAD_SIGNED_HALF:
              if (address & 1) break next;
              r[register] = (ram16[inRam >> 1] << 16) >> 16;
              break;
            case LOAD_SIGNED_BYTE:
              r[register] = (ram8[inRam] << 24) >> 24;
              break;
            case STORE:
              if (address & 3) break next;
              ram32[inRam >> 2] = r[register];
              break;
            case STORE_HALF:
              if (address & 1) break next;
              ram16[inRam >> 1] = r[register];
              break;
            default:
              ram8[inRam] = r[register];
          }
        } else {
          const inFlash = (address - FLASH) | 0;
          if (inFlash >>> 0 >= flashSize) break next;
          switch (access) {
            case LOAD:
              if (address & 3) break next;
              r[register] = flash32[inFlash >> 2];
              break;
            case LOAD_HALF:
              if (address & 1) break next;
              r[register] = flash16[inFlash >> 1];
              break;
            case LOAD_BYTE:
              r[register] = flash8[inFlash];
              break;
            case LOAD_SIGNED_HALF:
              if (address & 1) break next;
              r[register] = (flash16[inFlash >> 1] << 16) >> 16;
              break;
            case LOAD_SIGNED_BYTE:
              r[register] = (flash8[inFlash] << 24) >> 24;
              break;
            default: // A store.
              break next;
          }
        }
      }
      pc = following;
      cycles += spent;
    }

    registers[PC] = pc;
    core.N = result < 0;
    core.Z = result === 0;
    core.C = carry !== 0;
    core.V = overflow < 0;
    core.cycles += cycles;
    return cycles;
  };
}
