"""Where the package that is tested stands."""

import importlib.util
from pathlib import Path

SOURCE = Path(importlib.util.find_spec("tribo").origin).parent
