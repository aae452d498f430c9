"""Print the lowest versions that pyproject.toml allows, as constraints for pip.

    python .ci/lowest.py EXTRAS

EXTRAS are separated by commas.
"""

import re
import sys

from requirements import requirements

for line in requirements(sys.argv[1]):
    match = re.match(r"([\w.-]+)(?:\[.*\])?>=([\w.]+)", line)
    if match:
        print(f"{match[1]}=={match[2]}")
