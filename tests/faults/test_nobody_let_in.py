"""Servers of walkerlab listen on this computer only and require a token."""

import importlib.util
import ipaddress
import json
import os
import re
import subprocess
import sys
import urllib.error
import urllib.request
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.conftest import skip_without
from tests.faults import number
from tests.simulation.test_cluster import wait_until

psutil = pytest.importorskip("psutil")

NOTEBOOKS = Path(__file__).parents[2] / "notebooks"
N_KERNEL_PORTS = 5

INSECURE_CONFIG = """
c = get_config()
c.ServerApp.ip = "0.0.0.0"
c.ServerApp.allow_remote_access = True
c.IdentityProvider.token = ""
c.KernelManager.ip = "0.0.0.0"
c.ServerKernelManager.ip = "0.0.0.0"
"""
SERVERS = number([INSECURE_CONFIG], ["", INSECURE_CONFIG, 'c.ServerApp.token = ""', 'c.ServerApp.ip = "*"'])

posix = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signal that lets a server end in good order")


def listening(pid):
    """Return the addresses and ports on which a process and its children listen."""
    root = psutil.Process(pid)
    return {
        tuple(connection.laddr)
        for process in [root, *root.children(recursive=True)]
        for connection in connections(process)
        if connection.status == psutil.CONN_LISTEN or not connection.raddr
    }


def connections(process):
    try:
        return process.net_connections("inet")
    except psutil.NoSuchProcess:  # it has just ended
        return []


def is_only_here(pid):
    return all(ipaddress.ip_address(address).is_loopback for address, _ in listening(pid))


def ask(address, path, token="", method="GET"):
    """Send a request to a Jupyter server; return its answer, or None if access is denied."""
    question = urllib.request.Request(f"{address}{path}", method=method)
    if token:
        question.add_header("Authorization", f"token {token}")
    try:
        with urllib.request.urlopen(question, timeout=30) as answer:
            return json.load(answer)
    except urllib.error.HTTPError as error:
        if error.code != 403:
            raise
        return None


@contextmanager
def lab(folder, config):
    """Start ``walkerlab lab`` with a configuration of Jupyter; yield its process id, address and token."""
    (folder / "jupyter_server_config.py").write_text(config)
    command = [sys.executable, "-m", "walkerlab", "lab", "--no-browser", "--allow-root"]
    own = {name: str(folder) for name in ("HOME", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR")}
    environment = {name: value for name, value in os.environ.items() if not name.startswith("JUPYTER")} | own
    with subprocess.Popen(command, cwd=folder, env=environment, stderr=subprocess.PIPE, text=True) as server:
        try:
            found = (
                re.search(r"(http://[\w.]+:\d+)/lab/tree/\S*?(?:\?token=(\w+))?$", line.strip())
                for line in server.stderr
            )
            address, token = next(one for one in found if one).groups()
            yield server.pid, address, token
        finally:
            server.terminate()
            server.stderr.read()


@posix
@pytest.mark.parametrize("config", SERVERS)
def test_lab_is_local_and_requires_the_token_for_any_configuration_of_jupyter(tmp_path, config):
    with lab(tmp_path, config) as (pid, address, token):
        at_first = len(listening(pid))
        assert ask(address, "/api/kernels", token, "POST")
        wait_until(lambda: len(listening(pid)) >= at_first + N_KERNEL_PORTS)
        assert is_only_here(pid), listening(pid)
        for path in ("/api/kernels", "/api/contents", "/api/terminals"):
            assert ask(address, path) is None
            assert ask(address, path, "0" * 48) is None
            assert ask(address, path, token) is not None


# ------------------------------------------------------------------------------------------------------ workers

WALK = """
import os, sys
import walkerlab as wl
{cells}
settings = wl.Settings().with_(population_size=6, generations=2, duration=1)
for _ in wl.Evolution(settings, executor={executor}):
    pass
print("walked", flush=True)
sys.stdin.read()
"""


@contextmanager
def walking(folder, cells, executor):
    """Run an evolution in a process; yield its process id while its workers still exist."""
    command = [sys.executable, "-c", WALK.format(cells=cells, executor=executor)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, cwd=folder, **pipes) as process:
        assert any(line == "walked\n" for line in process.stdout)
        yield process.pid
        process.stdin.close()


def test_a_run_on_all_cores_does_not_listen(tmp_path):
    with walking(tmp_path, "", "None") as pid:
        assert psutil.Process(pid).children(recursive=True)
        assert not listening(pid)


def test_the_cluster_of_the_notebook_is_local(tmp_path):
    if not importlib.util.find_spec("distributed"):
        skip_without("distributed")
    book = json.loads((NOTEBOOKS / "teacher" / "12_a_bigger_computer.ipynb").read_text(encoding="utf-8"))
    cells = ["".join(cell["source"]) for cell in book["cells"] if cell["cell_type"] == "code"]
    with walking(tmp_path, "\n".join(cells[:2]), "executor") as pid:
        assert len(listening(pid)) >= 1 + 2 * 2  # the scheduler, and of each worker its own port and its nanny's
        assert is_only_here(pid), listening(pid)
