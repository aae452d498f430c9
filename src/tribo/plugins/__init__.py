"""Plug-ins, the classes that users write: potentials, fields, drives, and forces on bars' ends.

Here are their checks, the hash of their sources, and messages for those that do not compile.
"""
