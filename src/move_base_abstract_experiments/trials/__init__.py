"""One trial in its own process: the run or the function, its metrics, and the outputs that go back."""
