"""The results of a trial: metrics, folder, pictures and provenance; and the similarity of two studies."""
