"""Conversion of messages to the core's values and to bytes, publishers of such bytes, and final answers in order."""
