"""Chaos: seeds that choose other legal orders of equal events, until something fails; the fewest decisions for that."""
