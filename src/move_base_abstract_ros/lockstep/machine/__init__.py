"""What a program sees of its machine: chance, clocks, files, names; what cannot be followed labels the run."""
