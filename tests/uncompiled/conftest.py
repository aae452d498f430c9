"""These tests are for kernels that are plain Python: NUMBA_DISABLE_JIT=1 pytest tests/uncompiled.

A process with compiled kernels collects none of them; `test_mutation.py` starts one without.
"""

import os

if os.environ.get("NUMBA_DISABLE_JIT") != "1":
    collect_ignore_glob = ["test_*.py"]
