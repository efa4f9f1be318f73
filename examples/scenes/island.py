# Writes island.off, the mountain of island.json: a height field of ridged noise on a cone, in metres, z up.
#   python3 island.py > island.off
import math

SIDE, CELL = 45, 75.0  # points along a side, metres between them


def chance(x, z):
    """A number from 0 to 1 that belongs to a lattice point."""
    n = (x * 374761393 + z * 668265263 + 12345) & 0xFFFFFFFF
    n = ((n ^ (n >> 13)) * 1274126177) & 0xFFFFFFFF
    return (n ^ (n >> 16)) / 0xFFFFFFFF


def smooth(x, z):
    i, k = math.floor(x), math.floor(z)
    u, v = (t * t * (3 - 2 * t) for t in (x - i, z - k))
    low = chance(i, k) + u * (chance(i + 1, k) - chance(i, k))
    high = chance(i, k + 1) + u * (chance(i + 1, k + 1) - chance(i, k + 1))
    return low + v * (high - low)


def height(x, z):
    radius = math.hypot(x, 1.25 * z) / (0.5 * SIDE * CELL)
    ridges = sum(0.5**k * (1 - abs(2 * smooth(x / 620 * 2**k + 9, z / 620 * 2**k + 4) - 1)) for k in range(4))
    return max(1500 * (max(0, 1 - radius) ** 1.6) * (0.45 + 0.4 * ridges) - 30, -60)


middle = (SIDE - 1) / 2
print("OFF")
print(SIDE * SIDE, (SIDE - 1) ** 2, 0)
for k in range(SIDE):
    for i in range(SIDE):
        x, z = (i - middle) * CELL, (k - middle) * CELL
        print(f"{x:g} {z:g} {height(x, z):.0f}")
for k in range(SIDE - 1):
    for i in range(SIDE - 1):
        a = k * SIDE + i
        print(4, a, a + 1, a + SIDE + 1, a + SIDE)
