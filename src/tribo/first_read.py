"""A program that reads all of an HDF5 file: ``python first_read.py FILE SECONDS``.

It ends with status 0 if the file can be read, and else with an error, a signal, or after so many
seconds of processor time: within a damaged file the HDF5 library may run without end or crash.  It
imports nothing of tribo, as it has to start quickly.
"""

import signal
import sys

import netCDF4

# Bytes of values in a byte of a file, at most: zlib reaches 1032.
MOST_BYTES = 1100


def read(path: str, seconds: float) -> None:
    """Read all attributes, dimensions and values.  Raises whatever the library may raise."""
    if hasattr(signal, "setitimer"):  # not on Windows, where the caller ends this program
        signal.setitimer(signal.ITIMER_PROF, seconds)
    with open(path, "rb") as stream:
        image = stream.read()
    with netCDF4.Dataset("image", memory=image) as file:
        dict(file.__dict__)
        for variable in file.variables.values():
            dict(variable.__dict__)
            if variable.size * variable.dtype.itemsize > MOST_BYTES * len(image):
                raise ValueError(f"{variable.name} is larger than its file")
            variable[...]


if __name__ == "__main__":
    read(sys.argv[1], float(sys.argv[2]))
