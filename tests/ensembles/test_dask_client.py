"""An open client of Dask: files are written without its locks."""

import pytest

import tribo
from tribo import paper

distributed = pytest.importorskip("distributed")


def test_files_beside_an_open_client(tmp_path):
    """Of results, sweeps and ensembles, none of which uses the client."""
    scene = paper.scene("A")
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster),
    ):
        result = tribo.simulate(scene, accuracy=1e-6, out=tmp_path / "run.nc")
        result.save(tmp_path / "saved.nc")
        keys, how = {"upper.velocity": [0.4, 0.5]}, {"accuracy": 1e-6, "keep": ["upper.w1"]}
        swept = tribo.sweep(scene, keys, out=tmp_path / "sweep.nc", **how)
        vary = {"upper.velocity": [0.4, 0.5]}
        tribo.ensemble(scene, 2, vary, out=tmp_path / "ensemble.nc", **how)
    again = tribo.sweep(scene, keys, out=tmp_path / "sweep.nc", resume=True, **how)
    assert again["upper.w1"].identical(swept["upper.w1"])
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        *("ensemble.nc", "run.nc", "saved.nc", "sweep.nc")
    ]
