"""Terrains that cannot be built are rejected, with a value that is allowed."""

import re

import pytest

from tests.settings.cases import (
    error_message,
)
from walkerlab.settings.settings import Settings
from walkerlab.settings.terrain import MAX_PIECES, Terrain


def test_gravity_can_be_given_by_the_name_of_a_planet():
    assert Terrain(gravity="moon") == Terrain(gravity=(0, 0, -1.62))
    assert Settings().with_(gravity="jupiter").terrain.gravity == (0, 0, -24.79)
    message = error_message(Terrain, gravity="mooon")
    assert (
        "it must be 3 numbers: x, y, z, or the name of a preset: earth, moon, mars, jupiter. Did you mean 'moon'?"
        in message
    )


class TestImpossibleTerrain:
    """Terrain that is too slow to compute or does not fit is rejected, with a fix that is accepted."""

    def test_too_many_pieces(self):
        message = error_message(Terrain, texture_size=0.03, texture_density=0.4)
        assert "Terrain.texture_size 0.03 m and Terrain.texture_density 0.4 require about" in message
        larger = float(re.search(r"texture_size ([\d.]+) m would work", message).group(1))
        assert Terrain(texture_size=larger, texture_density=0.4).n_pieces <= MAX_PIECES

    def test_too_many_obstacles(self):
        message = error_message(Terrain, obstacle="log", obstacle_size=0.5, obstacle_density=2)
        fewer = float(re.search(r"a density of ([\d.]+) per m² would work", message).group(1))
        assert Terrain(obstacle="log", obstacle_size=0.5, obstacle_density=fewer)
        assert Terrain(obstacle="none", obstacle_size=0.5, obstacle_density=2), (
            "without obstacles, density does not matter"
        )

    @pytest.mark.parametrize(("structure", "level"), [("stairs", "step_depth"), ("gaps", "gap_distance")])
    def test_obstacles_larger_than_the_level_ground(self, structure, level):
        message = error_message(Terrain, structure=structure, obstacle="box", obstacle_size=0.5, obstacle_density=0.1)
        assert "Terrain.obstacle_size is 0.5 m" in message
        assert f"Terrain.{level} is" in message
        assert Terrain(structure="flat", obstacle="box", obstacle_size=0.5, obstacle_density=0.1)
