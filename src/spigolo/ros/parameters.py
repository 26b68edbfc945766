"""ROS parameters of the node: the options of the node, and all fields of the segmentation configuration."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, Field

from spigolo.errors import ConfigError, SpigoloError
from spigolo.ros.kinds import Kinds
from spigolo.settings.config import Config
from spigolo.settings.fields import field_names, value_at, value_of_text
from spigolo.settings.parameters import NotNegative, Settings
from spigolo.settings.presets import OBJECTS, PRESETS, preset

FIXED = ("queue", "reliable")
"""Names of options that cannot change while the node runs."""
ON, OFF = "on", "none"
"""Values of a ROS parameter that switches a stage of the segmentation on or off."""


class Options(Settings):
    """Parameters of the node, in addition to the parameters of the segmentation method."""

    preset: str = "OBJECTS"
    """Preset: OBJECTS, SHELF, TABLE, CLUTTER or a TOML file. A new preset replaces the values of all parameters of the
    segmentation method.
    """
    continuous: bool = True
    """Segment every pair of colour and depth images. If false, segment only if the service `segment` is
    called or a point arrives on the topic `click`.
    """
    tolerance_s: NotNegative = 0.015
    """Maximum difference between the time stamps of a colour and a depth image that form a pair, in seconds. Choose a
    value below half of the time between two frames of the camera.
    """
    depth_scale: NotNegative = 0.0
    """Metres per unit of depth. With 0, integer depth is in millimetres and floating-point depth is in metres, as is
    standard in ROS.
    """
    rectified: bool = False
    """Treat the images as rectified. If true, use the matrix P of CameraInfo and ignore the distortion D."""
    ids: bool = False
    """Give objects ids that stay the same while the objects are in view. If false, objects are numbered 1..N in the
    order of their scores. Ids restart at 1 when this parameter changes.
    """
    queue: Annotated[int, Field(ge=1, le=1000)] = 1
    """Maximum number of pairs of images that wait for segmentation. The value 1 keeps only the newest pair, which gives
    the shortest delay. This parameter is read-only.
    """
    reliable: bool = True
    """Subscribe with the quality of service RELIABLE. Set this parameter to false for camera drivers that publish with
    BEST_EFFORT. This parameter is read-only.
    """


@dataclass(frozen=True, slots=True)
class State:
    """Values of all parameters of a node."""

    options: Options
    """Parameters of the node, such as the queue length."""
    config: Config
    """Parameters of the segmentation method."""


def first_state(name: str = "OBJECTS") -> State:
    """Return the parameter values for a preset and default options. Raises ConfigError for an unknown preset."""
    return State(Options(preset=name), preset(name))


def descriptions(config: Config = OBJECTS) -> dict[str, str]:
    """Return the help texts of all parameters of the node, indexed by parameter name."""
    found = {name: " ".join((field.description or "").split()) for name, field in Options.model_fields.items()}
    for one in (config, *PRESETS.values()):
        found = field_names(one) | found
    return found


def values_of(state: State) -> dict[str, Any]:
    """Return the values of all parameters, converted to types of ROS parameters and indexed by parameter name. The
    value None of a field is converted to the text "none".
    """
    options = state.options.model_dump()
    return {name: options[name] if name in options else _stored(state, name) for name in descriptions(state.config)}


def _stored(state: State, name: str) -> Any:
    value = value_at(state.config, name)
    if value is None:
        return OFF
    if isinstance(value, BaseModel):
        return ON
    return list(map(float, value)) if isinstance(value, tuple) else value


def changed(state: State, changes: Mapping[str, Any]) -> State:
    """Return the values of all parameters after some parameters were changed. If the preset changes, it is applied
    before all other new values.

    changes: new values, indexed by parameter name. Raises ConfigError for an unknown name or an invalid value.
    """
    known = descriptions(state.config)
    unknown = next((name for name in changes if name not in known), None)
    if unknown is not None:
        raise ConfigError(f"unknown parameter {unknown!r}: `ros2 param list` shows all of them")
    own = {name: value for name, value in changes.items() if name in Options.model_fields}
    options = state.options.replace(**own) if own else state.options
    config = preset(options.preset) if "preset" in own else state.config
    fields = {name: _given(config, name, value) for name, value in changes.items() if name not in own}
    return State(options, config.replace(**fields) if fields else config)


def _given(config: Config, name: str, value: Any) -> Any:
    """Convert the value of a ROS parameter to the type that the configuration expects."""
    if value == ON:
        return {}  # an empty dict switches a stage on and keeps its values
    if isinstance(value, str):
        return value_of_text(value)
    return value if isinstance(value, bool | int | float) else list(value)


class NodeParameters:
    """Parameters that the node declares in ROS.

    state: current values of all parameters.
    """

    def __init__(self, node: Any, kinds: Kinds, on_change: Callable[[State], None]) -> None:
        self._node, self._kinds, self._on_change = node, kinds, on_change
        self._syncing = False
        meaning = descriptions()["preset"]
        named = node.declare_parameter("preset", "OBJECTS", self._descriptor("preset", meaning)).value
        self.state = first_state(str(named))
        values, known = values_of(self.state), descriptions(self.state.config)
        given = {
            name: node.declare_parameter(name, value, self._descriptor(name, known[name])).value
            for name, value in values.items()
            if name != "preset"
        }
        self.state = changed(self.state, {name: value for name, value in given.items() if value != values[name]})
        self._store(set(given))
        node.add_on_set_parameters_callback(self._set)

    def _descriptor(self, name: str, meaning: str) -> Any:
        descriptor = self._kinds.interfaces.ParameterDescriptor()
        descriptor.description = meaning
        descriptor.dynamic_typing = True  # dynamic types allow integers for floats, and "none" for any type
        descriptor.read_only = name in FIXED
        return descriptor

    def _set(self, parameters: list[Any]) -> Any:
        """Validate and set parameter values that ROS passes. If a value is invalid, the result contains the reason."""
        answer = self._kinds.interfaces.SetParametersResult
        if self._syncing:
            return answer(successful=True)
        wanted = {p.name: p.value for p in parameters if p.name in descriptions(self.state.config)}
        before = values_of(self.state)
        try:
            self.state = changed(self.state, wanted)
        except SpigoloError as error:
            return answer(successful=False, reason=str(error))
        after = values_of(self.state)
        self._store({name for name, value in after.items() if before.get(name) != value} - wanted.keys())
        self._on_change(self.state)
        return answer(successful=True)

    def _store(self, names: set[str]) -> None:
        """Write the current values of the given parameters to ROS. This function is called, for example, after a new
        preset has changed other parameters.
        """
        values = values_of(self.state)
        kind = self._kinds.rclpy.parameter.Parameter
        self._syncing = True
        try:
            changes = [kind(name, value=values[name]) for name in names - set(FIXED) if name in values]
            self._node.set_parameters([p for p in changes if self._node.has_parameter(p.name)])
        finally:
            self._syncing = False
