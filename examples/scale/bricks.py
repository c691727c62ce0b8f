#!/usr/bin/env python3
"""Writes a turned wall of so many bricks as OBJ: bricks of 2 m by 1 m by 1 m in layers of a hundred by ten, every other
layer moved by half a brick, turned by 3-4-5 about z and then about x. Rounded coordinates make neighbours touch, miss
each other or overlap by roundoffs.

    python3 bricks.py 100000 > bricks.obj
"""

import sys

CORNERS = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0), (0, 0, 1), (2, 0, 1), (2, 1, 1), (0, 1, 1)]
FACES = [(1, 4, 3, 2), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8)]


def turned(a, b):
    return (3 * a - 4 * b) / 5, (4 * a + 3 * b) / 5


def main():
    out = []
    for k in range(int(sys.argv[1])):
        start = (2 * (k % 100) + k // 1000 % 2, k // 100 % 10, k // 1000)
        out.append(f"o brick{k}")
        for corner in CORNERS:
            x, y, z = (s + c for s, c in zip(start, corner))
            x, y = turned(x, y)
            y, z = turned(y, z)
            out.append(f"v {x!r} {y!r} {z!r}")
        for face in FACES:
            out.append("f " + " ".join(str(8 * k + v) for v in face))
    print("\n".join(out))


main()
