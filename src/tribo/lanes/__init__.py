"""Members of an ensemble side by side, one in each lane of a register."""
