#!/usr/bin/env python3
"""Reads the store of a sweep and draws one figure of it, or prints its rows.

read_store.py out/results.sqlite --x machine.nodes --y speed_up --by cache.size -o figure.svg   (or --csv)

Every column of the view `summary` can be an axis: keys, counters and what is derived (docs/sweep-store.md). The table
`columns` knows the unit and meaning of each. Only the figure needs matplotlib.
"""

import argparse
import csv
import sqlite3
import sys


def read(store, x, y, by):
    """Rows (by, x, y) of the points that have been timed, and the unit of y."""
    with sqlite3.connect(f"file:{store}?mode=ro", uri=True) as database:
        names = [row[1] for row in database.execute("PRAGMA table_info(summary)")]
        for name in (x, y, by):
            if name not in names:
                sys.exit(f"{store}: there is no column {name}; there are {', '.join(names)}")
        rows = database.execute(f'SELECT "{by}", "{x}", "{y}" FROM summary WHERE "{y}" IS NOT NULL '
                                f'ORDER BY "{by}", "{x}"').fetchall()
        unit = database.execute("SELECT unit FROM columns WHERE name = ?", (y,)).fetchone()
    return rows, unit[0] if unit else ""


def draw(rows, x, y, by, unit, file):
    import matplotlib
    matplotlib.use("svg" if file.endswith(".svg") else "agg")
    matplotlib.rcParams["svg.hashsalt"] = "marti"  # the same rows give the same bytes
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(figsize=(6, 4), layout="constrained")
    for value in sorted({row[0] for row in rows}):
        line = [(row[1], row[2]) for row in rows if row[0] == value]
        axes.plot(*zip(*line), marker="o", label=f"{by} = {value}")
    axes.set(xlabel=x, ylabel=y if unit in ("", "1") else f"{y} ({unit})")
    axes.legend()
    figure.savefig(file, metadata={"Date": None} if file.endswith(".svg") else None)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("store")
    parser.add_argument("--x", default="machine.nodes")
    parser.add_argument("--y", default="speed_up")
    parser.add_argument("--by", default="cache.size", help="a line for each of its values")
    parser.add_argument("--csv", action="store_true", help="print the rows instead of drawing them")
    parser.add_argument("-o", "--output", default="figure.svg")
    arguments = parser.parse_args()
    rows, unit = read(arguments.store, arguments.x, arguments.y, arguments.by)
    if arguments.csv:
        csv.writer(sys.stdout, lineterminator="\n").writerows([(arguments.by, arguments.x, arguments.y), *rows])
    else:
        draw(rows, arguments.x, arguments.y, arguments.by, unit, arguments.output)


if __name__ == "__main__":
    main()
