"""Check scenarios before they run, and make scenarios from sizes: the program ``scenario``.

This is a program, not a node: it reads scenarios and maps, and writes files.
"""
