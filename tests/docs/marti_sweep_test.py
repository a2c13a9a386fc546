#!/usr/bin/env python3
"""marti_sweep_test.py MARTI SOURCE [PYTHON_WITH_MATPLOTLIB [PYTHON_WITH_PANDAS]]: docs/examples/marti_sweep.py on the
store of a real sweep has the names, units and values that `marti sweep --json` and points.csv have."""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

MARTI, SOURCE, DRAWING, FRAMING, *_ = [*sys.argv[1:], "", ""]
MODULE = pathlib.Path(SOURCE) / "docs" / "examples" / "marti_sweep.py"
sys.path.insert(0, str(MODULE.parent))
sys.modules["pandas"] = None  # the module must do without
import marti_sweep

CONFIG = """
scene.source = "teapot:2"
image.width = 16
image.height = 12
[prices]
node = 1
cache_kib = 0.25
[sweep.axes]
machine.nodes = [1, 2, 5]
cache.size = ["512 B", "4 KiB"]
node.clock = ["33 MHz", "66 MHz"]
prefetch.next_line = [false, true]
interconnect.kind = ["bus", "crossbar"]
"""


def run(*command, status=0):
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == status, (command, done.returncode, done.stdout, done.stderr)
    return done.stdout if status == 0 else done.stderr


class TheModule(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.work.name) / "out"
        config = pathlib.Path(cls.work.name) / "sweep.toml"
        config.write_text(CONFIG)
        cls.command = (MARTI, "sweep", str(config), "-o", str(cls.out), "--quiet", "--json")
        cls.json = json.loads(run(*cls.command))
        cls.sweep = marti_sweep.load(cls.out)

    @classmethod
    def tearDownClass(cls):
        cls.work.cleanup()

    def test_values_are_those_of_json(self):
        points = self.sweep.points()
        self.assertEqual(len(points), 48)
        self.assertEqual(len(points), len(self.json["rows"]))
        for point, row in zip(points, self.json["rows"]):
            # The advice has a table of its own.
            expected = {name: value for name, value in row.items() if not name.startswith("advice")}
            self.assertEqual(point, expected)
            for name, value in point.items():
                self.assertEqual(type(value), type(expected[name]), name)
        self.assertEqual({type(row["prefetch.next_line"]) for row in self.json["rows"]}, {bool})
        self.assertEqual({row["cache.size"] for row in self.json["rows"]}, {512, 4096})
        self.assertEqual({row["node.clock"] for row in self.json["rows"]}, {33e6, 66e6})

    def test_names_and_units_are_those_of_json_and_csv(self):
        columns = {column["name"]: column["unit"] for column in self.json["columns"]}
        with open(self.out / "points.csv", newline="") as file:
            table = list(csv.DictReader(file))
        self.assertEqual(list(table[0]), list(columns))
        names = [name for name in columns if not name.startswith("advice")]
        self.assertEqual(self.sweep.names(), names)
        for name, known in self.sweep.figures.items():
            self.assertEqual(known["unit"], columns[name], name)
        self.assertEqual(columns["cache.size"], "byte")
        self.assertEqual(columns["node.clock"], "Hz")
        text = {True: "true", False: "false", None: ""}
        for point, row in zip(self.sweep.points(), table):
            for name, value in point.items():
                if isinstance(value, float):
                    self.assertEqual(float(row[name]), value, name)
                else:
                    self.assertEqual(row[name], text[value] if value is None or value is True or value is False
                                     else str(value), name)

    def test_figures_are_those_of_the_catalogue(self):
        catalogue = run(MARTI, "figures")
        for name, known in self.sweep.figures.items():
            if name != "cost":
                self.assertIn(f"  {name} ", catalogue)
                self.assertIn(known["meaning"], catalogue)

    def test_points_of_some_values(self):
        where = {"machine.nodes": 5, "prefetch.next_line": True}
        points = self.sweep.points("end", where=where)
        expected = [row for row in self.json["rows"] if all(row[key] == value for key, value in where.items())]
        self.assertEqual([point["end"] for point in points], [row["end"] for row in expected])
        self.assertEqual(len(points), 8)
        self.assertEqual(list(points[0]), [*self.sweep.axes, "end"])

    def test_best_is_that_of_the_program(self):
        for figure in ("end", "hit_ratio"):
            for budget in (None, 5.2, 12):
                more = () if budget is None else ("--budget", str(budget))
                rows = json.loads(run(*self.command, "--best", figure, *more))["rows"]
                expected = next(row for row in rows if row["best"])
                best = self.sweep.best(figure, budget)
                self.assertEqual((best["cost"], best[figure]), (expected["cost"], expected[figure]))
        self.assertIsNone(self.sweep.best("end", budget=0))

    def test_a_wrong_question_is_one_message(self):
        for ask in (lambda: self.sweep.points("hit_rato"), lambda: self.sweep.best("nodes"),
                    lambda: self.sweep.points(where={"no.key": 1}), lambda: marti_sweep.load(self.work.name),
                    lambda: marti_sweep.load(self.out / "points.csv")):
            self.assertRaises(marti_sweep.SweepError, ask)
        self.assertIn("did you mean 'hit_ratio'", run(sys.executable, str(MODULE), str(self.out), "--csv", "hit_rato",
                                                      status=1))

    def test_runs_in_a_shell(self):
        lines = run(sys.executable, "-B", str(MODULE), str(self.out), "--csv", "speed_up").splitlines()
        self.assertEqual(lines[0], ",".join([*self.sweep.axes, "speed_up"]))
        self.assertEqual(len(lines), 49)
        self.assertTrue(run(sys.executable, "-B", str(MODULE), str(self.out)).startswith("48 points of marti "))

    def test_one_point_is_one(self):
        config = pathlib.Path(self.work.name) / "one.toml"
        config.write_text(CONFIG.split("[sweep.axes]")[0] + "[sweep.axes]\nmachine.nodes = [2]\n")
        out = pathlib.Path(self.work.name) / "one"
        run(MARTI, "sweep", str(config), "-o", str(out), "--quiet")
        self.assertTrue(run(sys.executable, "-B", str(MODULE), str(out)).startswith("1 point of marti "))

    def test_a_store_of_another_program_is_refused(self):
        store = pathlib.Path(self.work.name) / "other.sqlite"
        store.write_bytes((self.out / "results.sqlite").read_bytes())
        import sqlite3
        with sqlite3.connect(store) as database:
            database.execute("UPDATE store SET value = '99' WHERE what = 'format'")
        database.close()
        with self.assertRaisesRegex(marti_sweep.SweepError, "is of format 99, but this reads format 5"):
            marti_sweep.load(store)

    def test_plots_a_line_for_each_value(self):
        class Axes:  # stands for matplotlib's
            lines = {}
            plot = lambda self, x, y, marker, label: self.lines.update({label: list(zip(x, y))})
            set = lambda self, xlabel, ylabel: vars(self).update(xlabel=xlabel, ylabel=ylabel)
            legend = lambda self: None
        where = {"node.clock": 33e6, "interconnect.kind": "bus", "prefetch.next_line": False}
        axes = self.sweep.plot("end", "machine.nodes", by="cache.size", where=where, axes=Axes())
        self.assertEqual((axes.xlabel, axes.ylabel), ("machine.nodes", "end (ps)"))
        self.assertEqual(sorted(axes.lines), ["cache.size = 4096", "cache.size = 512"])
        for row in self.json["rows"]:
            if all(row[key] == value for key, value in where.items()):
                self.assertIn((row["machine.nodes"], row["end"]), axes.lines[f"cache.size = {row['cache.size']}"])

    @unittest.skipUnless(DRAWING, "there is no matplotlib")
    def test_draws(self):
        drawn = []
        for name in ("a.svg", "b.svg"):
            file = pathlib.Path(self.work.name) / name
            run(DRAWING, "-B", str(MODULE), str(self.out), "--plot", "speed_up", "--over", "machine.nodes", "--by",
                "cache.size", "-o", str(file))
            drawn.append(file.read_bytes())
        self.assertEqual(drawn[0], drawn[1])
        self.assertIn(b"<svg", drawn[0])
        for label in ("machine.nodes", "speed_up", "cache.size = 512", "cache.size = 4096"):
            self.assertIn(label.encode(), drawn[0])  # matplotlib writes each text as a comment above its glyphs

    @unittest.skipUnless(FRAMING, "there is no pandas")
    def test_makes_a_frame(self):
        ask = ("import json, sys; sys.path.insert(0, sys.argv[1]); import marti_sweep; "
               "frame = marti_sweep.load(sys.argv[2]).frame('end', 'hit_ratio', where={'cache.size': 512}); "
               "print(json.dumps({'index': [frame.index.name, *map(int, frame.index)], "
               "'types': {name: str(kind) for name, kind in frame.dtypes.items()}, "
               "'rows': json.loads(frame.to_json(orient='records', double_precision=15))}))")
        made = json.loads(run(FRAMING, "-B", "-c", ask, str(MODULE.parent), str(self.out)))
        expected = [row for row in self.json["rows"] if row["cache.size"] == 512]
        self.assertEqual(made["index"], ["ordinal", *(row["ordinal"] for row in expected)])
        self.assertEqual(made["types"]["prefetch.next_line"], "bool")
        self.assertEqual(made["types"]["end"], "int64")
        self.assertEqual(made["types"]["hit_ratio"], "float64")
        names = [*self.sweep.axes, "end", "hit_ratio"]
        self.assertEqual(list(made["types"]), names)
        for row, wanted in zip(made["rows"], expected, strict=True):
            for name in names:
                check = self.assertAlmostEqual if name == "hit_ratio" else self.assertEqual
                check(row[name], wanted[name])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
