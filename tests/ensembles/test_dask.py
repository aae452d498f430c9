"""Ensembles on a local cluster of processes: the same bits, also when a worker is killed."""

import os
import signal
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import tribo
from tribo import Output, ensemble, paper
from tribo.ensembles import batches

distributed = pytest.importorskip("distributed")


@pytest.mark.slow
def test_a_cluster_gives_the_same_bits(monkeypatch):
    """Of pairs and of other scenes; a worker that is killed at work loses no member."""
    monkeypatch.setattr(batches, "CHUNK", 256)
    scene = replace(paper.scene("A"), numerics=tribo.Numerics(accuracy=1e-6))
    vary, keep = {"upper.theta": stats.uniform(0.0, 0.2)}, ["upper.w1", "contact_energy"]
    warm = tribo.Surface("upper", shape=(3, 1), langevin=tribo.Langevin(0.6, 0.3))
    noisy = tribo.Scene((warm,), (), 4.0, output=Output(samples=5))
    here = ensemble(scene, 5000, vary, keep=keep)
    single = ensemble(noisy, 40, keep=["upper.w_T"], step=0.05)
    statistics = ensemble(scene, 5000, vary, keep=keep, statistics=True)
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        first = next(iter(client.run(os.getpid).values()))
        killed = []

        def kill(done):
            if done >= 2 and not killed:
                os.kill(first, signal.SIGKILL)
                killed.append(done)

        there = ensemble(scene, 5000, vary, keep=keep, engine=client, progress=kill)
        killed.clear()
        first = next(iter(client.run(os.getpid).values()))
        each = ensemble(noisy, 40, keep=["upper.w_T"], step=0.05, engine=client, progress=kill)
        sums = ensemble(scene, 5000, vary, keep=keep, statistics=True, engine=client)
    assert killed and first
    for one, other in ((here, there), (single, each), (statistics, sums)):
        assert one.drop_attrs().identical(other.drop_attrs())
    assert np.isfinite(there["upper.w1"]).all()
