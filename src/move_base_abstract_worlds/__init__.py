"""Scenarios checked before they run, and made by sizes: the program ``scenario``.

A program, no node: it reads scenarios and maps, and writes files.
"""
