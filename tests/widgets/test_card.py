"""A card says who a robot is, from whom it descends, and why its walk does not count."""

from walkerlab.widgets.card import card


def test_a_child_has_a_line_of_descent_and_one_of_chance_has_none(done):
    child = done.records[done.records.parents != ""].individual.iloc[-1]
    assert "Line of descent" in card(done.records, child)
    assert "drawn by chance" in card(done.records, 0)
    assert "Line of descent" not in card(done.records, 0)


def test_a_walk_that_does_not_count_has_its_reason_and_no_fitness(done):
    fell = done.records.assign(verdict="too_fast", reason="9 m/s <b>")
    assert "That is, 9 m/s &lt;b&gt;." in card(fell, 0)
    assert "Fitness" not in card(fell, 0)
    assert "Fitness" in card(done.records, done.champion.individual)
