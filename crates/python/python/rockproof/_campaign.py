"""Campaigns: engines compared with the oracle on pairs made to be hard."""

from __future__ import annotations

import json
import numbers
import os
import reprlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

from . import _native

if TYPE_CHECKING:
    import pandas
    import polars

    from ._native import Exact

Answer = Union[Mapping[str, Any], Iterable[Union[_native.Contact, Mapping[str, Any]]]]
Function = Callable[[_native.Block, _native.Block, "dict[str, float | str]"], Answer]
EngineArgument = Union[str, Function, "Mapping[str, Function]", "Sequence[str | Function]"]

#: The columns of `Results.findings`.
FINDING_COLUMNS = (
    "index", "family", "form", "tolerances", "engine", "cause", "change", "kind_before", "kind_after", "predicate",
    "features", "margin", "margin_ulps", "note",
)  # fmt: skip
#: The columns of `Results.summary`.
SUMMARY_COLUMNS = ("family", "form", "tolerances", "pairs", "engine", "cause", "change", "kind", "findings")


class Results:
    """What a campaign found.

    `findings` and `summary` are lists of dicts; `to_pandas` and `to_polars` make tables of them.
    """

    def __init__(self, run: _native.CampaignRun) -> None:
        self._run = run
        #: One dict for each difference: the pair's `index`, its `family` and `form`, the `tolerances`, whom it is about (`engine`), its `cause`, what
        #: changed (`change`, `kind_before`, `kind_after`), what decided it (`predicate`, `features`, `margin`, `margin_ulps`; None where nothing tells),
        #: and what an engine without an answer said (`note`).
        self.findings: list[dict[str, Any]] = run.findings()
        #: One dict for each group of pairs and class of findings: how many `pairs` were examined, and how many `findings` made.
        self.summary: list[dict[str, Any]] = run.summary()

    @property
    def pairs(self) -> int:
        """Pairs examined."""
        return self._run.pairs

    @property
    def contacts(self) -> int:
        """Contacts in the exact answers, over all tolerance sets."""
        return self._run.contacts

    @property
    def seconds(self) -> float:
        """How long it took, in seconds."""
        return self._run.seconds

    def pair(self, of: int | Mapping[str, Any]) -> _native.ExaminedPair:
        """The blocks and tolerances of a pair, by its number or by a finding about it.

        Raises InputError where there is no such pair.
        """
        is_row = isinstance(of, Mapping) or hasattr(of, "to_dict")
        return self._run.pair(of["index"] if is_row else of)

    def to_pandas(self, table: str = "findings") -> pandas.DataFrame:
        """The "findings" or the "summary" as a pandas DataFrame; needs pandas."""
        import pandas

        rows, columns = self._table(table)
        return pandas.DataFrame(rows, columns=list(columns))

    def to_polars(self, table: str = "findings") -> polars.DataFrame:
        """The "findings" or the "summary" as a Polars DataFrame; needs Polars."""
        import polars

        rows, columns = self._table(table)
        kinds = {"index": polars.UInt64, "pairs": polars.UInt64, "margin": polars.Float64, "margin_ulps": polars.Float64}
        kinds["findings"] = polars.UInt64
        schema = {name: kinds.get(name, polars.String) for name in columns}
        return polars.DataFrame(rows, schema=schema)

    def _table(self, table: str) -> tuple[list[dict[str, Any]], tuple[str, ...]]:
        tables = {"findings": (self.findings, FINDING_COLUMNS), "summary": (self.summary, SUMMARY_COLUMNS)}
        if table not in tables:
            raise _native.InputError(f'table is "{table}"; allowed are "findings" and "summary"')
        return tables[table]

    def __repr__(self) -> str:
        return f"<Results: {self.pairs} pairs, {len(self.findings)} findings>"


def campaign(
    engine: EngineArgument = ("f32", "f64"),
    *,
    pairs: int = 1024,
    seed: int = 1,
    families: str | Sequence[str] = (),
    tolerances: str | Sequence[str] = (),
    real: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = (),
    planarity: Exact | None = None,
    weld: Exact | None = None,
    scale: Exact | None = None,
    precision: str = "f64",
    metamorphic_every: int = 16,
    exact_ties: bool = False,
    threads: int = 0,
    progress: Callable[[int, int], object] | None = None,
) -> Results:
    """Compares engines with the oracle on generated and real pairs, and finds the cause of each difference.

    `engine` is "f32" or "f64" (the float code), a function, a dict of functions by name, or a sequence of names and functions. A function is asked
    `function(a, b, tolerances)`: two blocks, rounded to `precision`, and a dict of tolerances in metres, sines and radians. It answers an iterable of
    contacts (`Contact`, or dicts with `kind`, `feature_a`, `feature_b` and, if it knows them, `entrance`, `entrance_a`, `entrance_b`, `gap_sign`), or one
    dict: {"state": "apart" | "touching" | "overlapping"} with `gap_m` and `normal` (in which A leaves B) if it knows them, {"contacts": […]}, or
    {"unsupported": reason}. An exception is the engine's failure, `change` "failure" in the findings, with its last line as the `note`.
    Threads ask it at once; Python's lock lets one in at a time.

    `families` and `tolerances` are names (`rockproof.families()`; "auto", "shi", "zero", … or TOML files of tolerances), all of them if none is given; `real`
    are block files for the family "real", read as by `load` with `planarity`, `weld` and `scale`. One pair in `metamorphic_every` is asked again moved, mirrored and renumbered; 0 for none.
    With `exact_ties` blocks stay where families put them, on coarse grids, where many decisions are exact ties. `threads` is one a
    core if 0; results do not depend on it. `progress` is called now and then with the pairs looked at and the findings made.

    The same seed makes the same pairs and findings as `rockproof campaign` with the same settings. Ctrl-C ends it between two pairs.
    Raises InputError where a name or a file is not what it should be.
    """
    settings = {
        "pairs": pairs,
        "seed": seed,
        "families": _names("families", families),
        "tolerances": _names("tolerances", tolerances),
        "real": _names("real", real),
        "planarity": planarity,
        "weld": weld,
        "scale": scale,
        "metamorphic_every": metamorphic_every,
        "exact_ties": bool(exact_ties),
        "threads": threads,
        "precision": precision,
    }
    return Results(_native.run_campaign(_engines(engine), _line, settings, progress))


def families() -> dict[str, str]:
    """The families of pairs, with what each is for."""
    return dict(_native.families())


def _names(argument: str, value: Any) -> list[str]:
    """One name or path, or some, as texts."""
    names = [value] if isinstance(value, (str, os.PathLike)) else list(value) if isinstance(value, Iterable) else [None]
    if not all(isinstance(name, (str, os.PathLike)) for name in names):
        raise _native.InputError(f"{argument} is {reprlib.repr(value)}; allowed are a name and a sequence of names")
    return [os.fspath(name) for name in names]


def _engines(engine: EngineArgument) -> list[str | tuple[str, Function]]:
    if isinstance(engine, Mapping):
        engines: list[Any] = list(engine.items())
    else:
        several = isinstance(engine, Iterable) and not isinstance(engine, str) and not callable(engine)
        engines = [one if isinstance(one, str) else (_name(one), one) for one in (engine if several else [engine])]
    if not all(isinstance(one, str) or (isinstance(one[0], str) and callable(one[1])) for one in engines):
        raise _native.InputError(
            f'engine is {reprlib.repr(engine)}; allowed are "f32", "f64", a function, a dict of functions by name, and a sequence of names and functions'
        )
    return engines


def _name(function: Function) -> str:
    name = getattr(function, "__name__", type(function).__name__)
    return "function" if name == "<lambda>" else name


def _line(answer: Answer) -> str:
    """An engine's answer as a line of the protocol (docs/engines.md)."""
    if not isinstance(answer, Mapping):
        if isinstance(answer, str) or not isinstance(answer, Iterable):
            raise TypeError(f"an engine answers contacts or a dict, not {type(answer).__name__}")
        answer = {"contacts": answer}
    answer = {"id": 0, **answer}
    if isinstance(answer.get("contacts"), Iterable):
        answer["contacts"] = [_plain(contact) for contact in answer["contacts"]]
    return json.dumps(answer, default=_number)


def _plain(contact: Any) -> Any:
    return contact.to_dict() if isinstance(contact, _native.Contact) else contact


def _number(value: Any) -> Any:
    """What JSON does not know: NumPy's numbers and arrays, fractions."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, numbers.Real):
        return float(value)
    raise TypeError(f"{type(value).__name__} is no number, text, list or dict")
