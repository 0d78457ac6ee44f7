# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames computed by other processes: a real Dask cluster of two workers, which lose their lives on the way."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from types import SimpleNamespace

import numpy as np
import pytest

from convwass_addon.applications.morphs import runs
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.frame_cache import FrameCache
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.workers import one_blas_thread
from convwass_addon.cluster import ClusterExecutor, cluster_workers
from convwass_addon.errors import Cancelled, ConvwassError, InputError
from convwass_addon.progress import UNINTERRUPTED, Control
from tests.clusters import local_cluster
from tests.controls import CountingControl
from tests.shapes import ball, box
from tests.stored_frames import assert_as_stored

SHAPES = (ball(points=300), box())
QUICK = MorphSettings(motion="transport", resolution=20)
BLENDS = path_blends(2, 48)
RUNS = 13
"""Enough for work to be left when a worker is killed after the first of them."""


@pytest.fixture(scope="module")
def cluster():
    with local_cluster(n_workers=2, threads_per_worker=1, processes=True) as running:
        yield running


@contextmanager
def counted(address):
    """The cluster's workers, and the futures of all runs that they are given."""
    futures = []

    class Counting(ClusterExecutor):
        def submit(self, *call, **options):
            futures.append(super().submit(*call, **options))
            return futures[-1]

    with cluster_workers(address) as executor:
        executor.__class__ = Counting
        yield executor, futures


def steps(control=UNINTERRUPTED, **where):
    work = morph(MorphInputs.of(SHAPES, ["a", "b"]), BLENDS, QUICK, control, computation=Computation(**where))
    return (step for step in work if step.payload)


@pytest.fixture(scope="module")
def expected():
    return [step.payload for step in steps(workers=2)]


def assert_same(found, expected):
    assert [frame.blend for frame in found] == [frame.blend for frame in expected]
    for one, other in zip(found, expected, strict=True):
        assert one.record == other.record
        if other.mesh is not None:
            np.testing.assert_array_equal(one.mesh.vertices, other.mesh.vertices)
            np.testing.assert_array_equal(one.mesh.faces, other.mesh.faces)


def assert_same_from_files(found, expected):
    assert [frame.blend for frame in found] == [frame.blend for frame in expected]
    for one, other in zip(found, expected, strict=True):
        assert one.record == other.record
        assert_as_stored(one, other)


def kill(processes):
    for process in processes:
        os.kill(process, signal.SIGKILL)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows knows no SIGKILL")
def test_a_bake_survives_workers_that_are_killed(cluster, expected):
    """All arguments sent to the runs, including copies of common ones."""
    frames = []
    with counted(cluster.scheduler_address) as (executor, futures):
        before = set(executor.client.run(os.getpid).values())
        assert len(before) == 2
        for step in steps(executor=executor):
            if not frames:
                assert len(futures) == RUNS
                assert sum(not future.done() for future in futures) >= RUNS // 2
                kill(before)
            frames.append(step.payload)
        executor.client.wait_for_workers(2, timeout=60)
        assert not before & set(executor.client.run(os.getpid).values())
    assert_same(frames, expected)


def test_common_arguments_of_runs_are_sent_once(cluster, monkeypatch):
    """And to all workers, which then all have work."""
    sent = []
    with cluster_workers(cluster.scheduler_address) as executor:
        # Larger than Dask wants a call to be, which would be a warning.
        shared = executor.share(np.arange(2_000_000))
        places = [executor.submit(place_and_sum, shared, index) for index in range(12)]
        sent = [future.result(60) for future in places]
    assert {total for _, total in sent} == {1999999 * 1000000}
    assert len({process for process, _ in sent}) == 2


def place_and_sum(values, index):
    time.sleep(0.1)
    return os.getpid(), int(values.sum())


def test_runs_elsewhere_have_one_thread_of_blas(cluster):
    with cluster_workers(cluster.scheduler_address) as executor:
        during, after = executor.submit(blas_threads_of_a_run).result(60)
    assert during == {1}
    assert after == {2}


def blas_threads_of_a_run():
    """Numbers of BLAS threads while a run is solved, and after it, where two were allowed."""
    from threadpoolctl import threadpool_info, threadpool_limits

    def count(*_):
        return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}

    with threadpool_limits(2, user_api="blas"):
        return runs.solve_apart(SimpleNamespace(frames=count), ()), count()


def test_one_thread_of_blas_lasts_until_the_last_has_left():
    threadpoolctl = pytest.importorskip("threadpoolctl")

    def count():
        return {library["num_threads"] for library in threadpoolctl.threadpool_info() if library["user_api"] == "blas"}

    first, second = ExitStack(), ExitStack()
    with threadpoolctl.threadpool_limits(2, user_api="blas"):
        first.enter_context(one_blas_thread())
        second.enter_context(one_blas_thread())
        first.close()
        assert count() == {1}
        second.close()
        assert count() == {2}


def test_libraries_of_blas_are_looked_for_where_a_module_has_come(monkeypatch):
    threadpoolctl, looked = pytest.importorskip("threadpoolctl"), []
    real = threadpoolctl.ThreadpoolController
    monkeypatch.setattr(threadpoolctl, "ThreadpoolController", lambda: looked.append(1) or real())
    for new, wanted in (("one", 1), (None, 1), (None, 1), ("another", 2)):
        if new is not None:
            monkeypatch.setitem(sys.modules, f"of_a_test_{new}", None)
        with one_blas_thread():
            assert len(looked) == wanted


def test_cancelling_drops_runs_that_have_not_started(cluster):
    control = Control()
    with counted(cluster.scheduler_address) as (executor, futures):
        with pytest.raises(Cancelled):
            for _ in steps(executor=executor, control=control):
                control.cancel()
        assert sum(future.cancelled() for future in futures) >= RUNS // 2
        deadline = time.monotonic() + 30
        while any(executor.client.processing().values()) and time.monotonic() < deadline:
            time.sleep(0.05)
        assert not any(executor.client.processing().values())


def test_a_bake_on_a_cluster_can_be_stopped_while_it_waits():
    """Cancelling works although no run ever ends."""
    never = threading.Event()
    with ThreadPoolExecutor(1) as elsewhere:
        elsewhere.submit(never.wait)
        with pytest.raises(Cancelled):
            list(steps(executor=elsewhere, control=CountingControl(last=3)))
        never.set()


def test_frames_from_a_cluster_go_into_the_cache(cluster, expected, tmp_path):
    with cluster_workers(cluster.scheduler_address) as executor:
        wanted = [step.payload for step in steps(executor=executor, cache=FrameCache(tmp_path), wanted=range(8))]
    assert_same(wanted, expected[:8])
    again = [step.payload for step in steps(cache=FrameCache(tmp_path), wanted=range(8))]
    assert_same_from_files(again, expected[:8])


def test_errors_of_a_run_are_passed_on_unchanged(cluster):
    with cluster_workers(cluster.scheduler_address) as executor, pytest.raises(InputError, match="no volume"):
        executor.submit(refuse).result(60)


def refuse():
    raise InputError("no volume")


def test_a_cluster_without_the_package_gives_a_helpful_error(cluster):
    missing = ModuleNotFoundError(name="convwass_addon")
    for error, cause in ((missing, None), (RuntimeError("Error during deserialization"), missing)):
        with (
            pytest.raises(ConvwassError, match="does not have convwass_addon"),
            cluster_workers(cluster.scheduler_address),
        ):
            raise error from cause
    with pytest.raises(RuntimeError, match="another"), cluster_workers(cluster.scheduler_address):
        raise RuntimeError("another")


def test_a_scheduler_that_is_lost_ends_the_bake():
    started = local_cluster(n_workers=1, threads_per_worker=1, processes=False, protocol="tcp")
    with (
        pytest.raises(ConvwassError, match="was lost; start it"),
        cluster_workers(started.scheduler_address) as executor,
    ):
        waiting = executor.submit(time.sleep, 1.0)
        started.close()
        waiting.result(60)


@pytest.mark.parametrize(
    ("address", "message"),
    [("tcp://127.0.0.1:1", "No Dask scheduler answers at tcp://127.0.0.1:1"), ("what://ever", "No Dask scheduler")],
)
def test_schedulers_that_do_not_answer_are_named(address, message, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("convwass_addon.cluster.ANSWER_SECONDS", 0.5)
    with pytest.raises(InputError, match=message), cluster_workers(address):
        pass


def test_a_scheduler_without_workers_is_refused(monkeypatch):
    with (
        local_cluster(n_workers=0) as empty,
        monkeypatch.context() as changed,
        pytest.raises(InputError, match="has no workers"),
    ):
        changed.setattr("convwass_addon.cluster.WORKER_SECONDS", 1.0)
        with cluster_workers(empty.scheduler_address):
            pass


def test_a_missing_distributed_is_asked_for(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match="pip install distributed"), cluster_workers("tcp://127.0.0.1:1"):
        pass


def test_a_run_that_costs_every_worker_its_life_is_given_up(cluster, monkeypatch):
    # The last one, so that the cluster ends before another worker has started.
    monkeypatch.setattr(cluster.scheduler, "allowed_failures", 0)
    with pytest.raises(ConvwassError, match="lack of memory"), cluster_workers(cluster.scheduler_address) as executor:
        executor.submit(os._exit, 1).result(60)
