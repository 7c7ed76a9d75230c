"""How hypothesis draws: the same examples on every machine, unless asked: pytest --hypothesis-profile explore."""

import signal

from hypothesis import HealthCheck, settings

on_shared_machines = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("repeatable", derandomize=True, database=None, print_blob=True, **on_shared_machines)
settings.register_profile("explore", max_examples=1000, **on_shared_machines)
settings.load_profile("repeatable")

# A shell that starts something in the background has it ignore Ctrl-C; the tests of Ctrl-C must hold there too.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
