"""Scripts that start launch files one after another: each of these becomes a run in lockstep."""
