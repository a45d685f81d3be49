/* The map of flips as anyone would write it in C: the page's equations by classical RK4, one start after the other. Prints how
   many steps it took and for how long, ns. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "textbook.h"

static const float PI = 3.14159265f;

static unsigned long first_flip(const struct textbook *pendulum, float a1, float a2, float dt, unsigned long most) {
    float z[4] = {a1, a2, 0.0f, 0.0f};
    unsigned long steps = 0;
    while (steps < most && fabsf(z[0]) < PI && fabsf(z[1]) < PI) {
        counted_steps(pendulum, z, dt, 1);
        steps++;
    }
    return steps;
}

int main(int words, char **word) {
    if (words != 4) {
        return 2;
    }
    const long side = atol(word[1]);
    const float dt = strtof(word[2], NULL);
    const unsigned long most = strtoul(word[3], NULL, 10);
    const struct textbook pendulum = {1.0f, 1.0f, 1.0f, 1.0f, 1.0f};
    struct timespec from, to;
    unsigned long steps = 0;
    clock_gettime(CLOCK_MONOTONIC, &from);
    for (long row = 0; row < side / 2; row++) {
        for (long column = 0; column < side; column++) {
            const float a1 = (float)(2 * column + 1 - side) * (PI / (float)side);
            const float a2 = (float)(side - 1 - 2 * row) * (PI / (float)side);
            if (2.0f * cosf(a1) + cosf(a2) <= 1.0f) {
                steps += first_flip(&pendulum, a1, a2, dt, most);
            }
        }
    }
    clock_gettime(CLOCK_MONOTONIC, &to);
    printf("%lu %lld\n", steps, (to.tv_sec - from.tv_sec) * 1000000000LL + (to.tv_nsec - from.tv_nsec));
    return 0;
}
