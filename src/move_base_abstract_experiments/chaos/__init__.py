"""Chaos: seeds that choose another legal order of equal events, until a property fails; the fewest decisions for that."""
