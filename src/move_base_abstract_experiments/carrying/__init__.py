"""Who carries trials out: warm processes, workers, clusters, and what goes to them."""
