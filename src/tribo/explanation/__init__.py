"""The effects of a scene and their reasons, the method, and the predicted cost of a run."""

from tribo.explanation.explanation import Explanation, explain

__all__ = ["Explanation", "explain"]
