import json
import pydoc
import re
from functools import partial
from math import inf, nan, nextafter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from tests.strategies import all_settings, finite, robots
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.choices import Camera, Choice, Crossover, Fitness, Mutation, Selection, Structure
from walkerlab.settings.fields import PAIR, OneOf, Quantity
from walkerlab.settings.model import SettingsError
from walkerlab.settings.robot import LIGHTEST, Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.simulation import Simulation
from walkerlab.settings.terrain import MAX_PIECES, Terrain
from walkerlab.settings.values import code_text, function_name, number_text, vector_text

DOMAINS = {"terrain": Terrain, "robot": Robot, "algorithm": Algorithm, "simulation": Simulation}
FIELDS = [(domain, name) for domain in DOMAINS.values() for name in domain.declared()]
NUMBERS = [(domain, name) for domain, name in FIELDS if isinstance(domain.declared()[name], Quantity)]
CHOICES = [(domain, name) for domain, name in FIELDS if isinstance(domain.declared()[name], OneOf)]
NEEDS = {"n_elites": {"population_size": 10_000}, "texture_density": {"texture_size": 0.3}}
"""What an end of a range asks of another field."""

every_field = pytest.mark.parametrize(("domain", "name"), FIELDS)
every_number = pytest.mark.parametrize(("domain", "name"), NUMBERS)
every_choice = pytest.mark.parametrize(("domain", "name"), CHOICES)


def default(domain, name):
    return domain.model_fields[name].default


def with_part(domain, name, number):
    """Yield values in which one number is this one, and the others are as the default has them."""
    declared = domain.declared()[name]
    if not declared.parts:
        yield number
    for i in range(len(declared.parts)):
        yield (*default(domain, name)[:i], number, *default(domain, name)[i + 1 :])


def refusal(make, *args, **values):
    with pytest.raises(SettingsError) as caught:
        make(*args, **values)
    return str(caught.value)


def my_own(*args):
    return 1.0


# ------------------------------------------------------------------------------------------------ single numbers


def test_every_field_of_every_domain_is_declared_with_a_range_and_a_meaning():
    for domain, name in FIELDS:
        declared = domain.declared()[name]
        assert declared.about
        assert declared.about[0].islower()
        assert not declared.about.endswith(".")
        assert domain.model_json_schema()["properties"][name]["description"] == declared.about
    for domain in DOMAINS.values():
        assert set(domain.declared()) == set(domain.model_fields)


@every_number
def test_an_annotation_agrees_with_its_declaration(domain, name):
    declared = domain.declared()[name]
    number = int if declared.whole else float
    wanted = tuple[(number,) * len(declared.parts)] if declared.parts else number
    assert domain.model_fields[name].annotation == wanted
    assert type(default(domain, name)) is (tuple if declared.parts else number)
    schema = domain.model_json_schema()["properties"][name]
    assert (schema["minimum"], schema["maximum"], schema["unit"]) == (declared.low, declared.high, declared.unit)


@every_choice
def test_a_default_is_a_member_of_its_choices(domain, name):
    assert default(domain, name) in domain.declared()[name].choices


@pytest.mark.parametrize("domain", DOMAINS.values())
def test_help_lists_each_setting_with_default_meaning_unit_and_range_and_nothing_of_pydantic(domain):
    text = pydoc.plain(pydoc.render_doc(domain))
    one_line = re.sub(r"[\s|]+", " ", text)
    for name, declared in domain.declared().items():
        about = declared.about[0].upper() + declared.about[1:]
        assert f" {name} = {code_text(default(domain, name))} {about}. Allowed: {declared.range}." in one_line
        assert f"{name}: typing.Annotated" not in text
    assert "model_dump" not in text
    assert len(text.splitlines()) < 100


@every_number
def test_a_number_outside_its_range_is_refused_with_field_value_unit_range_and_meaning(domain, name):
    declared = domain.declared()[name]
    just_under = declared.low - 1 if declared.whole else nextafter(declared.low, -inf)
    just_over = declared.high + 1 if declared.whole else nextafter(declared.high, inf)
    for bad in (just_under, just_over, nan, inf, -inf, 10**40):
        for value in with_part(domain, name, bad):
            message = refusal(domain, **{name: value})
            assert message.startswith(f"{domain.__name__}.{name}")
            assert f" is {bad}{' ' * bool(declared.unit)}{declared.unit}; it must be " in message
            low, high = re.search(r"must be (-?\d+(?:\.\d+)?) to (\d+(?:\.\d+)?)", message).groups()
            assert (float(low), float(high)) == pytest.approx((declared.low, declared.high), rel=1e-9)
            assert message.endswith(f" It is {declared.about}.")


@every_number
def test_a_range_includes_its_ends(domain, name):
    declared = domain.declared()[name]
    ends = [declared.low, declared.high]
    if declared.parts:
        ends = [tuple(ends)] if declared.parts == PAIR else [(end,) * len(declared.parts) for end in ends]
    for end in ends:
        assert getattr(domain(**NEEDS.get(name, {}), **{name: end}), name) == end


@every_number
def test_only_numbers_are_numbers(domain, name):
    for bad in ("3", "3.0", True, None, 1j, [1.0], {}, np.bool_(True), np.array([1.0]), b"3"):
        for value in with_part(domain, name, bad):
            message = refusal(domain, **{name: value})
            assert message.startswith(f"{domain.__name__}.{name}")
            assert f"{bad!r}; it must be a" in message or f"{bad.item()!r}; it must be a" in message


@every_number
def test_whole_numbers_are_whole_and_all_become_plain_python(domain, name):
    declared = domain.declared()[name]
    plain = int if declared.whole else float
    middle = default(domain, name)
    for kind in (np.float64, np.float32) + ((np.int64,) if declared.whole else ()):
        given = tuple(map(kind, middle)) if declared.parts else kind(middle)
        got = getattr(domain(**{name: given}), name)
        assert [type(one) for one in (got if declared.parts else [got])] == [plain] * max(1, len(declared.parts))
        assert got == pytest.approx(middle)
    if declared.whole:
        for value in with_part(domain, name, declared.low + 0.5):
            assert "it must be a whole number" in refusal(domain, **{name: value})


@pytest.mark.parametrize(("domain", "name"), [(d, n) for d, n in NUMBERS if d.declared()[n].parts])
def test_several_numbers_come_as_many_as_are_needed(domain, name):
    parts = domain.declared()[name].parts
    good = default(domain, name)
    assert getattr(domain(**{name: list(good)}), name) == good
    assert getattr(domain(**{name: np.array(good)}), name) == good
    unordered = set(good), frozenset(good), dict.fromkeys(good), dict.fromkeys(good).keys()
    letters = [kind(b"123"[: len(parts)]) for kind in (bytes, bytearray)]
    for bad in (good[:-1], (*good, good[-1]), (), good[0], "123"[: len(parts)], None, *unordered, *letters):
        assert f"it must be {len(parts)} numbers: {', '.join(parts)}." in refusal(domain, **{name: bad})


@pytest.mark.parametrize("name", [name for name in Robot.declared() if Robot.declared()[name].parts == PAIR])
def test_a_min_over_its_max_is_refused(name):
    declared = Robot.declared()[name]
    message = refusal(Robot, **{name: (declared.high, declared.low)})
    assert message.startswith(f"Robot.{name} is ({declared.high:g}, {declared.low:g})")
    assert "its min must not be over its max" in message
    assert f" {declared.unit}; " in message or not declared.unit


def test_a_gravity_may_be_called_by_its_planet():
    assert Terrain(gravity="moon") == Terrain(gravity=(0, 0, -1.62))
    assert Settings().with_(gravity="jupiter").terrain.gravity == (0, 0, -24.79)
    message = refusal(Terrain, gravity="mooon")
    assert (
        "it must be 3 numbers: x, y, z. Or the name of one: earth, moon, mars, jupiter. Did you mean 'moon'?" in message
    )


def test_one_word_names_one_setting_and_where_two_domains_share_it_the_algorithm_has_it():
    places = Settings.places()
    assert sorted(places.values()) == sorted(
        (keyword, name) for keyword in DOMAINS for name in DOMAINS[keyword].declared()
    )
    assert places["seed"] == ("algorithm", "seed")
    both = Settings().with_(seed=3, terrain_seed=4)
    assert (both.algorithm.seed, both.terrain.seed) == (3, 4)


class TestGroundThatCannotBe:
    """More than a computer can bear, or than there is room for, is refused with a mend that will do."""

    def test_too_many_pieces(self):
        message = refusal(Terrain, texture_size=0.03, texture_density=0.4)
        assert "Terrain.texture_size 0.03 m and Terrain.texture_density 0.4 ask for some" in message
        larger = float(re.search(r"texture_size ([\d.]+) m would do", message).group(1))
        assert Terrain(texture_size=larger, texture_density=0.4).n_pieces <= MAX_PIECES

    def test_too_many_obstacles(self):
        message = refusal(Terrain, obstacle="log", obstacle_size=0.5, obstacle_density=2)
        fewer = float(re.search(r"a density of ([\d.]+) per m² would do", message).group(1))
        assert Terrain(obstacle="log", obstacle_size=0.5, obstacle_density=fewer)
        assert Terrain(obstacle="none", obstacle_size=0.5, obstacle_density=2), "where nothing lies, there is room"

    @pytest.mark.parametrize(("structure", "level"), [("stairs", "step_depth"), ("gaps", "gap_distance")])
    def test_obstacles_larger_than_what_they_lie_on(self, structure, level):
        message = refusal(Terrain, structure=structure, obstacle="box", obstacle_size=0.5, obstacle_density=0.1)
        assert "Terrain.obstacle_size is 0.5 m" in message
        assert f"Terrain.{level} is" in message
        assert Terrain(structure="flat", obstacle="box", obstacle_size=0.5, obstacle_density=0.1)


def test_a_message_reads_like_this():
    assert refusal(Terrain, step_height=0.9) == (
        "Terrain.step_height is 0.9 m; it must be 0.01 to 0.4 m. It is the rise of each stair."
    )
    assert refusal(Algorithm, seed=-1).startswith("Algorithm.seed is -1; it must be 0 to 2147483647. ")


# ------------------------------------------------------------------------------------------------------- choices


@every_choice
def test_a_choice_is_the_same_as_member_name_or_code(domain, name):
    for choice in domain.declared()[name].choices:
        chosen = domain(**{name: choice})
        assert getattr(chosen, name) is choice
        for way in (choice.name, choice.value, np.int64(choice.value)):
            assert domain(**{name: way}) == chosen
            assert getattr(domain(**{name: way}), name) is choice


@every_choice
def test_what_is_no_choice_is_refused_with_all_that_there_are(domain, name):
    choices = domain.declared()[name].choices
    another_kind = next(kind for kind in (Camera, Structure) if kind is not choices)
    for bad in ("nonsense", "", 99, -1, 1.0, True, None, another_kind(0), Camera, b"side"):
        message = refusal(domain, **{name: bad})
        assert message.startswith(f"{domain.__name__}.{name} is {bad!r}; it must be one of ")
        for choice in choices:
            assert f"{choice.name} ({choice.value})" in message


@every_choice
def test_a_misspelt_choice_gets_a_did_you_mean(domain, name):
    for choice in domain.declared()[name].choices:
        for typo in (choice.name.upper(), choice.name + choice.name[-1]):
            assert f"Did you mean '{choice.name}'?" in refusal(domain, **{name: typo})


def test_every_choice_has_a_code_of_its_own_and_says_what_it_is():
    for kind in Choice.__subclasses__():
        assert [choice.value for choice in kind] == list(range(len(kind)))
        assert all(choice.about for choice in kind)


@pytest.mark.parametrize("slot", ["selection", "crossover", "mutation"])
def test_a_slot_takes_a_function_or_a_list_of_anything_it_takes_alone(slot):
    kind = Algorithm.declared()[slot].choices
    first, second = list(kind)[:2]
    bound = partial(my_own, size=7)
    for slot_given, kept in (
        (my_own, my_own),
        (bound, bound),
        ([first], first),
        ([my_own], my_own),
        ([first, second.name, second.value, my_own], (first, second, second, my_own)),
        ((first, first), (first, first)),
    ):
        assert getattr(Algorithm(**{slot: slot_given}), slot) == kept
    for bad in ([], (), [[first]], [first, "nonsense"], [None], {first}, int):
        assert refusal(Algorithm, **{slot: bad}).startswith(f"Algorithm.{slot} is ")


def test_a_partial_is_what_a_run_file_gives_back():
    """Numbers of numpy become plain, and a partial that binds nothing becomes the function."""
    for given_one, shown in (
        (partial(my_own, size=np.int64(2)), "my_own(size=2)"),
        (partial(my_own, np.float64(0.5), how=np.bool_(True)), "my_own(0.5, how=True)"),
        (partial(my_own, size=np.array(7)), "my_own(size=7)"),
    ):
        alone, first = Algorithm(selection=given_one), Algorithm(selection=[given_one, my_own])
        assert function_name(alone.selection) == function_name(first.selection[0]) == shown
        again = Settings(algorithm=alone).with_(seed=3).algorithm
        assert again.selection is alone.selection
    assert Algorithm(selection=partial(my_own)).selection is my_own


def test_only_slots_for_functions_take_functions_and_only_slots_for_several_take_lists():
    assert Algorithm(fitness=my_own).fitness is my_own
    assert "or a function of your own" in refusal(Algorithm, fitness="nonsense")
    for domain, name, bad in (
        (Terrain, "structure", my_own),
        (Terrain, "structure", ["flat"]),
        (Algorithm, "fitness", ["distance", "velocity"]),
    ):
        assert refusal(domain, **{name: bad}).startswith(f"{domain.__name__}.{name} is ")


# ------------------------------------------------------------------------------------------ all faults, all names


def test_all_faults_of_one_call_are_told_at_once():
    beyond = {
        keyword: {
            name: next(with_part(domain, name, nan)) if (domain, name) in NUMBERS else "nonsense"
            for name in domain.declared()
        }
        for keyword, domain in DOMAINS.items()
    }
    everything = [f"{domain.__name__}.{name}" for domain, name in FIELDS]
    lines = refusal(Settings, **beyond).splitlines()
    assert [re.match(r"\w+\.\w+", line).group() for line in lines] == everything

    flat = {word: beyond[domain][name] for word, (domain, name) in Settings.places().items()}
    assert len(refusal(Settings().with_, **flat, no_such=1).splitlines()) == len(everything) + 1


@pytest.mark.parametrize("keyword", DOMAINS)
def test_what_is_no_domain_is_told_beside_all_other_faults(keyword):
    kind, other = DOMAINS[keyword], DOMAINS["robot" if keyword == "terrain" else "terrain"]()
    for bad in ("stairs", None, [], 3, kind, other, {1}):
        told = f"Settings.{keyword} is {bad!r}; it must be a {kind.__name__}, or a dict of its settings."
        assert refusal(Settings, **{keyword: bad}).startswith(told)
        singles = {"incline": 99, "weight": 1, "seed": -1, "duration": 0}
        first, *rest = refusal(Settings().with_, **singles, **{keyword: bad}, no_such=1).splitlines()
        assert first.startswith(told)
        assert len(rest) == len(singles) + 1
        refusal(Settings().with_, **{keyword: bad}, incline=5, weight=(3, 4), seed=1, duration=4)


def test_a_choice_given_for_its_domain_gets_a_did_you_mean():
    for domain, name in CHOICES:
        for choice in domain.declared()[name].choices:
            keyword = domain.__name__.lower()
            said = refusal(Settings, **{keyword: choice.name})
            mend = re.search(r"Did you mean (.*)\?$", said).group(1)
            assert choice.name in eval(f"dict({mend})")[keyword].model_dump().values()


@every_field
def test_an_unknown_name_gets_a_did_you_mean(domain, name):
    for typo in (name[:-1], name + "s", name.capitalize(), name.replace("_", "")):
        if typo in domain.declared():
            continue
        wanted = f"has no setting '{typo}'. Did you mean '{name}'?"
        assert wanted in refusal(domain, **{typo: 1})
        assert wanted in refusal(Settings, **{typo: 1})
        assert wanted in refusal(Settings().with_, **{typo: 1})


@every_field
def test_a_setting_given_outside_its_domain_is_told_its_domain(domain, name):
    keyword = domain.__name__.lower()
    word = next(word for word, place in Settings.places().items() if place == (keyword, name))
    assert f"{keyword}={domain.__name__}({name}=…)" in refusal(Settings, **{word: 1})


def test_a_name_like_no_other_gets_the_list():
    assert "It has structure, incline," in refusal(Terrain, qqq=1)
    assert "It has terrain, robot, algorithm, simulation." in refusal(Settings().with_, qqq=1)
    assert "Did you mean 'terrain'?" in refusal(Settings, terain={})


def test_all_faults_within_one_setting_are_told_at_once():
    x, z = refusal(Terrain, gravity=(99, 0, nan)).splitlines()
    assert x.startswith("Terrain.gravity's x is 99 m/s²; it must be -30 to 30 m/s².")
    assert z.startswith("Terrain.gravity's z is nan m/s²; it must be -30 to 30 m/s².")
    assert len(refusal(Robot, weight=("heavy", -1), legs=(0, 99)).splitlines()) == 4


def test_elites_leave_room_for_children():
    message = refusal(Algorithm, population_size=10, n_elites=10)
    assert "Algorithm.n_elites is 10" in message
    assert "Algorithm.population_size" in message
    assert Algorithm(population_size=10, n_elites=9).n_elites == 9


# ------------------------------------------------------------------------------------- limits that hold together


def whole_pairs(low, high):
    return st.tuples(st.integers(low, high), st.integers(low, high)).map(sorted).map(tuple)


@st.composite
def limits(draw):
    """Any limits, lengths in twentieths of a metre, so that they can be reckoned without rounding."""
    return {
        "segments": draw(whole_pairs(1, 8)),
        "legs": draw(whole_pairs(2, 16)),
        "segment_length": draw(whole_pairs(1, 40)),
        "body_length": draw(whole_pairs(1, 160)),
    }


def some_robot_obeys(segments, legs, segment_length, body_length):
    return any(
        legs[0] <= 2 * n_pairs <= legs[1]
        and n * segment_length[0] <= body_length[1]
        and n * segment_length[1] >= body_length[0]
        for n in range(segments[0], segments[1] + 1)
        for n_pairs in range(n + 1)
    )


def in_metres(limits):
    return {name: tuple(end / 20 for end in pair) if name.endswith("length") else pair for name, pair in limits.items()}


WIDEST = {name: (declared.low, declared.high) for name, declared in Robot.declared().items()}


@hypothesis_settings(max_examples=600)
@given(limits())
def test_limits_are_accepted_just_when_some_robot_obeys_them(drawn):
    if some_robot_obeys(**drawn):
        Robot(**in_metres(drawn))
        return
    message = refusal(Robot, **in_metres(drawn))
    for line in message.splitlines():
        named = {name: in_metres(drawn)[name] for name in re.findall(r"Robot\.(\w+)", line)}
        assert len(named) >= 2 or set(named) == {"legs"}
        refusal(Robot, **WIDEST | named)  # the fields that are named clash, whatever the others are


def test_each_way_to_clash_names_its_fields():
    for clash, named in (
        ({"legs": (3, 3)}, ["legs"]),
        ({"legs": (6, 8), "segments": (1, 2)}, ["legs", "segments"]),
        ({"segments": (4, 6), "segment_length": (0.5, 0.6)}, ["segments", "segment_length", "body_length"]),
        ({"segments": (1, 2), "body_length": (3.0, 4.0)}, ["segments", "segment_length", "body_length"]),
        ({"segment_length": (0.4, 0.41), "body_length": (0.5, 0.7)}, ["segment_length", "body_length"]),
        ({"legs": (6, 8), "segment_length": (0.5, 0.6)}, ["legs", "segment_length", "body_length"]),
    ):
        message = refusal(Robot, **clash)
        assert all(f"Robot.{name}" in message for name in named), message


# -------------------------------------------------------------------------------------------------------- values


@hypothesis_settings(max_examples=60)
@given(all_settings)
def test_settings_come_back_from_json_as_they_were(settings):
    text = settings.model_dump_json()
    assert Settings(**json.loads(text)) == settings
    assert Settings.model_validate_json(text) == settings
    assert json.loads(text) == settings.model_dump()


def test_json_holds_choices_by_name_and_of_functions_the_address_alone():
    bound = partial(my_own, size=np.int64(7), table=np.ones(2), how="fast")
    algorithm = Algorithm(fitness=my_own, selection=[Selection.top_half, bound], mutation=lambda genomes: genomes)
    settings = Settings(algorithm=algorithm)
    plain = json.loads(settings.model_dump_json())["algorithm"]
    assert plain == json.loads(json.dumps(settings.model_dump()))["algorithm"]
    assert plain["crossover"] == "paired"
    assert plain["fitness"] == {"function": f"{__name__}.my_own", "with": {}}
    with_it = {"size": 7, "table": {"array": [1.0, 1.0], "shape": [2], "dtype": "float64"}, "how": "fast"}
    positional = Algorithm(selection=partial(my_own, np.int64(3), "x", size=7)).model_dump()["selection"]
    assert positional == {"function": f"{__name__}.my_own", "with": {"size": 7}, "args": [3, "x"]}
    assert plain["selection"] == ["top_half", {"function": f"{__name__}.my_own", "with": with_it}]
    assert plain["mutation"] == {"function": f"{__name__}.<lambda>", "with": {}}
    assert len(refusal(Algorithm, **plain).splitlines()) == 3  # and an address is never taken for a function


@every_field
def test_settings_are_frozen(domain, name):
    settings, whole, keyword = domain(), Settings(), domain.__name__.lower()
    for changed, attribute, value in ((settings, name, default(domain, name)), (whole, keyword, settings)):
        said = refusal(setattr, changed, attribute, value)
        assert f"{type(changed).__name__}.{attribute} cannot be assigned: settings never change" in said
    assert (settings, whole) == (domain(), Settings())


def test_the_mend_of_a_change_can_be_typed_as_it_stands():
    s = Settings()
    stairs = Terrain(structure="stairs")
    for changed, name, value in ((s.algorithm, "seed", 3), (s, "seed", 3), (s, "terrain", stairs)):
        mend = refusal(setattr, changed, name, value).rpartition(" s = ")[2]
        assert eval(mend) == s.with_(**{name: value})


def test_whatever_way_settings_are_made_their_faults_are_told_in_our_words():
    for kind, bad in ((Settings, {"terrain": {"incline": 99}, "no_such": 1}), (Terrain, {"incline": 99, "sep": 2})):
        told = refusal(kind, **bad)
        assert refusal(kind.model_validate, bad) == refusal(kind.model_validate_json, json.dumps(bad)) == told
    assert "Invalid JSON" in refusal(Settings.model_validate_json, "{no")
    assert refusal(Settings.model_validate, 3).startswith("Settings is 3; ")


@hypothesis_settings(max_examples=60)
@given(all_settings, all_settings, st.sampled_from(list(Settings.places())))
def test_with_changes_just_that(settings, others, word):
    domain, name = Settings.places()[word]
    settings = settings.with_(robot=Robot(), terrain=Terrain(texture_size=0.3))  # where any single one will do
    value = getattr(getattr(others, domain), name)
    if domain == "robot":
        value = getattr(Robot(), name)
    if name in ("population_size", "n_elites"):
        settings = settings.with_(population_size=10_000, n_elites=0)
        value = max(value, 4) if name == "population_size" else value
    before = settings.model_dump()
    changed = settings.with_(**{word: value})
    assert settings.model_dump() == before
    assert getattr(getattr(changed, domain), name) == value
    after = changed.model_dump()
    after[domain][name] = before[domain][name]
    assert after == before


@given(robots(), robots())
@hypothesis_settings(max_examples=30)
def test_with_changes_a_whole_domain_and_single_settings_of_it_together(one, other):
    changed = Settings(robot=one).with_(robot=other, weight=one.weight, duration=3)
    assert dict(changed.robot) == dict(other) | {"weight": one.weight}
    assert changed.simulation == Simulation(duration=3.0)
    assert changed.with_(**dict(one)).robot == one


def test_equal_settings_are_equal_whatever_way_they_were_given():
    a = Settings(terrain=Terrain(structure="stairs"), algorithm=Algorithm(fitness=1, crossover="weighted"))
    b = Settings(terrain={"structure": 2}, algorithm={"fitness": Fitness.velocity, "crossover": [Crossover.weighted]})
    assert a == b
    assert hash(a) == hash(b)
    assert a != b.with_(mutation=Mutation.macro)


@hypothesis_settings(max_examples=100)
@given(all_settings)
def test_what_is_shown_can_be_pasted_back(settings):
    assert eval(repr(settings)) == settings
    assert str(settings) == repr(settings)


@given(finite)
def test_a_number_is_read_as_it_was_written(number):
    assert float(number_text(number)) == number
    assert eval(vector_text((number, 1.0, 0.0))) == (number, 1.0, 0.0)


def test_a_value_is_not_rounded_to_one_that_is_allowed():
    light, narrow = nextafter(LIGHTEST, 0.0), nextafter(1.0, 0.0)
    assert f"carry_weight is {light!r} kg" in refusal(Robot, carry_weight=light)
    assert f"is (1, {narrow!r}) m" in refusal(Robot, segment_length=(1.0, narrow))
    pieces = {"structure": "gaps", "gap_distance": 0.2, "texture_density": 0.1}
    assert "texture_size is 0.1600000000000001 m" in refusal(Terrain, texture_size=0.1600000000000001, **pieces)


def test_only_what_differs_is_shown_and_choices_and_functions_by_name():
    assert repr(Terrain(structure=2)) == "Terrain(structure='stairs')"
    algorithm = Algorithm(fitness=my_own, mutation=["macro", partial(my_own, 1, size=np.int64(7))])
    assert repr(algorithm) == "Algorithm(fitness=my_own, mutation=('macro', partial(my_own, 1, size=7)))"
    assert repr(Settings()) == "Settings()"
