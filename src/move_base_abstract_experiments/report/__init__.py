"""The report of an experiment: the page report.html and the tables behind it, made from the experiment's folder."""
