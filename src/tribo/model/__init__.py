"""The parts of a scene: asperites, surfaces, drives, springs, baths, fields and interactions.

It holds no numerics.  Scene files are read and written here.
"""
