"""All faults in full number, which takes about half an hour on two cores; further words are pytest's."""

import os
import sys

import pytest

os.environ["FAULTS"] = "full"
sys.exit(pytest.main(["-n", "auto", "tests/faults", *sys.argv[1:]]))
