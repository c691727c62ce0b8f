"""Contacts, separations and penetrations: worked out by hand, and as the command line has them."""

import json
from fractions import Fraction

import pytest
import rockproof
from rockproof import Block, InputError, Tolerances

UNIT = Block.cuboid((0, 0, 0), (1, 1, 1))


def test_a_cube_over_another_has_four_contacts_of_a_millimetre():
    above = Block.cuboid(("1/4", "1/4", "1.001"), ("3/4", "3/4", "1.501"))
    contacts = rockproof.classify(above, UNIT, {"search": "1/100"})
    top = next(number for number, face in enumerate(UNIT.faces) if all(UNIT.vertices[v][2] == 1 for v in face))
    low = [number for number, vertex in enumerate(above.exact_vertices) if vertex[2] < Fraction(5, 4)]
    assert [(c.kind, c.feature_a, c.feature_b) for c in contacts] == [("v-f", vertex, top) for vertex in low]
    assert {c.gap for c in contacts} == {Fraction(1, 1000)} and {c.gap_sign for c in contacts} == {1}
    assert {c.gap_squared for c in contacts} == {Fraction(1, 10**6)} and {c.gap_m for c in contacts} == {0.001}
    # 1.001 is no float: the float code sees 1.00099999999999989… and subtracts 1.
    floats = rockproof.classify(above, UNIT, {"search": "1/100"}, engine="f64")
    assert [(c.kind, c.feature_a, c.feature_b) for c in floats] == [("v-f", vertex, top) for vertex in low]
    assert {c.gap for c in floats} == {Fraction(1.001) - 1} != {Fraction(1, 1000)}
    assert {c.gap for c in rockproof.classify(above, UNIT, {"search": "1/100"}, engine="f32")} != {c.gap for c in floats}


@pytest.mark.parametrize("engine", ["exact", "f64", "f32"])
def test_an_overlap_has_a_negative_gap(engine):
    sunk = Block.cuboid(("1/4", "1/4", 1 - 2**-10), ("3/4", "3/4", 2))
    contacts = rockproof.classify(sunk, UNIT, {"search": "1/100", "penetration": "1/100"}, engine=engine)
    assert {c.gap for c in contacts} == {Fraction(-1, 1024)} and {c.gap_sign for c in contacts} == {-1}
    assert {c.gap_m for c in contacts} == {-(2**-10)} == {c.to_dict()["gap_m"] for c in contacts}


def test_an_irrational_gap_is_known_by_its_square():
    # The roof of a prism, sloping at 45 degrees: a vertex h above it is h/√2 from its plane.
    roof = Block([[-1, 0, 0], [1, 0, 0], [0, 0, 1], [-1, 4, 0], [1, 4, 0], [0, 4, 1]], [[0, 1, 2], [3, 5, 4], [0, 3, 4, 1], [1, 4, 5, 2], [0, 2, 5, 3]])
    tip = [["1/2", 2, "1/2"], ["1/2", 2, 3], [1, 2, 3], ["1/2", 3, 3]]
    up = Block.hull(tip).translated((0, 0, "1/100"))
    nearest = [c for c in rockproof.classify(up, roof, {"search": "1/10"}) if c.kind == "v-f"]
    assert [c.gap_squared for c in nearest] == [Fraction(1, 20000)] and [c.gap for c in nearest] == [None]
    assert nearest[0].gap_m == pytest.approx(0.01 / 2**0.5, rel=1e-15)


@pytest.mark.parametrize("engine", ["exact", "f64", "f32"])
@pytest.mark.parametrize("preset", ["auto", "shi"])
def test_contacts_of_a_model_are_those_of_the_command(root, command, engine, preset):
    file = root / "cases/real/slope_joints.dda"
    name = engine if engine == "exact" else f"stepper-{engine}"
    told = json.loads(command("classify", file, "--engine", name, "--tolerances", preset, "--format", "json"))
    found = rockproof.load(file).classify(preset, engine=engine)
    keys = ["kind", "feature_a", "feature_b", "entrance", "entrance_a", "entrance_b", "gap_sign", "gap_m"]
    expected = [(pair["block_a"], pair["block_b"], [[c[key] for key in keys] for c in pair["contacts"]]) for pair in told["pairs"]]
    assert len(expected) > 10
    assert [(pair.a, pair.b, [[c.to_dict()[key] for key in keys] for c in pair.contacts]) for pair in found] == expected
    (one,) = rockproof.load(file).classify(preset, engine=engine, pair=(0, 1))
    assert (one.a, one.b) == (0, 1) and one.contacts == found[0].contacts


def test_tolerances_are_exact_and_complete_when_derived():
    given = Tolerances("shi", search=Fraction(1, 10), overlap_angle=90, criteria="revised")
    assert given.preset == "shi" and given["search"] == Fraction(1, 10) and given["overlap_sine"] == 1
    complete = given.derive([UNIT])
    assert complete.preset is None and complete.criteria == "revised" and complete["search"] == Fraction(1, 10)
    assert set(complete.values) >= {"search", "territory", "penetration", "open", "close", "max_rotation"}
    assert Tolerances("shi", search="1/10") == Tolerances("shi", search=Fraction(1, 10)) != Tolerances("shi", search=0.1)
    for wrong, told in [
        (lambda: Tolerances("nobody"), "auto"),
        (lambda: Tolerances(serch=1), "unknown tolerance `serch`"),
        (lambda: Tolerances(search=-1), "0 or more"),
        (lambda: Tolerances(search="x"), "`search`"),
        (lambda: rockproof.classify(UNIT, UNIT, 7), "tolerances are of type int"),
        (lambda: Tolerances(None, search=1).derive([UNIT]), "no preset is named"),
        (lambda: rockproof.classify(UNIT, UNIT, {"search": 1e300}, engine="f32"), "`search` overflows"),
    ]:
        with pytest.raises(InputError, match=told):
            wrong()


@pytest.mark.parametrize(
    ("offset", "state", "gap", "squared"),
    [
        (("1/4", "1/2", 2), "apart", 1, 1),
        ((3, 3, 2), "apart", 3, 9),  # corner to corner: 2, 2, 1
        ((2, 2, 0), "apart", None, 2),  # edge to edge: √2
        ((1, 1, 1), "touching", 0, 0),
        (("1/2", "1/2", "3/4"), "overlapping", Fraction(-1, 4), Fraction(1, 16)),
        (("1e-30", 0, 1), "touching", 0, 0),
        ((0, 0, Fraction(10**30 + 1, 10**30)), "apart", Fraction(1, 10**30), Fraction(1, 10**60)),
    ],
)
def test_separations_of_cubes(offset, state, gap, squared):
    found = rockproof.separation(UNIT, UNIT.translated(offset))
    assert (found.state, found.gap, found.gap_squared) == (state, gap, squared)
    deep = rockproof.penetration(UNIT, UNIT.translated(offset))
    assert deep.overlaps == (state == "overlapping")
    assert deep.depth == (-gap if state == "overlapping" else 0)
    if deep.overlaps:
        x, y, z = deep.direction
        assert (x, y) == (0, 0) and z < 0, "A lies below and moves down"


def test_concave_blocks_have_a_penetration_and_no_separation():
    profile = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    vertices = [[x, y, z] for z in (0, 1) for x, y in profile]
    sides = [[k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6] for k in range(6)]
    corner = Block(vertices, [[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11], *sides])
    assert not corner.is_convex
    inside = Block.cuboid(("5/4", "3/4", "1/4"), ("7/4", "7/4", "3/4"))
    with pytest.raises(InputError, match="block a is concave"):
        rockproof.separation(corner, inside)
    assert rockproof.penetration(corner, inside).depth == Fraction(1, 4)
    outside = Block.cuboid(("5/4", "5/4", "1/4"), ("7/4", "7/4", "3/4"))
    assert not rockproof.penetration(corner, outside).overlaps


def test_what_rounding_destroys_is_named():
    thin = Block.cuboid((1, 0, 0), (Fraction(2**40 + 1, 2**40), 1, 1))
    assert rockproof.classify(thin, UNIT) and rockproof.classify(thin, UNIT, engine="f64")
    with pytest.raises(InputError, match="block a: "):
        rockproof.classify(thin, UNIT, engine="f32")
    with pytest.raises(InputError, match='engine is "f16"; allowed are'):
        rockproof.classify(thin, UNIT, engine="f16")
    for pair in [(0, -1), (0, 2**70), (0, 0.5), 5, (0, 1, 2)]:
        with pytest.raises(InputError, match=r"^pair is .*; allowed are two numbers of blocks, from 0$"):
            rockproof.Model([thin, UNIT]).classify(pair=pair)
    with pytest.raises(InputError, match="pair names block 5; there are 2"):
        rockproof.Model([thin, UNIT]).classify(pair=(0, 5))
