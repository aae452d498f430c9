"""Settings shared by all tests."""

import os

# Linear algebra on small matrices: threads only get in one another's way.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from hypothesis import HealthCheck, settings

# The same examples every time, and no clock: the first of them may have a kernel to compile.
settings.register_profile(
    "ci",
    deadline=None,
    derandomize=True,
    database=None,
    max_examples=25,
    suppress_health_check=[HealthCheck.too_slow],
)
# Others each time, to look further: pytest --hypothesis-profile=search
settings.register_profile("search", settings.get_profile("ci"), derandomize=False)
settings.load_profile("ci")
