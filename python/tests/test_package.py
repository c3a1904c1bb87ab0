# SPDX-License-Identifier: Apache-2.0
import ast
from importlib.metadata import version
from pathlib import Path

import stein
from stein import _stein

FOLDER = Path(stein.__file__).parent


def test_the_version_is_the_project_s():
    assert stein.__version__ == version("stein")


def test_there_are_stubs_for_all_of_it():
    assert (FOLDER / "py.typed").exists()
    text = (FOLDER / "_stein.pyi").read_text()
    stubs = {node.name for node in ast.parse(text).body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert stubs | {"version"} == {name for name in vars(_stein) if not name.startswith("_")}
    exec(compile(text, "_stein.pyi", "exec"), {})  # all that it names can be imported


def test_all_names_are_there():
    for name in stein.__all__:
        assert hasattr(stein, name), name
    assert set(stein.__all__) >= {name for name in vars(_stein) if not name.startswith("_")} - {"denoise", "version"}
