"""The clock of a process, on the scaled clock and in lockstep, and everything that differs between the two."""
