"""The values that the robots measure: readings from files, random fields, and the grid of both."""
