"""The program's own code: what is compiled into it, who in it asks, and how what it does labels the run."""
