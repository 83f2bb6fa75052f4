"""The program that a command line runs, its kind, and how a binary or a shell script is started."""
