"""Checks of a folder of results, however the run ended that wrote into it."""

import json
from pathlib import Path

import ratt_opt as ro
from analysis.faults.campaign import Campaign
from ratt_opt._files import MIXED
from ratt_opt.report.write import FILES

__all__ = ["check_results", "earlier_results"]


def earlier_results(campaign: Campaign, place: Path) -> Path:
    """Make a folder with the results of an earlier run about another scenario."""
    for name in (*FILES, "certificate.json"):
        campaign.put(place, f"results/{name}")
    return place / "results"


def check_results(campaign: Campaign, folder: Path) -> None:
    """Whole files: all of the earlier run, all of the later one, or a mark that says that they may be mixed.

    Figures may be missing: they are drawn once all else is written. A certificate belongs to the report beside it
    unless that says that it has none.
    """
    now = {file.name: file.read_bytes() for file in folder.iterdir() if not file.name.startswith(".")}
    if MIXED not in now:
        earlier = [now.get(name) == campaign.files[f"results/{name}"] for name in FILES if name in now]
        assert all(earlier) or not any(earlier), f"files of two runs without a mark: {earlier}"
    report = json.loads(now["report.json"])
    assert now["report.html"].endswith(b"</html>\n"), "half a page"
    for name, end, fault in (("plan.png", b"IEND\xaeB`\x82", "picture"), ("plan.svg", b"</svg>\n", "drawing")):
        assert now.get(name, end).endswith(end), f"half a {fault}"
    if "certificate.json" in now:
        proof = ro.verify_certificate(folder / "certificate.json")
        claim = report["certificate"].get("claim")
        assert claim in (None, {"lower": proof.lower, "upper": proof.upper}), "a report with another one's certificate"
