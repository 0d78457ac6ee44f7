# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compute frames on other machines, with the workers of a Dask scheduler.

This file is not part of the installed extension (``paths_exclude_pattern`` in the manifest), which has no permission to
use the network.
"""

from __future__ import annotations

import concurrent.futures
import pickle
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from .applications.morphs.runs import SharingExecutor
from .errors import ConvwassError, InputError

if TYPE_CHECKING:
    from distributed import Client

ANSWER_SECONDS = 10.0
"""Time limit for the scheduler to answer; chosen by hand, as the next one."""

WORKER_SECONDS = 10.0
"""Time limit for the first worker to appear."""


class ClusterExecutor(SharingExecutor):
    """Runs calls on a Dask cluster; arguments shared by many calls are sent only once.

    If a worker is lost, Dask repeats its calls elsewhere. A call that loses several workers is considered the cause and
    fails (``distributed.scheduler.allowed-failures``, 3 by default).

    Parameters
    ----------
    client : distributed.Client
        A connected client.
    """

    def __init__(self, client: Client) -> None:
        self.client = client
        # Not pure: otherwise Dask would hash all arguments to look for cached results.
        self._calls = client.get_executor(pure=False)

    def share(self, value: object) -> Any:
        """Send an argument of many calls to the cluster, and return a reference to it.

        The value becomes a result of the cluster: Dask recomputes lost results, but does not restore data that was only
        stored there.
        """
        # Sent as bytes, which the scheduler passes on unchanged.
        content = pickle.dumps(value, protocol=pickle.HIGHEST_PROTOCOL)
        with warnings.catch_warnings():
            # The warning is irrelevant, since the value is sent once.
            warnings.filterwarnings("ignore", message="Sending large graph")
            shared = self.client.submit(pickle.loads, content, pure=False)
        # Dask prefers workers that hold the arguments of a call; every worker should hold this one.
        self.client.replicate([shared])
        return shared

    def submit(self, call: Callable[..., Any], /, *args: Any, **options: Any) -> concurrent.futures.Future[Any]:
        """Run a call on a worker; see :class:`concurrent.futures.Executor`."""
        return self._calls.submit(call, *args, **options)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Accept no more calls; wait for pending calls, or cancel them."""
        self._calls.shutdown(wait=wait and not cancel_futures)


@contextmanager
def cluster_workers(address: str) -> Iterator[ClusterExecutor]:
    """Provide the workers of a Dask scheduler.

    Parameters
    ----------
    address : str
        Such as ``tcp://192.168.1.10:8786``.

    Yields
    ------
    ClusterExecutor
        Closed at the end of the context; the cluster keeps running.

    Raises
    ------
    InputError
        The package distributed is missing, the scheduler does not answer, or it has no workers.
    ConvwassError
        The connection was lost, or some frames repeatedly lost their workers.
    """
    try:
        import distributed
    except ImportError:
        raise InputError(
            "--scheduler requires the package distributed; install it with: {python} -m pip install distributed",
            python=sys.executable,
        ) from None
    with _connected(distributed, address) as client:
        try:
            yield ClusterExecutor(client)
        except distributed.KilledWorker as error:
            raise ConvwassError(
                "The workers of {address} were lost one after another while computing the same frames, most likely "
                "for lack of memory; use a lower resolution, fewer threads per worker, or larger machines.",
                address=address,
            ) from error
        except (concurrent.futures.CancelledError, distributed.comm.CommClosedError) as error:
            raise ConvwassError(
                "The scheduler at {address} was lost; start it and bake again.", address=address
            ) from error
        except (ModuleNotFoundError, RuntimeError) as error:
            # If the scheduler cannot import the called function, the error is wrapped in a message of the scheduler.
            missing = error if isinstance(error, ModuleNotFoundError) else error.__cause__
            if not isinstance(missing, ModuleNotFoundError):
                raise
            raise ConvwassError(
                "The cluster at {address} does not have {package}; start its scheduler and workers with a Python that "
                "has the same packages as this one.",
                address=address,
                package=missing.name,
            ) from error


@contextmanager
def _connected(distributed: Any, address: str) -> Iterator[Client]:
    try:
        client = _client(distributed, address)
    except (OSError, ValueError) as error:
        raise InputError(
            "No Dask scheduler answers at {address} ({reason}); give it as tcp://HOST:PORT and check that it runs "
            "there.",
            address=address,
            reason=_first_line(error),
        ) from error
    with client:
        try:
            client.wait_for_workers(1, timeout=WORKER_SECONDS)
        except OSError as error:
            raise InputError(
                "The scheduler at {address} has no workers; start some and try again.", address=address
            ) from error
        yield client


def _client(distributed: Any, address: str) -> Client:
    """Connect to a scheduler, with one retry."""
    try:
        return distributed.Client(address, timeout=ANSWER_SECONDS, set_as_default=False)
    except AssertionError:
        # On a very busy machine, Dask's own thread may not start within its ten seconds.
        return distributed.Client(address, timeout=ANSWER_SECONDS, set_as_default=False)


def _first_line(error: Exception) -> str:
    return (str(error).strip() or type(error).__name__).splitlines()[0]
