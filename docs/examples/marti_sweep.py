#!/usr/bin/env python3
"""Reads the store of a sweep (docs/sweep.md): its axes, figures and points, the best within a budget, a plot.

In a notebook, with this one file beside it:

    import marti_sweep
    sweep = marti_sweep.load("out")                          # the directory of `marti sweep ... -o out`
    sweep.axes                                               # ["machine.nodes", "cache.size"]
    sweep.figures["hit_ratio"]                               # unit, meaning, which is better, formula
    sweep.points("end", "speed_up", where={"cache.size": 16384})  # a dict for each point that has been timed
    sweep.frame("end", "speed_up")                           # the same as a DataFrame of pandas
    sweep.best("end", budget=30)                             # the point with the shortest frame for that cost
    sweep.plot("speed_up", "machine.nodes", by="cache.size") # a figure of matplotlib

In a shell:

    marti_sweep.py out                        what there is: axes, points, figures
    marti_sweep.py out --csv end speed_up     points as CSV
    marti_sweep.py out --best end --budget 30
    marti_sweep.py out --plot speed_up --over machine.nodes --by cache.size -o figure.svg

Names, units and values are those of `marti sweep --json` and of points.csv. Only Python's own library is needed; a
DataFrame needs pandas, a plot matplotlib.
"""

import argparse
import csv
import difflib
import os
import pathlib
import signal
import sqlite3
import sys

FORMAT = 5
POINT_COLUMNS = ("ordinal", "machine", "base", "cost")


class SweepError(Exception):
    """What is wrong with a store or with what was asked of it, in a sentence."""


def load(path):
    """The sweep in this directory, or of this results.sqlite."""
    return Sweep(path)


class Sweep:
    def __init__(self, path):
        path = pathlib.Path(path)
        self.path = path / "results.sqlite" if path.is_dir() else path
        if not self.path.is_file():
            raise SweepError(f"{self.path}: there is no such store of a sweep")
        # A store that nobody writes can be read where nothing may be written, without its log.
        logged = os.path.exists(f"{self.path}-wal")
        uri = self.path.resolve().as_uri() + ("?mode=ro" if logged else "?mode=ro&immutable=1")
        self._database = sqlite3.connect(uri, uri=True)
        try:
            store = dict(self._database.execute("SELECT what, value FROM store"))
            found = int(store.get("format", 0))
        except (sqlite3.Error, ValueError) as error:
            raise SweepError(f"{self.path}: is not the store of a sweep ({error})") from None
        if found != FORMAT:
            raise SweepError(f"{self.path}: is of format {found}, but this reads format {FORMAT}")
        self.version = store.get("version", "unknown")
        columns = list(self._database.execute("SELECT name, type FROM pragma_table_info('points')"))
        #: The keys that differ from point to point, as in the configuration; "point" for named points.
        self.axes = [name for name, _ in columns if name not in POINT_COLUMNS]
        self._flags = {name for name, kind in columns if kind == "BOOLEAN"}
        self._summary = self._names("summary")
        self._counters = [n for n in self._names("results") if n not in ("machine", "checksum", *self._summary)]
        #: What is known of each figure: a dict with "unit", "meaning", "better", "formula".
        self.figures = self._catalogue()

    def _names(self, table):
        return [name for (name,) in self._database.execute("SELECT name FROM pragma_table_info(?)", (table,))]

    def _catalogue(self):
        names = {"unit": "unit", "description": "meaning", "better": "better", "formula": "formula"}
        wanted = {*self._summary, *self._counters} - {*POINT_COLUMNS, *self.axes} | {"cost"}
        figures = {}
        for name, *row in self._database.execute(
            f"SELECT name, {', '.join(names)} FROM columns WHERE \"table\" IN ('summary', 'results')"
        ):
            if name in wanted:
                figures[name] = dict(zip(names.values(), row))
        return figures

    def _column(self, name):
        if name in self._summary:
            return "s." + _quoted(name)
        if name in self._counters:
            return "r." + _quoted(name)
        near = difflib.get_close_matches(name, self.names(), 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise SweepError(f"{self.path}: there is no figure and no axis {name!r}{hint}")

    def names(self):
        """Everything that a point has, in the order of points.csv."""
        return [*self._summary, *self._counters]

    def points(self, *names, where=None):
        """The points that have been timed, in order, as dicts with the axes and the figures of these names; without
        names with everything. `where`: only those with these values, for example {"machine.nodes": 8}. A figure that
        a machine does not have is None."""
        names = list(dict.fromkeys([*self.axes, *names])) if names else self.names()
        conditions, values = ["r.machine IS NOT NULL"], []
        for name, value in (where or {}).items():
            conditions.append(f"{self._column(name)} IS ?")
            values.append(value)
        rows = self._database.execute(
            f"SELECT {', '.join(map(self._column, names)) or '1'} FROM summary s "
            f"LEFT JOIN results r ON r.machine = s.machine WHERE {' AND '.join(conditions)} ORDER BY s.ordinal",
            values,
        )
        return [{name: self._value(name, value) for name, value in zip(names, row)} for row in rows]

    def _value(self, name, value):
        return bool(value) if name in self._flags and value is not None else value

    def frame(self, *names, where=None):
        """points() as a pandas.DataFrame, with the ordinals as its index."""
        import pandas

        rows = self.points(*({"ordinal": None, **dict.fromkeys(names or self.names())}), where=where)
        return pandas.DataFrame(rows).set_index("ordinal")

    def better(self, figure):
        """+1 if more of the figure is better, -1 if less is. SweepError where neither is."""
        self._column(figure)
        known = {"higher": 1, "lower": -1}.get(self.figures.get(figure, {}).get("better"))
        if known is None and not any("better" in each for each in self.figures.values()):
            raise SweepError(f"{self.path}: a store of an older marti does not say which values of {figure} are better")
        if known is None:
            raise SweepError(f"of {figure} neither a lower nor a higher value is better")
        return known

    def best(self, figure="end", budget=None, where=None):
        """The point with the best figure whose cost is not above the budget; of equal ones the cheapest, then the
        first. None when there is none."""
        sign = self.better(figure)
        points = [
            point
            for point in self.points("ordinal", "cost", figure, where=where)
            if point[figure] is not None and (budget is None or point["cost"] <= budget)
        ]
        return min(points, key=lambda p: (-sign * p[figure], p["cost"], p["ordinal"]), default=None)

    def plot(self, figure, over, by=None, where=None, axes=None):
        """Draws a figure over an axis with matplotlib, a line for each value of `by`, on `axes` or on new ones, which
        are returned."""
        if axes is None:
            from matplotlib import pyplot

            _, axes = pyplot.subplots(figsize=(6, 4), layout="constrained")
        lines = {}
        for point in self.points(over, figure, *([by] if by else []), where=where):
            if point[figure] is not None and point[over] is not None:
                lines.setdefault(point[by] if by else None, []).append((point[over], point[figure]))
        for value, line in sorted(lines.items(), key=lambda item: (str(type(item[0])), item[0])):
            axes.plot(*zip(*sorted(line)), marker="o", label=f"{by} = {value}")
        unit = self.figures.get(figure, {}).get("unit", "")
        axes.set(xlabel=over, ylabel=figure if unit in ("", "1") else f"{figure} ({unit})")
        if by:
            axes.legend()
        return axes


def _quoted(name):
    return '"' + name.replace('"', '""') + '"'


def _print_csv(points):
    writer = csv.writer(sys.stdout, lineterminator="\n")
    if points:
        writer.writerow(points[0])
    writer.writerows([str(value).lower() if isinstance(value, bool) else value for value in point.values()] for point in points)


def _save(sweep, arguments):
    import matplotlib

    svg = arguments.output.endswith(".svg")
    matplotlib.use("svg" if svg else "agg")
    matplotlib.rcParams["svg.hashsalt"] = "marti"  # the same points give the same bytes
    axes = sweep.plot(arguments.plot, arguments.over or sweep.axes[0], arguments.by)
    axes.figure.savefig(arguments.output, metadata={"Date": None} if svg else None)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sweep", help="directory of a sweep, or its results.sqlite")
    parser.add_argument("--csv", nargs="*", metavar="FIGURE", help="print points; without names with everything")
    parser.add_argument("--best", metavar="FIGURE")
    parser.add_argument("--budget", type=float, metavar="COST")
    parser.add_argument("--plot", metavar="FIGURE")
    parser.add_argument("--over", metavar="AXIS", help="the first axis if not given")
    parser.add_argument("--by", metavar="AXIS", help="a line for each of its values")
    parser.add_argument("-o", "--output", default="figure.svg")
    arguments = parser.parse_args()
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # `| head` is no error
    try:
        sweep = load(arguments.sweep)
        if arguments.csv is not None:
            _print_csv(sweep.points(*arguments.csv))
        elif arguments.best:
            best = sweep.best(arguments.best, arguments.budget)
            _print_csv([best] if best else [])
        elif arguments.plot:
            _save(sweep, arguments)
        else:
            count = len(sweep.points("cost"))
            print(f"{count} point{'' if count == 1 else 's'} of marti {sweep.version}")
            print("axes:   ", ", ".join(sweep.axes))
            for name, known in sweep.figures.items():
                print(f"{name:<32}{known['unit']:<8}{known['meaning']}")
    except SweepError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
