"""Arguments of compiled functions in another memory, as numba's convention has them."""

from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.kept import Kept
from tribo.live_pages.image import Image


class Argument(NamedTuple):
    """A number, an integer of 64 bits, or a place in an image; a null pointer without any."""

    kind: str  # "number", "integer", "place" or "null"
    value: float


NULL = Argument("null", 0)


def flat_arguments(arguments: Any, image: Image) -> list[Argument]:
    """The arguments behind those for results: words, and arrays that have no owner.

    Of an array these are no owner, number and size of its items, its place, shape and strides.
    """
    found: list[Argument] = []
    for each in arguments:
        if isinstance(each, Kept):
            found.append(Argument("place", image.place_of(each)))
        elif isinstance(each, np.ndarray):
            sizes = each.size, each.itemsize
            whole = *each.shape, *each.strides
            found += [NULL, NULL, *_integers(sizes)]
            found += [Argument("place", image.place_of(each)), *_integers(whole)]
        elif isinstance(each, tuple):
            found += flat_arguments(each, image)
        elif isinstance(each, float):
            found.append(Argument("number", each))
        elif each is None:
            found.append(NULL)
        else:
            found.append(Argument("integer", int(each)))
    return found


def _integers(values: tuple[int, ...]) -> list[Argument]:
    return [Argument("integer", value) for value in values]
