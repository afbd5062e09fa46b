"""Write ``ratt_opt/native/loops.py``, Python's side of the compiled loops, from the headers of ``ratt_opt/native/src``.

Run ``python -m analysis.boundary`` after a header has changed. A record becomes a class with its fields in order and
the first sentence of its comment. A function that a header marks ``EXPORTED`` becomes a method of ``Loops``.
Its argument ``Name *name`` is one record, ``Name name[]`` an array of them.
"""

import re
from textwrap import wrap
from typing import Any

from pycparser import CParser, c_ast

from ratt_opt.native import declared
from ratt_opt.native.sources import HEADERS, SOURCES

__all__ = ["TARGET", "generated", "read_headers"]

TARGET = SOURCES.parent / "loops.py"
WIDTH = 120
NUMBERS = {"int": "Int", "int32_t": "Int32", "int64_t": "Int64", "uint64_t": "UInt64", "double": "Double"}
ARRAYS = {"double": "Doubles", "uint8_t": "Bytes", "int": "Int32s", "void": "Anything", "char": "Text"}
TYPING = "from typing import Annotated, Protocol, cast"
LAST = 'loops = cast("Loops", Loader(Loops))\n"""Functions, bound at the first use."""'
HEAD = '''"""Records and functions of the compiled loops, by ``python -m analysis.boundary`` from the headers."""

# fmt: off
'''
COMMENT = re.compile(r"/\*(.*?)\*/", re.DOTALL)
KNOWN = "".join(f"typedef int {sign}int{n}_t;" for sign in ("", "u") for n in (8, 16, 32, 64)) + "typedef int size_t;\n"
"""Types of the compiler's own headers."""


def read_headers() -> dict[str, str]:
    """Return the text of each header by its name."""
    return {name: (SOURCES / f"{name}.h").read_text(encoding="utf-8") for name in HEADERS.split()}


def generated(headers: dict[str, str]) -> str:
    """Return the module that declares the exported functions, and the records that they name."""
    tree = CParser().parse(KNOWN + _joined(headers))
    structs = {node.name: node for node in tree.ext if _is_struct(node)}
    exported = [node for node in tree.ext if isinstance(node, c_ast.Decl) and "extern" in node.storage]
    complete = {name for name, node in structs.items() if node.type.type.decls}
    used = _reachable(structs, exported)
    records = [_record(node, headers, complete) for name, node in structs.items() if name in used]
    functions, family = [], ""
    for node in exported:
        if node.coord.file != family:
            family = node.coord.file
            functions.append(f"\n    # {family}")
        functions.append(_function(node, complete))
    protocol = 'class Loops(Protocol):\n    """Functions of the compiled loops, by header."""\n' + "\n".join(functions)
    body = "\n\n".join([*records, protocol, LAST])
    return f"{_head(body)}\n\n{body}\n"


def _joined(headers: dict[str, str]) -> str:
    """Return what the public headers declare, each after those that it includes, without comments and directives."""
    done: dict[str, str] = {}

    def add(name: str) -> None:
        if name in done:
            return
        for other in re.findall(r'^#include "(\w+)\.h"', headers[name], re.MULTILINE):
            add(other)
        blank = COMMENT.sub(lambda found: "\n" * found[0].count("\n"), headers[name])
        plain = re.sub(r"^#.*$", "", blank, flags=re.MULTILINE)
        done[name] = f'# 1 "{name}.h"\n' + plain.replace("EXPORTED ", "extern ")

    for name, text in headers.items():
        if re.search("^EXPORTED ", text, re.MULTILINE):
            add(name)
    return "".join(done.values())


def _is_struct(node: Any) -> bool:
    return isinstance(node, c_ast.Typedef) and isinstance(node.type.type, c_ast.Struct)


def _names(node: Any) -> set[str]:
    """Return the names of the types in a declaration."""
    own = set(node.names) if isinstance(node, c_ast.IdentifierType) else set()
    return own.union(*(_names(child) for _, child in node.children()))


def _reachable(structs: dict[str, Any], exported: list[Any]) -> set[str]:
    found: set[str] = set()
    waiting = set().union(*map(_names, exported)) & set(structs)
    while waiting:
        found.add(name := waiting.pop())
        waiting |= (_names(structs[name]) & set(structs)) - found
    return found


def _record(node: Any, headers: dict[str, str], complete: set[str]) -> str:
    """Return a record's class, several fields a line."""
    place = node.type.type.coord
    comment = _comment(headers[place.file.removesuffix(".h")], place)
    fields = " ".join(f"{one.name}:~{_field(one.type, complete)};" for one in node.type.type.decls or ())
    lines = [f"    {line.rstrip(';')}" for line in _lines(fields, WIDTH - 4)]
    return "\n".join(["@record", f"class {node.name}Record(Structure):", f'    """{comment}"""', *lines])


def _lines(text: str, width: int, **indents: Any) -> list[str]:
    """Fill lines that may end at a space; ``~`` is one where they may not."""
    return [line.replace("~", " ") for line in wrap(text, width, break_on_hyphens=False, **indents)]


def _comment(text: str, place: Any) -> str:
    """Return the first sentence of the comment that ends above a line."""
    for found in COMMENT.finditer(text):
        if text.count("\n", 0, found.end()) + 2 == place.line:
            sentence = re.split(r"(?<=\.)\s|:\s*\n?\s", " ".join(found[1].split()))[0].rstrip(".")
            return re.sub(r"`+", "``", sentence) + "."
    raise ValueError(f"{place.file}:{place.line} needs a comment above it")


def _field(kind: Any, complete: set[str]) -> str:
    """Return the annotation of a field: numbers, records and arrays as they are, addresses."""
    if isinstance(kind, c_ast.ArrayDecl):
        element = f"c_{_name(kind.type).removesuffix('_t')}"
        return f"Annotated[Array[{element}],~{element}~*~{kind.dim.value}]"
    if isinstance(kind, c_ast.PtrDecl):
        return "Anything" if isinstance(kind.type, c_ast.FuncDecl) else _array(_name(kind.type))
    return f"{_name(kind)}Record" if _name(kind) in complete else NUMBERS[_name(kind)]


def _argument(kind: Any, complete: set[str]) -> str:
    """Return the annotation of an argument or a result: as for a field, but one record for its address."""
    if isinstance(kind, c_ast.ArrayDecl):
        return _array(_name(kind.type))
    if isinstance(kind, c_ast.PtrDecl) and _name(kind.type) in complete:
        return f"{_name(kind.type)}Record"
    return "None" if isinstance(kind, c_ast.TypeDecl) and _name(kind) == "void" else _field(kind, complete)


def _array(name: str) -> str:
    if name.endswith("_t"):
        return ARRAYS.get(name) or f"{name.removesuffix('_t').replace('int', 'Int').replace('u', 'U')}s"
    return ARRAYS.get(name) or f"Pointer[{name}Record]"


def _name(kind: Any) -> str:
    return str(kind.type.names[0])


def _function(node: Any, complete: set[str]) -> str:
    """Return a method, whose lines end after an argument."""
    given = [one for one in (node.type.args.params if node.type.args else ()) if one.name]
    arguments = ["self", *(f"{one.name}:~{_argument(one.type, complete)}" for one in given)]
    text = f"def {node.name}({', '.join(arguments)})~->~{_argument(node.type.type, complete)}:~..."
    indent = " " * len(f"    def {node.name}(")
    return "\n".join(_lines(text, WIDTH, initial_indent="    ", subsequent_indent=indent))


def _head(body: str) -> str:
    """Return the module's docstring and its imports."""
    words = sorted(set(re.findall(r"\w+", body)))
    own = [word for word in words if word in declared.__all__]
    text = "\n".join(wrap(f"from ratt_opt.native.declared import ({', '.join(own)})", WIDTH, subsequent_indent="    "))
    numbers = ", ".join(word for word in words if word.startswith("c_"))
    return f"{HEAD}\nfrom ctypes import Array, Structure, {numbers}\n{TYPING}\n\n{text}"


if __name__ == "__main__":
    TARGET.write_text(generated(read_headers()), encoding="utf-8")
