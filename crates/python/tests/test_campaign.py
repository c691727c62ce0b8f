"""Campaigns: the command's findings, functions as engines, and what goes on meanwhile."""

import csv
import os
import signal
import threading
import time
from decimal import Decimal

import pytest
import rockproof
from rockproof import Block, InputError

SMALL = {"pairs": 128, "families": "face_stack", "tolerances": "auto"}


def exact(a, b, tolerances):
    return rockproof.classify(a, b, tolerances)



def test_findings_and_summary_are_those_of_the_command(command, tmp_path):
    command("campaign", "--pairs", 512, "--seed", 7, "--steps-every", 0, "--out", tmp_path / "run")
    found = rockproof.campaign(pairs=512, seed=7)

    def rows(name):
        with open(tmp_path / "run" / name, newline="") as file:
            return list(csv.DictReader(file))

    def number(text):
        return float(text) if text else None

    told = rows("findings.csv")
    assert len(told) == len(found.findings) > 100 and found.pairs == 512
    for row, finding in zip(told, found.findings):
        assert int(row["index"]) == finding["index"]
        assert number(row["margin"]) == finding["margin"] and number(row["margin_ulps"]) == finding["margin_ulps"]
        for name in ["family", "form", "tolerances", "engine", "cause", "change", "kind_before", "kind_after", "predicate", "features"]:
            assert row[name] == (finding[name] or ""), (name, row)
    summary = [{name: "" if value is None else str(value) for name, value in row.items()} for row in found.summary]
    assert summary == rows("summary.csv")


def test_exact_ties_are_those_of_the_command(command, tmp_path):
    command("campaign", "--pairs", 256, "--exact-ties", "--steps-every", 0, "--out", tmp_path / "run")
    found = rockproof.campaign(pairs=256, exact_ties=True)
    with open(tmp_path / "run" / "findings.csv", newline="") as file:
        told = [(int(row["index"]), row["change"]) for row in csv.DictReader(file)]
    own = [(finding["index"], finding["change"]) for finding in found.findings]
    assert told == own and own != [(f["index"], f["change"]) for f in rockproof.campaign(pairs=256).findings]


def test_a_function_that_is_right_has_no_finding():
    found = rockproof.campaign(exact, **SMALL)
    assert [f for f in found.findings if f["engine"] == "exact"] == []
    assert found.pairs == 128 and found.contacts > 100


def test_a_planted_mistake_is_found_and_its_pair_shows_it():
    def loses_the_last(a, b, tolerances):
        return rockproof.classify(a, b, tolerances)[:-1]

    found = rockproof.campaign({"mine": loses_the_last}, **SMALL)
    own = [f for f in found.findings if f["engine"] == "mine"]
    assert own and {f["cause"] for f in own} == {"engine"} and "missing" in {f["change"] for f in own}
    lost = next(f for f in own if f["change"] == "missing")
    pair = found.pair(lost)
    tolerances = pair.tolerances[lost["tolerances"]]["f64"]
    true = rockproof.classify(pair.a.rounded("f64"), pair.b.rounded("f64"), tolerances)
    assert lost["kind_before"] == true[-1].kind and pair.index == lost["index"] and pair.family == "face_stack"
    for number in [-1, 2**70, "first"]:
        with pytest.raises(InputError, match="there is no pair .*; there are 128, from 0"):
            found.pair(number)
    with pytest.raises(InputError, match="there is no pair 128; there are 128"):
        found.pair(128)


def test_answers_about_states_are_compared():
    def always_apart(a, b, tolerances):
        return {"state": "apart"}

    def right(a, b, tolerances):
        told = rockproof.separation(a, b)
        return {"state": told.state, "gap_m": told.gap if told.gap is not None else told.gap_m}

    found = rockproof.campaign([always_apart, right], **SMALL)
    assert {f["engine"] for f in found.findings if f["cause"] == "engine"} == {"always_apart"}
    assert {f["change"] for f in found.findings if f["engine"] == "always_apart"} >= {"state"}


def test_exceptions_and_nonsense_are_failures_of_the_engine():
    def raises(a, b, tolerances):
        raise ZeroDivisionError("no\nsecond line" if tolerances["search"] else "")

    def nonsense(a, b, tolerances):
        return [{"kind": "x-x"}]

    def no_json(a, b, tolerances):
        return {"state": "apart", "gap_m": Decimal(1)}

    def refuses(a, b, tolerances):
        return {"unsupported": "not today"}

    def nothing(a, b, tolerances):
        return None

    found = rockproof.campaign([raises, nonsense, no_json, refuses, nothing], **{**SMALL, "pairs": 16})
    notes = {f["engine"]: (f["change"], f["note"]) for f in found.findings if f["cause"] == "engine"}
    assert notes["raises"][0] == "failure" and "ZeroDivisionError: no" in notes["raises"][1] and "(line " in notes["raises"][1]
    assert notes["nonsense"][0] == "malformed" and "kind is" in notes["nonsense"][1]
    assert notes["no_json"][0] == "malformed" and "Decimal" in notes["no_json"][1]
    assert notes["refuses"] == ("unsupported", "unsupported: not today")
    assert notes["nothing"][0] == "malformed" and "NoneType" in notes["nothing"][1]


def test_functions_are_asked_with_what_their_precision_sees():
    seen = []

    def watches(a, b, tolerances):
        seen.append((isinstance(a, Block), a.is_exact_in("f32"), tolerances))
        return {"unsupported": "only looking"}

    rockproof.campaign(watches, precision="f32", **SMALL)
    assert seen and all(block and exact_in_f32 for block, exact_in_f32, _ in seen)
    assert set(seen[0][2]) >= {"search", "territory", "penetration", "criteria"} and seen[0][2]["criteria"] == "revised"


def test_settings_that_mean_nothing_are_refused():
    for settings, told in [
        ({"pairs": 0}, "pairs is 0"),
        ({"families": "nobody"}, 'family "nobody" does not exist; there are'),
        ({"tolerances": "nobody"}, 'tolerance set "nobody" does not exist'),
        ({"threads": 5000}, "threads is 5000"),
        ({"precision": "f16"}, 'precision is "f16"'),
        ({"real": "no.dda"}, "no.dda"),
        ({"planarity": "1e-4"}, "planarity is about the files of `real`, and there are none"),
        ({"real": "no.dda", "weld": -1}, "weld is negative; allowed is 0 or more"),
    ]:
        with pytest.raises(InputError, match=told):
            rockproof.campaign("f64", **settings)
    whole = "; allowed are whole numbers from 0 to 18446744073709551615$"
    for settings, told in [
        ({"pairs": 2.5}, "^pairs is 2.5; allowed are whole numbers from 1 to 18446744073709551615$"),
        ({"pairs": -1}, "^pairs is -1; allowed are whole numbers from 1 to "),
        ({"pairs": 2**64}, "^pairs is 18446744073709551616; allowed are whole numbers from 1 to "),
        ({"pairs": 10**5000}, "^pairs is a value of type int that is too long to show; allowed are "),
        ({"seed": "one"}, "^seed is 'one'" + whole),
        ({"seed": -1}, "^seed is -1" + whole),
        ({"metamorphic_every": None}, "^metamorphic_every is None" + whole),
        ({"threads": -1}, "^threads is -1; allowed are 1 to 1024, and 0 for one a core$"),
        ({"precision": 64}, '^precision is 64; allowed are "f64" and "f32"$'),
        ({"families": 5}, "^families is 5; allowed are a name and a sequence of names$"),
        ({"families": ["face_stack", 5]}, "^families is ..face_stack., 5.; allowed are a name"),
        ({"tolerances": [None]}, "^tolerances is .None.; allowed are a name"),
        ({"real": 5}, "^real is 5; allowed are a name"),
    ]:
        with pytest.raises(InputError, match=told):
            rockproof.campaign("f64", **settings)
    for engine in [5, [5], {"mine": 5}, {5: exact}, None]:
        with pytest.raises(InputError, match='^engine is .*; allowed are "f32", "f64", a function'):
            rockproof.campaign(engine)
    with pytest.raises(InputError, match='engine "nobody" does not exist'):
        rockproof.campaign("nobody")
    for name in ["f32", "any", "stepper-f64", "two words", "_mine", ""]:
        with pytest.raises(InputError, match=f'engine name "{name}": allowed are letters'):
            rockproof.campaign({name: exact})
    with pytest.raises(InputError, match="two engines"):
        rockproof.campaign([exact, exact])


def test_a_file_in_millimetres_is_read_as_its_conversion(root, command, tmp_path):
    file, metres = root / "cases/meshes/arch_mm.stl", tmp_path / "metres.toml"
    command("convert", file, metres, "--scale", "1/1000")
    scaled, converted = rockproof.load(file, scale="1/1000"), rockproof.load(metres)
    assert [block.exact_vertices for block in scaled.blocks] == [block.exact_vertices for block in converted.blocks]
    settings = {"pairs": 64, "families": "real", "tolerances": "auto"}
    found = rockproof.campaign(real=file, scale="1/1000", **settings)
    assert found.findings == rockproof.campaign(real=metres, **settings).findings != rockproof.campaign(real=file, **settings).findings
    # Only whoever says the unit is believed.
    quick = {"steps": 0, "candidates": 0}
    assert "doubt" in rockproof.examine(rockproof.load(file), **quick).sentence
    assert "doubt" not in rockproof.examine(rockproof.load(file, scale=1), **quick).sentence
    for scale in [0, -1]:
        with pytest.raises(InputError, match="scale is not above 0"):
            rockproof.load(file, scale=scale)
    with pytest.raises(InputError, match="a scale is for files of coordinates"):
        rockproof.load(metres, scale=2)
    with pytest.raises(InputError, match="scale is about the files of `real`"):
        rockproof.campaign(scale=2, pairs=1)


def test_ctrl_c_ends_a_campaign():
    # A shell starts what runs in its background with Ctrl-C ignored, and Python leaves that so.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    begun = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        rockproof.campaign("f64", pairs=50_000_000)
    assert time.monotonic() - begun < 30
    # And with a function, which needs Python's lock to answer.
    timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        rockproof.campaign(exact, pairs=50_000_000)


def test_other_threads_go_on_meanwhile():
    counted, over = [0], threading.Event()

    def count():
        while not over.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    found = rockproof.campaign("f64", pairs=4096)
    before = counted[0]
    over.set()
    thread.join()
    # Were Python's lock held, the count would be that before the campaign.
    assert before > 20 * found.seconds, (before, found.seconds)


def test_progress_is_told_and_may_end_the_campaign():
    told = []
    rockproof.campaign("f64", pairs=4096, progress=lambda pairs, findings: told.append((pairs, findings)))
    assert told and told == sorted(told) and told[-1][0] <= 4096

    def enough(pairs, findings):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        rockproof.campaign("f64", pairs=50_000_000, progress=enough)


def test_tables_of_pandas_and_polars():
    found = rockproof.campaign("f32", pairs=256)
    pandas = pytest.importorskip("pandas")
    table = found.to_pandas()
    assert len(table) == len(found.findings) and list(table.columns) == list(found.findings[0])
    assert found.pair(table.iloc[0]).index == found.findings[0]["index"]
    summary = found.to_pandas("summary")
    assert summary["findings"].sum() == len(found.findings) and isinstance(summary, pandas.DataFrame)
    polars = pytest.importorskip("polars")
    assert found.to_polars().shape == (len(found.findings), 14)
    assert found.to_polars("summary")["findings"].sum() == len(found.findings)
    assert found.to_polars().schema["margin"] == polars.Float64
    with pytest.raises(InputError, match="allowed are"):
        found.to_pandas("nothing")


def test_families_are_named_with_what_they_are_for():
    assert {"face_stack", "real", "sliver"} <= set(rockproof.families())
    assert all(text for text in rockproof.families().values())


def test_real_files_are_read_as_load_reads_them(root, command, tmp_path):
    file = root / "cases/real/voronoi_120.txt"
    settings = {"pairs": 64, "families": "real", "tolerances": "auto", "real": file}
    with pytest.raises(InputError, match="face 0 is not planar"):
        rockproof.campaign(**settings)
    found = rockproof.campaign(**settings, planarity="1e-4", weld=0)
    arguments = ["--family", "real", "--tolerances", "auto", "--real", file, "--planarity", "1e-4", "--weld", 0]
    command("campaign", "--pairs", 64, "--steps-every", 0, *arguments, "--out", tmp_path / "run")
    with open(tmp_path / "run/findings.csv", newline="") as rows:
        assert [int(row["index"]) for row in csv.DictReader(rows)] == [finding["index"] for finding in found.findings] != []
