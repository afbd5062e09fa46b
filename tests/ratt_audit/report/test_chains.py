"""The pages show the lines that their entries speak of, and their columns keep words whole."""

import re

import pytest

from ratt_audit import ledger
from ratt_audit.appendix.entry import EntryKind
from ratt_audit.entries import all_entries
from ratt_audit.report.chains import chain_lines
from ratt_opt import run_audit
from ratt_opt.report.palette import VERDICTS

CHAIN = "nd_p1d1v1"


@pytest.fixture(scope="module")
def audited(tmp_path_factory):
    """A quick audit of one chain, and its folder."""
    folder = tmp_path_factory.mktemp("audit")
    entries = [entry for entry in all_entries() if entry.chain == CHAIN and entry.kind is not EntryKind.CUMULATIVE]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ledger, "all_entries", lambda: iter(entries))
        return run_audit(folder, quick=True), folder


def test_a_chain_lists_each_line_once_with_the_printed_relation(audited):
    (chain,) = chain_lines(audited[0].document())
    head, *rows = chain.table
    assert chain.heading == f"Chain {CHAIN}"
    assert [row[0].split()[0] for row in rows] == [f"{CHAIN}_{k}" for k in range(1, 9)]
    assert rows[0][2] == "= f(u) on V1b\\A* and V1g\\A*"
    assert rows[6][2] == ">= (1-c)^3 f(u* on V1g)"
    assert rows[6][3].endswith(">= 0")
    assert len(head) == 4


def test_both_pages_show_them(audited):
    html = (audited[1] / "audit.html").read_text(encoding="utf-8")
    markdown = (audited[1] / "audit.md").read_text(encoding="utf-8")
    assert html.count("<math") == 8
    assert r"$\geq (1-c_\Phi)^3 \Phi(\mathbf{u}^\star_{\mathcal{V}_1^g})$" in markdown
    for text in ("(1-c)^3 f(u* on V1g)", f"Chain {CHAIN}"):
        assert text in html
        assert text in markdown.replace("\\", "")


def test_cells_do_not_break_words(audited):
    html = (audited[1] / "audit.html").read_text(encoding="utf-8")
    (style,) = re.findall(r"<style>(.*?)</style>", html, re.DOTALL)
    cells = "".join(rule for rule in style.splitlines() if rule.startswith(("td", "th")))
    assert not re.search("overflow-wrap|word-break|hyphens", cells)
    assert html.count("<table>") == html.count('<div class="wide"><table>')


def test_verdicts_have_the_colours_of_every_figure(audited):
    html = (audited[1] / "audit.html").read_text(encoding="utf-8")
    for verdict, look in VERDICTS.items():
        assert f"details.{verdict.replace(' ', '-')}{{border-color:{look.colour}}}" in html
