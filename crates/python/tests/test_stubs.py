"""The stubs name what is there, with its parameters, and everything has a docstring."""

import ast
import inspect
from pathlib import Path

import rockproof
from rockproof import _native

STUB = ast.parse((Path(rockproof.__file__).parent / "_native.pyi").read_text())


def parameters(function):
    arguments = function.args
    named = [a.arg for a in [*arguments.args, *arguments.kwonlyargs] if a.arg not in ("self", "cls")]
    return named + ([arguments.kwarg.arg] if arguments.kwarg else [])


def test_stubs_are_what_is_there():
    stub = {node.name: node for node in STUB.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    there = {name for name in dir(_native) if not name.startswith("__")}
    assert set(stub) == there
    for name, node in stub.items():
        thing = getattr(_native, name)
        assert inspect.getdoc(thing), name
        if isinstance(node, ast.FunctionDef):
            assert parameters(node) == list(inspect.signature(thing).parameters), name
        elif name != "InputError":
            members = {member.name: member for member in node.body if isinstance(member, ast.FunctionDef)}
            public = {member for member in vars(thing) if not member.startswith("_")}
            assert {member for member in members if not member.startswith("_")} == public, name
            assert {member for member in members if member.startswith("_")} <= set(vars(thing)), name
            for member in public:
                assert inspect.getdoc(getattr(thing, member)), f"{name}.{member}"
                if callable(getattr(thing, member)):
                    found = [p for p in inspect.signature(getattr(thing, member)).parameters if p != "self"]
                    assert parameters(members[member]) == found, f"{name}.{member}"
            if "__new__" in members:
                assert parameters(members["__new__"]) == list(inspect.signature(thing).parameters), name


def test_what_is_exported_is_documented():
    for name in rockproof.__all__:
        assert hasattr(rockproof, name) and (name == "__version__" or inspect.getdoc(getattr(rockproof, name)))
    assert (Path(rockproof.__file__).parent / "py.typed").exists()
