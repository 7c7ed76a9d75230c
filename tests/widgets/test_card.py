"""The card of a robot shows its origin, its ancestors, and why its walk does not count."""

from walkerlab.widgets.card import robot_card


def test_only_a_child_has_a_line_of_descent(done):
    child = done.records[done.records.parents != ""].individual.iloc[-1]
    assert "Line of descent" in robot_card(done.records, child)
    assert "random" in robot_card(done.records, 0)
    assert "Line of descent" not in robot_card(done.records, 0)


def test_a_walk_that_does_not_count_has_a_reason_and_no_fitness(done):
    fell = done.records.assign(verdict="too_fast", reason="9 m/s <b>")
    assert "Details: 9 m/s &lt;b&gt;." in robot_card(fell, 0)
    assert "Fitness" not in robot_card(fell, 0)
    assert "Fitness" in robot_card(done.records, done.champion.individual)
