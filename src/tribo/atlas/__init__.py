"""Hard scenes on which simple integrators fail: what is known of each, and what tribo gives.

The scenes are files in `scenes/`; `entries.toml` declares how each ends and holds its reference.
"""

from tribo.atlas.entries import Entry, chosen
from tribo.atlas.rows import HEAD, Row, judge, row, table

__all__ = ["HEAD", "Entry", "Row", "chosen", "judge", "row", "table"]
