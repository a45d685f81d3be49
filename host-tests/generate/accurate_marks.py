"""Makes the table of marks in kernel/src/sine/own_f32.rs.

    python3 -m pip install mpmath numpy
    python3 host-tests/generate/accurate_marks.py

A mark is an angle near k pi/32 whose sine and cosine both lie very close to numbers of the type, so that the table's
entries carry some ten bits more than the type holds (S. Gal, B. Bachelis, "An accurate elementary mathematical library
for the IEEE floating point standard", ACM TOMS 17, 1991). What the mark is beside k pi/32 is a number of the type.
"""

import mpmath as mp
import numpy as np

mp.mp.dps = 40
UNIT, REACH = 2.0**-26, 0.003

for k in range(9):
    centre = mp.pi * k / 32
    offsets = np.arange(-int(REACH / UNIT), int(REACH / UNIT) + 1) * UNIT if k else np.zeros(1)
    # sin and cos of centre + offset to 1e-19 by the addition theorem, in extended precision.
    s, c = np.longdouble(mp.nstr(mp.sin(centre), 30)), np.longdouble(mp.nstr(mp.cos(centre), 30))
    small = offsets.astype(np.longdouble)
    sine = s * np.cos(small) + c * np.sin(small)
    cosine = c * np.cos(small) - s * np.sin(small)
    miss = np.maximum(abs(sine - sine.astype(np.float32)), abs(cosine - cosine.astype(np.float32)))
    best = int(np.argmin(miss))
    values = offsets[best].astype(np.float32), sine[best].astype(np.float32), cosine[best].astype(np.float32)
    print("    [" + ", ".join(str(v) for v in values) + f"],   // misses by {float(miss[best]):.1e}")
