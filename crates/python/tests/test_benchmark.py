"""The benchmark set: its answers are those of the oracle, and its difficulties those of the float code."""

from collections import Counter
from fractions import Fraction

import pytest
import rockproof
from rockproof import InputError

FEATURES = ["kind", "feature_a", "feature_b", "entrance", "entrance_a", "entrance_b", "gap_sign"]


@pytest.fixture(scope="module")
def pairs(root):
    return list(rockproof.benchmark(root / "cases/benchmark/pairs.jsonl"))


def features(contacts):
    return [tuple(getattr(contact, name) for name in FEATURES) for contact in contacts]


def test_it_has_two_thousand_pairs_of_every_family_and_difficulty(pairs):
    assert [pair.id for pair in pairs] == list(range(2000))
    assert set(Counter(pair.family for pair in pairs)) == set(rockproof.families())
    assert set(Counter(pair.difficulty for pair in pairs)) == {"f32", "f64", "exact"}


def test_its_answers_come_out_again(pairs):
    for pair in pairs[::5]:
        found = rockproof.classify(pair.a, pair.b, pair.tolerances)
        assert features(found) == features(pair.contacts) != []
        assert [contact.gap_squared for contact in found] == [contact.gap_squared for contact in pair.contacts]
        if pair.state is not None:
            lie = rockproof.separation(pair.a, pair.b)
            assert (lie.state, lie.gap_squared) == (pair.state, pair.separation_squared)
        assert rockproof.penetration(pair.a, pair.b).depth_squared == pair.depth_squared

        def right(engine):
            try:
                return features(rockproof.classify(pair.a, pair.b, pair.tolerances, engine=engine)) == features(found)
            except InputError:
                return False

        assert pair.difficulty == next((engine for engine in ("f32", "f64") if right(engine)), "exact")


def test_a_pair_worked_out_by_hand(tmp_path):
    line = (
        '{"version":3,"id":0,"family":"x","form":"base","difficulty":"f32","tolerances":{"search":"1/3"},'
        '"a":{"vertices":[["0","0","0"],["1","0","0"],["0","1","0"],["0","0","1/3"]],"faces":[[0,2,1],[0,1,3],[1,2,3],[0,3,2]]},'
        '"b":{"vertices":[["0","0","1"],["1","0","1"],["0","1","1"],["0","0","4/3"]],"faces":[[0,2,1],[0,1,3],[1,2,3],[0,3,2]]},'
        '"contacts":[],"separation":{"state":"apart","gap_squared":"4/9"},"penetration":{"depth_squared":"0"}}\n'
    )
    file = tmp_path / "set.jsonl"
    file.write_text(line)
    (pair,) = rockproof.benchmark(file)
    assert pair.separation_squared == Fraction(4, 9) == rockproof.separation(pair.a, pair.b).gap_squared
    assert pair.tolerances["search"] == Fraction(1, 3) and pair.tolerances.preset is None
    for broken, told in [
        (line.replace('"version":3', '"version":9'), "set.jsonl:1: version is 9; read is 3"),
        (line.replace('"4/9"', '"x"'), "set.jsonl:1: "),
        (line.replace('"faces":[[0,2,1]', '"faces":[[0,2,9]', 1), "set.jsonl:1: "),
        (line.replace('"penetration"', '"depth"'), "set.jsonl:1: there is no 'penetration'"),
        (line + "nonsense\n", "set.jsonl:2: "),
    ]:
        file.write_text(broken)
        with pytest.raises(InputError, match=told):
            list(rockproof.benchmark(file))
    with pytest.raises(InputError, match="none.jsonl: "):
        list(rockproof.benchmark(tmp_path / "none.jsonl"))
