"""marti in Python: machines that trace rays, timed from a configuration.

    import marti

    result = marti.run("configs/marti.toml", machine__nodes=64)   # or {"machine.nodes": 64}
    result.end                         # the frame time in ps, as an attribute
    result.figures                     # all figures with unit and meaning, a DataFrame
    result.image                       # linear RGB, an array of height x width x 3
    result.report()                    # the page of `marti report`, shown in a notebook

    sweep = marti.sweep("configs/marti.toml", axes={"machine.nodes": [4, 8, 16], "cache.size": ["8KiB", "16KiB"]})
    sweep.points                       # a row for each machine, a DataFrame
    sweep.best("end", budget=30)       # those that no other beats in cost and frame time

    marti.open("out")                  # what a command has written: a Result, a Sweep or a Study

Names, units and meanings of figures are those of `marti figures`, keys those of `marti config`. The work is done in
this process, without the interpreter's lock, and Ctrl-C ends it. Results can be pickled, as executors do that bring
them from another process.
"""

from __future__ import annotations

import concurrent.futures
import contextlib
import functools
import hashlib
import html
import io
import json as _json
import os
import pathlib
import shutil
import sys
import tempfile
import types
import weakref
from typing import TYPE_CHECKING, Any, Iterable, Iterator, Mapping, Union

from . import _marti
from ._marti import Error

if TYPE_CHECKING:
    import numpy
    import pandas

__all__ = ["Error", "Page", "Result", "Study", "Sweep", "open", "run", "sweep"]

Path = Union[str, "os.PathLike[str]", None]

#: How often a share of a sweep is asked for again that a worker has not brought.
ATTEMPTS = 3


def run(
    config: Path = None,
    settings: Mapping[str, Any] | None = None,
    *,
    rays: numpy.ndarray | None = None,
    directory: Path = None,
    **more: Any,
) -> Result:
    """One frame on one machine.

    config: a TOML file; None: all keys have their defaults. Settings override the file: {"machine.nodes": 64}, or as
    arguments with two underscores for the dot, machine__nodes=64, which count if both are given. directory: where all
    is written that `marti run -o` writes, with what the run records. Error if a setting or the file is wrong.

    rays: an array of n x 8 or n x 9 numbers, as docs/scenes.md describes image.rays, traced in the place of an image:
    origin, least distance, direction, greatest distance, 0 for the closest hit or 1 for any."""
    with _given_rays(rays) as of_rays:
        own = _marti.run(_file(config), _assignments(settings, more) + of_rays, _file(directory))
    return Result(own, _file(directory))


def sweep(
    config: Path = None,
    axes: Mapping[str, Iterable[Any]] | Iterable[str] = (),
    settings: Mapping[str, Any] | None = None,
    *,
    rays: numpy.ndarray | None = None,
    directory: Path = None,
    threads: int = 0,
    share: str = "",
    executor: concurrent.futures.Executor | None = None,
    shares: int = 8,
    **more: Any,
) -> Sweep:
    """Every machine of the configuration's [sweep] and of these axes, which are all crossed.

    axes: {"machine.nodes": [4, 8]}, or texts as after --axis, ["machine.nodes=4..64:x2"]. directory: where the results
    are kept, so that the same call goes on with them; None: they last as long as the Sweep. threads: machines timed at
    a time; 0: as many as the computer has. share: "3/8" times only the third of eight parts of the machines.

    rays: an array, as in run(), traced for every machine. With a directory it is kept there, as rays-HASH.npy.

    executor: an executor of concurrent.futures or mpi4py.futures, or Dask's Client.get_executor(), whose workers time
    `shares` parts of the machines. A part that a worker does not bring is asked for again; what an executor that is
    broken leaves is timed here. The workers must see the configuration and the directory."""
    assignments = _assignments(settings, more)
    texts = _axis_texts(axes)
    if executor is None:
        with _given_rays(rays, _file(directory)) as of_rays:
            own = _marti.sweep(_file(config), texts, assignments + of_rays, _file(directory), threads, share)
        return Sweep(own, _file(directory))
    if share:
        raise ValueError("share: the executor's workers have the shares; leave it out")
    if int(shares) < 1:
        raise ValueError(f"shares: must be 1 or more, not {shares}")
    place = os.path.abspath(_file(directory) or tempfile.mkdtemp(prefix="marti-"))
    source = os.path.abspath(_file(config)) if _file(config) else ""
    try:
        with _given_rays(rays, place) as of_rays:
            _time_shares(executor, int(shares), (source, texts, assignments + of_rays, place, threads))
            whole = Sweep(_marti.sweep(source, texts, assignments + of_rays, place, threads, ""), _file(directory))
    except BaseException:
        if not _file(directory):
            shutil.rmtree(place, ignore_errors=True)
        raise
    if not _file(directory):
        weakref.finalize(whole, shutil.rmtree, place, ignore_errors=True)
    return whole


def open(directory: Path) -> Result | Sweep | Study:
    """What `marti run -o`, `marti sweep -o` or `marti study ... -o` has written into this directory."""
    found = _marti.open(_file(directory))
    return {_marti.Result: Result, _marti.Sweep: Sweep, _marti.Study: Study}[type(found)](found, _file(directory))


class Page:
    """A page of `marti report`: one HTML file that loads nothing."""

    def __init__(self, text: str):
        self.html = text

    def save(self, file: Path) -> None:
        _write(_file(file), self.html.encode())

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{html.escape(self.html)}" sandbox="allow-scripts" '
            'style="width: 100%; height: 800px; border: 0"></iframe>'
        )


class _Shown:
    """What all results have: a summary and a page. Pickled they are copies: of what is in a directory of the caller's
    its name, which must be there where the copy is made, else all that would be written."""

    def __init__(self, own: Any, directory: str = "", summary: str | None = None):
        self._own = own
        self._kept = os.path.abspath(directory) if directory else ""
        self._summary = own.summary() if summary is None else summary

    def __reduce__(self) -> tuple[Any, ...]:
        return _copied, (self._kept or self._written(), self._summary)

    def _written(self) -> dict[str, bytes]:
        """The files, by name, of a result that is in no directory of the caller's."""
        raise NotImplementedError

    @property
    def summary(self) -> str:
        """As the command prints it; of what was opened, the answer alone."""
        return self._summary

    def report(self) -> Page:
        """The page of `marti report`. A notebook shows it; Page.save() writes it."""
        return Page(self._own.report())

    def __repr__(self) -> str:
        return f"<marti.{type(self).__name__}: {self.summary.split(chr(10))[0]}>"


class Result(_Shown):
    """What one machine took for one frame. Each figure of `marti figures` is an attribute: result.end in ps,
    result.hit_ratio as a fraction; a figure that the machine does not have is None."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self._own.figure(name)
        except Error as error:
            raise AttributeError(str(error)) from None

    def __getitem__(self, name: str) -> Any:
        """A figure, those of the frame too: result["frame.camera_rays"]. Error for a name that no machine has."""
        return self._own.figure(name)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(row[0] for row in self._own.figures().rows if "." not in row[0])]

    @functools.cached_property
    def figures(self) -> pandas.DataFrame:
        """value, unit and meaning of each figure that the machine has, by name."""
        return _frame(self._own.figures()).set_index("figure")

    @property
    def settings(self) -> dict[str, str]:
        """Keys and values of the configuration, as a file has them."""
        return self._own.settings()

    @property
    def json(self) -> dict[str, Any]:
        """The whole result, as docs/internals/result-json.md describes it."""
        return _json.loads(self._own.json())

    @property
    def image(self) -> numpy.ndarray:
        """Linear RGB as float32, height x width x 3, rows from the top."""
        return self._own.image()

    @functools.cached_property
    def ray_hits(self) -> numpy.ndarray:
        """What each given ray hits, with fields distance, primitive and weights, as docs/scenes.md describes hits.npy."""
        import numpy

        return numpy.load(io.BytesIO(self._own.ray_hits()))

    def save(self, directory: Path) -> None:
        """Writes what `marti run -o` writes."""
        self._own.save(_file(directory))

    def _written(self) -> dict[str, bytes]:
        if self._own.directory():
            return _files_in(self._own.directory())
        with tempfile.TemporaryDirectory(prefix="marti-") as place:
            self._own.save(place)
            return _files_in(place)


class Sweep(_Shown):
    """The points of a sweep."""

    @functools.cached_property
    def points(self) -> pandas.DataFrame:
        """A row for each point that has been timed: its axes, its cost and all figures; units in .attrs["units"]."""
        return _frame(self._own.points())

    @property
    def axes(self) -> list[str]:
        """The columns of points that are axes."""
        return self._own.axes()

    @property
    def directory(self) -> str:
        return self._own.directory()

    @property
    def complete(self) -> bool:
        """Whether all points have been timed: not while other shares are missing."""
        return self._own.complete()

    @property
    def tables(self) -> dict[str, pandas.DataFrame]:
        """The tables of the sweep's question."""
        return {table.name: _frame(table) for table in self._own.tables()}

    def best(self, figure: str = "end", budget: float | None = None) -> pandas.DataFrame:
        """The points that no other beats in cost and in the figure, by cost; the last column marks the best that costs
        no more than the budget."""
        return _frame(self._own.best(figure, budget))

    def __reduce__(self) -> tuple[Any, ...]:
        if self._own.axes():
            return super().__reduce__()
        return _without_points, (self.directory, self._kept, self.summary)

    def _written(self) -> dict[str, bytes]:
        return _files_in(self.directory)


class Study(_Shown):
    """The tables of `marti study`."""

    @property
    def tables(self) -> dict[str, pandas.DataFrame]:
        return {table.name: _frame(table) for table in self._own.tables()}


def _file(name: Path) -> str:
    return "" if name is None else os.fspath(name)


def _files_in(directory: str) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in pathlib.Path(directory).iterdir() if file.is_file()}


def _copied(written: str | dict[str, bytes], summary: str) -> _Shown:
    """A result from the name of its directory, or from its files, which last as long as it."""
    if isinstance(written, str):
        found = open(written)
        return type(found)(found._own, written, summary)
    place = tempfile.mkdtemp(prefix="marti-")
    try:
        for name, content in written.items():
            pathlib.Path(place, name).write_bytes(content)
        found = open(place)
    except BaseException:
        shutil.rmtree(place, ignore_errors=True)
        raise
    copy = type(found)(found._own, "", summary)
    weakref.finalize(copy, shutil.rmtree, place, ignore_errors=True)
    return copy


def _without_points(directory: str, kept: str, summary: str) -> Sweep:
    """What a share gives while others are missing."""
    nothing = types.SimpleNamespace(columns=[], rows=[], title="")
    values = dict(directory=directory, complete=False, summary=summary, points=nothing, axes=[], tables=[])
    return Sweep(types.SimpleNamespace(**{name: lambda value=value: value for name, value in values.items()}), kept)


@contextlib.contextmanager
def _given_rays(rays: numpy.ndarray | None, directory: str = "") -> Iterator[list[str]]:
    """The settings by which these rays are traced, while their file is there: in the directory, or for the time being."""
    if rays is None:
        yield []
        return
    import numpy

    array = numpy.asarray(rays)
    content = io.BytesIO()
    numpy.save(content, numpy.ascontiguousarray(array, array.dtype if array.dtype == numpy.float32 else numpy.float64))
    name = f"rays-{hashlib.sha256(content.getbuffer()).hexdigest()[:16]}.npy"
    with contextlib.ExitStack() as stack:
        place = os.path.abspath(directory or stack.enter_context(tempfile.TemporaryDirectory(prefix="marti-")))
        is_new = not os.path.exists(place)
        os.makedirs(place, exist_ok=True)
        file = os.path.join(place, name)
        if not os.path.exists(file):
            _write(file, content.getvalue())
        try:
            yield ["image.integrator=rays", f"image.rays={file}"]
        except Error:
            if is_new and os.listdir(place) == [name]:
                shutil.rmtree(place, ignore_errors=True)
            raise


def _write(file: str, content: bytes) -> None:
    """Under a temporary name, which is then changed, so that no half file is left behind."""
    handle, part = tempfile.mkstemp(dir=os.path.dirname(os.path.abspath(file)))
    try:
        with os.fdopen(handle, "wb") as out:
            out.write(content)
        os.chmod(part, 0o666 & ~_umask())
        os.replace(part, file)
    except BaseException:
        os.unlink(part)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _axis_texts(axes: Mapping[str, Any] | Iterable[str]) -> list[str]:
    """Each as after --axis."""
    if isinstance(axes, str):
        return [axes]
    if not isinstance(axes, Mapping):
        return list(axes)
    texts = []
    for key, values in axes.items():
        single = isinstance(values, str) or not isinstance(values, Iterable)
        texts.append(f"{key}={','.join(map(_quoted, [values] if single else values))}")
    return texts


def _text(value: Any) -> str:
    """As a value stands after --set key=."""
    if hasattr(value, "item") and getattr(value, "ndim", 0) == 0:
        value = value.item()  # of numpy
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if value is None or isinstance(value, bytes):
        raise TypeError(f"no setting can be {value!r}: give a text, a number, a truth value, a list or a table of these")
    if isinstance(value, Mapping):
        parts = (f"{_json.dumps(key, ensure_ascii=False)} = {_element(each)}" for key, each in value.items())
        return "{" + ", ".join(parts) + "}"
    if isinstance(value, Iterable):
        return "[" + ", ".join(map(_element, value)) + "]"
    return str(value)


def _element(value: Any) -> str:
    """As a value stands in a list or a table of TOML."""
    return _json.dumps(value, ensure_ascii=False) if isinstance(value, str) else _text(value)


def _quoted(value: Any) -> str:
    """As a value stands in a list after --axis key=: with quotes, as in CSV, where it has a comma."""
    text = _text(value)
    return '"' + text.replace('"', '""') + '"' if "," in text or '"' in text else text


def _assignments(settings: Mapping[str, Any] | None, more: Mapping[str, Any]) -> list[str]:
    given = {**(settings or {}), **{name.replace("__", "."): value for name, value in more.items()}}
    return [f"{key}={_text(value)}" for key, value in given.items()]


def _frame(table: Any) -> pandas.DataFrame:
    import pandas

    frame = pandas.DataFrame(table.rows, columns=[column.name for column in table.columns])
    frame.attrs["title"] = table.title
    frame.attrs["units"] = {column.name: column.unit for column in table.columns}
    frame.attrs["meanings"] = {column.name: column.meaning for column in table.columns}
    return frame


def _time_share(work: tuple[str, list[str], list[str], str, int], share: str) -> None:
    config, axes, assignments, directory, threads = work
    _marti.sweep(config, axes, assignments, directory, threads, share)


def _time_shares(
    executor: concurrent.futures.Executor, shares: int, work: tuple[str, list[str], list[str], str, int]
) -> None:
    """Has the executor time all shares. What is wrong with the input is an Error at once; a share that is lost with its
    worker is asked for again."""
    attempts = dict.fromkeys((f"{number}/{shares}" for number in range(1, shares + 1)), 1)
    waiting: dict[concurrent.futures.Future[None], str] = {}
    try:
        for share in attempts:
            waiting[executor.submit(_time_share, work, share)] = share
        while waiting:
            done, _ = concurrent.futures.wait(waiting, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in done:
                share = waiting.pop(future)
                failure = future.exception()
                if failure is None:
                    continue
                # What names a key or a file is wrong for all; another process may still hold the part of one.
                is_input = isinstance(failure, Error) and (failure.key or failure.file)
                if is_input or attempts[share] == ATTEMPTS:
                    raise failure
                attempts[share] += 1
                waiting[executor.submit(_time_share, work, share)] = share
            if sys.stderr.isatty():
                end = "" if waiting else "\n"
                print(f"\r{shares - len(waiting)} of {shares} shares", end=end, file=sys.stderr, flush=True)
    except concurrent.futures.BrokenExecutor:
        pass  # it takes no work any more; the caller does the rest
    finally:
        for future in waiting:
            future.cancel()
        concurrent.futures.wait(waiting)  # those that run write into the directory
