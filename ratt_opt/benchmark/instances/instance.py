"""One instance: a problem in one of four forms, its class by a code of four letters, and where it comes from."""

from __future__ import annotations

import hashlib
import json
import lzma
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, SerializeAsAny

from ratt_opt._files import write_atomically
from ratt_opt.benchmark.instances.forms import Form, NetworkInput, SumInput, TableInput
from ratt_opt.errors import FileFormatError, InputError
from ratt_opt.scenario.files import parse_json
from ratt_opt.scenario.information_input import InformationInput
from ratt_opt.scenario.record import Record, Text
from ratt_opt.setfunctions.criteria.names import CLASSES

if TYPE_CHECKING:
    from ratt_opt.problem import Problem

__all__ = ["TRACKS", "BenchmarkInstance", "canonical", "read_document", "read_instance", "write_document"]

TRACKS = {"P": "plan", "A": "attack", "C": "cuts"}
"""First letter of a class: the question."""
VALUES = {"trace": "T", "logdet": "D", "maxeig": "E", "coverage": "C", "facility location": "F"}
"""Second letter: the set function; X for a table, N for a network."""
LARGEST_FILE = 64 * 2**20
"""Bytes of a document once it is unpacked."""
FORMS: dict[str, type[InformationInput | TableInput | SumInput | NetworkInput]] = {
    "ratt-opt information": InformationInput,
    "ratt-opt table": TableInput,
    "ratt-opt sum": SumInput,
    "ratt-opt network": NetworkInput,
}


class BenchmarkInstance(Record):
    """A problem of the benchmark.

    ``name`` : of its file; ``family`` : what it is drawn from; ``source`` : the call or publication that gives it;
    ``objective`` : criterion of a problem by matrices; ``code`` : its class, see :attr:`class_code`.

    If every robot has one element, nothing is to be planned: the question is the worst attack.
    """

    format: Literal["ratt-opt benchmark instance"] = "ratt-opt benchmark instance"
    version: Literal[1] = 1
    name: Annotated[Text, Field(pattern=r"^[a-z0-9][a-z0-9.-]{0,63}$")]
    family: Text
    source: Text
    code: Text = ""
    objective: Text = "trace"
    problem: SerializeAsAny[Form]

    @property
    def track(self) -> str:
        """The question: ``"plan"``, ``"attack"`` or ``"cuts"``."""
        if isinstance(self.problem, NetworkInput):
            return "cuts"
        return "attack" if len(set(self.problem.robot)) == len(self.problem.robot) else "plan"

    @property
    def maximises(self) -> bool:
        """True if more is better: plans. Attacks and cuts are the better the less they leave, or cost."""
        return self.track == "plan"

    @cached_property
    def team(self) -> Problem:
        """The problem of plans and attacks. InputError : it is one of cuts."""
        if isinstance(self.problem, NetworkInput):
            raise InputError("instance", "must be one of plans or attacks for this", self.name)
        if isinstance(self.problem, InformationInput):
            return self.problem.problem(self.objective)
        return self.problem.stated

    @property
    def network(self) -> NetworkInput:
        """The network of fewest cuts. InputError : it is another question."""
        if not isinstance(self.problem, NetworkInput):
            raise InputError("instance", "must be one of cuts for this", self.name)
        return self.problem

    @cached_property
    def class_code(self) -> str:
        """The class by four letters, computed from the problem.

        Track: P plan, A attack, C cuts. Value: T trace, D log-det, E max-eigenvalue, C coverage, F facility location,
        X table, N network. Network: K complete, G another one. Threat: s sensors, l links, b both, n nobody; of cuts
        u equal weights and sizes, w others.
        """
        letter = {track: letter for letter, track in TRACKS.items()}[self.track]
        if isinstance(self.problem, NetworkInput):
            n = self.problem.robots
            whole = "K" if len(self.problem.links) == n * (n - 1) // 2 else "G"
            return f"{letter}N{whole}{'u' if self.problem.weights is None and self.problem.sizes is None else 'w'}"
        kind = {"ratt-opt information": self.objective, "ratt-opt table": "table"}
        name = self.problem.kind if isinstance(self.problem, SumInput) else kind[self.problem.format]
        threat = {(0, 0): "n", (1, 0): "s", (0, 1): "l", (1, 1): "b"}
        hit = threat[int(self.problem.alpha_s > 0), int(self.problem.alpha_c > 0)]
        return f"{letter}{VALUES.get(name, 'X')}{'K' if self.problem.links is None else 'G'}{hit}"

    @property
    def sizes(self) -> tuple[int, int]:
        """Numbers of robots and of elements; of links, in the track of cuts."""
        if isinstance(self.problem, NetworkInput):
            return self.problem.robots, len(self.problem.links)
        return self.team.n_robots, self.team.objective.n

    @cached_property
    def document(self) -> dict[str, Any]:
        """The instance as its file holds it."""
        return {**self.model_dump(mode="json"), "code": self.class_code}


def read_instance(path: str | Path) -> BenchmarkInstance:
    """Read an instance, packed (``.xz``) or plain.

    Raises
    ------
    FileFormatError : unreadable, or a field breaks its rule; the text names file and field.
    """
    document = read_document(path)
    if not isinstance(document, dict) or document.get("format") != "ratt-opt benchmark instance":
        found = document.get("format", "nothing") if isinstance(document, dict) else type(document).__name__
        raise FileFormatError(f"{path}: format", "must be 'ratt-opt benchmark instance'", found)
    given = document.get("problem")
    form = given.get("format") if isinstance(given, dict) else None
    if not isinstance(given, dict) or not isinstance(form, str) or form not in FORMS:
        raise FileFormatError(f"{path}: problem.format", f"must be {', '.join(FORMS)}", form)
    if document.get("objective", "trace") not in CLASSES:
        raise FileFormatError(f"{path}: objective", f"must be {', '.join(CLASSES)}", document["objective"])
    try:
        instance = BenchmarkInstance(**{**document, "problem": FORMS[form](**given)})
        if instance.code not in {"", instance.class_code}:
            raise InputError("code", f"must be {instance.class_code}, the class of the problem", instance.code)
    except InputError as error:
        raise FileFormatError(f"{path}: {error.argument}", error.rule, error.value) from None
    return instance


def read_document(path: str | Path) -> Any:
    """Read strict JSON, packed (``.xz``) or plain, of bounded size. FileFormatError : it is not that."""
    file = Path(path)
    try:
        with lzma.open(file) if file.suffix == ".xz" else file.open("rb") as stream:
            raw = stream.read(LARGEST_FILE + 1)
    except (OSError, lzma.LZMAError, EOFError) as error:
        raise FileFormatError(str(file), "must be a file that can be read", getattr(error, "strerror", error)) from None
    if len(raw) > LARGEST_FILE:
        raise FileFormatError(str(file), f"must be at most {LARGEST_FILE} bytes", "a longer file")
    return parse_json(raw, str(file))


def canonical(document: object) -> bytes:
    """A document as the bytes that its hash is of: sorted fields, shortest floats, UTF-8."""
    return json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def write_document(document: object, path: Path) -> str:
    """Write a document, packed if the name ends in ``.xz``, and return its SHA-256."""
    raw = canonical(document)
    packed = lzma.compress(raw, preset=9 | lzma.PRESET_EXTREME) if path.suffix == ".xz" else raw + b"\n"
    write_atomically(path, lambda file: file.write_bytes(packed))
    return hashlib.sha256(raw).hexdigest()
