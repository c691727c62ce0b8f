#!/usr/bin/env python3
"""The benchmark set through codes behind Rockproof's line protocol: a table of how often each is right, in Markdown.

    python3 examples/other_codes/benchmark.py coal="python3 examples/other_codes/python_codes.py coal" parry-f64="PATH/rockproof-parry f64"

Asks about every pair of convex blocks in cases/benchmark/pairs.jsonl, with each coordinate as the f64 nearest to it, and holds the answer against the exact
separation of the exact blocks: what a user of the code sees. A code that does not answer within 20 s is started anew. `NAME:f32=…` is a code that calculates in
f32.
"""
import json
import math
import pathlib
import select
import shlex
import subprocess
import sys
from fractions import Fraction

SET = pathlib.Path(__file__).parents[2] / "cases/benchmark/pairs.jsonl"
SECONDS = 20
# What gaps may be off by, as a part of the largest coordinate: about what such codes stop their iterations at (docs/other_codes.md).
ACCURACY = {"f32": 2.0**-9, "f64": 2.0**-19}
STATES = ["apart", "touching", "overlapping"]


class Code:
    """A program that answers questions, a line each."""

    def __init__(self, command):
        self.command = shlex.split(command)
        self.process = None

    def answer(self, question):
        """What it says, or None where it says nothing that can be used."""
        if self.process is None:
            self.process = subprocess.Popen(
                self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
            )
        try:
            self.process.stdin.write((json.dumps(question) + "\n").encode())
            self.process.stdin.flush()
            if select.select([self.process.stdout], [], [], SECONDS)[0]:
                said = json.loads(self.process.stdout.readline())
                usable = said.get("state") in STATES and math.isfinite(said.get("gap_m", 0.0))
                return said if usable else None
        except (BrokenPipeError, ValueError, TypeError, AttributeError):
            pass
        self.end()
        return None

    def end(self):
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            self.process = None


def block(exact):
    vertices = [[float(Fraction(c)) for c in vertex] for vertex in exact["vertices"]]
    return {"vertices": vertices, "faces": exact["faces"], "reflex": []}


def pairs():
    with SET.open(encoding="utf-8") as lines:
        for line in lines:
            pair = json.loads(line)
            if pair["separation"] is not None:
                yield pair


def judge(code, accuracy):
    """How many of each difficulty are right, and what is wrong."""
    counts = dict.fromkeys(["right f32", "right f64", "right exact", "wrong", "far", "gap", "none"], 0)
    for pair in pairs():
        a, b = block(pair["a"]), block(pair["b"])
        state, gap = pair["separation"]["state"], math.sqrt(Fraction(pair["separation"]["gap_squared"]))
        if state == "overlapping":
            gap = -gap
        allowed = accuracy * max(abs(c) for solid in (a, b) for vertex in solid["vertices"] for c in vertex)
        said = code.answer({"id": pair["id"], "a": a, "b": b})
        if said is None:
            counts["none"] += 1
        elif said["state"] != state:
            counts["wrong"] += 1
            counts["far"] += abs(gap) > allowed
        else:
            counts["right " + pair["difficulty"]] += 1
            counts["gap"] += "gap_m" not in said or abs(said["gap_m"] - gap) > allowed
    return counts


def main():
    codes = [argument.partition("=") for argument in sys.argv[1:]]
    if not codes or any(not command for _, _, command in codes):
        sys.exit(__doc__)
    sizes = {}
    for pair in pairs():
        sizes[pair["difficulty"]] = sizes.get(pair["difficulty"], 0) + 1
    print("| code | " + " | ".join(f"right, of {sizes[d]} {d}" for d in ("f32", "f64", "exact")), end=" | ")
    print("wrong | of these beyond accuracy | right, but gap off by more, or none | no usable answer |")
    print("| --- |" + " ---: |" * 7)
    for name, _, command in codes:
        name, _, precision = name.partition(":")
        code = Code(command)
        counts = judge(code, ACCURACY[precision or "f64"])
        code.end()
        print(f"| {name} | " + " | ".join(str(count) for count in counts.values()) + " |", flush=True)


if __name__ == "__main__":
    main()
