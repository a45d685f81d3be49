/* The page's equations of motion in C, as anyone would write them, by classical RK4. */
#include <stdint.h>

struct textbook {
    float m1, m2, l1, l2, g;
};

/* Advances z = (a1, a2, p1, p2) by `steps` steps of `dt` s. This is what is counted. */
void counted_steps(const struct textbook *pendulum, float z[4], float dt, uint32_t steps);
