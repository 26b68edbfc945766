"""Controls of the tuning page: a slider, checkbox, dropdown or text field for each parameter, grouped by stage."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from spigolo.view.tuning_fields import MAIN, Leaf, Part, Range, Stage, Variants, range_of
from spigolo.view.tuning_values import Values

if TYPE_CHECKING:
    import viser


class Controls:
    """Controls of all parameters on a tuning page.

    - gui: interface of the page.
    - values: values of all parameters.
    - changed: function that is called with the key and the new value of a changed control. The new value is None if a
      rule was switched off, and True or False if a stage was switched on or off.
    """

    def __init__(self, gui: viser.GuiApi, values: Values, changed: Callable[[str, Any], None]) -> None:
        self._gui, self._values, self._changed = gui, values, changed
        self.handles: dict[str, list[Any]] = defaultdict(list)
        """Controls of all parameters, indexed by key. The dict also contains the dropdowns that select one of several
        alternative classes, such as the cost function.
        """
        self.switches: dict[str, list[Any]] = defaultdict(list)
        """Checkboxes that switch optional parameters and stages on or off, indexed by key."""
        self._folders: dict[str, Any] = {}
        with gui.add_folder("main"):
            for path, label in MAIN.items():
                part = values.parts[path]
                assert isinstance(part, Leaf)
                self._add_leaf(part, label, switch=False)
        for part in values.tree.parts:
            self._add(part)
        self.refresh()

    def refresh(self) -> None:
        """Show the current values of all parameters, and adapt the ranges of the sliders."""
        for key, handles in self.handles.items():
            part, value = self._values.parts[key], self._values.of[key]
            for handle in handles:
                if isinstance(part, Leaf) and part.kind in ("number", "integer"):
                    _set_range(handle, range_of(part, value), value)
                else:
                    handle.value = _text(value)
        self.follow()

    def follow(self, moved: Any = None) -> None:
        """Show which stages are switched on. If a parameter has two controls, set both controls to the same value.

        moved: control that the user is moving, which is not changed.
        """
        for key, switches in self.switches.items():
            for switch in switches:
                _assign(switch, "value", self._values.on[key])
        for key, handles in self.handles.items():
            on = self._values.on.get(key, True)
            for k, handle in enumerate(handles):
                if handle is not moved and len(handles) > 1 and isinstance(self._values.parts[key], Leaf):
                    _assign(handle, "value", self._values.of[key])
                twin = key in MAIN and k == 0
                _assign(handle, "disabled", twin and not (on and self._values.active(key)))
                _assign(handle, "visible", twin or on)
        for key, folder in self._folders.items():
            _assign(folder, "visible", self._is_shown(key))

    def _is_shown(self, key: str) -> bool:
        around, variant, _ = key.rpartition("[")
        if variant and key.endswith("]"):
            stages = self._values.parts[around]
            assert isinstance(stages, Variants)
            return stages.stages[self._values.of[around]].key == key
        return self._values.on.get(key, True)

    def _add(self, part: Part) -> None:
        if isinstance(part, Leaf):
            self._add_leaf(part, part.label)
        elif isinstance(part, Variants):
            with self._gui.add_folder(part.label, expand_by_default=False):
                self._add_choice(part.key, "function", tuple(part.stages), part.help)
                for stage in part.stages.values():
                    self._add_stage(stage)
        else:
            self._add_stage(part)

    def _add_stage(self, stage: Stage) -> None:
        with self._gui.add_folder(stage.label, expand_by_default=False):
            if stage.optional:
                self._add_switch(stage.key, "on", stage.help)
            with self._gui.add_folder(None) as inside:
                self._folders[stage.key] = inside
                for part in stage.parts:
                    self._add(part)

    def _add_leaf(self, leaf: Leaf, label: str, switch: bool = True) -> None:
        if leaf.optional and switch:
            self._add_switch(leaf.key, label, leaf.help)
        value = self._values.of[leaf.key]
        if leaf.kind == "switch":
            handle: Any = self._gui.add_checkbox(label, bool(value), hint=leaf.help)
        elif leaf.kind == "choice":
            self._add_choice(leaf.key, label, leaf.choices, leaf.help)
            return
        elif leaf.kind == "list":
            handle = self._gui.add_text(label, _text(value), hint=leaf.help)
        else:
            span = range_of(leaf, value)
            handle = self._gui.add_slider(label, span.low, span.high, span.step, _within(value, span), hint=leaf.help)
        self.handles[leaf.key].append(handle)
        handle.on_update(lambda event: self._take(leaf.key, event.target))

    def _add_choice(self, key: str, label: str, choices: tuple[str | int, ...], text: str) -> None:
        handle = self._gui.add_dropdown(
            label, tuple(map(str, choices)), initial_value=str(self._values.of[key]), hint=text
        )
        self.handles[key].append(handle)
        handle.on_update(lambda event: self._take(key, event.target))

    def _add_switch(self, key: str, label: str, text: str) -> None:
        handle = self._gui.add_checkbox(label, self._values.on[key], hint=text)
        self.switches[key].append(handle)
        handle.on_update(lambda event: self._switch(key, event.target))

    def _switch(self, key: str, handle: Any) -> None:
        if self._values.on[key] == handle.value:
            return  # the checkbox was set by `follow`
        stage = isinstance(self._values.parts[key], Stage)
        self._changed(key, handle.value if stage else self._values.of[key] if handle.value else None)
        self.follow(handle)

    def _take(self, key: str, handle: Any) -> None:
        part = self._values.parts[key]
        value = handle.value
        if isinstance(part, Leaf):
            value = _typed(part, value)
            if not self._values.on.get(key, True):
                return
        if value != self._values.of[key]:
            self._changed(key, value)
            self.follow(handle)


def _set_range(handle: Any, span: Range, value: float) -> None:
    for name in ("min", "max", "step"):
        _assign(handle, name, getattr(span, name if name == "step" else {"min": "low", "max": "high"}[name]))
    _assign(handle, "value", _within(value, span))


def _within(value: float, span: Range) -> float:
    return min(max(value, span.low), span.high)


def _assign(handle: Any, name: str, value: Any) -> None:
    """Set a property of a control, unless it already has the value. Only changes are then sent to the browser."""
    if getattr(handle, name) != value:
        setattr(handle, name, value)


def _text(value: Any) -> Any:
    """Convert the value of a parameter to the value of its control. Lists and choices are converted to text."""
    if isinstance(value, tuple | list):
        return ", ".join(f"{v:g}" for v in value)
    return value if isinstance(value, bool) else str(value)


def _typed(leaf: Leaf, value: Any) -> Any:
    """Convert the value of a control to the type of its parameter. Text that is not a list of numbers is returned
    unchanged.
    """
    if leaf.kind == "choice":
        return next(choice for choice in leaf.choices if str(choice) == value)
    if leaf.kind == "list":
        words = value.replace(",", " ").split()
        try:
            return tuple(int(word) if word.lstrip("-").isdecimal() else float(word) for word in words)
        except ValueError:
            return value
    return int(value) if leaf.kind == "integer" else value
