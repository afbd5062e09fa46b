"""Where arrays are in memory, and which ones C may read."""

from __future__ import annotations

import numpy as np
import pytest

from ratt_opt import InputError
from ratt_opt.native.library import address, checked

RECORD = np.dtype([("mask", np.uint64), ("count", np.int32)])


@pytest.mark.parametrize("array", [np.zeros(3), np.zeros((4, 2))[1:], np.zeros(5, RECORD), np.zeros(2, np.bool_)])
@pytest.mark.parametrize("is_locked", [False, True])
def test_addresses_are_those_of_numpy(array, is_locked):
    """Of arrays that may be written and others, and of what is left of them."""
    if is_locked:
        array = array.copy()
        array.setflags(write=False)
    for one in (array, array[1:], array[:0]):
        assert address(one) == one.ctypes.data


def test_only_arrays_of_the_type_shape_and_layout_are_read():
    good = np.zeros((2, 3))
    assert checked("x", good, np.float64, (2, 3), written=True) is good
    locked = good.copy()
    locked.setflags(write=False)
    assert checked("x", locked, np.float64, [2, 3]) is locked
    for bad in (good.tolist(), good.astype(np.float32), good.T, np.zeros((2, 6))[:, ::2], np.zeros((3, 2)), None):
        with pytest.raises(InputError, match=r"^x must "):
            checked("x", bad, np.float64, (2, 3))
    with pytest.raises(InputError, match="contiguous and writable"):
        checked("x", locked, np.float64, (2, 3), written=True)
