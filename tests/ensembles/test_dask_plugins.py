"""A sweep with a plug-in on two workers: one is killed, and one has no file of the plug-in."""

import os
import signal

import numpy as np
import pytest

import tribo

distributed = pytest.importorskip("distributed")

PLUGIN = """\
import numpy as np

import tribo


class Soft(tribo.Potential):
    strength: float
    length: float

    def energy(self, r):
        return self.strength * np.exp(-r / self.length)
"""
SCENE = """\
duration = 4.0

[interaction]
potential = "soft.py:Soft"
strength = 0.3
length = 0.5

[[surface]]
name = "upper"
bob = [-1.0, 0.4]
velocity = [0.5, 0.0]

[[surface]]
name = "lower"
facing = "up"
"""


@pytest.mark.slow
def test_a_worker_is_killed_and_one_lacks_the_file_of_a_plug_in(tmp_path):
    """The first worker has read the file; it is gone when the other one, and its successor, start.

    Points with other durations are tasks of their own, so that both workers take some.
    """
    (tmp_path / "soft.py").write_text(PLUGIN)
    (tmp_path / "scene.toml").write_text(SCENE)
    scene = tribo.load_scene(tmp_path / "scene.toml")
    values = {"duration": np.linspace(2.0, 4.0, 24).tolist()}
    keep = ["upper.w1", "upper.theta"]
    how = {"keep": keep, "method": "rk4", "step": 0.002, "progress": False}
    here = tribo.sweep(scene, values, **how)
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        first, other = client.run(os.getpid).items()
        alone = client.submit(_one_run, str(tmp_path / "scene.toml"), workers=[first[0]])
        assert np.isfinite(alone.result())
        (tmp_path / "soft.py").unlink()
        killed = []

        def kill(done):
            if done >= 2 and not killed:
                os.kill(first[1], signal.SIGKILL)
                killed.append(done)

        settings = how | {"progress": kill}
        there = tribo.sweep(scene, values, engine=client, **settings)
        pids = set(client.run(os.getpid).values())
    assert killed and first[1] not in pids and other[1] in pids
    assert there.drop_attrs().identical(here.drop_attrs())
    assert np.isfinite(there["upper.w1"]).all()


def _one_run(path):
    """The end of a run of a scene file, by a worker that finds its plug-in."""
    return float(tribo.simulate(tribo.load_scene(path), method="rk4", step=0.01)["upper"].w1[-1, 0])
