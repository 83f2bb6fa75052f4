"""Ordinary kriging of samples, the variograms it takes, and arithmetic with the same bits on every computer."""
