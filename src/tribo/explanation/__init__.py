"""What a run will do and cost, before it is run.

The effects that a scene calls for, and the reason for each; the method, and the predicted cost.
"""

from tribo.explanation.explanation import Explanation
from tribo.explanation.summary import explain

__all__ = ["Explanation", "explain"]
