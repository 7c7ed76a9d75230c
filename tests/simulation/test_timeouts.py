"""Waiting for results ends, even if an executor never completes its tasks."""

from concurrent.futures import Future
from types import SimpleNamespace

import pytest

from walkerlab.simulation.timeouts import results_in_order


def test_a_client_that_is_closed_while_tasks_run_is_reported():
    done, never_done = Future(), Future()
    done.set_result(1)
    executor = SimpleNamespace(_client=SimpleNamespace(status="running"))
    results = results_in_order([done, never_done], executor, limit=10)
    assert next(results) == 1
    executor._client.status = "closed"
    with pytest.raises(RuntimeError, match="client is closed; make another"):
        next(results)
