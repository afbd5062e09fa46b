"""Every table as LaTeX: whole rows, escaped names, and commands that print nothing else."""

import re
from pathlib import Path

import pytest

import ratt_opt as ro
from ratt_opt.cli import run
from ratt_opt.report.latex import latex_of, latex_table
from ratt_opt.report.tables import report_tables


def tabulars(text: str) -> list[list[list[str]]]:
    """The cells of every tabular; fails where LaTeX would: another number of cells, braces or dollars left open."""
    found = []
    for kinds, body in re.findall(r"\\begin\{tabular\}\{@\{\}(\w+)@\{\}\}(.*?)\\end\{tabular\}", text, re.DOTALL):
        lines = [line for line in body.strip().splitlines() if not re.fullmatch(r"\\(top|mid|bottom)rule", line)]
        rows = [re.split(r"(?<!\\) & ", line.removesuffix(r" \\")) for line in lines]
        assert all(line.endswith(r" \\") for line in lines)
        assert {len(row) for row in rows} == {len(kinds)}
        assert not any(line.startswith("[") for line in lines)  # it would be an argument of the line break before
        for line in lines:
            bare = re.sub(r"\\[\\{}&%$#_]", "", line)
            assert bare.count("{") == bare.count("}")
            assert bare.count("$") % 2 == 0
            bare = re.sub(r"\$(?:\\alpha_(?:s|c|\{cs\})|n_\{\\max\})\$", "", bare)
            assert not re.search(
                r"[&%#_~^<>]", bare.replace(" & ", "").replace("$<$", "").replace("$>$", "").replace("$^2$", "")
            )
        found.append(rows)
    return found


def test_names_are_text() -> None:
    nasty = "50% of $x_1^2$ & {a} ~ b#c \\input{x} <i> …"
    (rows,) = tabulars(latex_table(["name", "value"], [[nasty, "[1, 2]"], ["[3, 4]", "5"]]))
    assert rows[1][0].startswith(r"50\% of \$x\_1\textasciicircum{}2\$")
    assert rows[2][0] == "{}[3, 4]"


def test_numbers_are_flush_right() -> None:
    text = latex_table(["planner", "n"], [["ratt", "12"], ["greedy", "3"]])
    assert r"\begin{tabular}{@{}lr@{}}" in text


def test_a_report_s_tables_hold_what_the_terminal_shows() -> None:
    report = ro.bound(ro.random_scenario(4, 3, alpha_s=1, alpha_c=2, seed=0), time_limit=20)
    tables = list(report_tables(report))
    found = tabulars(report.to_latex())
    assert len(found) == len(tables) == 4
    for table, rows in zip(tables, found, strict=True):
        assert len(rows) == 1 + table.row_count
        assert rows[0] == [str(column.header).replace("²", "$^2$") for column in table.columns]
        assert latex_of(table).startswith("\\begin{table}\n\\centering\n\\caption{")


@pytest.fixture
def scenario_file(tmp_path: Path) -> Path:
    path = tmp_path / "team.json"
    ro.save_scenario(ro.random_scenario(4, 3, alpha_s=1, alpha_c=2, seed=0), path)
    return path


def test_commands_print_latex_and_nothing_else(scenario_file: Path, tmp_path: Path, capsys) -> None:
    out = tmp_path / "out"
    for command, count in (
        (["bound", str(scenario_file), "--out", str(out)], 4),
        (["attack", str(scenario_file), "--plan", str(out / "report.json"), "--rank", "2", "--explain"], 3),
        (["audit", "--quick", "--out", str(tmp_path / "audit")], 1),
    ):
        assert run([*command, "--latex"]) == 0
        printed = capsys.readouterr().out
        assert len(tabulars(printed)) == count
        rest = re.sub(r"\\begin\{table\}.*?\\end\{table\}\n", "", printed, flags=re.DOTALL)
        assert all(line.startswith("%") or not line for line in rest.splitlines())


def test_two_kinds_of_output_are_refused(scenario_file: Path, tmp_path: Path, capsys) -> None:
    assert run(["bound", str(scenario_file), "--out", str(tmp_path / "o"), "--json", "--latex"]) == 2
    assert "--latex must come without --json" in capsys.readouterr().err
    assert not (tmp_path / "o").exists()
