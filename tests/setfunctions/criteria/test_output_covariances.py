"""Covariances of outputs in C against the definition, in parts and in one, and what C may not read."""

import numpy as np
import pytest

from ratt_opt import InputError, _blocks
from ratt_opt.setfunctions.criteria.output_covariances import output_covariances, output_traces

SHAPES = [(1, 1, 1), (0, 2, 3, 1), (5, 0, 2, 1), (3, 1, 2, 2), (2, 3, 2, 4, 2), (7, 3, 6, 1), (2, 1, 9, 3)]
"""Any batch, targets, states and outputs."""


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("at_once", [1, 10**6])
def test_covariances_are_those_of_the_definition(shape, at_once, monkeypatch):
    """Dimensions of which C has loops of their own, and others."""
    monkeypatch.setattr(_blocks, "STEPS", at_once)
    *batch, targets, d, q = shape
    rng = np.random.default_rng(d)
    for scale in (1e-6, 1.0, 1e6):
        root = rng.normal(size=(*batch, targets, d, d))
        matrices = scale * (root @ np.swapaxes(root, -1, -2) + np.eye(d))
        output = rng.normal(size=(targets, q, d))
        expected = output @ np.linalg.inv(matrices) @ np.swapaxes(output, -1, -2)
        found = output_covariances(matrices, output)
        assert found.shape == expected.shape
        assert np.allclose(found, expected, rtol=1e-9, atol=1e-12 / scale)
        assert np.array_equal(found, np.swapaxes(found, -1, -2))
        traces = np.trace(expected, axis1=-2, axis2=-1)
        assert np.allclose(output_traces(matrices, output), traces, rtol=1e-9, atol=0)
        assert np.array_equal(output_traces(np.swapaxes(matrices, -1, -2), output), output_traces(matrices, output))


def test_what_c_may_not_read_is_refused():
    matrices, output = np.tile(np.eye(3), (4, 2, 1, 1)), np.ones((2, 1, 3))
    for call in (output_traces, output_covariances):
        call(matrices, output)
        for bad in (matrices.astype(np.float32), matrices[:, :1], matrices[..., :2], matrices[..., :2, :]):
            with pytest.raises(InputError):
                call(bad, output)
        for bad in (output.astype(np.float32), np.ones((1, 1, 3)), np.ones((2, 1, 2))):
            with pytest.raises(InputError):
                call(matrices, bad)
