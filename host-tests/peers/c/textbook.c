#include "textbook.h"

float SIN(float);
float COS(float);

/* (a1', a2', p1', p2'), `[math24]`. */
static void derivatives(const struct textbook *pendulum, const float z[4], float rates[4]) {
    const float m1 = pendulum->m1, m2 = pendulum->m2, l1 = pendulum->l1, l2 = pendulum->l2, g = pendulum->g;
    const float a1 = z[0], a2 = z[1], p1 = z[2], p2 = z[3];
    const float d = a1 - a2, m = m1 + m2;
    const float sin_d = SIN(d), cos_d = COS(d);
    const float den = m1 + m2 * sin_d * sin_d;
    const float brackets = p1 * p1 * m2 * l2 * l2 - 2.0f * p1 * p2 * m2 * l1 * l2 * cos_d + p2 * p2 * m * l1 * l1;
    const float a_1 = p1 * p2 * sin_d / (l1 * l2 * den);
    const float a_2 = brackets * SIN(2.0f * d) / (2.0f * l1 * l1 * l2 * l2 * den * den);
    rates[0] = (p1 * l2 - p2 * l1 * cos_d) / (l1 * l1 * l2 * den);
    rates[1] = (p2 * m * l1 - p1 * m2 * l2 * cos_d) / (m2 * l1 * l2 * l2 * den);
    rates[2] = -m * g * l1 * SIN(a1) - a_1 + a_2;
    rates[3] = -m2 * g * l2 * SIN(a2) + a_1 - a_2;
}

/* sum = z + h rates */
static void moved(const float z[4], float h, const float rates[4], float sum[4]) {
    for (int i = 0; i < 4; i++) {
        sum[i] = z[i] + h * rates[i];
    }
}

static void step(const struct textbook *pendulum, float z[4], float dt) {
    float k1[4], k2[4], k3[4], k4[4], stage[4];
    derivatives(pendulum, z, k1);
    moved(z, dt / 2.0f, k1, stage);
    derivatives(pendulum, stage, k2);
    moved(z, dt / 2.0f, k2, stage);
    derivatives(pendulum, stage, k3);
    moved(z, dt, k3, stage);
    derivatives(pendulum, stage, k4);
    for (int i = 0; i < 4; i++) {
        z[i] += dt / 6.0f * (k1[i] + 2.0f * k2[i] + 2.0f * k3[i] + k4[i]);
    }
}

__attribute__((noinline)) void counted_steps(const struct textbook *pendulum, float z[4], float dt, uint32_t steps) {
    while (steps--) {
        step(pendulum, z, dt);
    }
}
