#!/usr/bin/env python3
"""FCL (python-fcl) and Coal behind Rockproof's line protocol: what their signed distance queries say about two convex polyhedra.

    pip install python-fcl==0.7.0.11 coal==3.0.3 numpy
    rockproof campaign --engine-command "fcl=python3 examples/other_codes/python_codes.py fcl-libccd"

Arguments: fcl-libccd, fcl-indep (FCL's two GJK solvers) or coal; `test` runs cases worked out by hand on all three, or on those named.
Transforms are identities: coordinates are those of the question. The signed distance is taken by its sign: positive apart, zero
touching, negative overlapping. FCL's normal is the line between its two witness points, Coal's its own, which points from the first
object to the second: A leaves B against it.
"""
import json
import sys

import numpy


def fcl_code(solver_name):
    import fcl

    solver = getattr(fcl.GJKSolverType, solver_name)

    def body(block):
        faces = numpy.concatenate([[len(face), *face] for face in block["faces"]])
        return fcl.CollisionObject(fcl.Convex(numpy.array(block["vertices"]), len(block["faces"]), faces), fcl.Transform())

    def say(a, b):
        a, b = body(a), body(b)
        found = fcl.DistanceResult()
        request = fcl.DistanceRequest(enable_nearest_points=True, enable_signed_distance=True, gjk_solver_type=solver)
        gap = fcl.distance(a, b, request, found)
        # The witnesses of the same query: apart A leaves B from its own to the other, overlapping the other way round.
        apart = found.nearest_points[0] - found.nearest_points[1]
        return gap, apart if gap > 0 else -apart

    return say


def coal_code():
    import coal

    def body(block):
        points, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
        for vertex in block["vertices"]:
            points.append(numpy.array(vertex))
        for face in block["faces"]:
            for p, q in zip(face[1:], face[2:]):
                triangles.append(coal.Triangle(face[0], p, q))
        return coal.Convex(points, triangles)

    here = coal.Transform3s()

    def say(a, b):
        found = coal.DistanceResult()
        gap = coal.distance(body(a), here, body(b), here, coal.DistanceRequest(True, True), found)
        return gap, -found.normal

    return say


CODES = {"fcl-libccd": lambda: fcl_code("GST_LIBCCD"), "fcl-indep": lambda: fcl_code("GST_INDEP"), "coal": coal_code}


def written(gap, normal):
    state = "apart" if gap > 0 else "touching" if gap == 0 else "overlapping"
    # A number that is none becomes NaN, which is no JSON: the answer is malformed, and counted so.
    answer = {"state": state, "gap_m": float(gap)}
    # Witnesses may coincide; then there is no direction to tell.
    if numpy.any(normal):
        answer["normal"] = [float(part) for part in normal]
    return answer


def test(names):
    def cube(x, y, z):
        corners = [[x + (n & 1), y + (n >> 1 & 1), z + (n >> 2 & 1)] for n in range(8)]
        faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        return {"vertices": corners, "faces": faces}

    unit = cube(0.0, 0.0, 0.0)
    for name in names or CODES:
        say = CODES[name]()
        for a, b, state, gap, direction in [
            (cube(0.25, 0.375, 1.5), unit, "apart", 0.5, (0, 0, 1)),
            (cube(0.25, 0.375, 0.75), unit, "overlapping", -0.25, (0, 0, 1)),
            (unit, cube(0.25, 0.375, 0.75), "overlapping", -0.25, (0, 0, -1)),
            (cube(3.0, 3.0, 2.0), unit, "apart", 3.0, (2 / 3, 2 / 3, 1 / 3)),
            (cube(0.25, 4.0, 5.0), unit, "apart", 5.0, (0, 0.6, 0.8)),
        ]:
            answer = written(*say(a, b))
            normal = numpy.array(answer["normal"])
            assert answer["state"] == state and abs(answer["gap_m"] - gap) < 1e-6, (name, answer)
            assert numpy.allclose(normal / numpy.linalg.norm(normal), direction, atol=1e-5), (name, answer)
        print(f"{name}: as worked out by hand")


def main():
    if sys.argv[1:2] == ["test"] and set(sys.argv[2:]) <= set(CODES):
        return test(sys.argv[2:])
    if len(sys.argv) != 2 or sys.argv[1] not in CODES:
        sys.exit(f"usage: python_codes.py {'|'.join(CODES)}|test [CODE…]")
    say = CODES[sys.argv[1]]()
    for line in sys.stdin:
        question = json.loads(line)
        if question["a"]["reflex"] or question["b"]["reflex"]:
            answer = {"unsupported": "a block is concave"}
        else:
            answer = written(*say(question["a"], question["b"]))
        print(json.dumps({"id": question["id"], **answer}), flush=True)


if __name__ == "__main__":
    main()
