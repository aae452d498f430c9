"""Series that are computed when they are first needed."""

from functools import cached_property
from typing import Any, Self, TypeVar, overload

T = TypeVar("T")


class lazy_property(cached_property[T]):  # noqa: N801 (is used as a decorator)
    """A property that is computed once for each object.

    As `functools.cached_property` of Python 3.12: the lock that this has in 3.11 takes longer than
    short series do.  Two threads may compute a value twice, which is the same.
    """

    @overload
    def __get__(self, instance: None, owner: type | None = None) -> Self: ...
    @overload
    def __get__(self, instance: object, owner: type | None = None) -> T: ...
    def __get__(self, instance: Any, owner: type | None = None) -> Self | T:
        if instance is None:
            return self
        assert self.attrname is not None
        value = instance.__dict__[self.attrname] = self.func(instance)
        return value
