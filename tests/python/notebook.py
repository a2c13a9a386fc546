#!/usr/bin/env python3
"""notebook.py check|record NOTEBOOK: runs the cells of a notebook one after the other, as Jupyter does, and compares what
each gives as text with what stands in the notebook, or writes it there. Jupyter itself is not needed."""

import ast
import contextlib
import io
import json
import pathlib
import sys


def output_of(source, names):
    """What the cell prints, then the text of its last expression."""
    tree = ast.parse(source)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed = io.StringIO()
    value = None
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, "cell", "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
    outputs = []
    if printed.getvalue():
        outputs.append({"name": "stdout", "output_type": "stream", "text": lines(printed.getvalue())})
    if value is not None:
        outputs.append({"data": {"text/plain": lines(repr(value))}, "execution_count": None, "metadata": {},
                        "output_type": "execute_result"})
    return outputs


def lines(text):
    return text.splitlines(keepends=True)


def main(what, file):
    path = pathlib.Path(file)
    notebook = json.loads(path.read_text(encoding="utf-8"))
    names = {"__name__": "__main__"}
    wrong = 0
    for number, cell in enumerate(notebook["cells"], 1):
        if cell["cell_type"] != "code":
            continue
        found = output_of("".join(cell["source"]), names)
        if what == "check" and found != cell["outputs"]:
            wrong += 1
            print(f"{file}: cell {number} gives\n{json.dumps(found, indent=1)}\nnot\n{json.dumps(cell['outputs'], indent=1)}")
        cell["outputs"] = found
    if what == "record":
        path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
