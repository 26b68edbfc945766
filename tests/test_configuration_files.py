"""Rules for configurations: a file's base, what a message advises, and what a worker gets."""

from __future__ import annotations

import pickle

import pytest

import spigolo as sp
from spigolo.errors import ConfigError
from spigolo.settings import Additions, Support
from spigolo.settings.presets import from_toml


def test_a_toml_text_may_start_from_a_preset() -> None:
    changed = "[partition]\ngamma = 0.5\n"
    assert from_toml('base = "TABLE"\n' + changed) == sp.TABLE.replace(name="mine", partition={"gamma": 0.5})
    assert from_toml('base = "shelf"', name="rack") == sp.SHELF.replace(name="rack")
    assert from_toml(sp.TABLE.to_toml()) == sp.TABLE
    with pytest.raises(ConfigError, match="unknown preset 'TABEL' as base: expected one of OBJECTS"):
        from_toml('base = "TABEL"')
    with pytest.raises(ConfigError, match="unknown parameter"):
        from_toml('base = "TABLE"\n[partition]\ngama = 1')


def test_switching_the_support_off_says_what_else_to_switch_off() -> None:
    with pytest.raises(ConfigError, match=r"joining, .* rules\.ledge require .* --additions\.joining none --add"):
        sp.OBJECTS.replace(**{"additions.support": "none"})
    with pytest.raises(ConfigError, match=r"flats requires additions.support: .* --additions\.flats none"):
        sp.TABLE.replace(additions={"flats": {}})
    assert Additions(support=Support()).joining is None


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_a_segmenter_is_pickled_as_its_configuration(protocol: int) -> None:
    segmenter = sp.Segmenter(sp.TABLE)
    other = pickle.loads(pickle.dumps(segmenter, protocol))
    assert isinstance(other, sp.Segmenter)
    assert other.config == sp.TABLE
    assert other.workspace is not segmenter.workspace
