"""Examinations: is a model safe, with which tolerances, and what is wrong with it?"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from . import _native

if TYPE_CHECKING:
    import pandas
    import polars

    from ._native import Precision, TolerancesLike

#: The columns of `Examination.findings` and `Examination.pairs`.
PAIR_COLUMNS = (
    "block_a", "block_b", "overlap_m", "overlap", "contacts_see_it", "f32_differ", "f32_broken", "f64_differ", "f64_broken",
    "tolerances_change", "worst_engine", "worst_cause", "worst_change", "worst_predicate", "worst_roundoffs", "passage_m",
    "unseen_after_step_m",
)  # fmt: skip
_TEXTS = ("overlap", "contacts_see_it", "worst_engine", "worst_cause", "worst_change", "worst_predicate")
_NUMBERS = ("overlap_m", "worst_roundoffs", "passage_m", "unseen_after_step_m")


class Examination:
    """What an examination found. `str` of it is the answer in words.

    `findings` and `pairs` are lists of dicts; `to_pandas` and `to_polars` make tables of them. `write` leaves page, tables and grid in a directory.
    """

    def __init__(self, run: _native.ExaminationRun) -> None:
        self._run = run
        #: Whether nothing is wrong with the model under the tolerances it was examined with.
        self.is_safe: bool = run.is_safe
        #: "safe", "safe with another set", "not safe" or "not decided".
        self.answer: str = run.answer
        #: The rules that the tolerances break, as `check` has them.
        self.violations: list[_native.Violation] = run.violations
        #: The blocks that overlap, as `check` has them.
        self.overlaps: list[_native.Overlap] = run.overlaps
        #: The complete tolerances that the model was examined with.
        self.tolerances: _native.Tolerances = run.tolerances
        #: The complete tolerances that are better, or None.
        self.recommended: _native.Tolerances | None = run.recommended
        #: One dict for each pair of blocks with something to say, the worst first: how it overlaps (`overlap_m`, `overlap`, `contacts_see_it`), how many of
        #: its contacts differ from the exact ones in each precision and how many of these no tie excuses (`f64_differ`, `f64_broken`), the worst of them
        #: (`worst_cause`, `worst_change`, `worst_predicate`, `worst_roundoffs`), and what steps did (`passage_m`, `unseen_after_step_m`); None where nothing tells.
        self.findings: list[dict[str, Any]] = run.findings()
        #: The same for all neighbouring pairs, by their numbers.
        self.pairs: list[dict[str, Any]] = run.pairs()

    @property
    def sentence(self) -> str:
        """The answer with its reasons, in one sentence."""
        return self._run.text.partition("\n")[0]

    def to_dict(self) -> dict[str, Any]:
        """Everything, as `examine.json` has it (`next` is None: it is about files, and `write` makes those)."""
        return json.loads(self._run.json())

    def to_pandas(self, table: str = "findings") -> pandas.DataFrame:
        """The "findings" or all "pairs" as a pandas DataFrame; needs pandas."""
        import pandas

        return pandas.DataFrame(self._table(table), columns=list(PAIR_COLUMNS))

    def to_polars(self, table: str = "findings") -> polars.DataFrame:
        """The "findings" or all "pairs" as a Polars DataFrame; needs Polars."""
        import polars

        kinds = {**{name: polars.String for name in _TEXTS}, **{name: polars.Float64 for name in _NUMBERS}}
        return polars.DataFrame(self._table(table), schema={name: kinds.get(name, polars.UInt64) for name in PAIR_COLUMNS})

    def write(self, directory: str | os.PathLike[str], *, overwrite: bool = False) -> list[str]:
        """Writes what `rockproof examine` writes: the page with the model in 3-D, tables as CSV and LaTeX, blocks for ParaView, the tolerances to use, cases
        to replay. A model made in Python is written as well, `model.toml`, for the commands that the page names. Answers the names of the files.

        Raises InputError where the directory holds something else, or an examination that `overwrite` does not discard.
        """
        return self._run.write(os.fspath(directory), overwrite)

    def _table(self, table: str) -> list[dict[str, Any]]:
        tables = {"findings": self.findings, "pairs": self.pairs}
        if table not in tables:
            raise _native.InputError(f'table is "{table}"; allowed are "findings" and "pairs"')
        return tables[table]

    def __str__(self) -> str:
        return self._run.text

    def __repr__(self) -> str:
        return f"<Examination: {self.answer}, {len(self.findings)} of {len(self.pairs)} pairs with findings>"


def examine(
    model: _native.Model,
    tolerances: TolerancesLike = None,
    *,
    precision: Precision = "f64",
    steps: int | None = None,
    candidates: int = 8,
    threads: int = 0,
    progress: Callable[[str, int, int], object] | None = None,
) -> Examination:
    """Examines a model as `rockproof examine` does: is it safe, with which tolerances, and what is wrong with it?

    Looks at sizes, rules and overlaps, classifies every neighbouring pair exactly and in f32 and f64, makes some steps and audits each, and searches for
    tolerances that do better, which it examines in the same way.

    `tolerances` are those of the file, or "auto", if they are not given; `precision` is what the model is to be safe in, "f64" or "f32". `steps` are made
    after settling, whatever the size of the model: if it is None, 5 where the model has at most 2,000 blocks; 0 for none. `candidates` is how many sets
    are tried, those given among them; 0 for none. `threads` is one a core if 0; results do not depend on it. `progress` is called now and then with what
    is done ("overlaps", "pairs", "steps", "tolerance sets"), how much of it is done, and how much there is.

    Ctrl-C ends it between two pairs, steps or sets. Raises InputError where a coordinate or a tolerance overflows in that precision, or the model cannot be stepped.
    """
    run = _native.run_examination(model, tolerances, precision, steps, candidates, threads, progress)
    return Examination(run)
