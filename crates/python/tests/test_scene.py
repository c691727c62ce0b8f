"""Steps: against closed forms, and side by side."""

from fractions import Fraction

import pytest
import rockproof
from rockproof import InputError, Scene


def heights(step):
    return [z for _, _, z in step.exact_positions[0]]


@pytest.mark.parametrize(("arithmetic", "error"), [("f32", Fraction(1, 10**6)), ("f64", Fraction(1, 10**14)), ("exact", Fraction(1, 2**200))])
def test_a_block_falls_by_half_g_t_squared(root, arithmetic, error):
    scene = Scene(root / "cases/handmade/free_fall.toml")
    begun = [z for _, _, z in scene.model[0].exact_vertices]
    for number in range(1, 6):
        step = scene.step(arithmetic)
        fallen = 5 * Fraction(number, 100) ** 2
        assert step.number == number and step.converged and step.contacts == []
        assert all(abs(now - (then - fallen)) <= error for now, then in zip(heights(step), begun))
    assert step.time == pytest.approx(0.05) and step.time_step == pytest.approx(0.01)
    assert step.positions[0][0][2] == float(heights(step)[0])


def test_arithmetics_go_side_by_side_and_begin_anew(root):
    scene = Scene(root / "cases/handmade/incline_1_2_unsettled.toml")
    steps = {arithmetic: scene.step(arithmetic) for arithmetic in ("f64", "f32", "exact")}
    assert {step.number for step in steps.values()} == {1}
    contacts = {name: [(c.blocks, c.kind, c.feature_a, c.feature_b, c.mode) for c in step.contacts] for name, step in steps.items()}
    assert contacts["f64"] == contacts["exact"] != []
    assert scene.step("f64").number == 2 and scene.step("exact").number == 2
    scene.reset()
    again = scene.step("f64")
    assert again.number == 1 and again.exact_positions == steps["f64"].exact_positions
    assert all(abs(c.gap_m - e.gap_m) < 1e-12 for c, e in zip(steps["f64"].contacts, steps["exact"].contacts))


def test_scenes_come_from_texts_and_models(root):
    text = (root / "cases/handmade/free_fall.toml").read_text()
    from_text, from_model = Scene(text=text), Scene(rockproof.load(root / "cases/handmade/free_fall.toml"))
    assert from_text.step().exact_positions == from_model.step().exact_positions
    assert from_text.tolerances()["search"] == Fraction(1, 2)
    assert Scene(text=text, tolerances={"search": "1/3"}).tolerances("exact")["search"] == Fraction(1, 3)
    with pytest.raises(InputError, match="scene.toml:2:.*unknown key"):
        Scene(text="[simulation]\ngravty = 1\n")
    with pytest.raises(InputError, match="scene.toml:2:") as long:
        Scene(text="[simulation]\ngravity\x1b = \"" + "7" * 100_000 + "\"\n")
    assert len(str(long.value)) < 10_000 and "\x1b" not in str(long.value)
    with pytest.raises(InputError, match="one of them"):
        Scene()
    with pytest.raises(InputError, match='arithmetic is "f16"'):
        from_text.step("f16")
