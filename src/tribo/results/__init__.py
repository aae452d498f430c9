"""What a run delivers: its data, data set, state and journal, notes, report and averages."""
