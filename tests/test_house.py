"""Rules of all modules: one value a constant, few numbers, one meaning a class name, no circle (types included)."""

import ast
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FILES = sorted(path for name in ("ratt_opt", "ratt_audit", "analysis") for path in (ROOT / name).rglob("*.py"))


def module_name(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def assigned_twice(text: str) -> list[str]:
    """The names that the top level of a module assigns more than once."""
    counts: Counter[str] = Counter()
    for node in ast.parse(text).body:
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
        counts.update(name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name))
    return [name for name, count in counts.items() if count > 1]


def imports(texts: dict[str, str]) -> dict[str, set[str]]:
    """Module -> modules of the same set that it imports anywhere, also for types or inside a function."""
    found: dict[str, set[str]] = {}
    for module, text in texts.items():
        named = set()
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ImportFrom) and node.module:
                parts = {alias.name: f"{node.module}.{alias.name}" for alias in node.names}
                named |= {part if part in texts else node.module for part in parts.values()}
            elif isinstance(node, ast.Import):
                named |= {alias.name for alias in node.names}
        found[module] = named & (set(texts) - {module})
    return found


def in_circles(edges: dict[str, set[str]]) -> set[str]:
    """The modules that are left when those that import nothing left, or that nothing left imports, are taken away."""
    left = dict(edges)
    while gone := {
        module for module in left if not left[module] & set(left) or not any(module in left[other] for other in left)
    }:
        left = {module: below for module, below in left.items() if module not in gone}
    return set(left)


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("GROWTH = 1.5\nTURN, GROWTH = 20, 2.0", ["GROWTH"]),
        ("A: int = 1\nA = 2", ["A"]),
        ("A = B = 1\ndef f():\n    A = 2", []),
    ],
)
def test_a_second_value_is_noticed(text: str, names: list[str]) -> None:
    assert assigned_twice(text) == names


def test_a_circle_is_noticed_in_types_and_inside_functions() -> None:
    texts = {
        "p.a": "if TYPE_CHECKING:\n    from p.b import B",
        "p.b": "def f():\n    from p import c",
        "p.c": "import p.a",
        "p.d": "from p.a import A",
    }
    assert in_circles(imports(texts)) == {"p.a", "p.b", "p.c"}
    assert not in_circles(imports(texts | {"p.c": ""}))


def test_no_constant_has_two_values() -> None:
    found = {module_name(path): assigned_twice(path.read_text(encoding="utf-8")) for path in FILES}
    assert {module: names for module, names in found.items() if names} == {}


def test_no_import_runs_in_a_circle() -> None:
    texts = {module_name(path): path.read_text(encoding="utf-8") for path in FILES}
    # Packages hand names on, and load those of the library only when they are asked for.
    faces = {module_name(path) for path in FILES if path.name == "__init__.py"}
    assert in_circles(imports({module: text for module, text in texts.items() if module not in faces})) == set()


def numbers(text: str) -> list[str]:
    """Names to which the top level of a module assigns a number that is written out."""

    def is_number(node: ast.AST) -> bool:
        if isinstance(node, ast.UnaryOp):
            return is_number(node.operand)
        if isinstance(node, ast.BinOp):
            return is_number(node.left) and is_number(node.right)
        return isinstance(node, ast.Constant) and type(node.value) in {int, float}

    found: list[str] = []
    for node in ast.parse(text).body:
        if isinstance(node, (ast.Assign, ast.AnnAssign)) and node.value is not None:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            values = node.value.elts if isinstance(node.value, ast.Tuple) else [node.value]
            if any(map(is_number, values)):
                found += [x.id for target in targets for x in ast.walk(target) if isinstance(x, ast.Name)]
    return found


def test_a_number_is_noticed() -> None:
    text = "A = 1\nB: float = -2.0**3\nC, D = 1, 'x'\nE = (0.5, 1)\nF = True\nG = len('x')\ndef f(): H = 1"
    assert numbers(text) == ["A", "B", "C", "D", "E"]


def test_a_new_number_is_a_parameter() -> None:
    """What is left at the top of modules is mathematics: a tolerance with its reason, a limit of a format."""
    package = [path for path in FILES if path.is_relative_to(ROOT / "ratt_opt")]
    assert sum(len(numbers(path.read_text(encoding="utf-8"))) for path in package) <= 150


def classes_of(texts: dict[str, str]) -> dict[str, set[str]]:
    """Class name -> modules that define such a class."""
    found: dict[str, set[str]] = {}
    for module, text in texts.items():
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ClassDef):
                found.setdefault(node.name, set()).add(module)
    return found


def test_a_second_meaning_is_noticed() -> None:
    texts = {"p.a": "class A: pass\nclass B: pass", "p.b": "def f():\n    class A: pass"}
    assert classes_of(texts) == {"A": {"p.a", "p.b"}, "B": {"p.a"}}


def test_a_class_name_of_the_package_has_one_meaning() -> None:
    package = {
        module_name(path): path.read_text(encoding="utf-8") for path in FILES if path.is_relative_to(ROOT / "ratt_opt")
    }
    assert {name: modules for name, modules in classes_of(package).items() if len(modules) > 1} == {}
