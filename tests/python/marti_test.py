#!/usr/bin/env python3
"""marti_test.py PROGRAM SOURCE: import marti says what the program says, ends on Ctrl-C, and names what is wrong."""

import concurrent.futures
import csv
import importlib.util
import json
import multiprocessing
import os
import pathlib
import pickle
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import marti
import numpy
import pandas

PROGRAM = sys.argv[1]
SOURCE = pathlib.Path(sys.argv[2])
SMALL = {"scene.source": "tetra:3", "image.width": 32, "image.height": 24}
AXES = {"machine.nodes": [1, 2, 4], "cache.size": ["1KiB", "4KiB"]}


def program(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def given(settings):
    return [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]


def axes_given(axes):
    return [word for key, values in axes.items() for word in ("--axis", f"{key}={','.join(map(str, values))}")]


def ends_once(work, marker):
    """Ends the worker process the first time that any does this."""
    try:
        os.close(os.open(marker, os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return work()
    os._exit(9)


class OneByOne(concurrent.futures.Executor):
    """An executor whose workers are a process each, so that the end of one is not that of the others. The first ends."""

    def __init__(self, marker):
        self.marker = marker

    def submit(self, function, /, *arguments):
        future = concurrent.futures.Future()

        def wait():
            with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
                try:
                    future.set_result(pool.submit(ends_once, Call(function, arguments), self.marker).result())
                except Exception as failure:
                    future.set_exception(failure)

        threading.Thread(target=wait).start()
        return future


class Call:
    def __init__(self, function, arguments):
        self.function, self.arguments = function, arguments

    def __call__(self):
        return self.function(*self.arguments)


class Runs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.config = SOURCE / "configs" / "marti.toml"
        cls.result = marti.run(cls.config, SMALL, machine__nodes=4)
        cls.printed = json.loads(program("run", cls.config, "--json", *given({**SMALL, "machine.nodes": 4})))

    def test_every_figure_is_that_of_the_program(self):
        machine, frame = self.printed["figures"]["machine"], self.printed["figures"]["frame"]
        texts = {"scene", "image_hash", "hit_hash"}  # which are no figures
        values = {**machine, **{"frame." + name: value for name, value in frame.items() if name not in texts}}
        self.assertEqual(dict(self.result.figures["value"]), values)
        for name, value in machine.items():
            self.assertEqual(getattr(self.result, name), value, name)
            self.assertEqual(type(self.result[name]), type(value), name)
        self.assertEqual(self.result["frame.camera_rays"], 32 * 24)
        self.assertEqual(self.result.figures.loc["end", "unit"], "ps")
        self.assertIn("end", dir(self.result))
        self.assertIsNone(self.result.simt_rays)
        self.assertEqual(self.result.settings["machine.nodes"], "4")

    def test_json_and_summary_are_those_of_the_program(self):
        def without_advice(result):
            result["machine"].pop("what_helps")  # as far as the time went
            return result

        self.assertEqual(without_advice(self.result.json), without_advice(dict(self.printed)))
        self.assertIn("frame time", self.result.summary)
        self.assertTrue(repr(self.result).startswith("<marti.Result: answer"))

    def test_keys_may_be_arguments(self):
        result = marti.run(machine__nodes=2, scene__source="tetra:2", image__width=8, image__height=8)
        self.assertEqual(result.settings["machine.nodes"], "2")
        self.assertEqual(result["frame.camera_rays"], 64)

    def test_what_is_saved_opens_as_it_was(self):
        with tempfile.TemporaryDirectory() as directory:
            self.result.save(directory)
            opened = marti.open(directory)
            pandas.testing.assert_frame_equal(opened.figures, self.result.figures)
            self.assertEqual(opened.image.shape, (24, 32, 3))
            self.assertEqual(opened.image.dtype, numpy.float32)
            numpy.testing.assert_array_equal(opened.image, self.result.image)
            self.assertGreater(self.result.image.max(), 0.1)
            self.assertEqual(opened.report().html, self.result.report().html)
            with self.assertRaisesRegex(marti.Error, "already"):
                opened.save(directory)

    def test_a_run_may_record_into_a_directory(self):
        with tempfile.TemporaryDirectory() as directory:
            result = marti.run(self.config, SMALL, directory=directory, machine__nodes=4, record__timeline=True)
            self.assertEqual(result.end, self.result.end)
            self.assertTrue(pathlib.Path(directory, "timeline.json").exists())
            numpy.testing.assert_array_equal(result.image, self.result.image)
            self.assertIn("timeline", result.summary)
            with self.assertRaisesRegex(marti.Error, "already"):
                result.save(directory)
        with self.assertRaisesRegex(marti.Error, "record.timeline"):
            marti.run(self.config, SMALL, record__timeline=True)

    def test_rays_may_be_an_array(self):
        numbers = numpy.random.default_rng(3)
        rays = numpy.zeros((500, 9))
        rays[:, 0:3] = numbers.uniform(-1.0, 1.0, (500, 3))
        rays[:, 4:7] = numbers.normal(size=(500, 3))
        rays[:, 7] = numpy.where(numpy.arange(500) % 3 == 0, 0.5, numpy.inf)
        rays[::2, 8] = 1
        scene = {"scene.source": "tetra:3"}
        for array in (rays, rays[:, :8], rays.astype(numpy.float32), numpy.asfortranarray(rays)):
            with tempfile.TemporaryDirectory() as directory:
                result = marti.run(self.config, scene, rays=array, directory=directory)
                file = pathlib.Path(directory, "dumped.npy")
                numpy.save(file, numpy.ascontiguousarray(array))
                of_file = {**scene, "image.integrator": "rays", "image.rays": file}
                printed = json.loads(program("run", self.config, "--json", *given(of_file)))
                self.assertEqual(result.end, printed["figures"]["machine"]["end"])
                self.assertEqual(result["frame.camera_rays"], 250 if array.shape[1] == 9 else 500)
                hits = result.ray_hits
                # As bytes, because a distance may be no number.
                self.assertEqual(hits.tobytes(), numpy.load(pathlib.Path(directory, "hits.npy")).tobytes())
                self.assertEqual(hits.tobytes(), marti.run(self.config, scene, rays=array).ray_hits.tobytes())
                self.assertEqual(hits.shape, (500,))
                found = hits["primitive"] >= 0
                self.assertGreater(found.sum(), 10)
                numpy.testing.assert_allclose(hits["weights"][found].sum(axis=1), 1.0)
                self.assertTrue((hits["distance"][found] <= array[found, 7]).all())
                self.assertTrue(numpy.isinf(hits["distance"][hits["primitive"] == -1]).all())
                if array.shape[1] == 9:
                    self.assertFalse((array[found, 8] == 1).any())
                    self.assertGreater((hits["primitive"] == -2).sum(), 10)
        with tempfile.TemporaryDirectory() as directory:
            file, log = pathlib.Path(directory, "dumped.npy"), pathlib.Path(directory, "a.log")
            numpy.save(file, rays)
            of_file = {**scene, "image.integrator": "rays", "image.rays": file}
            program("run", self.config, "--save-log", log, *given(of_file))
            logged = marti.run(self.config, {"scene.log": log})
            with self.assertRaisesRegex(marti.Error, "does not know what its rays hit"):
                logged.ray_hits
        with tempfile.TemporaryDirectory() as directory:
            kept = pathlib.Path(directory, "out")
            with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
                sweeps = [marti.sweep(self.config, {"machine.nodes": [2, 4]}, scene, rays=rays),
                          marti.sweep(self.config, {"machine.nodes": [2]}, scene, rays=rays, directory=kept),
                          marti.sweep(self.config, {"machine.nodes": [2, 4]}, scene, rays=rays, directory=kept,
                                      executor=pool, shares=2)]
            for sweep in sweeps:
                for nodes, end in zip(sweep.points["machine.nodes"], sweep.points["end"]):
                    self.assertEqual(marti.run(self.config, scene, rays=rays, machine__nodes=nodes).end, end)
            self.assertEqual(len(list(kept.glob("rays-*.npy"))), 1)
            with self.assertRaisesRegex(marti.Error, "machine.nodes"):
                marti.sweep(self.config, {"machine.nodes": [0]}, rays=rays, directory=pathlib.Path(directory, "wrong"))
            self.assertEqual(os.listdir(directory), ["out"])
        rays[17, 4:7] = 0
        with self.assertRaisesRegex(marti.Error, "ray 17 .*: its direction is 0") as caught:
            marti.run(self.config, scene, rays=rays)
        self.assertEqual(caught.exception.key, "image.rays")
        with self.assertRaisesRegex(marti.Error, "image.integrator"):
            self.result.ray_hits

    def same_result(self, copy, result):
        pandas.testing.assert_frame_equal(copy.figures, result.figures)
        numpy.testing.assert_array_equal(copy.image, result.image)
        self.assertEqual((copy.summary, copy.settings, copy.report().html),
                         (result.summary, result.settings, result.report().html))

    def test_results_can_be_pickled(self):
        copy = pickle.loads(pickle.dumps(self.result))
        self.same_result(copy, self.result)
        self.same_result(pickle.loads(pickle.dumps(copy)), self.result)
        with tempfile.TemporaryDirectory() as directory:
            kept = marti.run(self.config, SMALL, directory=directory, machine__nodes=4)
            data = pickle.dumps(kept)
            self.assertLess(len(data), 10000)  # its name, not its files
            self.same_result(pickle.loads(data), kept)
        with self.assertRaisesRegex(marti.Error, "no such directory"):
            pickle.loads(data)
        with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            brought = pool.submit(marti.run, self.config, SMALL, machine__nodes=4).result()
        self.assertEqual(brought.end, self.result.end)
        numpy.testing.assert_array_equal(brought.image, self.result.image)

    def test_the_page_is_shown_in_notebooks(self):
        page = self.result.report()
        self.assertTrue(page.html.startswith("<!DOCTYPE html>"))
        self.assertIn("<iframe srcdoc=", page._repr_html_())
        with tempfile.TemporaryDirectory() as directory:
            page.save(pathlib.Path(directory, "page.html"))
            self.assertEqual(pathlib.Path(directory, "page.html").read_text(), page.html)
            self.assertEqual(os.listdir(directory), ["page.html"])

    def test_errors_have_file_line_and_key(self):
        with tempfile.TemporaryDirectory() as directory:
            config = pathlib.Path(directory, "wrong.toml")
            config.write_text("[machine]\nnodes = 4\n\n[cache]\nsize = \"3 apples\"\n")
            with self.assertRaises(marti.Error) as caught:
                marti.run(config)
            error = pickle.loads(pickle.dumps(caught.exception))
            self.assertEqual((error.file, error.line, error.key), (str(config), 5, "cache.size"))
            self.assertIsInstance(error, ValueError)
        with self.assertRaises(marti.Error) as caught:
            marti.run(machine__nodes=0)
        self.assertEqual((caught.exception.file, caught.exception.line, caught.exception.key),
                         (None, None, "machine.nodes"))
        with self.assertRaises(marti.Error) as caught:
            marti.run(scene__source="no:such", structure__max_level=3)
        self.assertEqual((caught.exception.file, caught.exception.line, caught.exception.key),
                         (None, None, "scene.source"))
        with tempfile.TemporaryDirectory() as directory:
            config = pathlib.Path(directory, "wrong.toml")
            for text, line, key in (("[machine]\nnode = 4\n", 2, "machine.node"),
                                    ("[cache]\nsize = 16 KiB\n", 2, "cache.size"),
                                    ("[cache]\nways = 3\nsize = \"1 KiB\"\n", 3, "cache.size"),
                                    ("\n[scene]\nsource = \"no: such.obj\"\n", 3, "scene.source"),
                                    ("[sweep]\nfilter = \"cache.size <\"\n[sweep.axes]\nmachine.nodes = [1]\n", 2,
                                     "sweep.filter"),
                                    ("[sweep.axes]\nmachine.nodes = [1, 0]\n", 2, "machine.nodes")):
                config.write_text(text)
                with self.assertRaises(marti.Error) as caught:
                    marti.sweep(config, {"machine.clusters": [1]})
                self.assertEqual((caught.exception.file, caught.exception.line, caught.exception.key),
                                 (str(config), line, key), str(caught.exception))
        with self.assertRaises(marti.Error) as caught:
            marti.run("missing.toml")
        self.assertEqual((caught.exception.file, caught.exception.key), ("missing.toml", None))
        for wrong, words in ((lambda: marti.run("missing.toml"), "no such file"),
                             (lambda: marti.run(machine__node=3), "machine.nodes"),
                             (lambda: self.result["hit_rati"], "hit_ratio"),
                             (lambda: marti.open("missing"), "no such directory"),
                             (lambda: marti.open(SOURCE), "expected is the directory")):
            with self.assertRaisesRegex(marti.Error, words):
                wrong()
        with self.assertRaisesRegex(AttributeError, "hit_ratio"):
            self.result.hit_rati

    def test_ctrl_c_ends_the_work(self):
        timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        began = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            marti.run(scene__source="teapot:20", image__width=4096, image__height=4096, machine__nodes=64)
        self.assertLess(time.monotonic() - began, 20)
        self.assertEqual(marti.run(None, SMALL).end, marti.run(None, SMALL).end)

    def test_ctrl_c_ends_reading_a_scene(self):
        with tempfile.TemporaryDirectory() as directory:
            scene = pathlib.Path(directory, "many.obj")
            side = 900
            points = "".join(f"v {x} {y} {(x * y) % 7}\n" for y in range(side) for x in range(side))
            cells = "".join(f"f {y * side + x + 1} {y * side + x + 2} {y * side + x + side + 1}\n"
                            for y in range(side - 1) for x in range(side - 1))
            scene.write_text(points + cells)
            timer = threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT))
            timer.start()
            with self.assertRaises(KeyboardInterrupt):
                marti.run(None, {"scene.source": scene})

    def test_other_threads_go_on_meanwhile(self):
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            runs = [pool.submit(marti.run, self.config, SMALL, machine__nodes=4) for _ in range(4)]
            self.assertEqual({run.result().end for run in runs}, {self.result.end})


class Sweeps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.config = SOURCE / "configs" / "marti.toml"
        cls.made = tempfile.TemporaryDirectory()
        cls.directory = pathlib.Path(cls.made.name, "program")
        program("sweep", cls.config, "-o", cls.directory, *given(SMALL), *axes_given(AXES))
        cls.sweep = marti.sweep(cls.config, AXES, SMALL)

    @classmethod
    def tearDownClass(cls):
        cls.made.cleanup()

    def same(self, sweep):
        with open(self.directory / "points.csv") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(sweep.points.columns), list(rows[0]))
        self.assertEqual(len(sweep.points), 6)
        for name in sweep.points.columns:
            for row, value in zip(rows, sweep.points[name]):
                if isinstance(value, str):
                    self.assertEqual(row[name], value, name)
                else:
                    self.assertEqual(float(row[name]) if row[name] else None, None if pandas.isna(value) else value, name)

    def test_points_are_those_of_the_program(self):
        self.same(self.sweep)
        self.same(marti.open(self.directory))
        self.assertEqual(self.sweep.axes, ["machine.nodes", "cache.size"])
        self.assertTrue(self.sweep.complete)
        self.assertEqual(self.sweep.points.attrs["units"]["end"], "ps")
        self.assertEqual(self.sweep.best("end", budget=30)["machine.nodes"].max(), 4)
        self.assertIn("<!DOCTYPE html>", self.sweep.report().html)

    def test_sweeps_can_be_pickled(self):
        copy = pickle.loads(pickle.dumps(self.sweep))
        self.same(copy)
        self.same(pickle.loads(pickle.dumps(copy)))
        self.assertNotEqual(copy.directory, self.sweep.directory)
        pandas.testing.assert_frame_equal(copy.best("end"), self.sweep.best("end"))
        self.assertEqual(copy.summary, self.sweep.summary)
        place = copy.directory
        del copy
        self.assertFalse(os.path.exists(place))
        with tempfile.TemporaryDirectory() as directory:
            part = marti.sweep(self.config, AXES, SMALL, directory=directory, share="1/2")
            copy = pickle.loads(pickle.dumps(part))
            self.assertEqual((copy.complete, copy.summary, copy.directory), (False, part.summary, part.directory))
            whole = marti.sweep(self.config, AXES, SMALL, directory=directory)
            self.assertEqual(pickle.loads(pickle.dumps(whole)).directory, whole.directory)

    def test_its_own_directory_goes_with_the_sweep(self):
        sweep = marti.sweep(self.config, {"machine.nodes": [1, 2]}, SMALL)
        place = sweep.directory
        self.assertTrue(os.path.isdir(place))
        del sweep
        self.assertFalse(os.path.exists(place))

    def test_intervals_are_rows_of_the_store(self):
        settings = {**SMALL, "record.interval": "100us", "energy.preset": "45nm"}
        axes = {"machine.nodes": [2, 5], "memory.model": ["fixed", "dram"], "cache.line": [64]}
        with tempfile.TemporaryDirectory() as directory:
            with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
                sweep = marti.sweep(self.config, axes, settings, directory=directory, executor=pool, shares=2)
            store = sqlite3.connect(pathlib.Path(directory, "results.sqlite"))
            store.row_factory = sqlite3.Row
            counted = [row[1] for row in store.execute("PRAGMA table_info(intervals)")][4:]
            for _, given in sweep.points[sweep.axes].iterrows():
                own = {key: str(value) for key, value in given.items()}
                row = store.execute("SELECT * FROM points JOIN results USING (machine) WHERE \"machine.nodes\" = ? AND "
                                    "\"memory.model\" = ?", (int(given["machine.nodes"]), given["memory.model"])).fetchone()
                rows = store.execute("SELECT * FROM intervals WHERE machine = ? ORDER BY ordinal", (row["machine"],)).fetchall()
                self.assertGreater(len(rows), 3)
                self.assertEqual([each["to_ps"] for each in rows[:-1]], [each["from_ps"] for each in rows[1:]])
                self.assertEqual(rows[-1]["to_ps"], row["end"])
                grown = 0
                for name in counted:
                    values = [each[name] for each in rows]
                    if name.startswith("spent_"):
                        continue
                    if values[0] is None:
                        self.assertEqual(set(values), {None}, name)
                    else:
                        self.assertEqual(sum(values), row[name], name)
                        grown += 1
                self.assertGreater(grown, 30)
                self.assertEqual(sum(each[name] for each in rows for name in counted if name.startswith("spent_")),
                                 row["end"] * row["nodes"])
                alone = marti.run(self.config, {**settings, **own}).json["machine"]["intervals"]
                shown = store.execute("SELECT f.*, i.* FROM interval_figures f JOIN intervals i USING (machine, ordinal) "
                                      "WHERE machine = ? ORDER BY ordinal", (row["machine"],)).fetchall()
                self.assertEqual(alone["count"], len(shown))
                for name, values in alone["columns"].items():
                    values = values["values"] if isinstance(values, dict) else values
                    self.assertEqual([each[name] for each in shown], values, name)
            without = store.execute("SELECT COUNT(*) FROM results WHERE machine NOT IN (SELECT machine FROM points)")
            self.assertGreater(without.fetchone()[0], 0)  # machines of one node, that are no points
            self.assertEqual(store.execute("SELECT COUNT(DISTINCT machine) FROM intervals").fetchone()[0], 4)
            store.close()

    def test_shares_are_merged_and_a_lost_one_is_asked_for_again(self):
        with tempfile.TemporaryDirectory() as directory:
            marker = os.path.join(directory, "one worker has ended")
            place = os.path.join(directory, "out")
            sweep = marti.sweep(self.config, AXES, SMALL, directory=place, executor=OneByOne(marker), shares=3)
            self.assertTrue(os.path.exists(marker))
            self.same(sweep)
            self.assertFalse([name for name in os.listdir(place) if "part" in name])

    def test_what_a_broken_executor_leaves_is_timed_here(self):
        with tempfile.TemporaryDirectory() as directory:
            with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
                with self.assertRaises(concurrent.futures.BrokenExecutor):
                    pool.submit(os._exit, 9).result()
                self.same(marti.sweep(self.config, AXES, SMALL, directory=directory, executor=pool, shares=3))

    def test_a_share_needs_a_directory_and_says_what_is_missing(self):
        with self.assertRaisesRegex(marti.Error, "directory"):
            marti.sweep(self.config, AXES, SMALL, share="1/2")
        with tempfile.TemporaryDirectory() as directory:
            part = marti.sweep(self.config, AXES, SMALL, directory=directory, share="1/2")
            self.assertFalse(part.complete)
            self.assertIn("other shares", part.summary)
            self.same(marti.sweep(self.config, AXES, SMALL, directory=directory, share="2/2"))

    def test_ctrl_c_ends_a_sweep_and_keeps_what_is_done(self):
        with tempfile.TemporaryDirectory() as directory:
            timer = threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT))
            timer.start()
            began = time.monotonic()
            with self.assertRaises(KeyboardInterrupt):
                marti.sweep(self.config, {"machine.nodes": list(range(1, 100))}, {"image.width": 512, "image.height": 512},
                            directory=directory)
            self.assertLess(time.monotonic() - began, 20)
            points = marti.sweep(self.config, AXES, SMALL, directory=directory).points
            self.assertEqual(list(points["end"]), list(self.sweep.points["end"]))

    def test_what_is_wrong_for_all_workers_is_told_once(self):
        with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            with self.assertRaisesRegex(marti.Error, "machine.nodes"):
                marti.sweep(self.config, {"machine.nodes": [0]}, SMALL, executor=pool, shares=2)

    def test_dask_is_an_executor(self):
        if not os.environ.get("MARTI_LONG_TESTS"):
            self.skipTest("Dask takes half a minute; ./test --full asks for it")
        try:
            import distributed
        except ImportError:
            self.skipTest("Dask is not installed (Debian: python3-distributed)")
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
            with distributed.Client(cluster) as client, tempfile.TemporaryDirectory() as directory:
                self.same(marti.sweep(self.config, AXES, SMALL, directory=directory, executor=client.get_executor(),
                                      shares=3))

    def test_mpi_is_an_executor(self):
        if importlib.util.find_spec("mpi4py") is None or shutil.which("mpiexec") is None:
            self.skipTest("mpi4py is not installed (Debian: python3-mpi4py)")
        with tempfile.TemporaryDirectory() as directory:
            script = pathlib.Path(directory, "sweep.py")
            script.write_text(
                "import marti\nfrom mpi4py.futures import MPIPoolExecutor\n"
                "if __name__ == '__main__':\n"
                "    with MPIPoolExecutor() as executor:\n"
                f"        marti.sweep({str(self.config)!r}, {AXES!r}, {SMALL!r}, directory='out', executor=executor, shares=3)\n")
            # Open MPI refuses more processes than cores, and the user root, unless it is told otherwise.
            environment = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                           "OMPI_MCA_rmaps_base_oversubscribe": "1", "PYTHONDONTWRITEBYTECODE": "1"}
            subprocess.run(["mpiexec", "-n", "3", sys.executable, "-m", "mpi4py.futures", script], cwd=directory,
                           env=environment, check=True, capture_output=True, text=True, timeout=100)
            self.same(marti.open(pathlib.Path(directory, "out")))
            self.assertFalse([name for name in os.listdir(pathlib.Path(directory, "out")) if "part" in name or "-of-" in name])

    def test_names_with_commas_and_lists(self):
        self.assertEqual(marti._axis_texts({"cache.size": "8KiB", "machine.nodes": numpy.int64(4)}),
                         ["cache.size=8KiB", "machine.nodes=4"])
        self.assertEqual(marti._text(numpy.bool_(False)), "false")
        for wrong in (None, b"8", {"a": None}):
            with self.assertRaises(TypeError):
                marti._text(wrong)
        self.assertEqual(marti._quoted("a,b.obj"), '"a,b.obj"')
        self.assertEqual(marti._text(["leaving", 1, True]), '["leaving", 1, true]')
        self.assertEqual(marti._text(["a.obj", {"source": "b.obj", "translate": [0, 0.5, 1]}]),
                         '["a.obj", {"source" = "b.obj", "translate" = [0, 0.5, 1]}]')


class Studies(unittest.TestCase):
    def test_tables_of_a_study(self):
        with tempfile.TemporaryDirectory() as directory:
            program("study", "operations", "-o", directory, "--set", "scene.source=tetra:2", "--set", "image.width=8",
                    "--set", "image.height=8")
            study = marti.open(directory)
            self.assertTrue(study.tables)
            for name, table in study.tables.items():
                self.assertEqual(len(table), len(pandas.read_csv(pathlib.Path(directory, name + ".csv"))), name)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
