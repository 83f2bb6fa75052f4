"""Carry trials out: on warm processes, workers and clusters."""
