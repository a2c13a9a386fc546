#!/usr/bin/env python3
"""lidar.py BEAMS STEPS: the rays of a lidar that turns once, as an array of NumPy (numpy.save would write the same file):
in each of so many steps so many beams, one above the other from 25 degrees down to 15 degrees up, up to 100 away."""

import array
import math
import sys


def rays(beams, steps, at=(0.0, 6.0, 3.0), reach=100.0):
    for step in range(steps):
        around = 2.0 * math.pi * step / steps
        for beam in range(beams):
            up = math.radians(-25.0 + 40.0 * (beam + 0.5) / beams)
            yield from (*at, 0.0)
            yield from (math.cos(up) * math.cos(around), math.cos(up) * math.sin(around), math.sin(up), reach)


def main(beams, steps):
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({beams * steps}, 8), }}".ljust(117) + "\n"
    sys.stdout.buffer.write(b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode())
    array.array("f", rays(beams, steps)).tofile(sys.stdout.buffer)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
