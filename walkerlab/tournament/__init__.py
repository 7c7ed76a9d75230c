"""The class tournament: genomes of a folder walk on the same grounds under one judge, and are ranked."""
