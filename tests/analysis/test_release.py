"""What a release consists of: two files that install without a network, a recipe, a citation, forms."""

import re
import subprocess
import sys
import tomllib

import pytest

import ratt_opt
from analysis import release

ROOT = release.ROOT
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CONDA_NAMES = {"matplotlib": "matplotlib-base", "lazy_loader": "lazy-loader"}
"""The names of packages that differ on conda-forge."""


@pytest.mark.parametrize("kind", ["wheel", "sdist"])
def test_wheel_and_source_distribution_install_without_a_network(kind: str, tmp_path) -> None:
    printed = release.install_and_plan(release.build(kind, ROOT, tmp_path / "dist"), tmp_path)
    assert printed.split()[0] == ratt_opt.__version__
    assert "site-packages" in printed


def test_a_copy_that_is_not_the_built_one_is_noticed(tmp_path, monkeypatch) -> None:
    wheel = release.build("wheel", ROOT, tmp_path / "dist")
    monkeypatch.setattr(release, "PLAN", "print('0.1.0 /elsewhere/ratt_opt/__init__.py')")
    with pytest.raises(subprocess.CalledProcessError, match="exit status 1"):
        release.install_and_plan(wheel, tmp_path)


def test_the_recipe_of_conda_states_the_same_requirements() -> None:
    recipe = (ROOT / "packaging" / "conda-forge" / "meta.yaml").read_text(encoding="utf-8")
    run = re.search(r"^  run:\n((?:    - .*\n)+)", recipe, re.MULTILINE)
    assert run is not None
    found = {line.strip("- ").strip() for line in run[1].splitlines()}
    stated = set()
    for requirement in PROJECT["dependencies"]:
        name, bound = requirement.split(">=")
        stated.add(f"{CONDA_NAMES.get(name, name)} >={bound}")
    assert found - {"python"} == stated
    assert f'{{% set version = "{ratt_opt.__version__}" %}}' in recipe
    assert f"license: {PROJECT['license']}" in recipe
    assert f"[py<{PROJECT['requires-python'].removeprefix('>=').replace('.', '')}]" in recipe
    assert f"summary: {PROJECT['description']}" in recipe


def test_the_citation_has_the_version_and_reports_have_the_citation(tmp_path) -> None:
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {ratt_opt.__version__}\n" in text
    (number,) = set(re.findall(r"arXiv:([\d.]+)", text))
    scenario = ratt_opt.random_scenario(3, 2, alpha_s=1, alpha_c=0, seed=0)
    report = ratt_opt.bound(scenario, time_limit=5, guarantees="none")
    cited = report.to_dict()["citation"]
    assert f"ratt-opt {ratt_opt.__version__}" in cited
    assert number in cited
    report.save(tmp_path, certificate=False)
    assert cited in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_no_address_is_invented() -> None:
    """Fields for public addresses are empty until there are such addresses, and the release page says so."""
    page = (ROOT / "docs" / "contributors" / "release.md").read_text(encoding="utf-8")
    assert PROJECT.get("urls", {}) == {}
    for field in ("[project.urls]", "date-released", "identifiers", "home:", "CODE_OF_CONDUCT.md"):
        assert field in page


def test_the_references_of_the_paper_are_all_listed_and_all_cited() -> None:
    paper, listed = ((ROOT / "paper" / name).read_text(encoding="utf-8") for name in ("paper.md", "paper.bib"))
    keys = set(re.findall(r"^@\w+\{(\w+),", listed, re.MULTILINE))
    assert set(re.findall(r"@([a-z]+\d{4}\w*|mrclam)", paper)) == keys
    assert listed.count("url = ") + listed.count("doi = ") >= len(keys) - 1
    assert 600 < len(paper.split()) < 1200  # two pages


def test_the_forms_ask_for_what_a_fault_needs() -> None:
    form = (ROOT / ".github" / "ISSUE_TEMPLATE" / "fault.yml").read_text(encoding="utf-8")
    assert re.findall(r"id: (\w+)", form) == ["did", "saw", "expected", "version", "kind"]
    assert "CHANGELOG.md" in (ROOT / ".github" / "PULL_REQUEST_TEMPLATE.md").read_text(encoding="utf-8")


def test_the_command_fails_when_a_build_fails(monkeypatch, capsys, tmp_path) -> None:
    def broken(*_: object) -> None:
        raise subprocess.CalledProcessError(1, [sys.executable], "", "no backend")

    monkeypatch.setattr(release, "build", broken)
    assert release.main(["--out", str(tmp_path), "--no-twine"]) == 1
    assert "no backend" in capsys.readouterr().err
