"""JSON parser that raises an error if an object has the same key twice, instead of using the last value."""

import json
from typing import Any


class DuplicateKeyError(ValueError):
    """A key occurs more than once in a JSON object."""


def loads(text: str | bytes | bytearray) -> Any:
    """Parse JSON text.

    Raises:
        DuplicateKeyError: If a key occurs more than once in an object; the message names it.
        ValueError: If the text is not JSON.
        RecursionError: If it is nested too deeply.
    """
    return json.loads(text, object_pairs_hook=_without_duplicates)


def _without_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise DuplicateKeyError(
                f"the key {key!r:.60} occurs more than once, with {found[key]!r:.60} and {value!r:.60}"
            )
        found[key] = value
    return found
