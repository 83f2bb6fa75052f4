"""The program's own code: hooks that are compiled into it, which code asks the machine, and labels for what it does."""
