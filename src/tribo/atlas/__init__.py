"""Hard scenes on which simple integrators fail: what is known of each, and what tribo gives.

The scenes are files in `scenes/`; `entries.toml` declares how each ends and holds its reference.
"""

from tribo.atlas.entries import HardScene, chosen
from tribo.atlas.rows import HEAD, Row, judge, row

__all__ = ["HEAD", "HardScene", "Row", "chosen", "judge", "row"]
