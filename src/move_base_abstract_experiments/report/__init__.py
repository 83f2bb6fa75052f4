"""What came out of an experiment: the page report.html and the tables behind it, from what its folder holds."""
