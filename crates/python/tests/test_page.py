"""docs/python.md shows what happens: its `python` blocks run in order, in one session, in the sources' root.

With ROCKPROOF_RENEW=1 the outputs are written anew instead.
"""

import doctest
import os
import traceback

from conftest import ROOT

PAGE = ROOT / "docs/python.md"


def sessions(text):
    """The blocks of a page, each line where it stands, the rest empty."""
    inside = False
    for line in text.splitlines():
        if line.startswith("```"):
            inside = line == "```python"
            yield ""
        else:
            yield line if inside else ""


class Recorder(doctest.DocTestRunner):
    """Runs a session and keeps what it shows, by the line of the example."""

    shown = {}

    def report_success(self, out, test, example, got):
        self.shown[example.lineno] = example.want

    def report_failure(self, out, test, example, got):
        super().report_failure(out, test, example, got)
        self.shown[example.lineno] = got

    def report_unexpected_exception(self, out, test, example, exc_info):
        super().report_unexpected_exception(out, test, example, exc_info)
        last = "".join(traceback.format_exception_only(*exc_info[:2]))
        self.shown[example.lineno] = f"Traceback (most recent call last):\n    ...\n{last}"


def test_the_page_shows_what_happens(monkeypatch):
    monkeypatch.chdir(ROOT)
    page = PAGE.read_text()
    text = "\n".join(sessions(page)) + "\n"
    test = doctest.DocTestParser().get_doctest(text, {}, "docs/python.md", str(PAGE), 0)
    assert len(test.examples) > 20
    told, runner = [], Recorder(optionflags=doctest.ELLIPSIS, verbose=False)
    runner.run(test, out=told.append)
    if "ROCKPROOF_RENEW" in os.environ:
        lines = page.splitlines()
        for example in reversed(test.examples):
            begin = example.lineno + example.source.count("\n")
            lines[begin : begin + example.want.count("\n")] = runner.shown[example.lineno].splitlines()
        PAGE.write_text("\n".join(lines) + "\n")
    else:
        assert not told, "".join(told)
