"""Exceptions that the program does not catch, and failed jobs whose outcome it never asks for, as events of the run."""
