"""Tells whether contact analysis of polyhedral blocks can be trusted.

Lengths are metres, angles of tolerances degrees, times seconds. Exact values are `fractions.Fraction`.
"""

from ._native import (
    Block,
    CheckReport,
    Contact,
    ExaminedPair,
    Fall,
    InputError,
    Model,
    Overlap,
    PairContacts,
    Penetration,
    Scene,
    Separation,
    Step,
    StepContact,
    Tolerances,
    Violation,
    __version__,
    check,
    classify,
    load,
    penetration,
    separation,
)
from ._benchmark import BenchmarkContact, BenchmarkPair, benchmark
from ._campaign import Results, campaign, families
from ._examine import Examination, examine

__all__ = [
    "BenchmarkContact",
    "BenchmarkPair",
    "Block",
    "CheckReport",
    "Contact",
    "Examination",
    "ExaminedPair",
    "Fall",
    "InputError",
    "Model",
    "Overlap",
    "PairContacts",
    "Penetration",
    "Results",
    "Scene",
    "Separation",
    "Step",
    "StepContact",
    "Tolerances",
    "Violation",
    "__version__",
    "benchmark",
    "campaign",
    "check",
    "classify",
    "examine",
    "families",
    "load",
    "penetration",
    "separation",
]
