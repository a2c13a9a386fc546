#!/usr/bin/env python3
"""Runs what a document shows: check_document.py --program MARTI --source DIR DOCUMENT

Every `marti` command of the document is run, in its order and in one directory, and must end as the text says. Where
output is shown below a command, each shown line must be in what the program prints, in that order. Commands of other
programs are looked at only: the files, presets and targets they name must be there. So must be every subcommand, option
and key that the prose names. tests/docs/README.md says how a document marks what is too expensive.
"""

import argparse
import hashlib
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import document
from references import Checker, WrongReference

# Times of the computer that runs the test differ from run to run.
HOST_TIME = re.compile(r"\b(in|about) [\d.,]+ ?(ns|us|ms|s|min|h)\b")
TAKES_SETTINGS = ("run", "explore", "sweep", "study", "trace")
OTHER_PROGRAMS = ("sed", "sqlite3", "cat", "head", "ls", "cp", "mkdir")


def masked(line):
    return HOST_TIME.sub(r"\1 TIME", line).rstrip()


def label_of(line):
    """What a line of the summary begins with, without its figures."""
    return re.match(r"\s*[^\d\s][^\d]*?(?=\s{2,}|\s*[-+(]?\d|:|$)", line)


def missing_line(shown, output, exact):
    """The first shown line that is not in the output where it should be, or nothing."""
    lines = [masked(line) for line in output.split("\n")]
    at = 0
    for number, line in shown:
        if exact:
            wanted = masked(line)
            found = next((i for i in range(at, len(lines)) if lines[i] == wanted), None)
        else:
            label = label_of(line)
            if not label:
                continue
            found = next((i for i in range(at, len(lines)) if lines[i].startswith(label[0])), None)
        if found is None:
            return number, line
        at = found + 1
    return None


class Runner:
    """Runs commands in one directory that has the configurations where the documents say they are."""

    # Of commands that only print, by the command and by what they can read: documents share them.
    outcomes = {}

    def __init__(self, program, source, directory):
        self.directory = directory
        tools = directory / ".tools"
        tools.mkdir()
        (tools / "marti").symlink_to(program)
        for folder in ("configs", "docs/examples"):
            if (source / folder).is_dir():
                shutil.copytree(source / folder, directory / folder)
        self.environment = {"PATH": f"{tools}:/usr/local/bin:/usr/bin:/bin", "HOME": str(directory),
                            "LC_ALL": "C.UTF-8", "OMP_NUM_THREADS": "1"}

    def files(self):
        """Every file in the directory, in short: the same where the same can be read."""
        digest = hashlib.sha256()
        for path in sorted(self.directory.rglob("*")):
            if path.is_file() and not path.is_symlink():
                content = path.read_bytes()
                digest.update(f"{path.relative_to(self.directory)}\0{len(content)}\0".encode() + content)
        return digest.hexdigest()

    def run(self, text):
        """The exit status and the output. What only prints is not run twice on the same files."""
        prints_only = " -o" not in text and ">" not in text and text.startswith("marti run")
        key = (text, self.files()) if prints_only else None
        if key in self.outcomes:
            return self.outcomes[key]
        done = subprocess.run(["bash", "-o", "pipefail", "-c", text], cwd=self.directory, env=self.environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=600, check=False)
        outcome = (done.returncode, done.stdout.decode("utf-8", "replace"))
        if key:
            self.outcomes[key] = outcome
        return outcome


def with_settings(text, extra):
    """The command with the arguments that make it cheap, behind its subcommand's own."""
    words = text.split()
    if words[1] not in TAKES_SETTINGS:
        return text
    head, bar, tail = text.partition(" | ")
    return f"{head} {extra}{bar}{tail}"


def without_advice(text, shown):
    """A run takes twice as long when it measures what would help, which nobody looks at who is not shown it."""
    if not re.match(r"marti run (?!.*(-o |--json|--what-helps|--within|--save-log|>))", text):
        return text
    return text if not shown or any("helps" in line or line.startswith("answer") for _, line in shown) else with_settings(text, "--no-what-helps")


def is_synopsis(text):
    """Does it stand for commands instead of being one?"""
    return re.search(r"(?:^|\s)\[|\.\.\.|(?:^|\s)(?:CONFIG|DIR|SOURCE)(?=\s|$)", text) is not None


def is_ours(text):
    return re.match(r"(marti|\S*build/\S+/marti)\s", text) is not None


def runnable(text, runner):
    """Other programs that only read, if they are installed."""
    words = text.split()
    if words[0] == "python3":
        return len(words) > 1 and words[1].startswith("docs/examples/")
    return words[0] in OTHER_PROGRAMS and shutil.which(words[0], path=runner.environment["PATH"]) is not None


class Report:
    def __init__(self, name):
        self.name, self.faults = name, []
        self.ran = self.smaller = self.skipped = self.looked_at = self.spans = 0

    def fault(self, line, text):
        self.faults.append(f"{self.name}:{line}: {text}")

    def __str__(self):
        return (f"{self.name}: {self.ran} commands run, {self.smaller} run smaller, {self.skipped} skipped, "
                f"{self.looked_at} of other programs looked at, {self.spans} named in the prose")


def check_command(command, runner, checker, report):
    if command.status == 0:  # one that must fail may name what there is not
        checker.check(command.text)
    if is_synopsis(command.text):
        report.spans += 1
        return
    if command.needs and not checker.has(command.needs):
        report.skipped += 1
        print(f"{report.name}:{command.line}: skipped, there is no marti {command.needs}: {command.text}")
        return
    if command.needs:
        report.fault(command.line, f"marti {command.needs} is there; the test comment must go: {command.text}")
    if command.skip:
        report.skipped += 1
        print(f"{report.name}:{command.line}: skipped, {command.skip}: {command.text}")
        return
    if not is_ours(command.text) and not runnable(command.text, runner):
        report.looked_at += 1
        return
    text = re.sub(r"^\S*build/\S+/marti(?=\s)", "marti", command.text)
    unchanged = text
    if command.extra:
        text = with_settings(text, command.extra)
    status, output = runner.run(without_advice(text, command.shown))
    if text.startswith("marti report ") and status == 2 and "-DMARTI_REPORT=ON" in output:
        report.skipped += 1
        print(f"{report.name}:{command.line}: skipped, the program was built without charts: {command.text}")
        return
    if text != unchanged:
        report.smaller += 1
    else:
        report.ran += 1
    if status != command.status:
        report.fault(command.line, f"exit status {status}, not {command.status}: {text}\n{output}")
        return
    missing = missing_line(command.shown, output, text == unchanged)
    if missing:
        report.fault(missing[0], f"stale: not in the output of {text}\n  {missing[1]}\nwhich is\n{output}")


def check(arguments, path):
    path = path.resolve()
    source = arguments.source.resolve()
    name = str(path.relative_to(source)) if path.is_relative_to(source) else path.name
    report = Report(name)
    with tempfile.TemporaryDirectory(prefix="marti-docs-") as directory:
        runner = Runner(arguments.program.resolve(), source, pathlib.Path(directory))
        checker = Checker(runner, source)
        items, spans = document.read_document(path.read_text(encoding="utf-8"))
        for item in items:
            try:
                if isinstance(item, document.File):
                    target = runner.directory / item.name
                    if not target.resolve().is_relative_to(runner.directory.resolve()):
                        raise WrongReference(f"{item.name} is outside of the test's directory")
                    target.parent.mkdir(parents=True, exist_ok=True)
                    target.write_text(item.text, encoding="utf-8")
                else:
                    check_command(item, runner, checker, report)
            except WrongReference as error:
                report.fault(item.line, str(error))
        for line, span in spans:
            report.spans += 1
            try:
                checker.check(span)
            except WrongReference as error:
                report.fault(line, f"{error}: `{span}`")
    return report


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("documents", type=pathlib.Path, nargs="+")
    arguments = parser.parse_args()
    status = 0
    for path in arguments.documents:
        try:
            report = check(arguments, path)
        except document.DocumentError as error:
            print(f"{path}: {error}")
            status = 1
            continue
        for fault in report.faults:
            print(fault)
            status = 1
        print(report)
    return status


if __name__ == "__main__":
    sys.exit(main())
