"""The form: a control for each setting, and beside them what cannot be."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, cast

import traitlets

from walkerlab.settings.glossary import rows_of
from walkerlab.settings.model import Domain, SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import did_you_mean, function_name
from walkerlab.text.html import Html, join, table, tag
from walkerlab.widgets.component import Part, script, style
from walkerlab.widgets.controls import OWN, PLACE, controls_of, idle, in_words, label
from walkerlab.widgets.presets import PRESETS, worlds

Named = dict[str, Any]
"""Things by their name."""

KINDS: dict[str, type[Domain]] = {name: type(field.default) for name, field in Settings.model_fields.items()}


class Form(Part):
    """Settings to be moved: what its controls say is ``settings``, and setting that moves the controls.

    Of a combination that cannot be, the message stands beside the fields that it names, and ``settings`` is None until
    it is mended. A function of the user's own is one more choice of its slot.

        form = Form(only=["structure", "step_height"])
        form.observe(lambda change: print(change.new), "settings")
    """

    title = "form"
    _esm = script("controls", "form")
    _css = style("form")

    settings = traitlets.Instance(Settings, allow_none=True)
    fault = traitlets.Unicode("")

    tabs = traitlets.Any([]).tag(sync=True)
    values = traitlets.Any({}).tag(sync=True)
    faults = traitlets.Any({}).tag(sync=True)
    idle = traitlets.Any({}).tag(sync=True)
    presets = traitlets.Any([]).tag(sync=True)
    preset = traitlets.Any("").tag(sync=True)

    def __init__(self, settings: Settings | None = None, only: Sequence[str] = ()) -> None:
        """Make a form.

        Args:
            settings: what its controls say at first; the defaults if None.
            only: the domains (``"terrain"``) and single settings (``"step_height"``, ``"terrain_seed"``) to be shown;
                all if none is named. The others keep their values.

        Raises:
            ValueError: if there is no setting of such a name.
        """
        self._shown = _places([only] if isinstance(only, str) else only)
        self._own: dict[tuple[str, str], Named] = {}
        self._worlds = worlds({domain for domain in KINDS if self._shown[domain] == _fields(domain)})
        self._last = settings or Settings()
        super().__init__(presets=[{"name": name, "about": PRESETS[name].about} for name in self._worlds])
        self._show(self._last)

    def set_state(self, sync_data: Named) -> None:
        """Hear from a browser what is its to say: no more than the values, and the name of a preset."""
        super().set_state({name: said for name, said in sync_data.items() if name in ("values", "preset")})

    def snapshot(self) -> Html:
        """Write the settings that are shown as static HTML, a table to a domain."""
        tables = tag("div", *map(self._table, self._last), class_="beside")
        return join(tables, tag("p", self.fault)) if self.fault else tables

    def _table(self, named: tuple[str, Domain]) -> Html:
        """Write the shown settings of a domain: those that differ from the default are bold and marked."""
        name, domain = named
        rows = [row for row in rows_of(domain) if row.name in self._shown[name]]
        lines = ([f"● {label(row.name)}" if row.changed else label(row.name), row.value] for row in rows)
        strong = ["strong" if row.changed else "" for row in rows]
        caption = f"{name.capitalize()} (● differs from the default)" if any(strong) else name.capitalize()
        return table(caption, ("setting", "value"), lines, classes=strong) if rows else Html("")

    @traitlets.validate("values")
    def _whole(self, proposal: Any) -> dict[str, Named]:
        """Keep what is not said as it was, and leave out what there is no setting for: a browser may send anything."""
        said: Any = proposal.value
        given = {name: said[name] if isinstance(said, Mapping) and name in said else {} for name in KINDS}
        self._plain = {
            name: {
                field: fields[field] if isinstance(fields, Mapping) and field in fields else kept
                for field, kept in self._plain[name].items()
            }
            for name, fields in given.items()
        }
        return self._plain

    @traitlets.observe("settings")
    def _move(self, change: Any) -> None:
        """Move the controls to settings that someone else has set."""
        if change.new is not None and change.new != self._read()[0]:
            self._show(change.new)

    @traitlets.observe("values")
    def _hear(self, _change: object = None) -> None:
        """Take in what the controls say, be it settings or not."""
        settings, fault = self._read()
        self._last = settings or self._last
        self.faults, self.idle, self.fault = _beside(fault), idle(self.values), fault
        self.settings = settings
        self.preset = self._world()

    @traitlets.observe("preset")
    def _go(self, change: Any) -> None:
        """Go to the world that was chosen, if there is one of the name."""
        world = self._worlds.get(change.new, {}) if isinstance(change.new, str) else {}
        if change.new != self._world() and world:
            self.settings = self._last.with_(**world)
        self.preset = self._world()

    def _world(self) -> str:
        """Name the preset that the settings are; "" if they are none."""
        settings = self.settings
        same = (
            name
            for name, world in self._worlds.items()
            if all(getattr(settings, domain, None) == made for domain, made in world.items())
        )
        return next(same, "")

    def _show(self, settings: Settings) -> None:
        """Move every control to what settings say."""
        values = settings.model_dump()
        for domain, field, value in _each(settings):
            if any(map(callable, _several(value))):
                values[domain][field] = self._name(domain, field, value)
        self._plain = values
        self.tabs = self._tabs()
        if self.values == values:  # a function has been replaced by another of its name
            self._hear()
        self.values = values

    def _read(self) -> tuple[Settings | None, str]:
        """Return the settings that the controls say, or None and why they cannot be."""
        said = {
            domain: {field: self._meant(domain, field, value) for field, value in fields.items()}
            for domain, fields in self.values.items()
        }
        try:
            return Settings.model_validate(said), ""
        except SettingsError as error:
            return None, str(error)

    def _meant(self, domain: str, field: str, value: Any) -> Any:
        """Return the function of the user's own that a name stands for; all else as it is."""
        if isinstance(value, list):
            return [self._meant(domain, field, one) for one in cast(list[Any], value)]
        own = self._own.get((domain, field), {})
        return own.get(value, value) if isinstance(value, str) else value

    def _name(self, domain: str, field: str, value: Any) -> Any:
        """Name the functions among what fills a slot, and remember them by that name."""
        named: Named = {}

        def name(one: Any) -> str:
            if not callable(one):
                return one.name
            ways = (f"{OWN}{function_name(one)}{'′' * n}" for n in range(len(named) + 1))  # two may share a name
            free = next(way for way in ways if named.get(way, one) is one)
            named[free] = one
            return free

        names = [name(one) for one in _several(value)]
        self._own[domain, field] = self._own.get((domain, field), {}) | named
        return names if isinstance(value, tuple) else names[0]

    def _tabs(self) -> list[Named]:
        """Return the controls to be shown, by domain."""
        tabs: list[Named] = []
        for domain, kind in KINDS.items():
            own = {field: list(named) for (of, field), named in self._own.items() if of == domain}
            controls = [control for control in controls_of(kind, own) if control["name"] in self._shown[domain]]
            about = kind.summary()
            if controls:
                tabs.append({"domain": domain, "title": domain, "about": about, "controls": controls})
        return tabs


def _places(only: Iterable[str]) -> dict[str, list[str]]:
    """Return the fields of each domain that are to be shown, in their order."""
    places = Settings.places()
    wanted = set(only) or set(KINDS)
    for name in sorted(wanted - {*places, *KINDS}):
        raise ValueError(f"there is no setting {name!r} to be shown.{did_you_mean(name, [*KINDS, *places])}")
    return {
        domain: [field for name, (of, field) in places.items() if of == domain and (domain in wanted or name in wanted)]
        for domain in KINDS
    }


def _fields(domain: str) -> list[str]:
    return list(KINDS[domain].model_fields)


def _several(value: Any) -> tuple[Any, ...]:
    return cast(tuple[Any, ...], value) if isinstance(value, tuple) else (value,)


def _each(settings: Settings) -> Iterable[tuple[str, str, Any]]:
    """Yield each single setting: its domain, its field and its value."""
    return ((domain, field, value) for domain, fields in settings for field, value in fields)


def _beside(fault: str) -> dict[str, str]:
    """Put each sentence beside the fields that it names: {"terrain.step_height": "Step height is …"}."""
    beside: dict[str, list[str]] = {}
    for line in fault.splitlines():
        for domain, field in PLACE.findall(line):
            if field in _fields(domain.lower()):
                sentences = beside.setdefault(f"{domain.lower()}.{field}", [])
                sentences += [in_words(line)] * (in_words(line) not in sentences)
    return {place: "\n".join(sentences) for place, sentences in beside.items()}
