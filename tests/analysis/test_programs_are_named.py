"""Every program of `analysis` is named on a page, in the gate or in a test: what nobody runs is a result."""

from tests.documents import ROOT

PLACES = ("README.md", "CONTRIBUTING.md", ".pre-commit-config.yaml", "docs/measured.toml", ".ci/run")


def texts():
    pages = [*ROOT.glob("docs/**/*.md"), *ROOT.glob("notebooks/*.ipynb"), *ROOT.glob("tests/**/*.py")]
    paths = [
        *(ROOT / place for place in PLACES),
        *(page for page in pages if page.name != "test_programs_are_named.py"),
    ]
    return [path.read_text(encoding="utf-8") for path in paths]


def programs():
    for path in sorted(ROOT.glob("analysis/**/*.py")):
        if '__name__ == "__main__"' in path.read_text(encoding="utf-8"):
            parts = path.relative_to(ROOT).with_suffix("").parts
            yield ".".join(parts[:-1] if parts[-1] == "__main__" else parts)


def test_every_program_is_named():
    read = "\n".join(texts())
    families = {name.rpartition(".")[0] for name in programs()} - {"analysis"}
    run_together = {family for family in families if (ROOT / family.replace(".", "/") / "__main__.py").exists()}
    unnamed = [
        name
        for name in programs()
        if name not in read and name.replace(".", "/") not in read and name.rpartition(".")[0] not in run_together
    ]
    assert list(programs())
    assert unnamed == []
