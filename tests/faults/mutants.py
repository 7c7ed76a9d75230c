"""Mutated texts of genomes and settings for fuzzing; the same ``rng`` gives the same text."""

import json
import re
from contextlib import suppress
from copy import deepcopy

import numpy as np

from walkerlab.genome.genome import Genome
from walkerlab.settings.fields import MIN_MAX, OneOf
from walkerlab.settings.model import SettingsError
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings

WIDE_LIMITS = [Robot(segments=(n, n), body_length=(0.05, 8.0), legs=(2, 16)) for n in range(1, 9)]

NUMBERS = [
    *(
        "1e999",
        "-1e999",
        "1e308",
        "-1.7976931348623157e308",
        "5e-324",
        "1e-999",
        "1e5",
        "1e+5",
        "+5",
        ".5",
        "5.",
        "1.5",
    ),
    *("-0", "-0.0", "0", "1", "-1", "2147483648", "9007199254740993", "18446744073709551616", "00012", "1_000", "0x10"),
    *("NaN", "nan", "Infinity", "-Infinity", "inf", "true", "null", "١٢", "１２", "²"),
    *("9" * 4000, "9" * 4301, "0." + "1" * 4000, "1" + "0" * 400),
]
SPECIAL_TEXTS = [
    *"\0\a\b\t\n\r\x1b\x1c\x7f\x85\xa0\u2028\u2029\u200b\u200e\u202e\u2066\ufeff\ufffe\ud800\udfff\u0301",
    *" |=-\\\"'{}[],:<&é😀１ｗ",
    *("\x1b[31m", "\x1b]0;title\a", "\x1b[2J", "\r\n", "\\u0000", "\\ud800", "\\u202e", "\\x", "//", "/*"),
    *("<script>alert(1)</script>", "%s", "{0}", "{0.__class__}", "__import__('os').system('false')"),
]
WRONG_VALUES = [
    *(None, True, False, 0, -1, 1e308, float("nan"), float("inf"), 10**400),
    *("", "x", "rank", "moon", "1e5", "٣", "A" * 5000, "\x1b[31m", "\u202e", "\ud800"),
    *([], [[]], [None] * 3, [1, 2, 3], [0.1, 0.2], [2, 1], ["rank", "rank"], ["rank"] * 2000),
    *({}, {"x": 1}, {"min": 1, "max": 2}, {"__class__": "Robot"}),
    {"function": "os.system", "with": {"command": "false"}},
    {"function": "walkerlab.ga.selection.rank", "with": {}},
    {"function": "builtins.eval", "with": {}, "args": ["1/0"]},
]
HUGE = 10**6  # characters
VAST = 4 * 10**7  # characters


def genome_text(rng):
    """Return the text of a valid genome of 1 to 8 segments, in version 1 or 2 of the text form."""
    text = str(Genome.random(WIDE_LIMITS[rng.integers(8)], rng=rng))
    return text if rng.integers(2) else re.sub(r" (own|repeat)\b| (lag|duty)=\S+", "", text.replace("wl2", "wl1"))


def settings(rng):
    """Draw valid settings as plain data, complete or with some fields only."""
    drawn = {
        name: _domain(type(field.default), rng) for name, field in Settings.model_fields.items() if rng.random() < 0.9
    }
    return drawn if rng.random() < 0.5 else json.loads(Settings(**drawn).model_dump_json())


def _domain(kind, rng):
    while True:
        share = rng.random() ** 2
        drawn = {name: _value(declared, rng) for name, declared in kind.declared().items() if rng.random() < share}
        with suppress(SettingsError):
            kind(**drawn)
            return drawn


def _value(declared, rng):
    if isinstance(declared, OneOf):
        one = [*declared.choices][rng.integers(len(declared.choices))]
        one = one.name if rng.random() < 0.7 else int(one)
        return [one] * int(rng.integers(1, 4)) if declared.several and rng.random() < 0.3 else one
    if declared.presets and rng.random() < 0.3:
        return [*declared.presets][rng.integers(len(declared.presets))]
    drawn = rng.uniform(declared.low, declared.high, max(1, len(declared.components)))
    drawn = np.clip(np.round(drawn, 0 if declared.whole else rng.integers(1, 9)), declared.low, declared.high)
    plain = drawn.astype(int if declared.whole else float).tolist()
    return sorted(plain) if declared.components == MIN_MAX else plain if declared.components else plain[0]


def mutated(text, other, rng):
    """Apply 1 to 20 mutations to a text, mostly few, some with pieces of another text."""
    for _ in range(_draw_count(rng)):
        text = TEXT_MUTATIONS[rng.integers(len(TEXT_MUTATIONS))](text, other, rng)
    return text


def _draw_count(rng):
    return rng.integers(1, 3 if rng.random() < 0.7 else 21)


def with_long_piece(text, size, rng):
    """Insert a very long piece into a text."""
    start = rng.integers(len(text) + 1)
    piece = ["A", "9", " ", "[", '"', "|", "a=1 "][rng.integers(7)]
    return "".join([text[:start], piece * (size // len(piece)), text[start:]])


def with_wrong_values(plain, rng):
    """Replace 1 to 20 values or names in plain data by wrong ones, mostly few."""
    plain = deepcopy(plain)
    for _ in range(_draw_count(rng)):
        wrong = deepcopy(WRONG_VALUES[rng.integers(len(WRONG_VALUES))])
        locations = list(_locations(plain))
        if not locations or rng.random() < 0.02:
            return wrong
        container, key = locations[rng.integers(len(locations))]
        if isinstance(container, dict) and rng.random() < 0.3:
            container[_misspell(key, rng)] = container.pop(key)
        else:
            container[key] = wrong
    return plain


def _locations(plain):
    """Yield each dict and list in plain data with each of its keys."""
    for key in plain if isinstance(plain, dict) else range(len(plain)) if isinstance(plain, list) else ():
        yield plain, key
        yield from _locations(plain[key])


def _misspell(name, rng):
    misspelt = [
        name + "s",
        name[:-1],
        name.upper(),
        name + "\x1b[1m",
        "A" * 3000,
        "",
        SPECIAL_TEXTS[rng.integers(len(SPECIAL_TEXTS))],
    ]
    return misspelt[rng.integers(len(misspelt))]


def _span(text, rng, longest=40):
    start = rng.integers(len(text) + 1)
    return start, start + rng.integers(1, longest)


def _flip(text, _, rng):
    start, end = _span(text, rng, 3)
    return text[:start] + chr(rng.integers(0, 128 if rng.random() < 0.5 else 0x2FFF)) + text[end:]


def _insert(text, _, rng):
    start, _ = _span(text, rng)
    return text[:start] + SPECIAL_TEXTS[rng.integers(len(SPECIAL_TEXTS))] + text[start:]


def _delete(text, _, rng):
    start, end = _span(text, rng)
    return text[:start] + text[end:]


def _duplicate(text, _, rng):
    start, end = _span(text, rng, 200)
    return text[:end] + text[start:end] + text[end:]


def _swap(text, other, rng):
    start, end = _span(text, rng, 200)
    first, last = _span(other, rng, 200)
    return text[:start] + other[first:last] + text[end:]


def _tokens(text, _, rng):
    tokens = re.split(r"(\s+|[,:{}|])", text)
    i, j = rng.integers(len(tokens), size=2)
    match rng.integers(4):
        case 0:
            tokens[i] = ""
        case 1:
            tokens[i] *= 2
        case 2:
            tokens[i], tokens[j] = tokens[j], tokens[i]
        case _:
            tokens[i:i] = tokens[j : j + 4]
    return "".join(tokens)


def _number(text, _, rng):
    numbers = list(re.finditer(r"-?\d+(\.\d+)?", text))
    if not numbers:
        return text
    match = numbers[rng.integers(len(numbers))]
    return text[: match.start()] + NUMBERS[rng.integers(len(NUMBERS))] + text[match.end() :]


def _nest(text, _, rng):
    start, _ = _span(text, rng)
    depth = [2, 50, 190, 210, 2000][rng.integers(5)]
    opened, closed = [("[", "]"), ('{"robot":', "}"), ("(", ")")][rng.integers(3)]
    return text[:start] + opened * depth + closed * depth * int(rng.integers(2)) + text[start:]


def _repeat_keys(text, _, rng):
    pairs = re.findall(r'"\w+": ?[^,{}\[\]]+', text) or [text[:50]]
    several = ", ".join([pairs[rng.integers(len(pairs))]] * int(rng.integers(1, 5)))
    start = text.find(",", rng.integers(len(text) + 1))
    return f"{text[: start + 1]} {several}, {text[start + 1 :]}"


def _blanks(text, _, rng):
    return text.replace(" ", ["\n", "\t ", "\r\n", "\u3000", "\x1c", "  "][rng.integers(6)])


TEXT_MUTATIONS = [
    _flip, _insert, _delete, _duplicate, _swap, _tokens, _number, _number, _number, _nest, _repeat_keys, _blanks,
]  # fmt: skip
