"""The genome editor parses while the user types, marks errors, and reports genes beyond the limits."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import walkerlab as wl
from tests.strategies import genomes, robots
from tests.text.test_html import HOSTILE
from walkerlab.commands.worlds import WALKER_GENOME as GENOME
from walkerlab.genome.features import is_expressed
from walkerlab.genome.repair_notes import describe_repairs
from walkerlab.genome.text import GenomeError
from walkerlab.view import sketch
from walkerlab.widgets.editor import MAX_NOTES, PICTURE_SIZE, Editor
from walkerlab.widgets.outcomes import Outcome, compare_outcomes, simulate_outcome
from walkerlab.widgets.repairs import describe_fault, find_fault, format_genome

G = wl.Genome.parse(GENOME)
WORDS = str(G).split()


def fault_of(text):
    with pytest.raises(GenomeError) as caught:
        wl.Genome.parse(text)
    return str(caught.value)


# ---------------------------------------------------------------------------------------- place of an error


@given(st.integers(0, len(WORDS) - 1), st.text(st.characters(exclude_categories=["Cs", "Z", "C"]), min_size=1))
def test_the_place_of_an_error_is_the_wrong_word(which, wrong):
    wrong = "x" + wrong.replace("|", "") + "𝕏"  # the last character is two UTF-16 code units
    text = " ".join([*WORDS[:which], wrong, *WORDS[which + 1 :]])
    start, end = find_fault(fault_of(text), text)
    assert text.encode("utf-16-le")[2 * start : 2 * end].decode("utf-16-le").startswith("x")
    assert start == len(" ".join([*WORDS[:which], ""]))
    assert end - start == len(wrong.encode("utf-16-le")) // 2


def test_the_place_of_a_missing_word_is_the_end():
    text = " ".join(WORDS[:-1])
    assert find_fault(fault_of(text), text) == (len(text), len(text))
    assert find_fault("it has too many characters", text) is None


@given(genomes())
def test_a_formatted_genome_is_parsed_unchanged(genome):
    assert wl.Genome.parse(format_genome(genome)) == genome


# --------------------------------------------------------------------------------------------------- limits


def sentences_of(genome, robot):
    """Return the repairs of a genome as sentences."""
    return [str(repair) for repair in describe_repairs(genome, robot)]


@given(robots(), st.integers(0, 99))
def test_a_genome_within_the_limits_has_no_repairs(robot, seed):
    assert describe_repairs(wl.Genome.random(robot, rng=np.random.default_rng(seed)), robot) == []


@given(robots(), genomes())
def test_every_changed_genome_has_a_description(robot, genome):
    repaired = genome.within(robot)
    sentences = sentences_of(genome, robot)
    assert all("used" in one or "repeated" in one or "ignored" in one for one in sentences)
    if genome.n_parts == repaired.n_parts and np.abs(genome.values[:2] - repaired.values[:2]).max() > 0.001:
        assert sentences


BEYOND = {
    "Segment 2: leg length 0.9 m is above the limit of 0.6 m; 0.6 m is used.": ("own length=0.42", "own length=0.9", 2),
    "Segment 1: leg force 0.5 N·m is below the limit of 2 N·m; 2 N·m is used.": ("force=14", "force=0.5", 1),
    "segments 9 is above the limit of 4; 4 is used.": ("segments=3", "segments=9", 1),
    "The robot has 4 segments, and the genome describes 3; the last one is repeated.": ("segments=3", "segments=9", 1),
    "segments 2.4 is not a whole number; 2 is used.": ("segments=3", "segments=2.4", 1),
    "frequency 9 Hz is above the limit of 3 Hz; 3 Hz is used.": ("frequency=1.2", "frequency=9", 1),
    "duty 0.1 is below the limit of 0.3; 0.3 is used.": ("duty=0.5", "duty=0.1", 1),
    "lag 7 rad is not within one turn; 0.717 rad is used.": ("lag=0", "lag=7", 1),
    "Segment 2: repeat 0.7 is not a whole number; 1 is used.": ("own", "repeat=0.7", 2),
    "Segment 1: hip phase 7 rad is not within one turn; 0.717 rad is used.": ("phase=0", "phase=7", 1),
    "Segment 3: legs 7 is above the limit of 1; 1 is used.": ("legs", "legs=7", 3),
}


@pytest.mark.parametrize("sentence", BEYOND)
def test_each_gene_beyond_the_limits_is_named_with_the_used_value(sentence):
    old, new, nth = BEYOND[sentence]
    pieces = str(G).split(old)
    text = old.join(pieces[:nth]) + new + old.join(pieces[nth:])
    assert sentence in sentences_of(wl.Genome.parse(text), wl.Robot())


def test_a_value_beyond_a_limit_says_why_another_than_the_limit_is_used():
    long = GENOME.replace("seg length=0.26", "seg length=1.386", 1)
    limits = wl.Robot(segment_length=(0.2, 0.5), body_length=(0.6, 0.9))
    (sentence,) = [one for one in sentences_of(wl.Genome.parse(long), limits) if "1.386" in one]
    used = wl.Genome.parse(long).within(limits).values[4]
    assert used < 0.5, "precondition of this test"
    assert sentence == (
        "Segment 1: length 1.386 m is above the limit of 0.5 m, and the body must be between 0.6 and 0.9 m long; "
        f"{used:.4g} m is used."
    )


def test_an_error_names_the_line_and_the_word():
    text = format_genome(G).replace("knee", "elbow", 1)
    line = text[: text.index("elbow")].count("\n") + 1
    assert describe_fault(fault_of(text), text) == f"Line {line}: expected 'knee', got 'elbow'."
    assert describe_fault("it has too many characters\nmore", text) == "it has too many characters"


def test_legs_that_repeat_others_have_no_repairs():
    wrong = GENOME.replace("own length=0.42", "own length=0.9")
    first, *others = wrong.split("own")
    repeating = "own".join([first, "repeat".join(others)])
    assert sentences_of(wl.Genome.parse(repeating), wl.Robot()) == [
        "Segment 1: leg length 0.9 m is above the limit of 0.6 m; 0.6 m is used."
    ]


def test_a_gene_that_does_not_fit_with_the_others_is_reported_with_the_reason():
    heavy = sentences_of(wl.Genome.parse(GENOME.replace("mass=2", "mass=9")), wl.Robot())
    assert (
        heavy[0] == "Segment 1: mass 9 kg does not fit, because the robot must weigh between 3 and 12 kg; 4 kg is used."
    )
    limits = wl.Robot(weight=(3, 40), legs=(2, 2), body_length=(0.4, 0.6))
    dense = sentences_of(wl.Genome.parse(GENOME.replace("mass=2", "mass=9")), limits)
    reason = "because the density of a segment of this size must be between 400 and 2500 kg/m³; 7.372 kg is used."
    assert f"Segment 2: mass 9 kg does not fit, {reason}" in dense
    bare = sentences_of(G, wl.Robot(legs=(2, 4)))
    assert bare == ["Segment 3: legs 1 does not fit, because the robot must have between 2 and 4 legs; 0 is used."]
    long = sentences_of(G, wl.Robot(body_length=(0.4, 0.6)))
    assert all("because the body must be between 0.4 and 0.6 m long" in one for one in long[-2:])


# --------------------------------------------------------------------------------------------------- widget


def test_the_initial_genome_is_random_or_given():
    assert Editor().genome == Editor().genome is not None
    assert Editor(G).genome == G.within(wl.Robot())
    assert Editor(GENOME).text == GENOME
    assert Editor("no gene").fault == "Line 1: expected 'wl2', got 'no'."


def test_a_changed_text_is_parsed_and_drawn():
    editor = Editor(G)
    assert (editor.fault, editor.fault_range, editor.notes) == ("", [], [])
    assert editor.picture == sketch.draw_robot(G, wl.Robot(), size=PICTURE_SIZE)
    editor.text = GENOME.replace("0.42", "0.3")
    assert editor.genome == wl.Genome.parse(GENOME.replace("0.42", "0.3")).within(wl.Robot())
    assert editor.picture == sketch.draw_robot(editor.genome, wl.Robot(), size=PICTURE_SIZE)


@pytest.mark.parametrize(
    "text", ["", "wl2", HOSTILE, "\ud800", "wl2 " * 9000, GENOME + " x", GENOME.replace("=2", "=1e999")]
)
def test_an_invalid_text_gives_no_genome_and_a_message(text):
    editor = Editor(G)
    before = editor.picture
    editor.text = text
    assert editor.genome is None
    assert editor.fault
    assert "\n" not in editor.fault
    assert editor.picture == before
    editor.text = GENOME
    assert (editor.genome, editor.fault) == (G.within(wl.Robot()), "")


def test_an_invalid_text_has_no_notes():
    editor = Editor(G, wl.Settings().with_(legs=(2, 2)))
    assert editor.notes
    assert editor.reasons
    editor.text = "wl2"
    assert (editor.notes, editor.reasons) == ([], {})


def test_each_gene_that_is_not_used_as_written_has_its_reason():
    editor = Editor(G)
    for gene, value in enumerate(G.values[:-1]):
        editor._handle_custom_msg({"gene": gene, "value": value * 4}, [])
    written, used = np.array(editor.values), np.array(editor.repaired)
    beyond = (np.abs(written - used) > 0.0005) & np.array(editor.used)
    assert beyond.any()
    assert set(editor.reasons) == {gene["name"] for gene, wrong in zip(editor.genes, beyond, strict=True) if wrong}


def test_new_limits_change_the_genome_and_not_the_text():
    editor = Editor(G)
    text = editor.text
    editor.settings = wl.Settings().with_(legs=(2, 2))
    assert editor.text == text
    assert editor.genome == G.within(wl.Robot(legs=(2, 2)))
    assert len(editor.notes) == 2
    editor.settings = wl.Settings().with_(leg_force=(1, 2), segment_length=(0.2, 0.25), weight=(0.5, 1))
    assert len(editor.notes) == MAX_NOTES + 1
    assert editor.notes[-1] == "And 7 more."


def test_setting_the_genome_changes_the_text_once():
    editor = Editor()
    texts = []
    editor.observe(lambda change: texts.append(change.new), "text")
    editor.genome = G
    assert editor.text == format_genome(G)
    assert editor.genome == G.within(wl.Robot())
    assert len(texts) == 1


def test_every_gene_has_a_slider_with_the_range_of_the_gene_table():
    robot = wl.Robot(segments=(1, 2), legs=(2, 4))
    editor = Editor(settings=wl.Settings(robot=robot))
    table = wl.gene_table(robot)
    assert [(one["name"], one["low"], one["high"], one["meaning"]) for one in editor.genes] == list(
        table[["gene", "low", "high", "meaning"]].itertuples(index=False, name=None)
    )
    assert {(one["group"], one["section"]) for one in editor.genes} == {
        *(("whole robot", section) for section in ("body", "gait")),
        *((f"segment {i}", section) for i in (1, 2) for section in ("body", "legs", "gait")),
    }
    assert len(editor.values) == len(editor.used) == len(table)


@settings(max_examples=10)
@given(st.integers(0, 55), st.floats(0, 1))
def test_a_slider_changes_one_gene_in_the_text_and_undo_restores_it(index, share):
    editor = Editor(G.within(wl.Robot()))
    gene = editor.genes[index]
    value = round(gene["low"] + share * (gene["high"] - gene["low"]), 3)
    before = editor.text
    editor._handle_custom_msg({"gene": index, "value": value}, [])
    expected = G.within(wl.Robot()).values.copy()
    expected[index] = value
    assert wl.Genome.parse(editor.text) == wl.Genome(expected)
    assert editor.values == expected.tolist()
    assert editor.used == is_expressed(editor.genome.values[np.newaxis])[0].tolist()
    assert editor.genome == wl.Genome(expected).within(wl.Robot())
    editor._handle_custom_msg({"press": "undo"}, [])
    assert (editor.text, editor.values) == (before, editor.original)


def test_after_an_edit_the_walk_is_compared_with_that_before_it():
    settings = wl.Settings().with_(duration=1)
    editor = Editor(G, settings)
    editor._handle_custom_msg({"gene": 1, "value": 2.0}, [])
    editor._handle_custom_msg({"press": "try"}, [])
    before, after = (simulate_outcome(one, settings) for one in (G, editor.genome))
    assert editor.result == compare_outcomes(after, before)
    assert editor.result["distance"] in editor.snapshot()
    editor.accept(Outcome(9.0, "ok", "", ""))
    editor._handle_custom_msg({"press": "try"}, [])
    assert editor.result["before"] == "before: 9.00 m"
    assert not editor.result["is_better"]
    editor.settings = settings.with_(gravity="moon")
    assert editor.result == {}


def test_an_invalid_message_of_a_slider_changes_nothing():
    editor = Editor(G)
    before = editor.text
    for wrong in (
        {"gene": 999, "value": 1},
        {"gene": -1, "value": 1},
        {"gene": 1, "value": float("nan")},
        {"gene": "1"},
    ):
        editor._handle_custom_msg(wrong, [])
    assert editor.text == before


def test_the_buttons_pass_a_valid_genome_to_the_callbacks():
    editor = Editor(G)
    walked = []
    inserted = []
    editor.on_walk(walked.append)
    editor.on_insert(inserted.append)
    for message in ({"press": "walk"}, {"press": "insert"}, {"press": "fly"}, {"press": []}, None, 3, "walk"):
        editor._handle_custom_msg(message, [])
    editor.text = "no gene"
    editor._handle_custom_msg({"press": "walk"}, [])
    assert walked == inserted == [editor.genome or G.within(wl.Robot())]


def test_only_buttons_with_a_callback_are_visible():
    editor = Editor(G)
    assert editor.buttons == []
    editor.on_insert(print)
    assert editor.buttons == ["insert"]


# -------------------------------------------------------------------------------------------------- browser

MODEL = """async ([source, traits]) => {
    const { default: widget } = await import(URL.createObjectURL(new Blob([source], { type: "text/javascript" })));
    const listeners = {};
    window.sent = [];
    window.model = {
        get: name => traits[name],
        set: (name, value) => { traits[name] = value; },
        save_changes: () => sent.push(traits.text),
        send: message => sent.push(message),
        on: (name, listener) => (listeners[name] ??= []).push(listener),
        update: changes => {
            Object.assign(traits, changes);
            for (const name in changes) listeners[`change:${name}`]?.forEach(listener => listener());
        },
    };
    widget.render({ model, el: document.body.appendChild(document.createElement("div")) });
}"""


WIDGET_TRAITS = ("layout", "tooltip", "tabbable", "comm", "keys", "log")


@pytest.fixture
def shown(page):
    """An editor in a browser; ``sent`` holds its messages to Python."""
    editor = Editor(G)
    names = [name for name in editor.trait_names(sync=True) if not name.startswith("_") and name not in WIDGET_TRAITS]
    page.add_style_tag(content=Editor._css)
    for register in (editor.on_walk, editor.on_insert, editor.on_try):
        register(print)
    page.evaluate(MODEL, [Editor._esm, {name: getattr(editor, name) for name in names}])
    return page


def test_in_a_browser_an_error_is_marked_and_disables_the_buttons(shown):
    text = shown.get_by_label("Genome", exact=True)
    assert text.input_value() == format_genome(G)
    assert shown.get_by_role("img").get_attribute("aria-label").startswith("A robot: 3 segments")
    assert shown.get_by_role("button", name="Play its walk").is_enabled()
    assert shown.get_by_role("button", name="Insert into the next generation").is_disabled()

    wrong = Editor(format_genome(G).replace("knee", "elbow", 1))
    text.fill(wrong.text)
    shown.wait_for_function("sent.length")
    assert shown.evaluate("sent[0]") == wrong.text
    shown.evaluate(
        "changes => model.update(changes)",
        {"fault": HOSTILE + wrong.fault, "fault_range": wrong.fault_range, "notes": [HOSTILE]},
    )
    assert shown.locator("mark").text_content() == "elbow"
    assert HOSTILE in shown.locator(".messages").text_content()
    assert text.get_attribute("aria-invalid") == "true"
    assert shown.get_by_role("button", name="Play its walk").is_disabled()
    mark, area = (shown.locator(one).bounding_box() for one in ("mark", "textarea"))
    assert area["x"] < mark["x"] < area["x"] + area["width"]
    shown.get_by_role("button", name="Show the error").click()
    shown.keyboard.type("knee")
    texts = "sent.filter(one => typeof one === 'string')"
    shown.wait_for_function(f"{texts}.length == 2")
    assert shown.evaluate(texts)[1] == format_genome(G)


def test_in_a_browser_a_dragged_slider_is_sent_and_the_result_is_shown(shown):
    slider = shown.get_by_role("slider", name="length", exact=True).first
    slider.fill("0.3")
    shown.wait_for_function("sent.some(one => one.press === 'try')")
    sent = shown.evaluate("sent")
    assert {"gene": 4, "value": 0.3} in sent
    assert sent[-1] == {"press": "try"}, "the robot walks after the last change"
    edited = Editor(G)
    edited._handle_custom_msg({"gene": 4, "value": 0.3}, [])
    better = Outcome(2.904, "ok", "", "")
    result = compare_outcomes(better, Outcome(2.6751, "ok", "", ""))
    shown.evaluate("changes => model.update(changes)", {
        "text": edited.text, "values": edited.values, "repaired": edited.values, "result": result,
    })  # fmt: skip
    assert shown.get_by_label("Genome", exact=True).input_value() == edited.text
    assert shown.locator(".result").inner_text().split("\n")[:2] == ["2.90 m forward +0.22 m", "before: 2.68 m"]
    assert shown.locator(".row.changed").inner_text().split("\n")[-1] == f"was {G.values[4]:g}"
    shown.evaluate("values => model.update({ repaired: values })", [*edited.values[:4], 0.28, *edited.values[5:]])
    assert shown.locator(".row.beyond").inner_text().split("\n")[-1] == "used: 0.28"
    shown.locator(".row.beyond").hover()
    shown.evaluate("model.update({ reasons: { 'seg1.length': 'Too long.' } })")
    assert shown.locator(".help").inner_text() == "Too long.", "the reason stands beside the sliders"
    assert shown.get_by_text("No run is in progress.").count() == 1
    assert shown.locator(".row.unused").count() == 1, "only the first legs cannot repeat others"
    names = [gene["name"] for gene in edited.genes]
    copied = {**dict(zip(names, edited.values, strict=True)), "seg2.repeat": 1, "seg3.repeat": 1}
    shown.evaluate("values => model.update({ repaired: values })", list(copied.values()))
    assert shown.locator("legend").all_inner_texts() == [
        "body",
        *(f"{part}, copied by segments 2, 3" for part in ("legs", "gait")),
    ]
    offset = shown.get_by_role("slider", name="knee offset", exact=True)
    offset.dispatch_event("input")  # the slider is held, and does not follow Python
    offset.fill("-0.5")
    assert shown.locator(".row", has=offset).locator(".unit").inner_text() == "rad (-29°)"
    shown.get_by_role("button", name="whole robot").click()
    assert shown.get_by_role("slider", name="segments").input_value() == "3"


def test_in_a_browser_the_distance_is_in_view_with_the_sliders_of_a_segment(shown):
    before = Outcome(2.68, "ok", "", "")
    result, sliders = shown.locator(".result"), shown.locator(".row input[type=range]")
    for width in (560, 500):  # a notebook in a window 900 px wide, with and without margins
        shown.set_viewport_size({"width": width, "height": 600})
        tops = set()
        for after in (Outcome(2.9, "ok", "", ""), Outcome(2.9, "airborne", "from 5.36 s on " * 9, "")):
            shown.evaluate("result => model.update({ result })", compare_outcomes(after, before))
            box, first, last = (one.bounding_box() for one in (result, sliders.first, sliders.last))
            assert box["y"] + box["height"] <= first["y"]
            assert last["y"] + last["height"] - box["y"] < 600
            tops.add(first["y"])
        assert len(tops) == 1, "a long verdict moves no slider"


def test_in_a_browser_the_current_text_is_sent_before_a_button_acts(shown):
    shown.get_by_label("Genome", exact=True).press("End")
    shown.keyboard.type(" ")
    shown.get_by_role("button", name="Play its walk").click()
    sent = [message for message in shown.evaluate("sent") if message != {"press": "try"}]  # which may come later
    assert sent[-1] == {"press": "walk"}
    assert json.dumps(sent[-2]) != json.dumps(format_genome(G))
