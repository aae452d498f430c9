"""A program that reads all of an HDF5 file: ``python first_read.py FILE SECONDS``.

It ends with status 0 if the file can be read, and else with an error, a signal, or after so many
seconds of processor time: within a damaged file the HDF5 library may run without end or crash.  It
imports nothing of tribo, as it has to start quickly.
"""

import signal
import sys

import h5py

# Bytes of values in a byte of a file, at most: zlib reaches 1032.
MOST_BYTES = 1100
# The attribute with references to the dimensions of a dataset.
DIMENSIONS = "DIMENSION_LIST"


def read(path: str, seconds: float) -> None:
    """Read all attributes, dimensions and values.  Raises whatever the library may raise."""
    if hasattr(signal, "setitimer"):  # not on Windows, where the caller ends this program
        signal.setitimer(signal.ITIMER_PROF, seconds)
    with open(path, "rb") as stream, h5py.File(stream) as file:
        size = stream.seek(0, 2)
        dict(file.attrs)
        for dataset in file.values():
            for references in dict(dataset.attrs).get(DIMENSIONS, ()):
                for reference in references:
                    file[reference]
            if dataset.nbytes > MOST_BYTES * size:
                raise ValueError(f"{dataset.name} is larger than its file")
            dataset[()]


if __name__ == "__main__":
    read(sys.argv[1], float(sys.argv[2]))
