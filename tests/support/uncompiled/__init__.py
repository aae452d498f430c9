"""Short scenes, their starts and ends, and the loop for a pair, for the tests in `uncompiled`."""
