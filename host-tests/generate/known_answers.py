#!/usr/bin/env python3
"""Makes data/known_answers.csv: the double pendulum in arbitrary precision.

    python3 host-tests/generate/known_answers.py            # writes the table to stdout, ten minutes on two cores
    python3 host-tests/generate/known_answers.py S4 S9      # only these scenes

Needs mpmath. Hamilton's equations in the form of the source page, with its A1 and A2, are integrated by Taylor series.
Every scene is run twice, with different precision, order and step; the column `agreement` is the largest difference
between the two, and a scene whose runs differ in the digits written is refused. The column `growth` says how much a
small error at the start has grown by then, in the norm max(|a1|, |a2|, |p1|/P1, |p2|/P2), where P1 and P2 are the
greatest momenta the energy allows: a third run, started 1e-25 away, shows it.
"""

import sys
from multiprocessing import Pool
from operator import mul

from mpmath import cos, mp, mpf, polyval, sin, sqrt

# scene: initial angles in degrees, initial velocities in rad/s, masses, lengths, gravity, times in s; decimals are exact.
SCENES = {
    "S1": (("0", "30"), ("0", "0"), ("1", "1"), ("0.25", "0.25"), "9.8", (1, 2, 5, 10)),
    "S1b": (("0", "30"), ("0", "0"), ("1", "0.2"), ("0.25", "0.25"), "9.8", (1, 2, 5, 10)),
    "S1c": (("0", "30"), ("0", "0"), ("1", "5"), ("0.25", "0.25"), "9.8", (1, 2, 5, 10)),
    "S2": (("30", "30"), ("0", "0"), ("1", "1"), ("1", "1"), "9.8", (1, 5, 10, 20)),
    "S3": (("90", "90"), ("0", "0"), ("1", "1"), ("1", "1"), "9.8", (1, 5, 10, 20)),
    "S3b": (("120", "120"), ("0", "0"), ("1", "1"), ("1", "1"), "9.8", (1, 5, 10, 20)),
    "S4": (("171", "171"), ("0", "0"), ("1", "2.75"), ("1", "1"), "9.8", (1, 5, 10, 20)),
    "S5": (("179.9", "179.9"), ("0", "0"), ("1", "1"), ("1", "1"), "9.8", (1, 5, 10, 20)),
    "S6": (("90", "90"), ("0", "0"), ("1", "1000"), ("1", "1"), "9.8", (1, 2, 5, 10)),
    "S7": (("90", "90"), ("0", "0"), ("1", "0.001"), ("1", "1"), "9.8", (1, 5, 10, 20)),
    "S8": (("120", "-20"), ("0", "0"), ("2", "1"), ("1", "0.5"), "9.8", (1, 5, 10, 20)),
    "S9": (("40", "-75"), ("2", "-3"), ("0.7", "1.3"), ("0.6", "1.1"), "9.81", (1, 5, 10, 20)),
    "S10": (("-15", "100"), ("0", "12"), ("3", "0.5"), ("0.4", "0.1"), "9.81", (1, 2, 5, 10)),
    "S11": (("60", "60"), ("1.5", "0"), ("1", "1"), ("1", "2"), "1.62", (1, 5, 10, 20)),
    "S12": (("10", "200"), ("3", "-4"), ("1", "2"), ("0.5", "1"), "0", (1, 5, 10, 20)),
}

DIGITS = 33
OFFSET = "1e-25"


def fixed(x):
    """x as an integer multiple of 2^-mp.prec: sums of products of these are what makes the table in minutes."""
    return int(mp.nint(mp.ldexp(x, mp.prec)))


def product(a, b, k):
    """Coefficient k of the product of two power series."""
    return sum(map(mul, a[: k + 1], reversed(b[: k + 1]))) >> mp.prec


def quotient(numerator, den, known, k):
    """Coefficient k of a power series n/den: its earlier ones are `known`, `numerator` is n's coefficient k."""
    return ((numerator << mp.prec) - sum(map(mul, den[1 : k + 1], reversed(known[:k])))) // den[0]


def extend_sin_cos(angle, s, c, k):
    """Appends coefficient k of sin and cos of `angle`: s' = c a', c' = -s a'."""
    if k == 0:
        value = mp.ldexp(angle[0], -mp.prec)
        s.append(fixed(sin(value)))
        c.append(fixed(cos(value)))
    else:
        slope = [j * angle[j] for j in range(1, k + 1)]
        ds = sum(map(mul, slope, reversed(c[:k])))
        dc = -sum(map(mul, slope, reversed(s[:k])))
        s.append((ds >> mp.prec) // k)
        c.append((dc >> mp.prec) // k)


def taylor(z, masses, lengths, g, order):
    """The Taylor series of (a1, a2, p1, p2) about the state z, all in fixed point."""
    (m1, m2), (l1, l2) = masses, lengths
    times = lambda constant: lambda x, c=fixed(constant): c * x >> mp.prec
    # w1 = (p1/l1^2 - p2 cos D/(l1 l2))/den,  w2 = (p2 (m1 + m2)/(m2 l2^2) - p1 cos D/(l1 l2))/den
    p1_in_w1, p2_in_w2, pc_in_w = times(1 / l1**2), times((m1 + m2) / (m2 * l2**2)), times(1 / (l1 * l2))
    # A1 = p1 p2 sin D/(l1 l2 den)
    # A2 = [p1^2 m2/l1^2 - 2 p1 p2 cos D m2/(l1 l2) + p2^2 (m1 + m2)/l2^2] sin 2D/(2 den^2)
    p1p1_in_a2, p1p2_in_a2, p2p2_in_a2 = times(m2 / l1**2), times(2 * m2 / (l1 * l2)), times((m1 + m2) / l2**2)
    m2_times, torque1, torque2 = times(m2), times((m1 + m2) * g * l1), times(m2 * g * l2)

    a1, a2, p1, p2 = ([fixed(x)] for x in z)
    d = [a1[0] - a2[0]]
    s1, c1, s2, c2, s, c, den, p1p2, w1, w2, a1_num, a1_term, bracket, sin_2d, a2_half, a2_term = ([] for _ in range(16))
    for k in range(order):
        extend_sin_cos(a1, s1, c1, k)
        extend_sin_cos(a2, s2, c2, k)
        extend_sin_cos(d, s, c, k)
        den.append(m2_times(product(s, s, k)) + (fixed(m1) if k == 0 else 0))
        w1.append(quotient(p1_in_w1(p1[k]) - pc_in_w(product(p2, c, k)), den, w1, k))
        w2.append(quotient(p2_in_w2(p2[k]) - pc_in_w(product(p1, c, k)), den, w2, k))

        p1p2.append(product(p1, p2, k))
        a1_num.append(pc_in_w(product(p1p2, s, k)))
        a1_term.append(quotient(a1_num[k], den, a1_term, k))
        squares = p1p1_in_a2(product(p1, p1, k)) + p2p2_in_a2(product(p2, p2, k))
        bracket.append(squares - p1p2_in_a2(product(p1p2, c, k)))
        sin_2d.append(2 * product(s, c, k))
        a2_half.append(quotient(product(bracket, sin_2d, k) // 2, den, a2_half, k))
        a2_term.append(quotient(a2_half[k], den, a2_term, k))

        force = a1_term[k] - a2_term[k]
        a1.append(w1[k] // (k + 1))
        a2.append(w2[k] // (k + 1))
        d.append(a1[k + 1] - a2[k + 1])
        p1.append((-torque1(s1[k]) - force) // (k + 1))
        p2.append((-torque2(s2[k]) + force) // (k + 1))
    return [[mp.ldexp(x, -mp.prec) for x in series] for series in (a1, a2, p1, p2)]


def norm(z, scale):
    return max(abs(x) / s for x, s in zip(z, scale))


def integrate(z, masses, lengths, g, times, scale, order):
    """The states at the times; each step ends where the last terms of its series fall below the working precision.

    Four terms are looked at: a motion with a symmetry in time has only every second or fourth.
    """
    tolerance = mpf(10) ** -(mp.dps - 2)
    t, states = mpf(0), []
    for end in times:
        while t < end:
            series = taylor(z, masses, lengths, g, order)
            last = [(k, norm([x[k] for x in series], scale)) for k in range(order - 3, order + 1)]
            h = min((tolerance / c) ** (mpf(1) / k) for k, c in last if c)
            h = min(h, end - t)
            z, t = [polyval(x[::-1], h) for x in series], (end if h == end - t else t + h)
        states.append(z)
    return states


def prepare(name):
    angles, velocities, masses, lengths, g, times = SCENES[name]
    (m1, m2), (l1, l2), g = map(mpf, masses), map(mpf, lengths), mpf(g)
    a1, a2 = (mpf(a) * mp.pi / 180 for a in angles)
    w1, w2 = map(mpf, velocities)
    coupling = m2 * l1 * l2 * cos(a1 - a2)
    total = m1 + m2
    p1, p2 = total * l1**2 * w1 + coupling * w2, m2 * l2**2 * w2 + coupling * w1
    kinetic = (total * l1**2 * w1**2 + m2 * l2**2 * w2**2) / 2 + coupling * w1 * w2
    energy = kinetic + total * g * l1 * (1 - cos(a1)) + m2 * g * l2 * (1 - cos(a2))
    scale = [mpf(1), mpf(1), l1 * sqrt(2 * total * energy), l2 * sqrt(2 * m2 * energy)]
    return [a1, a2, p1, p2], (m1, m2), (l1, l2), g, times, scale


def rows(name):
    runs = []
    for digits, order in ((60, 60), (56, 44)):
        mp.dps = digits
        runs.append(integrate(*prepare(name), order))
    z, masses, lengths, g, times, scale = prepare(name)
    near = [x + s * mpf(OFFSET) for x, s in zip(z, scale)]
    runs.append(integrate(near, masses, lengths, g, times, scale, 44))

    angles, velocities, masses, lengths, g, times = SCENES[name]
    given = ",".join((name, *angles, *velocities, *masses, *lengths, g))
    lines = []
    for time, z, again, moved in zip(times, *runs):
        agreement = norm([x - y for x, y in zip(z, again)], scale)
        if agreement > mpf(10) ** -DIGITS:
            sys.exit(f"{name} at {time} s: two runs agree only to {mp.nstr(agreement, 2)}")
        growth = norm([x - y for x, y in zip(moved, again)], scale) / mpf(OFFSET)
        values = ",".join(mp.nstr(x, DIGITS, min_fixed=0, max_fixed=0, strip_zeros=False) for x in z)
        lines.append(f"{given},{time},{values},{mp.nstr(growth, 3)},{mp.nstr(agreement, 1)}")
    print(f"{name} done", file=sys.stderr)
    return lines


if __name__ == "__main__":
    names = sys.argv[1:] or list(SCENES)
    print("scene,a1_deg,a2_deg,w1_start,w2_start,m1,m2,l1,l2,g,t,a1,a2,p1,p2,growth,agreement")
    with Pool() as pool:
        for lines in pool.imap(rows, names):
            print("\n".join(lines), flush=True)
