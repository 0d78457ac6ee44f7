# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Other machines that compute frames: the workers of a Dask scheduler.

This file is left out of what Blender installs (``paths_exclude_pattern`` of the manifest): an extension without the
permission to use the network has no client of one.
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
"""How long a scheduler may take to answer; chosen, as what follows."""

WORKER_SECONDS = 10.0
"""How long its first worker may take to be there."""


class ClusterExecutor(SharingExecutor):
    """Runs calls on a Dask cluster; what many calls have in common is sent there once.

    A worker that is lost costs what it was computing: Dask computes that again elsewhere, until so many workers were
    lost over one call that the call is to blame (``distributed.scheduler.allowed-failures``, 3 by default).

    Parameters
    ----------
    client : distributed.Client
        Connected.
    """

    def __init__(self, client: Client) -> None:
        self.client = client
        # Not pure: otherwise Dask would take a hash of all arguments to find out whether it has the result already.
        self._calls = client.get_executor(pure=False)

    def share(self, value: object) -> Any:
        """Send something to the cluster that many calls take as an argument, and return what stands for it there.

        It becomes a result of the cluster's own, since Dask makes lost results again, but not data that it was merely
        given to keep.
        """
        # Bytes, which the scheduler passes on as they are.
        content = pickle.dumps(value, protocol=pickle.HIGHEST_PROTOCOL)
        with warnings.catch_warnings():
            # That it is large is known, and it is sent once.
            warnings.filterwarnings("ignore", message="Sending large graph")
            shared = self.client.submit(pickle.loads, content, pure=False)
        # Dask hands calls to workers that have their arguments. All of them shall have this one.
        self.client.replicate([shared])
        return shared

    def submit(self, call: Callable[..., Any], /, *args: Any, **options: Any) -> concurrent.futures.Future[Any]:
        """Run a call on a worker; see :class:`concurrent.futures.Executor`."""
        return self._calls.submit(call, *args, **options)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Take no more calls; those that have been taken are waited for, or cancelled."""
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
        Ends with the context; the cluster itself stays.

    Raises
    ------
    InputError
        The package distributed is missing, no scheduler answers, or it has no workers.
    ConvwassError
        The cluster was lost, or loses every worker that takes up some run.
    """
    try:
        import distributed
    except ImportError:
        raise InputError(
            "A scheduler needs the package distributed; install it with: {python} -m pip install distributed",
            python=sys.executable,
        ) from None
    with _connected(distributed, address) as client:
        try:
            yield ClusterExecutor(client)
        except distributed.KilledWorker as error:
            raise ConvwassError(
                "The workers of {address} were lost one after the other over the same frames, most likely for "
                "want of memory; use a lower resolution, fewer threads for each worker, or larger machines.",
                address=address,
            ) from error
        except (concurrent.futures.CancelledError, distributed.comm.CommClosedError) as error:
            raise ConvwassError(
                "The scheduler at {address} was lost; start it and bake again.", address=address
            ) from error
        except (ModuleNotFoundError, RuntimeError) as error:
            # A scheduler that cannot import what a worker is to call says so in a message of its own.
            missing = error if isinstance(error, ModuleNotFoundError) else error.__cause__
            if not isinstance(missing, ModuleNotFoundError):
                raise
            raise ConvwassError(
                "The cluster at {address} does not know {package}; start its scheduler and its workers with a "
                "Python that has the same packages as this one.",
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
    """Connect; once more where Dask's own thread did not start in its ten seconds, on a machine that is too busy."""
    try:
        return distributed.Client(address, timeout=ANSWER_SECONDS, set_as_default=False)
    except AssertionError:
        return distributed.Client(address, timeout=ANSWER_SECONDS, set_as_default=False)


def _first_line(error: Exception) -> str:
    return (str(error).strip() or type(error).__name__).splitlines()[0]
