"""CAA against the paper's numbers and against all integer partitions."""

from functools import cache

import pytest

from ratt_opt import InputError, caa


@cache
def _partitions(total: int, largest: int) -> list[tuple[int, ...]]:
    if total == 0:
        return [()]
    return [(part, *rest) for part in range(min(total, largest), 0, -1) for rest in _partitions(total - part, part)]


def _smallest_largest_part(n_robots: int, alpha_c: int) -> int:
    links = n_robots * (n_robots - 1) // 2
    return min(
        parts[0] for parts in _partitions(n_robots, n_robots) if links - sum(p * (p - 1) // 2 for p in parts) <= alpha_c
    )


@pytest.mark.parametrize(("n_robots", "alpha_c", "n_max", "alpha_cs"), [(10, 29, 5, 5), (4, 3, 3, 1), (4, 4, 2, 2)])
def test_numbers_of_the_paper(n_robots: int, alpha_c: int, n_max: int, alpha_cs: int) -> None:
    result = caa(n_robots, alpha_c)
    assert (result.n_max, result.alpha_cs) == (n_max, alpha_cs)


@pytest.mark.parametrize("n_robots", range(1, 13))
def test_equals_the_best_integer_partition(n_robots: int) -> None:
    for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
        assert caa(n_robots, alpha_c).n_max == _smallest_largest_part(n_robots, alpha_c)


@pytest.mark.parametrize(
    ("n_robots", "alpha_c", "name"),
    [(0, 0, "n_robots"), (4, 7, "alpha_c"), (4, -1, "alpha_c"), (4, 1.5, "alpha_c"), (True, 0, "n_robots")],
)
def test_out_of_range_is_refused(n_robots: int, alpha_c: int, name: str) -> None:
    with pytest.raises(InputError, match=name):
        caa(n_robots, alpha_c)
