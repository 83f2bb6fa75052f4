"""Ordinary kriging of samples, its variograms, and arithmetic with the same bits on every computer."""
