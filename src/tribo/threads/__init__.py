"""Threads: what each may write, and how several share one run."""
