"""What the tests share: the sources' root, and the command line to compare with."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
# Tests that lack a program say so; where this is set they fail instead.
NO_SKIP = "ROCKPROOF_NO_SKIP" in os.environ


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def command():
    """Runs `rockproof` in the sources' root and gives its standard output; the program is built by `cargo build --release`."""
    program = Path(os.environ.get("ROCKPROOF_COMMAND", ROOT / "target/release/rockproof"))
    if not program.exists():
        if NO_SKIP:
            pytest.fail(f"{program} is not there")
        pytest.skip(f"{program} is not there: cargo build --release makes it")

    def run(*arguments, exits=0):
        done = subprocess.run([program, *map(str, arguments)], cwd=ROOT, capture_output=True, text=True)
        assert done.returncode == exits, done.stderr
        return done.stdout

    return run
