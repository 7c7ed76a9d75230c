"""Immutable objects: attributes that cannot be assigned, and arrays that stay read-only in copies."""

from dataclasses import fields
from typing import Any, ClassVar

import numpy as np

from walkerlab.system.errors import WalkerlabError


class ReadOnlyError(WalkerlabError, AttributeError):
    """An assignment to a read-only attribute; the message says what to do instead."""


class ReadOnlyProperties:
    """Base of classes whose properties cannot be assigned or deleted.

    Attributes:
        INSTEAD: For each property, why it is read-only and what to do instead; as sentences for the error message.
    """

    INSTEAD: ClassVar[dict[str, str]] = {}

    def __setattr__(self, name: str, value: object) -> None:
        """Assign an attribute that is not a property.

        Raises:
            ReadOnlyError: If it is a property.
        """
        self._require_writable(name)
        super().__setattr__(name, value)

    def __delattr__(self, name: str) -> None:
        """Delete an attribute that is not a property.

        Raises:
            ReadOnlyError: If it is a property.
        """
        self._require_writable(name)
        super().__delattr__(name)

    def _require_writable(self, name: str) -> None:
        if isinstance(getattr(type(self), name, None), property):
            raise ReadOnlyError(f"{type(self).__name__}.{name} is read-only. {self.INSTEAD.get(name, '')}".rstrip())


class ReadOnlyArrays:
    """Base of dataclasses whose arrays are read-only, even in copies and after unpickling."""

    def __post_init__(self) -> None:
        """Make each array read-only."""
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy through the constructor, because numpy makes the copy of a read-only array writable."""
        return type(self), tuple(getattr(self, field.name) for field in fields(self))  # type: ignore[arg-type]
