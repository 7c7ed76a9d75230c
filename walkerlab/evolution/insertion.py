"""Genomes that users insert into a run, until the next generation is bred."""

from collections.abc import Generator
from contextlib import contextmanager
from threading import Lock

from walkerlab.genome.genome import Genome
from walkerlab.settings.algorithm import Algorithm


class InsertedGenomes:
    """The queue of inserted genomes; one thread may insert while another breeds."""

    def __init__(self, algorithm: Algorithm) -> None:
        """Create an empty queue for a run with these settings, before its first generation."""
        self._n_children = algorithm.population_size - algorithm.n_elites
        self._n_generations = algorithm.generations
        self._next_bred: int | None = None
        self._waiting: list[Genome] = []
        self._lock = Lock()

    @property
    def waiting(self) -> list[Genome]:
        """Genomes that are not in a generation yet."""
        with self._lock:
            return list(self._waiting)

    def set_next_generation(self, generation: int) -> None:
        """Accept genomes for the given generation and later ones."""
        with self._lock:
            self._next_bred = generation

    def add(self, genome: Genome) -> int:
        """Add a genome, and return the number of the generation that will contain it.

        Raises:
            ValueError: If there is no room for the genome, no generation is complete yet, or the run is complete.
        """
        with self._lock:
            if self._next_bred is None:
                raise ValueError(
                    "a genome cannot be inserted into the first generation, which is random; insert it when that "
                    "generation is complete"
                )
            if self._next_bred >= self._n_generations:
                raise ValueError(
                    f"no further generation will be bred: generation {self._n_generations - 1} is the last. To "
                    "add some, resume the run with more generations"
                )
            if len(self._waiting) >= self._n_children:
                raise ValueError(
                    f"the next generation has {self._n_children} places for children, and inserted genomes take all "
                    "of them; insert this one into a later generation"
                )
            self._waiting.append(genome)
            return self._next_bred

    @contextmanager
    def taking_for(self, generation: int) -> Generator[list[Genome]]:
        """Yield the genomes for a generation; an error in the block puts them back."""
        with self._lock:
            taken = self._waiting[: self._n_children]
            self._waiting = self._waiting[self._n_children :]
            self._next_bred = generation + 1
        try:
            yield taken
        except BaseException:  # such as Ctrl-C during the walks: the generation will be bred again
            with self._lock:
                self._waiting = taken + self._waiting
                self._next_bred = generation
            raise
