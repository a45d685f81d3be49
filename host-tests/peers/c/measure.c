/* Runs one request from the semihosting command line, written as the firmware's `measure` takes it, and prints every
   sampled state on a line: a1 a2 p1 p2 as the hexadecimal bits of their double. */
#include "textbook.h"

enum { SYS_OPEN = 0x01, SYS_WRITE = 0x05, SYS_GET_CMDLINE = 0x15, SYS_EXIT = 0x18, APPLICATION_EXIT = 0x20026 };

static int semihosting(int operation, const void *argument) {
    register int r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

/* The fields of a request, as postcard writes them: integers in sevens of bits, the lowest first, of the seven with more after
   them the eighth bit set; numbers little-endian, as this processor is. */
static const char *text;

static unsigned digit(char c) {
    return (unsigned)(c <= '9' ? c - '0' : c - 'a' + 10);
}

static uint8_t byte(void) {
    const unsigned high = digit(*text++);
    return (uint8_t)(high << 4 | digit(*text++));
}

static uint32_t integer(void) {
    uint32_t value = 0;
    for (int shift = 0; shift < 32; shift += 7) {
        const uint8_t seven = byte();
        value |= (uint32_t)(seven & 0x7f) << shift;
        if (seven < 0x80) {
            break;
        }
    }
    return value;
}

static float number(void) {
    union { double value; uint8_t bytes[8]; } word;
    for (int i = 0; i < 8; i++) {
        word.bytes[i] = byte();
    }
    return (float)word.value;
}

static void print(int output, float value, char end) {
    union { double value; uint64_t bits; } word = { .value = value };
    char text[] = "................ ";
    for (int i = 0; i < 16; i++) {
        text[i] = "0123456789abcdef"[word.bits >> (60 - 4 * i) & 15];
    }
    text[16] = end;
    const struct { int file; const char *text; int length; } block = { output, text, 17 };
    semihosting(SYS_WRITE, &block);
}

static void run(void) {
    static char buffer[256];
    const struct { char *text; int length; } block = { buffer, sizeof buffer };
    semihosting(SYS_GET_CMDLINE, &block);
    text = buffer;
    integer(); /* the method */
    struct textbook pendulum;
    pendulum.m1 = number();
    pendulum.m2 = number();
    pendulum.l1 = number();
    pendulum.l2 = number();
    pendulum.g = number();
    float z[4] = { 0 };
    z[0] = number();
    z[1] = number();
    number(); /* from rest */
    number();
    const float dt = number();
    const uint32_t stride = integer(), samples = integer();
    const struct { const char *name; int mode, length; } console = { ":tt", 4 /* to be written */, 3 };
    const int output = semihosting(SYS_OPEN, &console);
    for (uint32_t sample = 0; sample < samples; sample++) {
        counted_steps(&pendulum, z, dt, stride);
        for (int i = 0; i < 4; i++) {
            print(output, z[i], i < 3 ? ' ' : '\n');
        }
    }
}

void reset(void) {
#ifdef __ARM_FP
    *(volatile uint32_t *)0xe000ed88 |= 0xf << 20; /* CPACR: the floating-point unit on */
    __asm__ volatile("dsb\n\tisb");
#endif
    run();
    semihosting(SYS_EXIT, (const void *)APPLICATION_EXIT);
    for (;;) {
    }
}

static void fault(void) {
    semihosting(SYS_EXIT, 0);
    for (;;) {
    }
}

extern char stack_top;

__attribute__((section(".vectors"), used)) static void *const vectors[16] = {
    &stack_top, reset, fault, fault, fault, fault, fault,
};
