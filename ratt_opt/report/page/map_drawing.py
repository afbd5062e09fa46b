"""The map of a page: robots and targets tell who they are, to a mouse, a keyboard or a screen reader."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.report.description import describe, named
from ratt_opt.report.ellipses import SIGMAS, ellipse_of
from ratt_opt.report.fields import FIELD_WORDS, LOST_WORDS, WATCH_WORDS, field_of, watched_pairs
from ratt_opt.report.spots import SPOTS, best_spot

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ratt_opt._validation import FloatArray
    from ratt_opt.findings import AssessedPlan, Findings
    from ratt_opt.report.picture import Picture
    from ratt_opt.report.spots import Box

__all__ = ["SIZES", "PageMap", "legend_html", "map_svg"]


@dataclass(frozen=True, slots=True, kw_only=True)
class PageMap:
    """Sizes of a map on a page, in pixels.

    ``mark`` : half the width of a robot or target
    ``letter``, ``line``, ``foot`` : of words, the width of a letter, the height of a line, the space below its foot
    ``spread`` : distance of a word from its place over that on paper
    ``most_links`` : more links of groups are not drawn: they would be one blot, and make the page large. Cut ones are
    """

    width: float
    height: float
    margin: float = 40.0
    mark: float = 11.0
    letter: float = 6.8
    line: float = 14.0
    foot: float = 3.5
    spread: float = 1.3
    most_links: int = 400


SIZES = {"broad": PageMap(width=800, height=560), "narrow": PageMap(width=390, height=460)}
"""Drawings for desks and for telephones, on which the words of the other would be too small."""


def map_svg(picture: Picture, report: Findings, view: AssessedPlan) -> str:
    """Return the map drawn twice, of which the page shows one; lengths are in proportion, north is up."""
    return "".join(_drawing(picture, report, view, size, kind) for kind, size in SIZES.items())


def _drawing(picture: Picture, report: Findings, view: AssessedPlan, size: PageMap, kind: str) -> str:
    place = _frame(picture, size)
    at = [place(x) for x in picture.places]
    parts = [
        *_fields(picture, at, place),
        *_links(picture, at, size.most_links),
        *_watching(picture, at, place),
        *_targets(picture, place),
        *_robots(picture, at, report, view),
        *_words(picture, at, place),
        *(() if picture.is_layout else _scale_bar(place)),
    ]
    label = escape(f"Map of {len(at)} robots under attack; tab through robots and targets for their details")
    box = f'viewBox="0 0 {size.width:g} {size.height:g}" role="group" aria-label="{label}"'
    return f'<svg class="map {kind}" {box}>{"".join(parts)}</svg>'


def legend_html(pictures: Sequence[Picture]) -> str:
    """Return what the marks of the maps mean, of those that are on one of them."""
    entries = (
        ("<circle cx='10' cy='10' r='8' class='seeing'/>", "robot of the best group", lambda _: True),
        ("<rect x='3' y='3' width='14' height='14' class='lost'/>", "robot of another group", _has_lost),
        ("<path d='M3 3L17 17M17 3L3 17' class='cross'/>", "blinded robot", lambda p: p.attack.sensing),
        ("<circle cx='10' cy='10' r='8' class='guard'/>", "protected robot", lambda p: p.protected_robots),
        ("<path d='M0 10H20' class='heading'/>", "heading", _has_arrows),
        ("<path d='M1 10L19 2A20 20 0 0 1 19 18Z' class='field seeing'/>", FIELD_WORDS, lambda p: p.views),
        ("<path d='M0 10H20' class='watch'/>", WATCH_WORDS, lambda p: watched_pairs(p, p.seeing)),
        ("<path d='M0 10H20' class='watch vain'/>", LOST_WORDS, lambda p: watched_pairs(p, _in_vain(p))),
        ("<path d='M0 10H20' class='link'/>", "link", lambda p: p.links),
        ("<path d='M0 10H20' class='link guarded'/>", "protected link", lambda p: p.protected_links),
        ("<path d='M0 10H20' class='cut'/>", "cut link", lambda p: p.attack.links),
        ("<path d='M10 2L18 17H2Z' class='target'/>", _target_words(pictures), lambda p: p.targets is not None),
        ("<path d='M10 2L18 17H2Z' class='target unseen'/>", "target left unseen", lambda p: p.unseen),
    )
    items = (
        f"<li><svg width='20' height='20' aria-hidden='true'>{mark}</svg> {text}</li>"
        for mark, text, is_on in entries
        if any(map(is_on, pictures))
    )
    return f'<ul class="legend">{"".join(items)}</ul>'


def _in_vain(picture: Picture) -> frozenset[int]:
    return frozenset(range(len(picture.places))) - picture.seeing


def _has_arrows(picture: Picture) -> bool:
    """Some heading is drawn as an arrow, not as a field of view."""
    return picture.headings is not None and (picture.views is None or any(view.angle is None for view in picture.views))


def _has_lost(picture: Picture) -> bool:
    return len(picture.best | picture.attack.sensing) < len(picture.places)


def _target_words(pictures: Sequence[Picture]) -> str:
    drawn = any(picture.posterior is not None for picture in pictures)
    known = ["dotted: 95 % before, filled: after measuring"] if drawn else []
    known += ["×: its weight"] if any(picture.is_weighted for picture in pictures) else []
    return f"target ({'; '.join(known)})" if known else "target"


class _Frame:
    """Metres to places on the page."""

    def __init__(self, points: FloatArray, size: PageMap) -> None:
        self.low, self.size = points.min(axis=0), size
        span = np.maximum(points.max(axis=0) - self.low, 1e-9)
        self.scale = float(np.min((np.array([size.width, size.height]) - 2 * size.margin) / span))
        if float(span.max()) <= 1e-9:
            self.scale = 1.0
        self.rest = (np.array([size.width, size.height]) - self.scale * span) / 2

    def __call__(self, point: FloatArray) -> tuple[float, float]:
        x, y = self.scale * (point - self.low) + self.rest
        return float(x), self.size.height - float(y)


def _frame(picture: Picture, size: PageMap) -> _Frame:
    """Find the frame around all places, and around the ellipses of targets."""
    points = [picture.places]
    if picture.targets is not None:
        prior = picture.prior if picture.prior is not None else np.zeros((len(picture.targets), 2, 2))
        half = SIGMAS * np.sqrt(np.diagonal(prior, axis1=1, axis2=2))
        points += [picture.targets - half, picture.targets + half]
    across = float(np.linalg.norm(np.ptp(np.vstack(points), axis=0)))
    reaches = [field_of(picture, i)[2] for i in range(len(picture.places))] if picture.views is not None else []
    for place, reach in zip(picture.places, reaches, strict=False):
        if reach <= across:  # the map holds it whole; wider ones would shrink all else
            points += [place[None] - reach, place[None] + reach]
    return _Frame(np.vstack(points), size)


def _fields(picture: Picture, at: list[tuple[float, float]], place: _Frame) -> Iterator[str]:
    """A sector for each robot of limited view."""
    for i, (x, y) in enumerate(at if picture.views is not None else ()):
        heading, angle, reach = field_of(picture, i)
        kind = "blinded" if i in picture.attack.sensing else "seeing" if i in picture.best else "lost"
        r = reach * place.scale
        kind += " rim" if angle > np.pi else ""  # it would flood the map: only its rim is drawn
        if angle >= 2 * np.pi:
            yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r:.1f}" class="field {kind}"/>'
            continue
        ends = [heading - angle / 2, heading + angle / 2]
        (u, v), (s, t) = ((x + r * float(np.cos(a)), y - r * float(np.sin(a))) for a in ends)
        large = int(angle > np.pi)
        arc = f"A{r:.1f} {r:.1f} 0 {large} 0 {s:.1f} {t:.1f}"
        yield f'<path d="M{x:.1f} {y:.1f}L{u:.1f} {v:.1f}{arc}Z" class="field {kind}"/>'


def _watching(picture: Picture, at: list[tuple[float, float]], place: _Frame) -> Iterator[str]:
    """A thin line from each robot to each target that it measures."""
    if picture.targets is None:
        return
    for kind, robots in (("watch", picture.seeing), ("watch vain", _in_vain(picture))):
        for i, j in watched_pairs(picture, robots):
            (x, y), (u, v) = at[i], place(picture.targets[j])
            yield f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{u:.1f}" y2="{v:.1f}" class="{kind}"/>'


def _links(picture: Picture, at: list[tuple[float, float]], most: int) -> Iterator[str]:
    kept, cut = sorted(picture.links - picture.attack.links), sorted(picture.attack.links)
    shown = kept if len(kept) <= most else sorted(picture.protected_links)
    for kind, links in (("link", shown), ("cut", cut)):
        for i, j in links:
            (x, y), (u, v) = at[i], at[j]
            guarded = " guarded" if (i, j) in picture.protected_links else ""
            yield f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{u:.1f}" y2="{v:.1f}" class="{kind}{guarded}"/>'


def _targets(picture: Picture, place: _Frame) -> Iterator[str]:
    if picture.targets is None:
        return
    for j, target in enumerate(picture.targets):
        x, y = place(target)
        text = f"target {named(j, picture.target_names[j] if picture.target_names else '', 'target')}"
        text += "" if picture.weights is None else f", weight {picture.weights[j]:g}"
        if picture.prior is not None and picture.posterior is not None:
            for kind, covariance in (("before", picture.prior[j]), ("after", picture.posterior[j])):
                yield _ellipse(x, y, covariance, place.scale, kind)
            deviation = np.sqrt(np.trace(picture.posterior[j]))
            text += f", root of the trace left after measuring {deviation:.3g} m"
        text += ", left unseen" if j in picture.unseen else ""
        kind = "target unseen" if j in picture.unseen else "target"
        mark = f'<path d="M{x:.1f} {y - 8:.1f}l8 14h-16Z" class="{kind}"/>'
        yield f'<g tabindex="0" role="img" aria-label="{escape(text)}"><title>{escape(text)}</title>{mark}</g>'


def _ellipse(x: float, y: float, covariance: FloatArray, scale: float, kind: str) -> str:
    long, short, angle = ellipse_of(covariance)
    rx, ry, turn = scale * long, scale * short, -float(np.degrees(angle))
    where = f'transform="translate({x:.1f} {y:.1f}) rotate({turn:.1f})"'
    return f'<ellipse rx="{rx:.1f}" ry="{ry:.1f}" {where} class="{kind}"/>'


def _robots(picture: Picture, at: list[tuple[float, float]], report: Findings, view: AssessedPlan) -> Iterator[str]:
    known = describe(report.problem, report.source)
    for i, (x, y) in enumerate(at):
        hit, best = i in picture.attack.sensing, i in picture.best
        watches = ", ".join(f"T{j}" for _, j in watched_pairs(picture, [i]))
        role = view.role(i)
        guarded = ", protected" if i in picture.protected_robots else ""
        text = f"robot {known.robot(i)}: {known.label(int(view.elements[i]))}; {role}{guarded}"
        text += f"; measures {watches or 'no target'}" if picture.watched is not None else ""
        if hit:
            mark = f'<path d="M{x - 9:.1f} {y - 9:.1f}l18 18m0 -18l-18 18" class="cross"/>'
        elif best:
            mark = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="10" class="seeing"/>'
        else:
            mark = f'<rect x="{x - 9:.1f}" y="{y - 9:.1f}" width="18" height="18" class="lost"/>'
        mark += f'<circle cx="{x:.1f}" cy="{y:.1f}" r="14" class="guard"/>' if guarded else ""
        if picture.headings is not None and (picture.views is None or picture.views[i].angle is None):
            u, v = np.cos(picture.headings[i]), -np.sin(picture.headings[i])
            mark += f'<path d="M{x + 10 * u:.1f} {y + 10 * v:.1f}l{12 * u:.1f} {12 * v:.1f}" class="heading"/>'
        yield f'<g tabindex="0" role="img" aria-label="{escape(text)}"><title>{escape(text)}</title>{mark}</g>'
        inside = "number light" if best and not hit else "number" if hit else "number dark"
        shift = -17 if hit else 0
        yield f'<text x="{x + shift:.1f}" y="{y + 4:.1f}" class="{inside}">{i}</text>'


def _words(picture: Picture, at: list[tuple[float, float]], place: _Frame) -> Iterator[str]:
    """The names of robots and targets, each at the place at which it covers least.

    A name that would cover others is left out; the page shows it to a reader who points there. A target's number stays.
    """
    targets = [] if picture.targets is None else [place(x) for x in picture.targets]
    words: list[tuple[tuple[str, ...], tuple[float, float]]]
    words = [((picture.target_label(j), f"T{j}"), spot) for j, spot in enumerate(targets)]
    words += [((name,), spot) for name, spot in zip(picture.names, at, strict=True) if name]
    size, mark = place.size, place.size.mark
    taken: list[Box] = [(x - mark, y - mark, x + mark, y + mark) for x, y in (*at, *targets)]
    taken += [(at[i][0] - 2 * mark, at[i][1] - mark, *at[i]) for i in picture.attack.sensing]  # their numbers
    inside = (0.0, 0.0, size.width, size.height)
    for texts, (x, y) in words:
        for text in texts:
            boxes = [_box(text, x, y, spot, size) for spot in SPOTS]
            chosen, covered = best_spot(boxes, taken, inside)
            if covered <= 0 or text is not texts[0]:
                taken.append(boxes[chosen])
                left, _, _, bottom = boxes[chosen]
                yield f'<text x="{left:.1f}" y="{bottom - size.foot:.1f}" class="small">{escape(text)}</text>'
                break


def _box(text: str, x: float, y: float, spot: tuple[float, float, str], size: PageMap) -> Box:
    """Return the box of a word in a spot beside its place."""
    dx, dy, side = spot
    width = size.letter * len(text)
    left = x + size.spread * dx - {"left": 0.0, "center": width / 2, "right": width}[side]
    middle = y - size.spread * dy
    return left, middle - size.line / 2, left + width, middle + size.line / 2


def _scale_bar(place: _Frame) -> Iterator[str]:
    """A length in metres in the lower left corner."""
    longest = place.size.width / 4 / place.scale
    power = 10.0 ** np.floor(np.log10(longest))
    length = float(power * max(step for step in (1, 2, 5) if step * power <= longest))
    x, y = 12.0, place.size.height - 12.0
    yield f'<path d="M{x:g} {y - 5:g}v5h{length * place.scale:.1f}v-5" class="scale"/>'
    yield f'<text x="{x + 4:g}" y="{y - 6:g}" class="small">{length:g} m</text>'
