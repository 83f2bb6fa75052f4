"""The machine as a program sees it: chance, clocks, files, names. What cannot be followed labels the run."""
