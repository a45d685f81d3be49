"""Makes the polynomials and the parts of pi/2 in kernel/src/numbers/sine.rs.

    python3 -m pip install mpmath numpy
    python3 host-tests/exact/sine_polynomials.py

Each polynomial is the minimax fit (Remez exchange) on abs r <= pi/4, a hair beyond. Coefficients are rounded to the
target type one after the other, lowest order first, and what remains is fitted again after each rounding, so that
later coefficients make up for the rounding of earlier ones.
"""

import mpmath as mp
import numpy as np

mp.mp.dps = 40
# Beyond pi/4 by 1 %: a reduced argument may exceed pi/4 by the error of choosing the multiple of pi/2.
EDGE = mp.pi / 4 * mp.mpf("1.01")


def remez(target, weight, powers, start, end):
    """Coefficients of the given powers of z that minimise max |weight (sum - target)| on [start, end], and that maximum."""
    count = len(powers)
    nodes = [(start + end) / 2 - (end - start) / 2 * mp.cos(mp.pi * i / count) for i in range(count + 1)]
    grid = [start + (end - start) * mp.mpf(i) / 800 for i in range(801)]
    for _ in range(30):
        rows = [[z**p for p in powers] + [(-1) ** i / weight(z)] for i, z in enumerate(nodes)]
        solution = mp.lu_solve(mp.matrix(rows), mp.matrix([target(z) for z in nodes]))
        coefficients, level = solution[:-1], abs(solution[-1])
        errors = [weight(z) * (sum(c * z**p for c, p in zip(coefficients, powers)) - target(z)) for z in grid]
        extrema, best = [], 0
        for i in range(1, len(grid) + 1):
            if i == len(grid) or (errors[i] > 0) != (errors[best] > 0):
                extrema.append(best)
                best = i
            elif abs(errors[i]) > abs(errors[best]):
                best = i
        while len(extrema) > count + 1:
            extrema.pop(0 if abs(errors[extrema[0]]) < abs(errors[extrema[-1]]) else -1)
        if len(extrema) < count + 1:
            break
        nodes = [grid[i] for i in extrema]
        worst = max(abs(errors[i]) for i in extrema)
        if worst < level * mp.mpf("1.0001"):
            break
    return coefficients, max(abs(e) for e in errors)


def fit(target, weight, powers, to_type, start, end):
    """Rounded coefficients: round the lowest power, fit the others again, and so on."""
    fixed = []
    for i in range(len(powers)):
        rest = lambda z: target(z) - sum(mp.mpf(float(c)) * z**p for c, p in zip(fixed, powers))
        coefficients, _ = remez(rest, weight, powers[i:], start, end)
        fixed.append(to_type(float(coefficients[0])))
    polynomial = lambda z: sum(mp.mpf(float(c)) * z**p for c, p in zip(fixed, powers))
    steps = [start + (end - start) * mp.mpf(i) / 1000 for i in range(1001)]
    return fixed, max(abs(weight(z) * (polynomial(z) - target(z))) for z in steps)


def sine_tail(z):
    """(sin r / r - 1)/z with z = r^2."""
    return sum((-1) ** (k + 1) * z**k / mp.factorial(2 * k + 3) for k in range(14))


def cosine_tail(z):
    """(cos r - 1 + z/2)/z^2 with z = r^2."""
    return sum((-1) ** k * z**k / mp.factorial(2 * k + 4) for k in range(14))


def pi_over_two(bits, digits):
    """pi/2 in parts: each but the last holds `bits` significant bits, so that whole multiples of it are exact."""
    rest, parts = mp.pi / 2, []
    for count in bits:
        exponent = int(mp.floor(mp.log(rest, 2)))
        part = mp.floor(rest / mp.mpf(2) ** (exponent + 1 - count)) * mp.mpf(2) ** (exponent + 1 - count)
        parts.append(part)
        rest -= part
    return [float(p) for p in parts] + [digits(float(rest))]


def show(name, values, error=None):
    note = "" if error is None else f"   // error of the fit {mp.nstr(error, 2)}"
    print(f"{name}: {', '.join(np.format_float_positional(v, unique=True, trim='0') for v in values)}{note}")


TINY = mp.mpf("1e-12")
for name, kind, terms in (("f32", np.float32, 3), ("f64", np.float64, 6)):
    print(name)
    powers = list(range(terms))
    absolute = lambda z: mp.sqrt(z) * z
    relative = lambda z: z
    show("  sine  ", *fit(sine_tail, absolute if name == "f32" else relative, powers, kind, TINY, EDGE**2))
    show("  cosine", *fit(cosine_tail, lambda z: z * z, powers, kind, TINY, EDGE**2))

show("pi/2 f32", pi_over_two([11, 11], np.float32))
show("pi/2 f64", pi_over_two([33, 33], np.float64))
