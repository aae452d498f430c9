"""The memory of a time loop as one block that can stand at any place of another memory.

Kernels find arrays by addresses, which stand in words of eight bytes.  An image has the arrays one
after another, and the places of those words: a page that copies the block adds to each of them the
place where the block begins, and sets those of units to the places of the units.
"""

import ctypes
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from tribo.compiler.kept import Kept
from tribo.compiler.lanes import LANES

# Segments begin at multiples of a cache line [bytes].
LINE = 64
WORD = 8


class Segment(NamedTuple):
    """Bytes of this process, and their place in the block."""

    begin: int
    end: int
    place: int


class Image(NamedTuple):
    """A block of `size` bytes, of which all behind `words` is room for what a run writes."""

    words: np.ndarray  # (n,) int64
    addresses: np.ndarray  # places of words that hold a place in the block
    units: np.ndarray  # (k, 2) places of words for units, and the number of each unit
    size: int
    segments: tuple[Segment, ...]

    def place_of(self, array: Any) -> int:
        """The place in the block of an array, or of the words of a tuple that is kept."""
        address = array.address if isinstance(array, Kept) else array.ctypes.data
        for segment in self.segments:
            if segment.begin <= address < segment.end:
                return segment.place + address - segment.begin
        return 0  # of an empty array, of which nothing is read


def image_of(items: Any, rooms: Any, units: Mapping[int, int]) -> Image:
    """The image of all arrays in `items`, nested tuples; of those in `rooms` there is room only.

    `units` has the numbers of units by their addresses.
    """
    written = _joined(map(_extent, _arrays_in(rooms)))
    read = [each for each in map(_extent, _arrays_in(items)) if not _near(each, written)]
    segments = _placed(_joined(read), 0)
    end = segments[-1].place + _whole(segments[-1])
    rest = _placed(written, end)
    words = np.zeros(end // WORD, np.int64)
    for segment in segments:
        first = segment.place // WORD
        count = (segment.end - segment.begin) // WORD
        pointer = ctypes.cast(segment.begin, ctypes.POINTER(ctypes.c_int64))
        words[first : first + count] = np.ctypeslib.as_array(pointer, (count,))
    size = rest[-1].place + _whole(rest[-1])
    empty = [each.ctypes.data for each in _arrays_in((items, rooms)) if each.nbytes == 0]
    image = _with_places(words, (*segments, *rest), size, units)
    image.words[np.isin(image.words, empty)] = 0  # of which nothing is read
    return image


def _with_places(
    words: np.ndarray, segments: tuple[Segment, ...], size: int, units: Mapping[int, int]
) -> Image:
    """The image of words that hold addresses, in place of which they get places."""
    ordered = sorted(segments)
    begins = np.array([each.begin for each in ordered])
    owners = np.maximum(np.searchsorted(begins, words, side="right") - 1, 0)
    ends = np.array([each.end for each in ordered])
    places = np.array([each.place for each in ordered])
    is_address = (words >= begins[owners]) & (words < ends[owners])
    is_unit = np.isin(words, list(units))
    called = [(n, units[int(words[n])]) for n in np.flatnonzero(is_unit)]
    words = np.where(is_address, words - begins[owners] + places[owners], words)
    words[is_unit] = 0
    addresses = np.flatnonzero(is_address)
    return Image(words, addresses, np.array(called, int).reshape(-1, 2), size, segments)


def _arrays_in(item: Any) -> Iterator[np.ndarray]:
    """All arrays, those with the words of tuples that are kept among them."""
    if isinstance(item, np.ndarray):
        yield item
    elif isinstance(item, Kept):
        yield item.words
        yield from _arrays_in(item.item)
    elif isinstance(item, tuple):
        for each in item:
            yield from _arrays_in(each)


def _extent(array: np.ndarray) -> tuple[int, int]:
    """The addresses of an array and of the lanes behind it that kernels may reach."""
    owner = array
    while isinstance(owner.base, np.ndarray):
        owner = owner.base
    begin = array.ctypes.data
    wanted = begin + WORD * LANES * (array.nbytes // (WORD * LANES) + 2)
    end = max(begin + array.nbytes, min(wanted, owner.ctypes.data + owner.nbytes))
    return begin, begin + -(-(end - begin) // WORD) * WORD


def _near(one: tuple[int, int], others: list[tuple[int, int]]) -> bool:
    return any(one[0] < end and begin < one[1] for begin, end in others)


def _joined(extents: Any) -> list[tuple[int, int]]:
    """The extents that are not empty in their order, those that overlap as one."""
    joined: list[tuple[int, int]] = []
    for extent in extents:
        own = [each for each in joined if _near(extent, [each])]
        if extent[0] == extent[1]:
            continue
        place = joined.index(own[0]) if own else len(joined)
        whole = min(a for a, _ in (*own, extent)), max(b for _, b in (*own, extent))
        joined = [each for each in joined if each not in own]
        joined.insert(place, whole)
    return joined


def _placed(extents: list[tuple[int, int]], first: int) -> list[Segment]:
    """Segments for extents, one after another."""
    segments = []
    for begin, end in extents:
        segments.append(Segment(begin, end, first))
        first += _whole(segments[-1])
    return segments


def _whole(segment: Segment) -> int:
    """The bytes that a segment takes, to the end of a cache line."""
    return -(-(segment.end - segment.begin) // LINE) * LINE
