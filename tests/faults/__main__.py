"""Run all fault injection tests in full, about half an hour on two cores; arguments are passed to pytest."""

import os
import sys

import pytest

os.environ["FAULTS"] = "full"
sys.exit(pytest.main(["-n", "auto", "tests/faults", *sys.argv[1:]]))
