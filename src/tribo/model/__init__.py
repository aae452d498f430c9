"""What a scene is made of: asperites, surfaces, drives, springs, baths and fields.

Nothing in here is numerical; scene files are read and written here.
"""
