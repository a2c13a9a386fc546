#!/usr/bin/env python3
"""Holds every figure of many machines against what was recorded of them, so that a change of the code that should
change no answer is seen to change none.

    golden.py check PROGRAM       compares with figures.txt, as the test does
    golden.py record PROGRAM      writes figures.txt anew: when an answer was meant to change, with the reason in the commit
    golden.py compare OLD NEW     names each case and figure in which two programs differ, with both values
    golden.py machines [--count N] [--seed S] > machines.toml    makes the random machines anew

The cases are the shipped configurations and questions, with small images, and the random machines of machines.toml.
Of each the points' table of a sweep is read: a column for each figure of the catalogue, and the points that were left
out. figures.txt has a checksum for each case and column over the points. Columns that it does not have are new figures
and are no difference.
"""

import argparse
import csv
import hashlib
import io
import pathlib
import random
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
RECORDED = HERE / "figures.txt"
SMALL = ["image.width=24", "image.height=24"]
# Frames are small, so these machines are made smaller too: the time is spent on the variety.
SMALLER = {"bounces": ["image.samples=2"], "today": ["image.samples=2"]}
NOT_FIGURES = {"ordinal", "machine", "base", "point"}
# Predictions and advice are sentences, which may be said in better words; their truth has tests of its own.
SENTENCES = ("limit", "advice", "note")


def cases():
    """Name, arguments of `marti sweep` without the output directory."""
    for file in sorted([*(ROOT / "configs").glob("*.toml"), *(ROOT / "configs" / "questions").glob("*.toml"),
                        *(ROOT / "configs" / "studies").glob("*.toml")]):
        config = tomllib.loads(file.read_text(encoding="utf-8"))
        if {"paper", "schemes", "error", "stability", "machines"} & (config.keys() | config.get("sweep", {}).keys()):
            continue  # studies of their own, which `marti sweep` does not run
        arguments = [str(file)]
        for setting in SMALL + SMALLER.get(file.stem, []):
            if setting.split("=")[0] not in axes_of(config):
                arguments += ["--set", setting]
        if "count" in config.get("frames", {}):
            arguments += ["--set", "frames.count=1"]
        if "sweep" not in config:
            arguments += ["--axis", f"machine.nodes={config.get('machine', {}).get('nodes', 16)}"]
        yield file.stem, arguments
    yield "machines", [str(HERE / "machines.toml")]


def axes_of(config):
    """The keys of all axes of a configuration's [sweep], as section.key."""
    def flat(table, prefix=""):
        for key, value in table.items():
            if isinstance(value, dict):
                yield from flat(value, prefix + key + ".")
            else:
                yield prefix + key
    sweep = config.get("sweep", {})
    found = set(flat(sweep.get("axes", {})))
    for zipped in sweep.get("zip", []):
        found |= set(flat(zipped))
    for point in sweep.get("points", {}).values():
        found |= set(flat(point))
    return found


def columns(program, arguments):
    """The columns of the points' table, as name -> values, and what was printed of points that were left out."""
    with tempfile.TemporaryDirectory() as directory:
        run = subprocess.run([program, "sweep", *arguments, "-o", directory, "--quiet"],
                             capture_output=True, text=True, check=False)
        if run.returncode != 0:
            sys.exit(f"marti sweep {' '.join(arguments)}: exit status {run.returncode}\n{run.stderr}")
        text = (pathlib.Path(directory) / "points.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(io.StringIO(text)))
    return {name: [row[name] for row in rows] for name in rows[0]
            if name not in NOT_FIGURES and not name.startswith(SENTENCES)}, rows


def checksum(values):
    return hashlib.sha256("\n".join(values).encode()).hexdigest()[:12]


def record(program):
    lines = []
    for name, arguments in cases():
        found, rows = columns(program, arguments)
        lines.append(f"[{name}] {len(rows)} points")
        lines += [f"{column} {checksum(values)}" for column, values in found.items() if any(values)]
    RECORDED.write_text("\n".join(lines) + "\n", encoding="utf-8")


def check(program):
    recorded = {}
    for line in RECORDED.read_text(encoding="utf-8").splitlines():
        if line.startswith("["):
            case = recorded.setdefault(line[1:line.index("]")], {"": line.split()[-2]})
        else:
            column, value = line.split(" ")
            case[column] = value
    differences = []
    for name, arguments in cases():
        expected = recorded.pop(name, None)
        if expected is None:
            differences.append(f"{name}: was not recorded; golden.py record does")
            continue
        found, rows = columns(program, arguments)
        if str(len(rows)) != expected.pop(""):
            differences.append(f"{name}: {len(rows)} points")
        differences += [f"{name}: {column} " + ("differs" if column in found else "is not there")
                        for column, value in expected.items() if checksum(found.get(column, [])) != value]
    differences += [f"{name}: is not there any more" for name in recorded]
    return differences


def compare(old, new):
    differences = []
    for name, arguments in cases():
        before, rows = columns(old, arguments)
        after, rows_after = columns(new, arguments)
        if len(rows) != len(rows_after):
            differences.append(f"{name}: {len(rows)} points, {len(rows_after)} points")
            continue
        for column, values in before.items():
            for i, value in enumerate(values):
                other = after[column][i] if column in after else "no such figure"
                if value != other:
                    point = rows[i].get("point") or f"point {i}"
                    differences.append(f"{name}, {point}: {column} {value or '-'} -> {other or '-'}")
    return differences


def random_machines(count, seed):
    """Named points with random settings of every part of a machine; those that cannot be built are left out."""
    source = random.Random(seed)

    def size(low, high):
        return f"{1 << source.randint(low, high)} B"

    def one(settings, key, *choices):
        settings[key] = source.choice(choices)

    def some(probability, settings, key, *choices):
        if source.random() < probability:
            one(settings, key, *choices)

    print("# Random machines, made by golden.py machines. Settings that exclude each other are left out by the sweep.")
    print('[scene]\nsource = "teapot:3"\n\n[image]\nwidth = 20\nheight = 20\nmax_depth = 3\n')
    print('[sweep]\nskip_invalid = true\n')
    for number in range(count):
        m = {}
        scheme = source.choice(["image"] * 6 + ["pipeline", "space"])
        m["machine.scheme"] = scheme
        some(0.3, m, "structure.kind", "bvh", "bsp", "grid", "none")
        some(0.15, m, "image.integrator", "path")
        some(0.1, m, "image.seed", 2, 3)
        one(m, "machine.nodes", 1, 2, 3, 4, 7, 8, 16, 32, 64, 100)
        some(0.3, m, "machine.clusters", 2, 4)
        some(0.3, m, "node.clock", "100 MHz", "1 GHz", "37 MHz")
        some(0.2, m, "node.write_buffer", 1, 2, 16)
        some(0.25, m, "node.contexts", 2, 4, 16)
        some(0.2, m, "node.switch_cycles", 0, 3)
        one(m, "costs.preset", "arm1176-2003", "unit", "unit")
        one(m, "cache.organisation", "unified", "unified", "unified", "split", "none")
        m["cache.size"] = size(8, 16)
        m["cache.line"] = f"{16 << source.randint(0, 3)} B"
        one(m, "cache.ways", 1, 2, 4, 8, 0)
        some(0.4, m, "cache.replacement", "lru", "fifo", "random", "plru")
        some(0.3, m, "cache.hit_cycles", 0, 2, 5)
        some(0.3, m, "l2.sharing", "private", "shared")
        if "l2.sharing" in m:
            m["l2.size"] = size(13, 18)
            one(m, "l2.ways", 1, 4, 16)
            some(0.3, m, "l2.replacement", "fifo", "random", "plru")
        some(0.15, m, "prefetch.next_line", True)
        some(0.15, m, "prefetch.children", True)
        some(0.25, m, "database.placement", "replicated", "distributed")
        one(m, "interconnect.kind", "bus", "bus", "crossbar", "ideal")
        some(0.3, m, "interconnect.mode", "split", "held")
        some(0.3, m, "interconnect.arbitration", "round_robin", "fifo")
        some(0.4, m, "interconnect.width", "4 B", "16 B", "32 B")
        some(0.3, m, "interconnect.clock", "100 MHz", "400 MHz")
        some(0.3, m, "interconnect.latency_cycles", 0, 3, 40)
        one(m, "memory.model", "fixed", "fixed", "dram")
        if m["memory.model"] == "dram":
            one(m, "dram.preset", "ddr4-2400", "ddr5-4800", "hbm2-2000", "ddr4-2400")
            some(0.5, m, "dram.policy", "frfcfs", "fcfs")
            some(0.4, m, "dram.page", "closed", "open")
            some(0.3, m, "dram.channels", 2, 4)
        else:
            some(0.5, m, "memory.banks", 1, 2, 8)
            some(0.3, m, "memory.access_cycles", 1, 10)
            some(0.3, m, "memory.busy_cycles", 1, 20)
        some(0.4, m, "network.kind", "mesh", "hypercube", "crossbar", "bus", "ideal")
        some(0.5, m, "packets.width", 1, 2, 4, 16)
        some(0.5, m, "packets.height", 1, 2, 4)
        some(0.4, m, "packets.order", "scanline", "hilbert", "morton")
        some(0.3, m, "host.assignment", "blocks", "dynamic", "interleaved")
        some(0.3, m, "host.latency_cycles", 0, 1000)
        some(0.2, m, "host.occupancy_cycles", 5)
        some(0.2, m, "build.sharing", "shared", "private", "none")
        some(0.1, m, "count.miss_classes", True)
        some(0.1, m, "count.attribution", True)
        some(0.3, m, "energy.preset", "45nm", "22nm")
        some(0.2, m, "layout.node_order", "depth_first", "treelets")
        if scheme != "image":
            some(0.4, m, "messages.send_cycles", 3, 30)
            some(0.4, m, f"{scheme}.queue", 1, 2, 64)
            some(0.3, m, f"{scheme}.in_flight", 4, 100)
        print(f"[sweep.points.m{number:03}]")
        for key, value in m.items():
            print(f"{key} = " + (str(value).lower() if not isinstance(value, str) else f'"{value}"'))
        print()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    for name in ("check", "record"):
        commands.add_parser(name).add_argument("program")
    pair = commands.add_parser("compare")
    pair.add_argument("old")
    pair.add_argument("new")
    made = commands.add_parser("machines")
    made.add_argument("--count", type=int, default=400)
    made.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    if arguments.command == "machines":
        random_machines(arguments.count, arguments.seed)
        return
    if arguments.command == "record":
        record(arguments.program)
        return
    differences = (check(arguments.program) if arguments.command == "check"
                   else compare(arguments.old, arguments.new))
    for difference in differences:
        print(difference)
    if differences:
        sys.exit(1)


if __name__ == "__main__":
    main()
