"""From genomes to evaluations: one recorded walk, its verdict and its fitness, many of them on any executor."""
