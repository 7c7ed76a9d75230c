"""The form: a control for each setting, with messages about invalid values next to them."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, cast

import traitlets

from walkerlab.settings.classroom import require_fixed_values
from walkerlab.settings.glossary import glossary_rows
from walkerlab.settings.model import Domain, SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import did_you_mean, function_name
from walkerlab.text.templates import Markup, render
from walkerlab.widgets.component import Component, load_script, load_style
from walkerlab.widgets.controls import (
    FUNCTION_PREFIX,
    SETTING_NAME,
    make_controls,
    setting_label,
    unused_settings,
    use_labels,
)
from walkerlab.widgets.presets import FormPreset, choose_presets

NamedValues = dict[str, Any]
"""Values, keyed by name."""

DOMAINS: dict[str, type[Domain]] = {name: type(field.default) for name, field in Settings.model_fields.items()}


class Form(Component):
    """Controls for settings; ``settings`` follows the controls, and setting it changes them.

    While values are invalid, messages are shown next to the settings that they name, and ``settings`` is None. A user
    function in the initial settings is an additional option of its control.

        form = Form(only=["structure", "step_height"])
        form.observe(lambda change: print(change.new), "settings")
    """

    title = "form"
    _esm = load_script("controls", "form")
    _css = load_style("form")

    settings = traitlets.Instance(Settings, allow_none=True)
    fault = traitlets.Unicode("")

    tabs = traitlets.Any([]).tag(sync=True)
    values = traitlets.Any({}).tag(sync=True)
    faults = traitlets.Any({}).tag(sync=True)
    unused = traitlets.Any({}).tag(sync=True)
    presets = traitlets.Any([]).tag(sync=True)
    preset = traitlets.Any("").tag(sync=True)

    def __init__(
        self,
        settings: Settings | None = None,
        only: Sequence[str] = (),
        fixed: Mapping[str, str] | None = None,
        presets: Mapping[str, NamedValues] | None = None,
    ) -> None:
        """Create the form.

        Args:
            settings: Initial settings; the defaults if None.
            only: Names of the domains (``"terrain"``) and settings (``"step_height"``, ``"terrain_seed"``) to show;
                all if empty. The other settings keep their values.
            fixed: Reason for each setting that cannot be changed, by the name that ``Settings.with_`` takes; none if
                None.
            presets: Named worlds in the menu: by name, the settings that differ; the built-in ones if None.

        Raises:
            ValueError: If a name is unknown.
        """
        self._shown = _select_fields([only] if isinstance(only, str) else only)
        self._functions: dict[tuple[str, str], NamedValues] = {}  # user functions, keyed by field and name
        self._last_valid = settings or Settings()
        self._fixed = {Settings.field_locations()[name]: reason for name, reason in (fixed or {}).items()}
        complete = {domain for domain in DOMAINS if self._shown[domain] == _fields(domain)}
        self._presets = choose_presets(self._last_valid, presets, complete, fixed or {})
        super().__init__(presets=[{"name": name, "about": one.about} for name, one in self._presets.items()])
        self._show_settings(self._last_valid)

    def set_state(self, sync_data: NamedValues) -> None:
        """Accept only values and the name of a preset from the browser."""
        super().set_state({name: value for name, value in sync_data.items() if name in ("values", "preset")})

    def snapshot(self) -> Markup:
        """Return the shown settings as static HTML, with a table for each domain."""
        tables = [self._table(name, domain) for name, domain in self._last_valid if self._shown[name]]
        return render("widgets/form.html", tables=tables, fault=self.fault)

    def _table(self, name: str, domain: Domain) -> tuple[str, list[list[str]], list[str]]:
        """Return the caption, the cells and the class of each row of the shown settings of a domain."""
        rows = [row for row in glossary_rows(domain) if row.name in self._shown[name]]
        notes = [self._fixed.get((name, row.name), "") for row in rows]
        labels = [
            f"{setting_label(row.name, name)}{f' ({note})' if note else ''}"
            for row, note in zip(rows, notes, strict=True)
        ]
        cells = [[f"● {label}" if row.changed else label, row.value] for label, row in zip(labels, rows, strict=True)]
        return name.capitalize(), cells, ["strong" if row.changed else "" for row in rows]

    @traitlets.validate("values")
    def _complete(self, proposal: Any) -> dict[str, NamedValues]:
        """Replace missing and fixed values with the last ones, and remove unknown settings.

        A browser may send anything.
        """
        sent: Any = proposal.value
        given = {name: sent[name] if isinstance(sent, Mapping) and name in sent else {} for name in DOMAINS}
        self._last_values = {
            name: {
                field: fields[field]
                if isinstance(fields, Mapping) and field in fields and (name, field) not in self._fixed
                else last
                for field, last in self._last_values[name].items()
            }
            for name, fields in given.items()
        }
        return self._last_values

    @traitlets.validate("settings")
    def _keep_fixed(self, proposal: Any) -> Settings | None:
        """Reject settings in which a fixed one differs."""
        if proposal.value is not None:
            require_fixed_values(proposal.value, self._last_valid, self._fixed)
        return proposal.value

    @traitlets.observe("settings")
    def _update_controls(self, change: Any) -> None:
        """Update the controls to settings that were set from outside."""
        if change.new is not None and change.new != self._read_controls()[0]:
            self._show_settings(change.new)

    @traitlets.observe("values")
    def _update_settings(self, _change: object = None) -> None:
        """Update settings and messages from the values of the controls, valid or not."""
        settings, fault = self._read_controls()
        self._last_valid = settings or self._last_valid
        self.faults = _faults_by_setting(fault)
        self.unused = unused_settings(self.values)
        self.fault = fault
        self.settings = settings
        self.preset = self._current_preset()

    @traitlets.observe("preset")
    def _apply_preset(self, change: Any) -> None:
        """Change the settings to the selected preset, if it exists."""
        preset = self._presets.get(change.new) if isinstance(change.new, str) else None
        if change.new != self._current_preset() and preset:
            self.settings = self._last_valid.with_(**preset.settings)
        self.preset = self._current_preset()

    def _current_preset(self) -> str:
        """Return the name of the preset with the same effect as the settings; "" for other settings."""
        settings: Any = self.settings
        if not settings:
            return ""

        locations = Settings.field_locations()

        def is_current(preset: FormPreset) -> bool:
            return all(
                getattr(getattr(settings, domain), field) == value
                for (domain, field), value in ((locations[name], value) for name, value in preset.settings.items())
                if f"{domain}.{field}" not in self.unused
            )

        return next((name for name, preset in self._presets.items() if is_current(preset)), "")

    def _show_settings(self, settings: Settings) -> None:
        """Update all controls to settings."""
        values = settings.model_dump()
        for domain, field, value in _all_values(settings):
            if any(map(callable, _as_tuple(value))):
                values[domain][field] = self._name_functions(domain, field, value)
        self._last_values = values
        self.tabs = self._make_tabs()
        if self.values == values:  # a function was replaced by another one with the same name
            self._update_settings()
        self.values = values

    def _read_controls(self) -> tuple[Settings | None, str]:
        """Return the settings of the controls and "", or None and the error message."""
        values = {
            domain: {field: self._replace_names(domain, field, value) for field, value in fields.items()}
            for domain, fields in self.values.items()
        }
        try:
            return Settings.model_validate(values), ""
        except SettingsError as error:
            return None, str(error)

    def _replace_names(self, domain: str, field: str, value: Any) -> Any:
        """Replace the names of user functions in a value with the functions."""
        if isinstance(value, list):
            return [self._replace_names(domain, field, item) for item in cast(list[Any], value)]
        functions = self._functions.get((domain, field), {})
        return functions.get(value, value) if isinstance(value, str) else value

    def _name_functions(self, domain: str, field: str, value: Any) -> Any:
        """Replace the user functions in a value with names, and remember the functions by name."""
        named: NamedValues = {}

        def name(choice: Any) -> str:
            if not callable(choice):
                return choice.name
            base = f"{FUNCTION_PREFIX}{function_name(choice)}"
            candidates = (f"{base}{'′' * n}" for n in range(len(named) + 1))  # several functions may share a name
            unused = next(candidate for candidate in candidates if named.get(candidate, choice) is choice)
            named[unused] = choice
            return unused

        names = [name(choice) for choice in _as_tuple(value)]
        self._functions[domain, field] = self._functions.get((domain, field), {}) | named
        return names if isinstance(value, tuple) else names[0]

    def _make_tabs(self) -> list[NamedValues]:
        """Return the shown controls grouped by domain, as plain data."""
        tabs: list[NamedValues] = []
        for domain, domain_class in DOMAINS.items():
            functions = {field: list(named) for (other, field), named in self._functions.items() if other == domain}
            shown = self._shown[domain]
            all_controls = make_controls(domain_class, functions)
            controls = [
                control | {"fixed": self._fixed.get((domain, control["name"]), "")}
                for control in all_controls
                if control["name"] in shown
            ]
            if controls:
                about = domain_class.summary() if len(controls) == len(all_controls) else ""
                tabs.append({"domain": domain, "title": domain, "about": about, "controls": controls})
        return tabs


def _select_fields(only: Iterable[str]) -> dict[str, list[str]]:
    """Return the fields of each domain that are shown, in the order of their declaration."""
    locations = Settings.field_locations()
    wanted = set(only) or set(DOMAINS)
    for name in sorted(wanted - {*locations, *DOMAINS}):
        raise ValueError(f"there is no setting {name!r}.{did_you_mean(name, [*DOMAINS, *locations])}")
    return {
        domain: [
            field
            for name, (other, field) in locations.items()
            if other == domain and (domain in wanted or name in wanted)
        ]
        for domain in DOMAINS
    }


def _fields(domain: str) -> list[str]:
    return list(DOMAINS[domain].model_fields)


def _as_tuple(value: Any) -> tuple[Any, ...]:
    return cast(tuple[Any, ...], value) if isinstance(value, tuple) else (value,)


def _all_values(settings: Settings) -> Iterable[tuple[str, str, Any]]:
    """Return the domain, the field and the value of each setting."""
    return ((domain, field, value) for domain, fields in settings for field, value in fields)


def _faults_by_setting(fault: str) -> dict[str, str]:
    """Group the lines of an error message by the settings that they name.

    Returns:
        Sentences, keyed by setting: ``{"terrain.step_height": "Step height is …"}``.
    """
    found: dict[str, list[str]] = {}
    for line in fault.splitlines():
        sentence = use_labels(line)
        for domain, field in SETTING_NAME.findall(line):
            if field in _fields(domain.lower()):
                sentences = found.setdefault(f"{domain.lower()}.{field}", [])
                if sentence not in sentences:
                    sentences.append(sentence)
    return {setting: "\n".join(sentences) for setting, sentences in found.items()}
