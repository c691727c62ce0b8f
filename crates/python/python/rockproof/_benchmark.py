"""The benchmark set: pairs with exact answers, by family and difficulty (docs/benchmark_set.md)."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from . import _native

#: The version of the format that `benchmark` reads.
BENCHMARK_VERSION = 3


@dataclass(frozen=True)
class BenchmarkContact:
    """A contact that a pair has, exactly; the features as in `Contact`."""

    kind: str
    feature_a: int
    feature_b: int
    entrance: str
    entrance_a: int
    entrance_b: int
    #: 1 apart, 0 touching, -1 overlapping.
    gap_sign: int
    #: The square of the gap in m².
    gap_squared: Fraction


@dataclass(frozen=True)
class BenchmarkPair:
    """A pair of blocks with its exact answers."""

    #: Its number in the set.
    id: int
    #: The family that made it, and how: "base", "moved", "directed" at a boundary, "ladder" of a tolerance.
    family: str
    form: str
    #: The least precise arithmetic of Rockproof's float code that finds its contacts: "f32", "f64", or "exact" where neither does.
    difficulty: str
    a: _native.Block
    b: _native.Block
    #: The complete tolerances.
    tolerances: _native.Tolerances
    contacts: list[BenchmarkContact]
    #: "apart", "touching" or "overlapping"; None where a block is concave.
    state: str | None
    #: The square of the distance or depth in m²; None where a block is concave.
    separation_squared: Fraction | None
    #: The square of the penetration in m²; 0 where the blocks do not overlap.
    depth_squared: Fraction


def benchmark(path: str | os.PathLike[str]) -> Iterator[BenchmarkPair]:
    """Reads a benchmark set, `cases/benchmark/pairs.jsonl` of the sources, pair by pair.

    Raises InputError where a line is none of a set of this version, naming file and line.
    """
    try:
        file = open(path, encoding="utf-8")
    except OSError as error:
        raise _native.InputError(f"{os.fspath(path)}: {error.strerror}") from error
    with file:
        for number, line in enumerate(file, start=1):
            place = f"{os.fspath(path)}:{number}"
            try:
                read = json.loads(line)
                if not isinstance(read, dict) or read.get("version") != BENCHMARK_VERSION:
                    found = read.get("version") if isinstance(read, dict) else type(read).__name__
                    raise _native.InputError(f"version is {found}; read is {BENCHMARK_VERSION}")
                pair = _pair(read)
            except _native.InputError as error:
                raise _native.InputError(f"{place}: {error}") from error
            except KeyError as error:
                raise _native.InputError(f"{place}: there is no {error}") from error
            except (ValueError, TypeError, AttributeError) as error:
                raise _native.InputError(f"{place}: {error}") from error
            yield pair


def _pair(read: dict[str, Any]) -> BenchmarkPair:
    separation = read["separation"]
    contacts = [{**contact, "gap_squared": Fraction(contact["gap_squared"])} for contact in read["contacts"]]
    return BenchmarkPair(
        id=read["id"],
        family=read["family"],
        form=read["form"],
        difficulty=read["difficulty"],
        a=_native.Block(read["a"]["vertices"], read["a"]["faces"]),
        b=_native.Block(read["b"]["vertices"], read["b"]["faces"]),
        tolerances=_native.Tolerances(None, **read["tolerances"]),
        contacts=[BenchmarkContact(**contact) for contact in contacts],
        state=separation and separation["state"],
        separation_squared=separation and Fraction(separation["gap_squared"]),
        depth_squared=Fraction(read["penetration"]["depth_squared"]),
    )
