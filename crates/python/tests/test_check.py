"""`check`: what the command line finds, as objects."""

import re
from fractions import Fraction

import pytest
import rockproof
from rockproof import Block, InputError, Model


def test_rules_and_overlaps_of_a_model_are_those_of_the_command(root, command):
    file = root / "cases/real/slope_joints.dda"
    told = command("check", file, "--tolerances", "shi", exits=1)
    found = rockproof.check(rockproof.load(file), "shi")
    assert not found.is_sound
    assert int(re.search(r"rules: (\d+) violated", told)[1]) == len(found.violations) > 0
    for violation in found.violations:
        assert violation.rule in told and f"satisfied  by {violation.remedy}" in told
        assert f"found      {violation.found:.6e}".replace("e-0", "e-").replace("e+0", "e") in told
    assert ("overlaps: none" in told) == (not found.overlaps)


def test_overlaps_are_exact():
    slab = Block.cuboid((-9, -9, -4), (9, 9, 0))
    cube = Block.cuboid((0, 0, "-1/1000"), (1, 1, "999/1000"))
    apart = cube.translated((2, 0, "1/1000"))
    found = rockproof.check(Model([slab, cube, apart]), {"penetration": "1/16"})
    (overlap,) = found.overlaps
    assert overlap.blocks == (0, 1) and overlap.depth == Fraction(1, 1000) and overlap.depth_squared == Fraction(1, 10**6)
    assert (overlap.meaning, overlap.sight, overlap.is_deeper_than_penetration) == ("held", "seen", False)
    lost = rockproof.check(Model([slab, cube, apart]), {"penetration": "1/2000"})
    assert lost.overlaps[0].meaning == "lost" and lost.overlaps[0].is_deeper_than_penetration and not lost.is_sound
    # Overlaps alone make a model unsound.
    alone = rockproof.check(Model([slab, cube.translated((0, 0, "-1/2"))]))
    assert alone.violations == [] and [o.meaning for o in alone.overlaps] == ["lost"] and not alone.is_sound
    assert rockproof.check(Model([slab, cube.translated((0, 0, "1/1000"))])).is_sound
    assert found.tolerances["penetration"] == Fraction(1, 16)


def test_what_overflows_is_named(root):
    far = Model([Block.cuboid((0, 0, 0), ("1e39", 1, 1))], names=["long"])
    with pytest.raises(InputError, match='block 0 "long": a coordinate overflows when rounded to f32'):
        rockproof.check(far, {"search": 1, "penetration": 1, "territory": 0, "open": 0, "close": 0, "max_displacement": 1}, precision="f32")
    with pytest.raises(InputError, match="precision"):
        rockproof.check(far, precision="f16")
