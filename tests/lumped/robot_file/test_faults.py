"""A wrong robot file gets one line for each fault: key, value, unit, what is allowed."""

from pathlib import Path

import pytest
from wrong_files import wrong_files

from lumped.errors import InputError
from lumped.robot_file.load import described_by


def faults_of(tables):
    with pytest.raises(InputError) as refused:
        described_by(tables, Path())
    return refused.value.faults


@pytest.mark.parametrize("wrong", list(wrong_files()), ids=str)
def test_each_fault_is_one_line_with_its_key_and_what_is_allowed(wrong):
    faults = faults_of(wrong.tables())
    assert len(faults) == len(wrong.said), faults
    for line in wrong.said:
        assert any(fault.startswith(line) for fault in faults), (line, faults)
    assert not any("\n" in fault for fault in faults)


def test_an_empty_file_names_every_missing_key():
    missing = {fault.split(": missing")[0] for fault in faults_of({})}
    keys = ("schema", "name", "type", "geometry", "platform", "actuators", "leg1", "leg2")
    assert missing == set(keys)
