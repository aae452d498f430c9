"""A script with annotations as a user writes it: mypy checks it in strict mode."""

from typing import NamedTuple

import numpy as np

import tribo
from tribo import Asperite, Corrugation, Field, Output, Pulled, Scene, Surface, simulate


class Gauss(NamedTuple):
    height: float
    width: float

    def energy(self, r: float) -> float:
        return float(self.height * np.exp(-0.5 * (r / self.width) ** 2))


def work(speed: float) -> float:
    """The work on the upper surface; parts of scenes are given in all ways that types allow."""
    upper = Surface("upper", bob=[-5.0, 0.0], velocity=(speed, 0.0), asperite=Asperite(kappa=2.0))
    lower = Surface("lower", facing="up", drive=Pulled(stiffness=1.0, speed=0.0))
    rows = [
        Surface("row", shape=[4, 1], spacing=[1.0, 0.0], heights=[0.0, 0.1, 0.0, 0.1]),
        Surface("sheet", drive="bars", langevin={"gamma": 1.0, "on": "swing"}, species="C"),
        Surface("block", drive={"kind": "free", "load": 0.1}, springs={"stiffness": 2.0}),
        Surface("listed", positions=[[0.0, 0.0, 0.0]], bars="free", bath={"spectrum": "drude"}),
    ]
    assert [row.drive for row in rows] and rows[0].shape[0] == 4
    fields = [Field(Corrugation(0.1, 1.0), on=["lower"])]
    output = Output(times=[1.0, 20.0])
    contact = tribo.LennardJones(0.05, 0.2).with_cutoff(0.5)
    assert Scene([upper, lower], contact, 20.0).duration == 20.0
    scene = Scene([upper, lower], Gauss(0.05, 0.2), duration=20.0, fields=fields, output=output)
    result: tribo.Result = simulate(scene, accuracy=1e-6)
    values: np.ndarray = result["upper"].w1
    result.save("run.nc")
    print(result.status == "completed", result.error_estimate["W"], result.to_xarray())
    print(len(result.to_ase()), result.state().t, tribo.check(Gauss(0.05, 0.2)).passed)
    return float(values[-1, 0])


if __name__ == "__main__":
    print(work(0.5))
    case = tribo.paper.scene("A")
    ensemble = tribo.ensemble(case, 4, {"upper.theta": "normal(0,0.1)"})
    print(ensemble["upper.w1_mean"])
    tribo.plotting.save(tribo.plotting.axes(), "a.png")
