#!/usr/bin/env python3
"""random_reads.py COUNT CHANCE: so many reads of 64 bytes in 1 GiB as DRAMsim3 reads them; in each cycle of the memory one
comes with this chance. Numbers are those of splitmix64 (Steele, Lea, Flood, OOPSLA 2014), seeds 12345 and 67890."""

import sys

ALL = (1 << 64) - 1


def splitmix64(state):
    while True:
        state = state + 0x9E3779B97F4A7C15 & ALL
        mixed = (state ^ state >> 30) * 0xBF58476D1CE4E5B9 & ALL
        mixed = (mixed ^ mixed >> 27) * 0x94D049BB133111EB & ALL
        yield mixed ^ mixed >> 31


def main(count, chance):
    addresses, arrivals = splitmix64(12345), splitmix64(67890)
    cycle = 0
    while count > 0:
        if (next(arrivals) >> 11) * 2.0**-53 < chance:
            print(f"0x{64 * (next(addresses) % 2**24):x} READ {cycle}")
            count -= 1
        cycle += 1


if __name__ == "__main__":
    main(int(sys.argv[1]), float(sys.argv[2]))
