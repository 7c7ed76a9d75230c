"""Seals: settings that are fixed before they are revealed, so that everybody can verify that they were not changed.

The digest is the SHA-256 of a random salt and the settings. A class notes it down before the tournament. Without the
salt, it does not help to guess the settings; with both, anybody can compute it again.
"""

import hashlib
import json
import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from walkerlab.settings.arguments import require_settings
from walkerlab.settings.model import MAX_JSON, SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import short_repr
from walkerlab.system.errors import WalkerlabError
from walkerlab.system.files import display_path, file_path, write_text
from walkerlab.text import strict_json

SALT_BYTES = 16
SALT_DIGITS = 2 * SALT_BYTES
SHOWN_GROUP = 8  # digits of a digest between two spaces


class SealError(WalkerlabError, ValueError):
    """A file with settings or a seal cannot be used, or the settings are not those that were sealed."""


@dataclass(frozen=True, repr=False)
class Seal:
    """Settings with the salt of their digest; displayed as the digest, which reveals neither.

    Attributes:
        settings: The sealed settings.
        salt: Random hexadecimal digits; secret until the settings are revealed.
    """

    settings: Settings
    salt: str

    @property
    def text(self) -> str:
        """The text whose SHA-256 is the digest: the salt, and each changed setting as JSON."""
        return f"{self.salt} {_to_json(self.settings)}"

    @property
    def digest(self) -> str:
        """SHA-256 of ``text``, as 64 hexadecimal digits."""
        return hashlib.sha256(self.text.encode()).hexdigest()

    @property
    def shown_digest(self) -> str:
        """The digest in groups of digits, which are easier to compare."""
        return " ".join(self.digest[i : i + SHOWN_GROUP] for i in range(0, len(self.digest), SHOWN_GROUP))

    def __repr__(self) -> str:
        """Return the digest, without the secret settings."""
        return f"Seal(digest {self.shown_digest})"

    def save(self, path: str | Path) -> Path:
        """Save the settings and the salt; keep the file secret until the tournament.

        Args:
            path: File to write; an existing file is replaced.

        Raises:
            OSError: If the file cannot be written.
        """
        path = file_path(path)
        content = {"digest": self.digest, "salt": self.salt, "settings": json.loads(_to_json(self.settings))}
        write_text(path, json.dumps(content, indent=2) + "\n")
        return path


def seal(settings: Settings) -> Seal:
    """Seal settings with a new random salt.

    Args:
        settings: Settings with built-in operators and fitness; a function cannot be sealed.

    Raises:
        SealError: If the settings contain a function of the user.
    """
    new = Seal(require_settings(settings), secrets.token_hex(SALT_BYTES))
    try:
        is_restored = _read_settings(json.loads(_to_json(settings)), "these settings") == settings
    except SettingsError:  # a function is written by its name, which is not a setting
        is_restored = False
    if not is_restored:
        raise SealError("these settings contain a function, which cannot be sealed; use built-in operators only")
    return new


def open_seal(path: str | Path, digest: str = "") -> Seal:
    """Read sealed settings, and check that they are those that were sealed.

    Args:
        path: File that ``Seal.save`` wrote.
        digest: Digest that was noted down, with or without spaces; if empty, that in the file.

    Raises:
        SealError: If the file is not a seal, or the digest differs.
    """
    content = _read_json(path)
    match content:
        case {"digest": str(stored), "salt": str(salt), "settings": dict(settings)} if len(content) == 3:
            name = display_path(file_path(path))
            opened = Seal(_read_settings(settings, name), salt)
        case _:
            raise SealError(
                f"{display_path(file_path(path))} is not a seal; make one with: walkerlab league --seal settings.json"
            )
    verify_seal(opened, stored)
    if digest:
        verify_seal(opened, digest)
    return opened


def verify_seal(opened: Seal, digest: str) -> None:
    """Check that settings are those of a digest that was noted down.

    Args:
        opened: Settings and salt, as revealed.
        digest: Hexadecimal digits, with or without spaces, in small or capital letters.

    Raises:
        SealError: If the digest differs.
    """
    noted = "".join(digest.split()).lower()
    if noted != opened.digest:
        raise SealError(
            f"the settings are not those that were sealed: their digest is {opened.shown_digest}, "
            f"and {short_repr(digest)} was noted down"
        )


def read_settings_file(path: str | Path) -> Settings:
    """Read settings from a JSON file: ``{"structure": "stairs", "step_height": 0.05}``.

    Args:
        path: File with an object of settings by the names that ``Settings.with_`` takes, or by domain.

    Raises:
        SealError: If the file cannot be read, or is not an object in JSON.
        SettingsError: If a setting is unknown or invalid.
    """
    content = _read_json(path)
    return _read_settings(content, display_path(file_path(path)))


def _to_json(settings: Settings) -> str:
    """Write each changed setting as JSON, in alphabetical order."""
    plain = settings.model_dump(mode="json")
    locations = Settings.field_locations()
    changed = {name: plain[locations[name][0]][locations[name][1]] for name in settings.changes()}
    return json.dumps(changed, sort_keys=True, ensure_ascii=True)


def _read_json(path: str | Path) -> Any:
    path = file_path(path)
    try:
        with path.open("rb") as file:
            data = file.read(MAX_JSON + 1)
        if len(data) > MAX_JSON:
            raise ValueError(f"it has more than {MAX_JSON:,} bytes")
        return strict_json.loads(data.decode("utf-8-sig"))
    except OSError as error:
        raise SealError(f"{display_path(path)} cannot be read: {error.strerror or error}") from error
    except (ValueError, RecursionError) as error:
        raise SealError(f"{display_path(path)} is not a JSON file with settings: {error}") from error


def _read_settings(content: Any, name: str) -> Settings:
    if not isinstance(content, dict):
        raise SealError(f'{name} must contain an object, as in {{"structure": "stairs"}}; got {short_repr(content)}')
    try:
        return Settings().with_(**content)
    except TypeError:  # a key such as "self"
        raise SettingsError(f"{name}: it has a key that is not the name of a setting") from None
    except SettingsError as error:
        raise SettingsError("\n".join(f"{name}: {line}" for line in str(error).splitlines())) from error
