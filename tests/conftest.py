"""How hypothesis draws: the same examples on every machine, unless asked: pytest --hypothesis-profile explore."""

from hypothesis import HealthCheck, settings

on_shared_machines = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("repeatable", derandomize=True, database=None, print_blob=True, **on_shared_machines)
settings.register_profile("explore", max_examples=1000, **on_shared_machines)
settings.load_profile("repeatable")
