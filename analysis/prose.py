"""Check the English of pages, docstrings and messages: ``python -m analysis.prose [FILE ...]``.

It prints one line a finding, ``FILE:LINE: what to write instead``, and returns 1 if there are any. The word list is
``analysis/words.toml``. Besides, it counts words and conditions: a sentence has at most 40 words and two conditions.
A docstring, private ones too, and a comment begin with an imperative or a noun phrase.
Without arguments it reads every page and notebook, and every Python file of the package and of the studies.
"""

import ast
import io
import json
import re
import sys
import tokenize
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

__all__ = ["Finding", "Passage", "findings", "fragments", "main", "passages", "read_words", "readable_files"]

ROOT = Path(__file__).parents[1]
LONGEST = 40
"""Words of a sentence."""
CONDITIONS = 2
"""Conditions of a sentence; one of them may be its subject's."""
PAGES = ("README.md", "CONTRIBUTING.md", "CODE_OF_CONDUCT.md", "docs", "paper")
MADE = ("api", "gallery", "notebooks", "schemas")
"""Folders of docs that building the site writes."""
CODE = ("ratt_opt", "ratt_audit", "analysis", "docs/examples")

SENTENCE = re.compile(r"(?<=[.!?])\s+(?=[A-Zx(*\"\[])|(?<=[;:])\s+|\n\s*\n|\n\s*(?=- |[\w, ]+ : )")
"""End of a sentence. A colon and a semicolon end one, too, and so does the field of a record or parameter."""
FRAGMENT = re.compile(
    "(What|Of|The same|Those|How|So many|So few|Whose|Whom|Which|Where|Whether|As|That|There|Nothing|Nobody|Another"
    "|Only|But|And|No more|One more|To|From|In|By|At|For|With|Is|Does|Why|Who|When|If|Whatever|It|Its|These|Without"
    r"|Within|Between|Beside|Above|Beyond|Around|Over|Inside|After|Up|Too|Everybody|Far|Nearer)\b"
)
"""The beginning of a docstring's first line that is no imperative and no noun phrase."""
COMMENT = re.compile(r"# (What|Of|The same|Those|How|So many|So few|Whose|Whom)\b")
"""The beginning of a comment that is a fragment; a comment may begin with a condition."""
CONDITION = re.compile(r"\b(if|unless|whenever|when|where|until|as long as|provided that|in case)\b", re.IGNORECASE)
MARKUP = re.compile(r"<!--.*?-->|^```.*?^```$|^\$\$.*?\$\$$", re.DOTALL | re.MULTILINE)
FORMULA = re.compile(r"\n\s*\n(?:[ ]{4,}.*\n)+(?=\s*\n)")
"""A paragraph that is indented."""
LITERAL = re.compile(r"``.*?``|`.*?`|:\w+:`.*?`|\$[^$\n]+\$", re.DOTALL)
LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")


@dataclass(frozen=True, slots=True)
class Passage:
    """Text of one place; ``sentences`` says whether its sentences are counted, or only its words looked up."""

    file: Path
    line: int
    text: str
    sentences: bool


@dataclass(frozen=True, slots=True)
class Finding:
    """A place and what to write there instead."""

    file: Path
    line: int
    advice: str

    def __str__(self) -> str:
        """Return the line that compilers would print."""
        return f"{self.file}:{self.line}: {self.advice}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the findings in the files named, or in all; return 1 if there are any."""
    named = sys.argv[1:] if arguments is None else arguments
    found = list(findings(Path(name).resolve() for name in named) if named else findings(readable_files()))
    for finding in found:
        print(finding)
    print(f"{len(found)} findings", file=sys.stderr)
    return int(bool(found))


def readable_files() -> Iterator[Path]:
    """Yield every page, notebook and Python file that is checked."""
    for name in PAGES:
        place = ROOT / name
        pages = sorted(place.rglob("*.md")) if place.is_dir() else [place]
        yield from (page for page in pages if not set(page.relative_to(ROOT).parts[1:-1]) & set(MADE))
    yield from sorted((ROOT / "notebooks").glob("*.ipynb"))
    for name in CODE:
        yield from sorted((ROOT / name).rglob("*.py"))


def findings(files: Iterable[Path]) -> Iterator[Finding]:
    """Yield what is to be changed in these files."""
    instead, explained = read_words("instead"), read_words("explained")
    for file in files:
        shown = file.relative_to(ROOT) if file.is_relative_to(ROOT) else file
        whole = " ".join(file.read_text(encoding="utf-8").split())
        unexplained = [
            (word, f"say what it means: {say}") for word, say in explained if not re.search(say, whole, re.IGNORECASE)
        ]
        words = instead + (unexplained if file.suffix == ".md" else [])
        for passage in passages(file):
            yield from _in_words(passage, shown, words)
            if passage.sentences:
                yield from _in_sentences(passage, shown)
        if file.suffix == ".py":
            yield from fragments(file.read_text(encoding="utf-8"), shown)


def fragments(text: str, shown: Path) -> Iterator[Finding]:
    """Yield the docstrings and comments of a module that begin with a fragment."""
    begun = [(constant.lineno, str(constant.value)) for constant in _docstrings(ast.parse(text))]
    found = [(line, fragment[0]) for line, said in begun if (fragment := FRAGMENT.match(said))]
    before = -1
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            if token.start[0] != before + 1 and (fragment := COMMENT.match(token.string)):
                found.append((token.start[0], fragment[1]))
            before = token.start[0] if token.line.lstrip().startswith("#") else -1
    for line, beginning in sorted(found):
        yield Finding(shown, line, f'"{beginning}": begin with an imperative or a noun phrase')


def read_words(part: str, file: Path = ROOT / "analysis" / "words.toml") -> list[tuple[re.Pattern[str], str]]:
    """Return a part of the word list: patterns, and what to write instead, or what an explanation holds."""
    listed = tomllib.loads(file.read_text(encoding="utf-8"))[part]
    return [
        (re.compile(rf"(?:(?<!\w)|(?=,))(?:{pattern})\b", re.IGNORECASE), advice) for pattern, advice in listed.items()
    ]


def passages(file: Path) -> Iterator[Passage]:
    """Yield the prose of a page, of a notebook or of a Python file."""
    text = file.read_text(encoding="utf-8")
    if file.suffix == ".ipynb":
        yield from _of_notebook(file, text)
    else:
        yield from _of_page(file, text) if file.suffix == ".md" else _of_code(file, text)


def _of_notebook(file: Path, text: str) -> Iterator[Passage]:
    """The cells of text; the line is that of the cell in the file."""
    for cell in json.loads(text)["cells"]:
        if cell["cell_type"] == "markdown":
            first = text.count("\n", 0, text.find(json.dumps(cell["source"][0], ensure_ascii=False))) + 1
            for passage in _of_page(file, "".join(cell["source"])):
                yield replace(passage, line=first + passage.line - 1)


def _of_page(file: Path, text: str) -> Iterator[Passage]:
    """Paragraphs, items and the cells of tables, without blocks of code."""
    blank = MARKUP.sub(lambda block: "\n" * block[0].count("\n"), text)
    paragraph: list[str] = []
    first = 1
    for number, line in enumerate([*blank.split("\n"), ""], 1):
        starts = re.match(r"\s*(?:[-*] |\d+\. |#|>)", line)
        row = line.lstrip().startswith("|")
        if (not line.strip() or starts or row) and paragraph:
            yield Passage(file, first, "\n".join(paragraph), sentences=True)
            paragraph = []
        if row:
            yield from (Passage(file, number, cell, sentences=True) for cell in line.split("|"))
        elif line.strip():
            first = first if paragraph else number
            paragraph.append(re.sub(r"^\s*(?:[-*]|\d+\.|#+|>) ", "", line))


def _of_code(file: Path, text: str) -> Iterator[Passage]:
    """Docstrings, and other strings of at least two words."""
    tree = ast.parse(text)
    documented = list(_docstrings(tree))
    for constant in documented:
        yield Passage(file, constant.lineno, str(constant.value), sentences=True)
    for node in ast.walk(tree):
        said = node.value if isinstance(node, ast.Constant) and node not in documented else None
        if isinstance(said, str) and len(re.findall(r"[A-Za-z]{2,}", said)) >= 2 and "\\" not in said:
            yield Passage(file, getattr(node, "lineno", 1), said, sentences=False)


def _docstrings(node: ast.Module | ast.stmt) -> Iterator[ast.Constant]:
    """Yield docstrings, and strings below assignments."""
    for statement in getattr(node, "body", []):
        value = statement.value if isinstance(statement, ast.Expr) else None
        if isinstance(value, ast.Constant) and isinstance(value.value, str):
            yield value
        yield from _docstrings(statement)


def _in_words(passage: Passage, shown: Path, words: Iterable[tuple[re.Pattern[str], str]]) -> Iterator[Finding]:
    text = LITERAL.sub(lambda code: re.sub(r"[^\n]", "x", code[0]), LINK.sub(r"\1", passage.text))
    for pattern, advice in words:
        for found in pattern.finditer(text):
            line = passage.line + text.count("\n", 0, found.start())
            yield Finding(shown, line, f'"{" ".join(found[0].split())}": {advice}')


def _in_sentences(passage: Passage, shown: Path) -> Iterator[Finding]:
    text = LITERAL.sub("x", LINK.sub(r"\1", passage.text))
    for sentence in SENTENCE.split(FORMULA.sub("\n\n", text)):
        line = passage.line + passage.text.count("\n", 0, max(0, passage.text.find(sentence.strip()[:20])))
        words = len(sentence.split())
        if words > LONGEST:
            yield Finding(shown, line, f"{words} words in a sentence: make two of it")
        if len(conditions := CONDITION.findall(sentence)) > CONDITIONS:
            said = ", ".join(conditions)
            yield Finding(shown, line, f"{len(conditions)} conditions in a sentence ({said}): make two of it")


if __name__ == "__main__":
    sys.exit(main())
