#!/usr/bin/env python3
"""A complete client for Rockproof in Python: the separating axis theorem for two convex blocks, in plain floats.

    rockproof campaign --engine-command "sat=python3 examples/engines/client.py"

Replace `lie` by a call of your own code. One question a line on stdin, one answer a line on stdout; anything for people
goes to stderr.
"""
import json
import math
import sys


def minus(p, q):
    return [p[0] - q[0], p[1] - q[1], p[2] - q[2]]


def dot(p, q):
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


def cross(p, q):
    return [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]


def edges(block):
    pairs = {tuple(sorted(pair)) for face in block["faces"] for pair in zip(face, face[1:] + face[:1])}
    return [minus(block["vertices"][q], block["vertices"][p]) for p, q in sorted(pairs)]


def normals(block):
    corners = ([block["vertices"][v] for v in face[:3]] for face in block["faces"])
    return [cross(minus(q, p), minus(r, q)) for p, q, r in corners]


def lie(a, b):
    """How two convex blocks lie: the widest slab between them, or the thinnest overlap, over all axes."""
    axes = normals(a) + normals(b) + [cross(d, e) for d in edges(a) for e in edges(b)]
    widest, normal = None, None
    for axis in axes:
        length = math.sqrt(dot(axis, axis))
        if length < 1e-12:  # parallel edges: a tolerance of the kind a campaign finds
            continue
        for sign in (1.0, -1.0):
            n = [sign * c / length for c in axis]
            width = min(dot(n, p) for p in a["vertices"]) - max(dot(n, q) for q in b["vertices"])
            if widest is None or width > widest:
                widest, normal = width, n
    state = "apart" if widest > 0 else "touching" if widest == 0 else "overlapping"
    if state == "apart":
        return {"state": state}  # between two corners the slab is not the distance, so no gap is claimed
    return {"state": state, "gap_m": widest, "normal": normal}


def main():
    for line in sys.stdin:
        question = json.loads(line)
        if question["a"]["reflex"] or question["b"]["reflex"]:
            answer = {"unsupported": "a block is concave"}
        else:
            answer = lie(question["a"], question["b"])
        print(json.dumps({"id": question["id"], **answer}), flush=True)


if __name__ == "__main__":
    main()
