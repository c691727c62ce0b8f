"""Blocks: what numbers mean, what comes back, and what is refused."""

from decimal import Decimal
from fractions import Fraction

import numpy
import pytest
import rockproof
from rockproof import Block, InputError

CUBE_FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
CUBE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]


def cube_of(edge):
    return Block([[edge * c for c in vertex] for vertex in CUBE], CUBE_FACES)


def test_a_float_is_the_binary_number_it_is():
    block = cube_of(0.1)
    assert block.exact_vertices[6] == (Fraction(0.1),) * 3
    assert block.volume == Fraction(0.1) ** 3 != Fraction(1, 1000)


@pytest.mark.parametrize("tenth", [Fraction(1, 10), Decimal("0.1"), "0.1", "1/10"])
def test_texts_decimals_and_fractions_are_exact(tenth):
    block = Block([[tenth if c else 0 for c in vertex] for vertex in CUBE], CUBE_FACES)
    assert block.volume == Fraction(1, 1000)
    assert block.vertices[6] == (0.1, 0.1, 0.1)
    assert not block.is_exact_in("f64")


@pytest.mark.parametrize("kind", ["f4", "f8", "i4", "longdouble"])
def test_numpy_arrays_of_every_kind_are_taken_exactly(kind):
    array = numpy.array(CUBE, dtype=kind) * numpy.array(3, dtype=kind)
    if kind != "i4":
        array = array / numpy.array(7, dtype=kind)
    block = Block(array, numpy.array(CUBE_FACES))
    numerator, denominator = (int(array.max()), 1) if kind == "i4" else array.max().as_integer_ratio()
    assert block.exact_vertices[6][0] == Fraction(int(numerator), int(denominator))
    assert (kind == "longdouble") == (not block.is_exact_in("f64"))


def test_what_comes_back_is_canonical():
    # The top is two triangles; they become one face.
    faces = [face for face in CUBE_FACES if face != [4, 5, 6, 7]] + [[4, 5, 6], [4, 6, 7]]
    block = Block(CUBE, faces)
    assert len(block.faces) == 6 and len(block.edges) == 12 and block.is_convex
    assert sorted(map(sorted, block.faces)) == sorted(map(sorted, CUBE_FACES))
    assert block.bounds == ((0, 0, 0), (1, 1, 1))


def test_boxes_hulls_and_moved_blocks():
    box = Block.cuboid((0, 0, 0), (1, 1, 1))
    hull = Block.hull([*CUBE, ["1/2", "1/2", "1/2"]])
    assert hull.volume == box.volume == 1 and len(hull.vertices) == 8
    moved = box.translated(("1/3", 0, 0))
    assert moved.bounds == ((Fraction(1, 3), 0, 0), (Fraction(4, 3), 1, 1))
    assert moved != box and moved.translated(("-1/3", 0, 0)) == box
    assert moved.rounded("f32").bounds[0][0] == Fraction(float(numpy.float32(1 / 3)))


@pytest.mark.parametrize(
    ("vertices", "faces", "told"),
    [
        ([*CUBE[:7], [0, 1, float("nan")]], CUBE_FACES, ["vertex 7, coordinate z", "not a finite number"]),
        ([*CUBE[:7], [0, 1]], CUBE_FACES, ["vertex 7 has 2 coordinates", "3 coordinates"]),
        ([*CUBE[:7], [0, 1, "one"]], CUBE_FACES, ["vertex 7, coordinate z", '"one" is not a number']),
        ([*CUBE[:7], [0, 1, None]], CUBE_FACES, ["vertex 7, coordinate z", "NoneType is no number"]),
        ([*CUBE[:7], [0, 1, True]], CUBE_FACES, ["vertex 7, coordinate z", "bool is no number"]),
        ([*CUBE[:7], [0, 1, Decimal("1e99999999")]], CUBE_FACES, ["vertex 7", "exponent"]),
        ([*CUBE[:7], [0, 1, 10**20000]], CUBE_FACES, ["vertex 7", "10000 digits"]),
        ([*CUBE[:7], [0, 1, "1e400"]], CUBE_FACES, ["vertex 7", "beyond"]),
        ([*CUBE[:7], CUBE[0]], CUBE_FACES, ["vertices 0 and 7 are the same point"]),
        (CUBE, [*CUBE_FACES[:5], [3, 0, 4, -1]], ["face 5", "vertex numbers from 0"]),
        (CUBE, [*CUBE_FACES[:5], [3, 0, 4, 8]], ["8"]),
        (CUBE, [face[::-1] for face in CUBE_FACES], ["volume", "counter-clockwise"]),
        (CUBE, 7, ["faces are of type int"]),
        (7, CUBE_FACES, ["vertices are of type int"]),
    ],
)
def test_what_is_no_block_is_refused_with_the_place(vertices, faces, told):
    with pytest.raises(InputError) as refused:
        Block(vertices, faces)
    assert all(part in str(refused.value) for part in told), refused.value
    assert isinstance(refused.value, ValueError)


def test_files_name_file_and_line(tmp_path, root):
    model = rockproof.load(root / "cases/real/slope_joints.dda")
    assert len(model) == len(model.blocks) == len(model.names) and model[0] == model.blocks[0]
    assert model[-1] == model.blocks[-1]
    with pytest.raises(IndexError):
        model[len(model)]
    broken = tmp_path / "broken.obj"
    broken.write_text("v 0 0 0\nv 1 0 zero\n")
    for path, told in [(broken, "broken.obj:2:"), (tmp_path / "none.dda", "none.dda:"), (tmp_path / "x.xyz", "x.xyz:")]:
        with pytest.raises(InputError, match=told):
            rockproof.load(path)


def test_planarity_reads_what_is_less_planar(root):
    with pytest.raises(InputError, match="voronoi_120.txt:.*not planar"):
        rockproof.load(root / "cases/real/voronoi_120.txt")
    assert len(rockproof.load(root / "cases/real/voronoi_120.txt", planarity="1e-4")) == 120
    with pytest.raises(InputError, match="planarity is negative"):
        rockproof.load(root / "cases/real/voronoi_120.txt", planarity=-1)


def test_weld_joins_vertices_that_are_nearly_one(root, tmp_path):
    triangles = (root / "tests/fixtures/two_wedges.stl").read_text()
    corners = [line.split()[1:] for line in triangles.splitlines() if line.split()[:1] == ["vertex"]]
    # Every corner a vertex of its own, every second one a little off.
    lines = [f"v {float(x) + 1e-9 * (n % 2)!r} {y} {z}" for n, (x, y, z) in enumerate(corners)]
    lines += [f"f {n} {n + 1} {n + 2}" for n in range(1, len(corners), 3)]
    file = tmp_path / "soup.obj"
    file.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match="soup.obj"):
        rockproof.load(file, planarity="1e-6")
    assert len(rockproof.load(file, planarity="1e-6", weld="1e-8")) == 2
    with pytest.raises(InputError, match="weld is negative"):
        rockproof.load(file, weld=-1)
