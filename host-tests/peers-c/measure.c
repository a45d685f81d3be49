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

/* The next word of the line as a number; anything but a digit ends it. */
static uint64_t number(const char **line, unsigned base) {
    uint64_t value = 0;
    while (**line == ' ') {
        ++*line;
    }
    for (;; ++*line) {
        const char c = **line;
        const unsigned digit = c >= '0' && c <= '9' ? (unsigned)(c - '0') : c >= 'a' && c <= 'f' ? (unsigned)(c - 'a' + 10) : base;
        if (digit >= base) {
            return value;
        }
        value = value * base + digit;
    }
}

static float real(const char **line) {
    union { uint64_t bits; double value; } word = { .bits = number(line, 16) };
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
    const char *line = buffer;
    while (*line && *line != ' ') {
        line++; /* the subject's name */
    }
    const uint32_t samples = number(&line, 10), steps = number(&line, 10);
    struct textbook pendulum;
    pendulum.m1 = real(&line);
    pendulum.m2 = real(&line);
    pendulum.l1 = real(&line);
    pendulum.l2 = real(&line);
    pendulum.g = real(&line);
    float z[4] = { 0 };
    z[0] = real(&line);
    z[1] = real(&line);
    const float dt = real(&line);
    const struct { const char *name; int mode, length; } console = { ":tt", 4 /* to be written */, 3 };
    const int output = semihosting(SYS_OPEN, &console);
    for (uint32_t sample = 0; sample < samples; sample++) {
        counted_steps(&pendulum, z, dt, steps);
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
