"""A playground walks in the browser exactly as in Python, and its genes and its world can be changed."""

import hashlib
import json
import math

import numpy as np
import pytest

import walkerlab as wl
from tests.text.test_html import assert_harmless
from tests.view.test_replay import Links, open_file
from walkerlab.commands.worlds import WALKER_GENOME as GENOME
from walkerlab.view.playground import vendor
from walkerlab.view.playground.payload import page_data
from walkerlab.view.playground.translation import translate

SHORT = wl.Settings().with_(duration=2)
STAIRS = SHORT.with_(structure="stairs", step_height=0.05, carry_weight=1, drag_weight=1)

FAULTY_TEXTS = (
    "",
    "wl2",
    "wl3 segments=2",
    GENOME + " more",
    GENOME.replace("mass=", "mass=1e999 ", 1),
    GENOME.replace("mass=", "mass=1e999|", 1),
    GENOME.replace("legs ", "paws ", 1),
    GENOME.replace("length=", "length=٣", 1),
    GENOME.replace("length=", "length=0x", 1),
    GENOME.replace("| gait", "\x00<script>alert(1)</script>\u202e'\"\\ | gait", 1),
    GENOME.replace("| gait", "| seg | gait", 1),
    GENOME.replace("wl2", "\x1f\x85\ufeffwl2\u2028", 1),
    "😀" * 30 + "\n" + "x" * 200,
    "x" * 20_001,
)


class TestTheMuJoCoFiles:
    def test_their_checksums_are_those_of_the_declared_version(self):
        declared = json.loads((vendor.FOLDER / "version.json").read_text(encoding="utf-8"))
        assert (declared["package"], declared["version"], declared["licence"]) == (
            vendor.PACKAGE,
            vendor.VERSION,
            "Apache-2.0",
        )
        assert declared["sha256"] == {
            name: hashlib.sha256(vendor.decompressed_file(name)).hexdigest() for name in vendor.FILES
        }

    def test_the_folder_contains_nothing_else_and_is_below_three_megabytes(self):
        files = {path.name: path.stat().st_size for path in vendor.FOLDER.iterdir()}
        assert files.keys() == {"mujoco.js.gz", "mujoco.wasm.gz", "version.json", "LICENSE"}
        assert sum(files.values()) < 3e6


class TestTranslation:
    def test_unsupported_code_is_rejected(self):
        def with_import(x):
            return np.linalg.norm(x)

        def with_slice(x):
            return x[1:]

        for function in (with_import, with_slice):
            with pytest.raises(SyntaxError, match="cannot translate to JavaScript"):
                translate([function])


class TestArguments:
    def test_a_faulty_text_is_rejected_with_the_message_of_genome_parse(self):
        for text in FAULTY_TEXTS:
            with pytest.raises(wl.GenomeError) as expected:
                wl.Genome.parse(text)
            with pytest.raises(wl.GenomeError) as rejected:
                wl.playground(text, SHORT)
            assert str(rejected.value) == str(expected.value)

    def test_five_robots_are_too_many(self):
        with pytest.raises(ValueError, match="at most 4 robots; got 5"):
            wl.playground(5 * [GENOME], SHORT)

    def test_the_data_of_a_page_has_a_model_of_every_body_plan_within_the_limits(self):
        few = SHORT.with_(segments=(2, 3))
        genome = wl.Genome.parse(GENOME).within(few.robot)
        assert page_data([genome], few)["models"].keys() == {"11", "011", "101", "110", "111"}


class TestThePage:
    def test_labels_with_html_stay_text(self):
        hostile = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
        plain, attacked = (Links(wl.playground({name: GENOME}, SHORT).page) for name in ("Ada", hostile))
        assert attacked.scripts == plain.scripts
        assert attacked.loads == plain.loads == []

    def test_the_snapshot_is_the_preview_image(self):
        [picture] = assert_harmless(wl.playground({"<b>Ada</b>": GENOME}, SHORT).snapshot()).all("img")
        assert picture["src"].startswith("data:image/png;base64,")
        assert "<b>Ada</b>" in picture["alt"]

    def test_the_page_is_not_in_the_state_that_a_notebook_saves(self):
        assert len(repr(wl.playground(GENOME, SHORT).get_state())) < 200_000


# ---------------------------------------------------------------------------------------------- in a browser

MEASURE = """() => { // walks from the start to the end of the measured walk
    walkerlab.pause();
    walkerlab.applyChanges(); // may build the walk again, from another model
    const walk = walkerlab.walks[0];
    walk.restart();
    walk.settleNow();
    while (!walk.verdict) walk.step();
    walk.stepLevelWalk(Infinity);
    return { time: walk.trace.time, com: walk.trace.com, distance: walk.distance, verdict: walk.verdict.name };
}"""

IS_CHANGED = "number => walkerlab.walks[number].isChanged || walkerlab.walks[number].isOutdated"
APPLY = "walkerlab.applyChanges()"  # otherwise changes are applied with the next frame, which may take long

NAMELESS = """() => [...document.querySelectorAll("button, input, select, textarea, summary")]
    .filter((node) => !(node.ariaLabel || node.closest("label")?.textContent || node.textContent).trim())
    .map((node) => node.outerHTML)"""


def assert_same_walk(measured, genome, settings):
    walk = wl.simulate(genome, settings, poses=False)
    assert measured["verdict"] == walk.verdict
    assert measured["time"] == pytest.approx(walk.time.tolist())
    assert np.abs(np.array(measured["com"]) - walk.com).max() < 1e-3  # m
    assert measured["distance"] == pytest.approx(walk.distance, abs=1e-3)


def slider(page, name):
    index = page.evaluate(f"geneIndex(walkerlab.page, '{name}', 0)")
    return page.locator(f'input[data-gene="{index}"]')


def test_a_file_walks_as_in_python_while_genes_and_world_change(page, tmp_path):
    path = wl.playground(GENOME, SHORT).to_html(tmp_path / "walk.html")
    assert path.stat().st_size < 5e6
    page.set_viewport_size({"width": 390, "height": 844})
    open_file(page, path)
    page.wait_for_function("walkerlab.walks[0].time > 0.1", timeout=30_000)
    assert page.evaluate(NAMELESS) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert page.evaluate("document.querySelector('.transport').scrollWidth") <= 390
    assert_same_walk(page.evaluate(MEASURE), GENOME, SHORT)

    # A gene of the gait changes the walk at once.
    before = page.evaluate("walkerlab.walks[0].gait[0].amplitude")
    slider(page, "hip_amplitude").fill("20")
    page.evaluate(APPLY)
    assert page.evaluate("walkerlab.walks[0].gait[0].amplitude") == pytest.approx(math.radians(20), abs=1e-3) != before
    assert page.evaluate(IS_CHANGED, 0)
    page.evaluate(
        "walkerlab.restart(); walkerlab.pause(); while (!walkerlab.walks[0].verdict) walkerlab.walks[0].step()"
    )
    slider(page, "hip_amplitude").fill("25")
    page.evaluate(APPLY)
    page.evaluate("walkerlab.draw(0)")
    verdict = page.locator(".verdict")
    assert "Press Restart" in verdict.inner_text(), "the result is that of the earlier gait"

    # A changed slider shows its original value, and everything can be undone; the new walk is compared with the last.
    result = page.evaluate("walkerlab.walks[0].distance")
    undo = page.get_by_role("button", name="Undo all changes")
    page.locator(".world summary").click()  # closed on a phone, so that the gait is in view
    page.get_by_label("Planet, which sets the gravity").select_option("moon")
    page.evaluate(APPLY)
    assert page.locator(".slider .was:not(:empty)").all_inner_texts() == ["was 9.81", "was 17°"]
    undo.click()
    page.evaluate(f"{APPLY}; for (let i = 0; i < 5; i++) walkerlab.walks[0].step(); walkerlab.draw(0)")
    assert (page.locator(".slider.changed").count(), undo.is_disabled()) == (0, True)
    assert page.evaluate("walkerlab.state.world.gravity") == [0, 0, -9.81]
    assert page.evaluate("walkerlab.genome") == str(wl.Genome.parse(GENOME).within(SHORT.robot))
    assert verdict.inner_text().replace("\u00a0", " ") == f"The walk is measured for 2 s. Before: {result:.2f} m."
    assert_same_walk(page.evaluate(MEASURE), GENOME, SHORT)

    # Genes of the body are limited by the settings, and the copied text walks as the page does, on the moon, on ice.
    page.locator(".body summary").click()
    slider(page, "leg_length").fill("0.2")
    slider(page, "mass").fill(slider(page, "mass").get_attribute("max"))
    page.evaluate(APPLY)
    assert "require" in page.locator(".message").inner_text()
    page.get_by_label("Planet, which sets the gravity").select_option("moon")
    page.get_by_label("Material of the ground, which sets the friction").select_option("ice")
    page.locator(".text summary").click()
    text = page.get_by_label("Genome as text", exact=True).input_value()
    genome = wl.Genome.parse(text)
    assert np.array_equal(genome.within(SHORT.robot).values, genome.values)
    page.evaluate(APPLY)
    assert page.locator(".changes code").inner_text() == 'settings.with_(gravity="moon", texture="ice")'
    assert_same_walk(page.evaluate(MEASURE), genome, SHORT.with_(gravity="moon", texture="ice"))

    # A text can be pasted, of another body plan too; a faulty text is rejected with the same message.
    other = next(
        drawn
        for seed in range(100)
        if (drawn := wl.Genome.random(SHORT.robot, rng=np.random.default_rng(seed)))
        and wl.express(drawn).plan == (True, False, True)
    )
    page.get_by_label("Genome as text", exact=True).fill(str(other))
    page.get_by_role("button", name="Use this text").click()
    assert_same_walk(page.evaluate(MEASURE), other, SHORT.with_(gravity="moon", texture="ice"))
    page.evaluate("text => walkerlab.setGenome(text)", GENOME)
    assert page.evaluate("walkerlab.genome") == str(wl.Genome.parse(GENOME).within(SHORT.robot))
    for faulty in FAULTY_TEXTS:
        with pytest.raises(wl.GenomeError) as rejected:
            wl.Genome.parse(faulty)
        page.evaluate("text => walkerlab.setGenome(text)", faulty)
        assert page.locator(".error").text_content() == str(rejected.value)
    assert page.evaluate("walkerlab.genome") == str(wl.Genome.parse(GENOME).within(SHORT.robot))


def test_a_race_with_loads_on_stairs_walks_as_in_python_and_can_be_pushed(page, tmp_path):
    robots = {"Ada": GENOME, "Bea": GENOME.replace("frequency=1.2", "frequency=0.8", 1)}
    assert robots["Ada"] != robots["Bea"]
    bea = str(wl.Genome.parse(robots["Bea"]).within(STAIRS.robot))
    open_file(page, wl.playground(robots, STAIRS, camera="chase").to_html(tmp_path / "race.html"))
    page.wait_for_function("walkerlab.walks[1].time > 0.1", timeout=30_000)
    assert len(set(page.evaluate("walkerlab.walks.map((walk) => walk.time)"))) == 1
    assert "Bea" in page.locator(".score").inner_text()
    assert_same_walk(page.evaluate(MEASURE), GENOME, STAIRS)
    page.get_by_label("Robot whose genes are shown").select_option("Bea")
    assert page.evaluate("walkerlab.genome") == bea
    page.get_by_label("Speed").select_option("0.1×")  # so that the walk is still being measured on a busy computer
    page.get_by_role("button", name="Restart").click()
    page.get_by_role("button", name="Push the robot from the side").click()
    before = page.evaluate("walkerlab.walks[1].data.qpos[1]")
    page.evaluate(
        "for (let i = 0; i < 60; i++) { walkerlab.pusher.apply(walkerlab.walks[1], 1); walkerlab.walks[1].step(); }"
    )
    assert page.evaluate("walkerlab.walks[1].data.qpos[1]") - before > 0.05
    assert page.evaluate(IS_CHANGED, 1)

    # Without DecompressionStream, a sentence says which browser can run the page.
    page.add_init_script("delete window.DecompressionStream")
    page.reload()
    page.get_by_text("lacks DecompressionStream or WebAssembly").wait_for(timeout=20_000)
