"""A gene written by hand: read while one types, its fault found, and what is beyond the limits told of."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import walkerlab as wl
from tests.strategies import genomes, robots
from tests.text.test_html import HOSTILE
from walkerlab.commands.worlds import GENOME
from walkerlab.genome.text import GenomeError
from walkerlab.view import sketch
from walkerlab.widgets.editor import SAID, SIZE, Editor
from walkerlab.widgets.repairs import laid_out, mended, place_of

G = wl.Genome.parse(GENOME)
WORDS = str(G).split()


def fault_of(text):
    with pytest.raises(GenomeError) as caught:
        wl.Genome.parse(text)
    return str(caught.value)


# ------------------------------------------------------------------------------------------------- the place


@given(st.integers(0, len(WORDS) - 1), st.text(st.characters(exclude_categories=["Cs", "Z", "C"]), min_size=1))
def test_the_place_of_a_fault_is_the_word_that_is_wrong(which, wrong):
    wrong = "x" + wrong.replace("|", "") + "𝕏"  # to a browser, the last is two characters
    text = " ".join([*WORDS[:which], wrong, *WORDS[which + 1 :]])
    start, end = place_of(fault_of(text), text)
    assert text.encode("utf-16-le")[2 * start : 2 * end].decode("utf-16-le").startswith("x")
    assert start == len(" ".join([*WORDS[:which], ""]))
    assert end - start == len(wrong.encode("utf-16-le")) // 2


def test_where_a_word_is_missing_the_place_is_the_end():
    text = " ".join(WORDS[:-1])
    assert place_of(fault_of(text), text) == (len(text), len(text))
    assert place_of("it has too many characters", text) is None


@given(genomes())
def test_what_is_laid_out_in_lines_is_read_back_as_it_was(genome):
    assert wl.Genome.parse(laid_out(genome)) == genome


# ------------------------------------------------------------------------------------------------ the limits


@given(robots(), st.integers(0, 99))
def test_nothing_is_said_of_a_genome_within_the_limits(robot, seed):
    assert mended(wl.Genome.random(robot, rng=np.random.default_rng(seed)), robot) == []


@given(robots(), genomes())
def test_something_is_said_whenever_the_robot_is_another(robot, genome):
    own = genome.within(robot)
    said = mended(genome, robot)
    assert all("used" in one or "grown" in one or "left out" in one for one in said)
    if genome.n_parts == own.n_parts and np.abs(genome.values[:2] - own.values[:2]).max() > 0.001:
        assert said


BEYOND = {
    "Segment 2: leg length 0.9 m is over the limit 0.6 m: 0.6 m is used.": ("legs length=0.42", "legs length=0.9", 2),
    "Segment 1: leg force 0.5 N·m is under the limit 2 N·m: 2 N·m is used.": ("force=14", "force=0.5", 1),
    "segments 9 is over the limit 4: 4 is used.": ("segments=3", "segments=9", 1),
    "4 segments are to be grown, and 3 described: the last is grown again.": ("segments=3", "segments=9", 1),
    "segments 2.4 is not a whole number: 2 is used.": ("segments=3", "segments=2.4", 1),
    "frequency 9 Hz is over the limit 2.2 Hz: 2.2 Hz is used.": ("frequency=1.2", "frequency=9", 1),
    "Segment 1: hip phase 7 rad is not within one turn: 0.717 rad is used.": ("phase=0", "phase=7", 1),
    "Segment 3: legs 7 is over the limit 1: 1 is used.": ("legs", "legs=7", 3),
}


@pytest.mark.parametrize("sentence", BEYOND)
def test_each_gene_beyond_the_limits_is_named_with_what_is_used(sentence):
    old, new, nth = BEYOND[sentence]
    pieces = str(G).split(old)
    text = old.join(pieces[:nth]) + new + old.join(pieces[nth:])
    assert sentence in mended(wl.Genome.parse(text), wl.Robot())


def test_what_fits_alone_and_not_with_the_others_is_told_with_the_reason():
    heavy = mended(wl.Genome.parse(GENOME.replace("mass=2", "mass=9")), wl.Robot())
    assert heavy[0] == ("Segment 1: mass 9 kg does not fit, for the whole robot is to weigh 3 to 12 kg: 4 kg is used.")
    bare = mended(G, wl.Robot(legs=(2, 4)))
    assert bare == ["Segment 3: legs 1 does not fit, for the whole robot is to have 2 to 4 legs: 0 is used."]
    long = mended(G, wl.Robot(body_length=(0.4, 0.6)))
    assert all("for the whole body is to be 0.4 to 0.6 m long" in one for one in long[-2:])


# ------------------------------------------------------------------------------------------------ the widget


def test_it_begins_with_a_robot_of_chance_or_with_what_it_is_given():
    assert Editor().genome == Editor().genome is not None
    assert Editor(G).genome == G.within(wl.Robot())
    assert Editor(GENOME).text == GENOME
    assert Editor("no gene").fault.startswith("not a genome: at character 1")


def test_what_is_written_is_read_and_drawn():
    editor = Editor(G)
    assert (editor.fault, editor.place, editor.notes) == ("", [], [])
    assert editor.picture == sketch.draw_robot(G, wl.Robot(), size=SIZE)
    editor.text = GENOME.replace("0.42", "0.3")
    assert editor.genome == wl.Genome.parse(GENOME.replace("0.42", "0.3")).within(wl.Robot())
    assert editor.picture == sketch.draw_robot(editor.genome, wl.Robot(), size=SIZE)


@pytest.mark.parametrize(
    "text", ["", "wl1", HOSTILE, "\ud800", "wl1 " * 9000, GENOME + " x", GENOME.replace("2", "1e999")]
)
def test_a_text_that_is_no_gene_leaves_no_genome_and_says_why(text):
    editor = Editor(G)
    before = editor.picture
    editor.text = text
    assert editor.genome is None
    assert editor.fault
    assert "\n" not in editor.fault
    assert editor.picture == before
    editor.text = GENOME
    assert (editor.genome, editor.fault) == (G.within(wl.Robot()), "")


def test_of_a_text_that_is_no_gene_no_limits_are_told():
    editor = Editor(G, wl.Settings().with_(legs=(2, 2)))
    assert editor.notes
    editor.text = "wl1"
    assert editor.notes == []


def test_other_limits_are_held_at_once_and_the_text_stays():
    editor = Editor(G)
    text = editor.text
    editor.settings = wl.Settings().with_(legs=(2, 2))
    assert editor.text == text
    assert editor.genome == G.within(wl.Robot(legs=(2, 2)))
    assert len(editor.notes) == 2
    editor.settings = wl.Settings().with_(leg_force=(1, 2), segment_length=(0.2, 0.25), weight=(0.5, 1))
    assert len(editor.notes) == SAID + 1
    assert editor.notes[-1] == "And 7 more."


def test_a_genome_that_is_put_in_is_written():
    editor, heard = Editor(), []
    editor.observe(lambda change: heard.append(change.new), "text")
    editor.genome = G
    assert editor.text == laid_out(G)
    assert editor.genome == G.within(wl.Robot())
    assert len(heard) == 1


def test_its_buttons_hand_on_the_genome_and_only_a_genome():
    editor, walked, inserted = Editor(G), [], []
    editor.on_walk(walked.append)
    editor.on_insert(inserted.append)
    for message in ({"press": "walk"}, {"press": "insert"}, {"press": "fly"}, {"press": []}, None, 3, "walk"):
        editor._handle_custom_msg(message, [])
    editor.text = "no gene"
    editor._handle_custom_msg({"press": "walk"}, [])
    assert walked == inserted == [editor.genome or G.within(wl.Robot())]


def test_only_buttons_that_somebody_listens_to_are_there():
    editor = Editor(G)
    assert editor.heard == []
    editor.on_insert(print)
    assert editor.heard == ["insert"]


# ------------------------------------------------------------------------------------------------ in a browser

MODEL = """async ([source, traits]) => {
    const { default: widget } = await import(URL.createObjectURL(new Blob([source], { type: "text/javascript" })));
    const listeners = {};
    window.sent = [];
    window.model = {
        get: name => traits[name],
        set: (name, value) => { traits[name] = value; },
        save_changes: () => sent.push(traits.text),
        send: message => sent.push(message),
        on: (name, heard) => (listeners[name] ??= []).push(heard),
        tell: news => {
            Object.assign(traits, news);
            for (const name in news) listeners[`change:${name}`]?.forEach(heard => heard());
        },
    };
    widget.render({ model, el: document.body.appendChild(document.createElement("div")) });
}"""


@pytest.fixture
def shown(page):
    """An editor in a browser: what it says to Python is in ``sent``."""
    editor = Editor(G)
    names = ("text", "fault", "place", "notes", "picture", "can_insert", "heard")
    page.add_style_tag(content=Editor._css)
    for listen in (editor.on_walk, editor.on_insert):
        listen(print)
    page.evaluate(MODEL, [Editor._esm, {name: getattr(editor, name) for name in names}])
    return page


def test_in_a_browser_the_fault_is_marked_and_the_buttons_wait(shown):
    text = shown.get_by_label("Gene")
    assert text.input_value() == laid_out(G)
    assert shown.get_by_role("img").get_attribute("aria-label").startswith("A robot: 3 segments")
    assert shown.get_by_role("button", name="Let it walk").is_enabled()
    assert shown.get_by_role("button", name="Put it into the next generation").is_disabled()

    wrong = Editor(laid_out(G).replace("knee", "elbow", 1))
    text.fill(wrong.text)
    shown.wait_for_function("sent.length")
    assert shown.evaluate("sent") == [wrong.text]
    shown.evaluate(
        "news => model.tell(news)", {"fault": HOSTILE + wrong.fault, "place": wrong.place, "notes": [HOSTILE]}
    )
    assert shown.locator("mark").text_content() == "elbow"
    assert HOSTILE in shown.get_by_role("status").text_content()
    assert text.get_attribute("aria-invalid") == "true"
    assert shown.get_by_role("button", name="Let it walk").is_disabled()
    mark, area = (shown.locator(one).bounding_box() for one in ("mark", "textarea"))
    assert area["x"] < mark["x"] < area["x"] + area["width"]
    shown.get_by_role("button", name="Show the place").click()
    shown.keyboard.type("knee")
    shown.wait_for_function("sent.length == 2")
    assert shown.evaluate("sent")[1] == laid_out(G)


def test_in_a_browser_what_was_typed_last_is_read_before_it_walks(shown):
    shown.get_by_label("Gene").press("End")
    shown.keyboard.type(" ")
    shown.get_by_role("button", name="Let it walk").click()
    sent = shown.evaluate("sent")
    assert sent[-1] == {"press": "walk"}
    assert json.dumps(sent[-2]) != json.dumps(laid_out(G))
