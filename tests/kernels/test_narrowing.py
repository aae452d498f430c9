"""Kernels are compiled for what they use of a model, once for all models that agree in it."""

from typing import Any, NamedTuple

import numpy as np
import pytest
from numba import config

from tribo.kernels.compiled import kernel, shared_kernel
from tribo.kernels.narrowing import fields_used


class Small(NamedTuple):
    """A model of two fields."""

    size: float
    bath: Any


@kernel
def size_of(model):
    """A field that all models have."""
    return model.size


@kernel
def doubled(model, x):
    """A call of another kernel."""
    return 2.0 * size_of(model) + x


@kernel
def first(bath):
    """A branch that is not compiled without a bath."""
    if bath is not None:
        return bath[0]
    return 0.0


@kernel
def heat(model):
    """The field that differs."""
    return first(model.bath)


@kernel
def whole(model):
    """The model itself."""
    return model[0]


@shared_kernel
def entry(model):
    """Called from Python with two kinds of models."""
    return doubled(model, 1.0) + heat(model) + whole(model)


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="nothing is compiled")
def test_models_that_agree_share_kernels():
    """Kernels that do not read the field are compiled once, and all results are right."""
    assert entry(Small(3.0, None)) == 10.0
    assert entry(Small(3.0, np.array([5.0]))) == 15.0
    assert len(size_of.overloads) == len(doubled.overloads) == 1
    assert len(heat.overloads) == len(whole.overloads) == 2


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="nothing is compiled")
def test_fields_used():
    """Fields of a kernel and of those it calls; all of them where the model is used in any way."""
    assert fields_used(doubled.py_func) == {"size"}
    assert fields_used(heat.py_func) == {"bath"}
    assert fields_used(whole.py_func) is None
