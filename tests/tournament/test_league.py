"""A league ranks what is valid, lists what is not, and gives the same result in any order and on any executor."""

import os
import re
from concurrent.futures import ThreadPoolExecutor
from html.parser import HTMLParser

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.__main__ import main
from walkerlab.commands.worlds import WALKER_GENOME
from walkerlab.tournament.entries import MAX_NAME_LENGTH, MAX_TEXT_BYTES, read_entries
from walkerlab.tournament.seals import SealError

SETTINGS = wl.Settings().with_(duration=1)
HTML_NAME = "<img src=x onerror=alert(1)>"


def random_text(seed):
    return str(wl.Genome.random(SETTINGS.robot, rng=np.random.default_rng(seed)))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("class")
    for seed, name in enumerate(["Ada", "Bo", "Chen"]):
        (folder / f"{name}.txt").write_text(random_text(seed))
    (folder / "Twin.txt").write_text(random_text(0).replace(" | ", "\n| "))
    (folder / f"{HTML_NAME}.txt").write_text(random_text(9))
    (folder / f"{'x' * 90}.txt").write_text(random_text(10))
    invalid = {
        "empty.txt": b"",
        "blank.txt": b" \n",
        "two.txt": f"{WALKER_GENOME}\n{WALKER_GENOME}".encode(),
        "latin.txt": "wl2 größe".encode("latin-1"),
        "utf16.txt": WALKER_GENOME.encode("utf-16"),
        "binary.txt": b"wl2 \0\1",
        "big.txt": b" " * (MAX_TEXT_BYTES + 1),
        "heavy.txt": re.sub(r"mass=[\d.]+", "mass=400", WALKER_GENOME).encode(),
        "typo.txt": WALKER_GENOME.replace("duty", "duly").encode(),
        "fake.walk": b"SQLite format 3\0" + bytes(200),
        "page.html": b"<script>alert(1)</script>",
    }
    (folder / "ada.genome").write_text(WALKER_GENOME)
    for name, content in invalid.items():
        (folder / name).write_bytes(content)
    (folder / "run").mkdir()
    outside = tmp_path_factory.mktemp("outside") / "secret.txt"
    outside.write_text(WALKER_GENOME)
    os.symlink(outside, folder / "link.txt")
    if hasattr(os, "mkfifo"):
        os.mkfifo(folder / "pipe.txt")
    return folder


@pytest.fixture(scope="module")
def result(folder):
    with ThreadPoolExecutor(1) as executor:
        return wl.league(folder, SETTINGS, rounds=2, executor=executor, progress=False)


def test_files_that_are_not_one_genome_within_the_limits_are_listed_and_skipped(folder, result):
    taking_part = {standing.entry.name for standing in result.standings}
    reasons = {one.file: one.reason for one in result.skipped}
    assert len(taking_part) + len(reasons) == len(list(folder.iterdir()))
    assert {"Bo", "Chen", "Twin", HTML_NAME, "ada (1)", "Ada (2)"} <= taking_part
    expected = {
        "empty.txt": "empty", "blank.txt": "empty", "two.txt": "2 genomes", "latin.txt": "UTF-8", "utf16.txt": "UTF-16",
        "binary.txt": "binary", "big.txt": "bytes", "heavy.txt": "mass 400 kg is", "typo.txt": "expected 'duty=",
        "fake.walk": "not a run", "page.html": "must end in", "link.txt": "a link", "run": "a folder",
    }  # fmt: skip
    for file, reason in expected.items():
        assert reason in reasons.get(file, ""), file
    assert all(len(name) <= MAX_NAME_LENGTH for name in taking_part)


def test_the_ranking_depends_neither_on_the_order_nor_on_the_executor(folder, result):
    entries = {standing.entry.name: standing.entry.genome for standing in reversed(result.standings)}
    with ThreadPoolExecutor(3) as executor:
        again = wl.league(entries, SETTINGS, rounds=2, executor=executor, progress=False)
    assert again.table.equals(result.table)


def test_equal_printed_scores_share_a_rank_and_the_next_rank_is_left_out():
    genomes = {name: random_text(0) for name in ("B", "A")} | {"still": random_text(1)}
    with ThreadPoolExecutor(1) as executor:
        table = wl.league(genomes, SETTINGS, executor=executor, progress=False).table
    ranks = table.set_index("name")["rank"]
    assert ranks["A"] == ranks["B"]
    for _, row in table.iterrows():
        assert row["rank"] == 1 + (table.score > row.score).sum()


def test_the_score_is_the_median_of_the_confirmation_and_the_mean_of_the_rounds(result):
    for standing in result.standings:
        for ground, found in zip(result.grounds, standing.rounds, strict=True):
            assert found.score == max(0.0, np.median(np.maximum(found.confirmation.nudged, 0.0)))
            assert ground.terrain.seed - SETTINGS.terrain.seed in (0, 1)
        assert standing.score == pytest.approx(np.mean([found.score for found in standing.rounds]))
    first = result.standings[0]
    assert first.rounds[0].confirmation == wl.confirm(first.entry.genome, result.grounds[0])


class Scripts(HTMLParser):
    """Collects the elements and attributes that could run something."""

    def __init__(self):
        super().__init__()
        self.dangerous = []

    def handle_starttag(self, tag, attributes):
        self.dangerous += [tag] * (tag in ("script", "object", "embed"))
        self.dangerous += [name for name, _ in attributes if name.startswith("on")]
        if tag == "iframe":
            assert dict(attributes)["sandbox"] == "allow-scripts"


def test_the_page_runs_nothing_but_the_replay_and_reveals_the_seal(result, tmp_path):
    sealed = wl.seal(SETTINGS.with_(structure="stairs"))
    final = wl.League(result.standings[:2], result.skipped, [sealed.settings], sealed)
    page = final.save(tmp_path / "league.html").read_text(encoding="utf-8")
    parser = Scripts()
    parser.feed(page)
    assert parser.dangerous == []
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]
    assert "script-src 'unsafe-eval' 'sha256-" in policy.replace("&#39;", "'")
    assert "unsafe-inline" not in policy.partition("script-src")[2].partition(";")[0]
    assert sealed.shown_digest in page
    assert "stairs" in page
    board = result._repr_html_()
    assert HTML_NAME not in board
    assert "&lt;img src=x" in board


def test_a_seal_opens_only_with_the_settings_that_were_sealed(tmp_path):
    settings = SETTINGS.with_(structure="stairs", step_height=0.05)
    sealed = wl.seal(settings)
    file = sealed.save(tmp_path / "sealed.json")
    assert wl.open_seal(file, sealed.shown_digest.upper()).settings == settings
    assert wl.seal(settings).digest != sealed.digest  # the salt is random
    with pytest.raises(SealError, match="not those that were sealed"):
        wl.open_seal(file, wl.seal(settings).digest)
    file.write_text(file.read_text().replace("0.05", "0.06"))
    with pytest.raises(SealError, match="not those that were sealed"):
        wl.open_seal(file)
    with pytest.raises(SealError, match="function"):
        wl.seal(SETTINGS.with_(fitness=lambda rollout: rollout.distance))


def test_the_command_seals_and_an_invalid_request_says_what_to_do(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "settings.json").write_text('{"structure": "stairs", "step_height": 0.05}')
    assert main(["league", "--seal", "settings.json", "--out", "sealed.json"]) == 0
    digest = wl.open_seal("sealed.json").shown_digest
    assert digest in capsys.readouterr().out
    assert main(["league", "--seal", "settings.json", "--out", "sealed.json"]) == 2  # never overwritten
    (tmp_path / "settings.json").write_text('{"step_height": 9}')
    assert main(["league", "--seal", "settings.json", "--out", "other.json"]) == 2
    assert "between" in capsys.readouterr().err
    (tmp_path / "empty").mkdir()
    assert main(["league", "empty", "--quiet"]) == 2
    assert "no valid entry" in capsys.readouterr().err


def test_a_run_file_takes_part_with_its_champion(tmp_path):
    small = SETTINGS.with_(population_size=4, generations=1, n_elites=1)
    with ThreadPoolExecutor(1) as executor:
        run = wl.evolve(small, tmp_path / "Mia.walk", executor=executor, progress=False)
    entries, skipped = read_entries(tmp_path, SETTINGS.robot)
    assert not skipped
    assert [(entry.name, entry.genome) for entry in entries] == [("Mia", run.champion.genome)]
