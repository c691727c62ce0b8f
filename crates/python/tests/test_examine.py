"""`examine`: what the command line finds and writes, as objects."""

import csv
import json
import os
import shlex
import signal
import threading
import time

import pytest
import rockproof
from rockproof import Block, InputError, Model

FLOOR = Block.cuboid((-1, -1, -1), (3, 3, 0))
CUBE = Block.cuboid((0, 0, 0), (1, 1, 1))
QUICK = {"steps": 0, "candidates": 0}


def test_an_answer_and_its_files_are_those_of_the_command(root, command, tmp_path, monkeypatch):
    monkeypatch.chdir(root)
    file = "cases/real/slope_joints.dda"
    options = ["--tolerances", "shi", "--set", "search=1/100", "--candidates", 3]
    told = command("examine", file, *options, "--out", tmp_path / "told", exits=1)
    model = rockproof.load(file)
    found = rockproof.examine(model, rockproof.Tolerances("shi", search="1/100"), candidates=3)
    assert not found.is_safe and found.answer == "not safe" and found.violations and found.overlaps
    assert found.sentence == told.splitlines()[0]
    # There is a place for the tolerances in the one, and a next command.
    said = [line for line in told.splitlines() if not line.startswith("next:") and " set " not in line]
    assert [line for line in str(found).splitlines() if " set " not in line] == said
    written = found.write(tmp_path / "found")
    for name in os.listdir(tmp_path / "told"):
        if name not in ["cases", "rockproof.manifest.json"]:
            # Pages escape the slashes of paths.
            mine = (tmp_path / "found" / name).read_text().replace(f"{tmp_path.name}/found", f"{tmp_path.name}/told")
            mine = mine.replace(f"{tmp_path.name}&#x2f;found", f"{tmp_path.name}&#x2f;told")
            assert name in written and mine == (tmp_path / "told" / name).read_text(), name
    assert os.listdir(tmp_path / "found/cases") and os.listdir(tmp_path / "found/cases") == os.listdir(tmp_path / "told/cases")

    def value(text, found):
        return None if text == "" else type(found)(text)

    with open(tmp_path / "told/pairs.csv", newline="") as rows:
        rows = list(csv.DictReader(rows))
    assert len(rows) == len(found.pairs) > len(found.findings) > 0
    for row, pair in zip(rows, found.pairs):
        assert {name: value(row[name], pair[name]) for name in row} == pair
    document = json.loads((tmp_path / "told/examine.json").read_text())
    mine = found.to_dict()
    assert mine["next"] is None and mine["given"] == document["given"] and mine["pairs"] == document["pairs"]


def test_a_model_made_in_python_is_written_and_recommended_tolerances_are_safe(command, tmp_path):
    model = Model([FLOOR, CUBE, CUBE.translated((1, 0, 0))])
    given = rockproof.Tolerances("shi", search="1/100")
    found = rockproof.examine(model, given)
    assert found.answer == "safe with another set" and not found.is_safe and found.violations
    assert found.tolerances == rockproof.Tolerances("shi", search="1/100").derive(model.blocks) != found.recommended
    assert rockproof.examine(model, found.recommended, candidates=0).is_safe
    assert "model.toml" in found.write(tmp_path / "found")
    assert rockproof.load(tmp_path / "found/model.toml").blocks[2].exact_vertices == model.blocks[2].exact_vertices
    following = json.loads((tmp_path / "found/examine.json").read_text())["next"].split()
    assert following[:3] == ["rockproof", "examine", str(tmp_path / "found/model.toml")]
    # The tolerances in the page's commands are those of the model as well.
    found = rockproof.examine(Model([FLOOR, CUBE.translated((0, 0, "-1/2"))]), {"search": "1/3"}, **QUICK)
    found.write(tmp_path / "sunk")
    following = shlex.split(json.loads((tmp_path / "sunk/examine.json").read_text())["next"])
    assert following[1] == "classify" and following[-4:] == ["--set", "search=1/3", "--pair", "0,1"]
    assert "1 pair of neighbours" in command(*following[1:])


def test_directories_of_others_are_left_alone(command, root, tmp_path):
    found = rockproof.examine(Model([FLOOR, CUBE]), **QUICK)
    assert found.is_safe and found.findings == [] and len(found.pairs) == 1 and found.recommended is None
    found.write(tmp_path / "found")
    with pytest.raises(InputError, match="holds an examination already; overwrite=True discards it"):
        found.write(tmp_path / "found")
    found.write(tmp_path / "found", overwrite=True)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/index.html").write_text("mine")
    with pytest.raises(InputError, match="index.html is in the way"):
        found.write(tmp_path / "mine", overwrite=True)
    assert (tmp_path / "mine/index.html").read_text() == "mine"
    command("campaign", "--pairs", 8, "--family", "face_stack", "--steps-every", 0, "--out", tmp_path / "run")
    with pytest.raises(InputError, match="belongs to `rockproof campaign`; take another directory"):
        found.write(tmp_path / "run", overwrite=True)


def test_what_cannot_be_examined_is_named():
    far = Model([Block.cuboid((0, 0, 0), ("1e39", 1, 1))], names=["long"])
    with pytest.raises(InputError, match='block 0 "long": a coordinate overflows when rounded to f32'):
        rockproof.examine(far, {"search": 1, "penetration": 1, "territory": 0, "open": 0, "close": 0, "max_displacement": 1}, precision="f32")
    for wrong, word in [({"precision": "f16"}, "precision"), ({"candidates": 10_001}, "candidates"), ({"threads": 9999}, "threads")]:
        with pytest.raises(InputError, match=word):
            rockproof.examine(Model([FLOOR, CUBE]), **wrong)
    for wrong, told in [
        ({"steps": -1}, "^steps is -1; allowed are whole numbers from 0 to 18446744073709551615, and None for as many as suit the model$"),
        ({"steps": 2**70}, "^steps is 1180591620717411303424; "),
        ({"candidates": 2**40}, "^candidates is 1099511627776; allowed are 1 to 10000, and 0 for no search$"),
        ({"threads": 0.5}, "^threads is 0.5; allowed are 1 to 1024, and 0 for one a core$"),
    ]:
        with pytest.raises(InputError, match=told):
            rockproof.examine(Model([FLOOR, CUBE]), **wrong)


def test_ctrl_c_and_progress_end_it():
    signal.signal(signal.SIGINT, signal.default_int_handler)
    model = Model([FLOOR, CUBE])
    timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    begun = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        rockproof.examine(model, steps=100_000_000)
    assert time.monotonic() - begun < 30
    told = []

    def enough(what, done, total):
        told.append((what, done, total))
        if len(told) > 3:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        rockproof.examine(model, steps=100_000_000, progress=enough)
    assert told[-1][0] == "steps" and told[-1][2] == 100_000_000 and told[0][1] <= told[-1][1]


def test_other_threads_go_on_meanwhile(root):
    counted, over = [0], threading.Event()

    def count():
        while not over.is_set():
            counted[0] += 1
            time.sleep(0.001)

    model = rockproof.load(root / "cases/real/slope_joints.dda")
    thread = threading.Thread(target=count)
    thread.start()
    begun = time.monotonic()
    rockproof.examine(model, candidates=2)
    before, seconds = counted[0], time.monotonic() - begun
    over.set()
    thread.join()
    assert before > 20 * seconds, (before, seconds)


def test_tables_of_pandas_and_polars(root):
    found = rockproof.examine(rockproof.load(root / "cases/real/slope_joints.dda"), "shi", **QUICK)
    pandas = pytest.importorskip("pandas")
    table = found.to_pandas()
    assert isinstance(table, pandas.DataFrame) and len(table) == len(found.findings) and list(table.columns) == list(found.findings[0])
    assert len(found.to_pandas("pairs")) == len(found.pairs)
    polars = pytest.importorskip("polars")
    assert found.to_polars("pairs").shape == (len(found.pairs), 17)
    assert found.to_polars().schema["overlap_m"] == polars.Float64 and found.to_polars().schema["f64_broken"] == polars.UInt64
    with pytest.raises(InputError, match="allowed are"):
        found.to_pandas("nothing")
