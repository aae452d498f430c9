"""Compiled code that every method shares: records, equations of motion, powers and contact.

Kernels see floats and arrays only, and know nothing of scenes.
"""
