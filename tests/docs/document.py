"""Reads a Markdown document: its commands with the output it shows for them, the files it has the reader write,
and the commands that its prose names."""

import dataclasses
import os
import re
import shlex

# A command line of a block without `$ ` begins with one of these.
PROGRAMS = r"(?:marti|mpirun|srun|sqlite3|cmake|ctest|python3|gnuplot|\./\S+|build/\S+|cmake/\S+|docs/\S+)"
FENCE = re.compile(r"^( *)(```+)\s*(\w*)\s*$")
COMMENT = re.compile(r"^\s*<!--\s*test:\s*(.*?)\s*-->\s*$")


class DocumentError(Exception):
    """The document, or a comment of it for the test, is wrong."""


@dataclasses.dataclass
class Command:
    """A command, the lines of output shown below it, and what the comment before its block says of it."""

    line: int
    text: str
    shown: list = dataclasses.field(default_factory=list)
    skip: str = ""  # the reason
    extra: str = ""  # arguments that make it cheap
    needs: str = ""  # a subcommand that the program may not have yet
    status: int = 0


@dataclasses.dataclass
class Block:
    """A code block: fenced, of the kind its fence names, or indented."""

    line: int
    kind: str
    comment: tuple
    lines: list = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class File:
    """A file that the document shows and the reader is told to write."""

    line: int
    name: str
    text: str


def read_comment(line, text):
    """What `<!-- test: ... -->` says: skip, REASON; with ARGUMENTS; short ARGUMENTS; needs SUBCOMMAND; exit N; file
    NAME."""
    word, _, rest = text.partition(" ")
    word, rest = word.rstrip(","), rest.strip()
    if word not in ("skip", "with", "short", "needs", "exit", "file"):
        raise DocumentError(f"line {line}: a test comment begins with skip, with, short, needs, exit or file: {text}")
    if not rest:
        raise DocumentError(f"line {line}: test comment without a reason or value: {text}")
    if word == "exit" and not rest.isdigit():
        raise DocumentError(f"line {line}: exit wants a number: {text}")
    return word, rest


def apply_comment(command, comment):
    word, rest = comment
    if word == "skip":
        command.skip = rest
    elif word == "with":
        command.extra = rest
    elif word == "short":
        command.extra = "" if os.environ.get("MARTI_LONG_TESTS") == "1" else rest
    elif word == "needs":
        command.needs = rest
    elif word == "exit":
        command.status = int(rest)
    else:
        raise DocumentError(f"line {command.line}: a file's block holds no commands")


def joined(lines):
    """Pairs of line number and text, with lines that end in a backslash joined to the next."""
    pending, first = "", 0
    for number, line in lines:
        first = first or number
        if line.endswith("\\"):
            pending += line[:-1].rstrip() + " "
            continue
        yield first, pending + (line.strip() if pending else line)
        pending, first = "", 0
    if pending:
        raise DocumentError(f"line {first}: a command ends in a backslash")


def commands_of(lines, kind):
    """The commands of one block. In blocks of kind sh each line is one; elsewhere those that begin with `$ `,
    with their output below, or in indented blocks those that begin with a known program."""
    commands = []
    if kind == "sh":
        script = "part of a script" if lines and lines[0][1].startswith("#!") else ""
        for number, line in joined(lines):
            text = re.sub(r"\s+#\s.*$", "", line).strip()
            if text and not text.startswith("#"):
                commands.append(Command(number, text, skip=script))
        return commands
    if kind == "indented" and lines and re.match(PROGRAMS + r"\s", lines[0][1]):
        return [Command(number, line.strip()) for number, line in joined(lines)]
    numbers = iter(lines)
    for number, line in numbers:
        if line.startswith("$ "):
            text = line[2:].rstrip()
            while text.endswith("\\"):
                _, more = next(numbers)
                text = text[:-1].rstrip() + " " + more.strip()
            commands.append(Command(number, text))
        elif commands and line.strip() and line.strip() != "...":
            commands[-1].shown.append((number, line.rstrip()))
    return commands


def blocks_of(text):
    """Every code block with the comment before it, and the prose as pairs of line number and text."""
    blocks, prose, comment = [], [], None
    fence = indented = None  # the block that is open, by its kind
    after_blank = True
    for number, line in enumerate(text.split("\n"), 1):
        mark = FENCE.match(line)
        if fence:
            if mark and mark[2] == fence[1] and not mark[3]:
                fence = None
            else:
                blocks[-1].lines.append((number, line[len(fence[0]):]))
            continue
        if mark:
            fence, indented = (mark[1], mark[2]), None
            blocks.append(Block(number, mark[3], comment))
            comment = None
        elif COMMENT.match(line):
            if comment:
                raise DocumentError(f"line {number}: two test comments before one block")
            comment, indented = read_comment(number, COMMENT.match(line)[1]), None
        elif line.startswith("    ") and (indented or after_blank):
            if not indented:
                indented = Block(number, "indented", comment)
                blocks.append(indented)
                comment = None
            indented.lines.append((number, line[4:]))
        else:
            prose.append((number, line))
            if line.strip():
                indented = None
                if comment:
                    raise DocumentError(f"line {number}: a test comment stands directly before a block")
        after_blank = not line.strip() or COMMENT.match(line) is not None
    if fence:
        raise DocumentError(f"line {blocks[-1].line}: the block has no end")
    if comment:
        raise DocumentError("a test comment stands before no block")
    return blocks, prose


def read_document(text):
    """The commands and files of the document in its order, and the code spans of its prose."""
    items = []
    blocks, prose = blocks_of(text)
    for block in blocks:
        if block.comment and block.comment[0] == "file":
            items.append(File(block.line, block.comment[1], "".join(line + "\n" for _, line in block.lines)))
            continue
        found = commands_of(block.lines, block.kind)
        if block.comment and not found:
            raise DocumentError(f"line {block.line}: a test comment before a block without commands")
        for command in found:
            if block.comment:
                apply_comment(command, block.comment)
            items.append(command)
    spans = []
    for number, line in joined_prose(prose):
        for span in re.findall(r"(?<!`)`([^`]+)`(?!`)", line):
            if span.startswith("marti "):
                spans.append((number, span.replace("\\|", "|")))
    return items, spans


def joined_prose(prose):
    """Paragraphs as one line each, since a code span may go on in the next line; rows of tables are their own."""
    number, text = 0, ""
    for here, line in prose:
        if not line.strip() or line.startswith("|"):
            if text:
                yield number, text
            text = ""
            if line.strip():
                yield here, line
        else:
            number = number if text else here
            text += (" " if text else "") + line.strip()
    if text:
        yield number, text


def words_of(text):
    try:
        return shlex.split(text, comments=False)
    except ValueError:
        return text.split()
