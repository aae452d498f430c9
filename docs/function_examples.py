"""A runnable example of each public function, which the Python reference shows and a test runs.

Each of them follows on START.
"""

START = """\
>>> import numpy as np
>>> import tribo
>>> scene = tribo.paper.scene("A")
"""

EXAMPLES = {
    "tribo.simulate": """
>>> result = tribo.simulate(scene, accuracy=1e-6)
>>> print(result.status, f"{result['upper'].w[-1, 0]:.3f}")
completed 0.520
""",
    "tribo.prepare": """
>>> simulation = tribo.prepare(scene)
>>> for theta in (0.0, 0.1):
...     result = simulation.run({"upper.theta": theta}, estimate=False)
...     print(f"{result['upper'].w1[-1, 0]:.3f}")
-0.345
-0.358
""",
    "tribo.time_average": """
>>> t = np.linspace(0.0, 100.0, 2001)
>>> average = tribo.time_average(t, 2.0 + np.sin(t), after=10.0)
>>> print(abs(average.mean - 2.0) < average.half_width)
True
""",
    "tribo.exponential_average": """
>>> work = np.random.default_rng(0).normal(0.5, 1.0, 10_000)  # mean is variance / 2
>>> average = tribo.exponential_average(work, temperature=1.0)
>>> print(abs(average.mean - 1.0) < 2.0 * average.half_width)
True
""",
    "tribo.ensemble": """
>>> starts = {"upper.theta": np.linspace(-0.1, 0.1, 16)}
>>> data = tribo.ensemble(scene, vary=starts, keep=["upper.w1"], accuracy=1e-6)
>>> print(dict(data.sizes)["member"], f"{data['upper.w1'].values.mean():.2f}")
16 -0.35
""",
    "tribo.ensemble_member": """
>>> starts = {"upper.theta": np.linspace(-0.1, 0.1, 16)}
>>> data = tribo.ensemble(scene, vary=starts, keep=["upper.w1"], accuracy=1e-6)
>>> one = tribo.ensemble_member(data, 3)
>>> print(abs(one["upper.w1"].values.item() - data["upper.w1"].values[3].item()) < 1e-5)
True
""",
    "tribo.sweep": """
>>> data = tribo.sweep(scene, {"interaction.strength": [0.1, 0.2]})
>>> print(data["upper.W"].dims, f"{data['upper.W'].values[-1]:.3f}")
('interaction.strength',) 0.520
""",
    "tribo.friction_law": """
>>> drive = tribo.Pulled(stiffness=0.5, speed=0.1)
>>> tip = tribo.Surface("tip", drive=drive, langevin=tribo.Langevin(1.0, 0.0))
>>> field = tribo.Field(tribo.Corrugation(0.1, 1.0), on=("tip",))
>>> pulled = tribo.Scene((tip,), (), 60.0, fields=(field,))
>>> law = tribo.friction_law(pulled, speeds=[0.2, 0.4], distance=10.0, accuracy=1e-4)
>>> print(law["friction"].dims, bool((law["friction"] > 0.0).all()))
('speed',) True
""",
    "tribo.sensitivity": """
>>> data = tribo.sensitivity(scene, ["upper.W"], ["upper.velocity"], accuracy=1e-6)
>>> print(data["derivative"].dims, bool(data["half_width"].item() < 1e-2))
('quantity', 'key') True
""",
    "tribo.fit": """
>>> t = np.linspace(0.0, scene.duration, 101)
>>> angle = np.interp(t, (result := tribo.simulate(scene)).t, result["upper"].theta[:, 0])
>>> ranges = {"interaction.strength": (0.1, 0.4)}
>>> found = tribo.fit(scene, (t, angle), ranges, "upper.theta", starts=8)
>>> print(f"{found.values['interaction.strength']:.3f}")
0.200
""",
    "tribo.play": """
>>> player = tribo.play(scene, {"upper.velocity": (0.3, 2.0)})  # doctest: +SKIP
""",
    "tribo.live": """
>>> page = tribo.live(scene)  # doctest: +SKIP
""",
    "tribo.to_live_html": """
>>> print(tribo.to_live_html(scene, "live.html"))  # doctest: +SKIP
live.html
""",
    "tribo.add_method": """
>>> tribo.add_method("three-halves", order=2, weights=[1.0])
>>> result = tribo.simulate(scene, method="three-halves", step=0.05)
>>> print(result.status)
completed
""",
    "tribo.load_result": """
>>> path = tribo.simulate(scene).save("a.nc")
>>> print(f"{tribo.load_result('a.nc')['upper'].w[-1, 0]:.3f}")
0.520
""",
    "tribo.relax": """
>>> upper, lower = tribo.commensurate_rows(4, gap=1.1)
>>> rows = tribo.Scene((upper, lower), tribo.LennardJones(0.01, 1.0), duration=1.0)
>>> start = tribo.relax(rows)
>>> print(tribo.simulate(rows, start=start).status)
completed
""",
    "tribo.explain": """
>>> plan = tribo.explain(scene)
>>> print(plan.method, plan.degrees_of_freedom)
gauss-radau-15 2
""",
    "tribo.load_scene": """
>>> path = scene.save("a.toml")
>>> print(tribo.load_scene("a.toml") == scene)
True
""",
    "tribo.commensurate_rows": """
>>> upper, lower = tribo.commensurate_rows(8, spacing=1.5, upper={"velocity": (0.5, 0.0)})
>>> print(upper.count, lower.spacing[0])
8 1.5
""",
    "tribo.incommensurate_rows": """
>>> upper, lower = tribo.incommensurate_rows(8)
>>> print(f"{upper.spacing[0] / lower.spacing[0]:.3f}")
1.618
""",
    "tribo.periodic_rows": """
>>> upper, lower, period = tribo.periodic_rows(8)
>>> print(upper.count, lower.count)
8 13
""",
    "tribo.potentials.expression": """
>>> bond = tribo.potentials.expression("D * (1 - exp(-a * (r - 1)))**2", D=2.0, a=1.5)
>>> print(f"{bond.energy(1.0):.3f} {bond.force(1.2):.3f}")
0.000 -1.152
""",
    "tribo.potentials.tabulated": """
>>> table = tribo.potentials.tabulated(np.cos, low=0.5, high=3.0, tolerance=1e-8)
>>> print(abs(table.energy(1.234) - np.cos(1.234)) < 1e-7)
True
""",
    "tribo.potentials.from_points": """
>>> r = np.linspace(0.5, 3.0, 200)
>>> table = tribo.potentials.from_points(r, 1.0 / r)
>>> print(f"{table.energy(1.0):.5f}")
1.00000
""",
    "tribo.potentials.from_csv": """
>>> r = np.linspace(0.5, 3.0, 200)
>>> np.savetxt("curve.csv", np.column_stack((r, 1.0 / r)), delimiter=",")
>>> print(f"{tribo.potentials.from_csv('curve.csv').energy(1.0):.5f}")
1.00000
""",
    "tribo.potentials.named": """
>>> print(tribo.potentials.named("yukawa", strength=0.2, screening=0.5))
Yukawa(strength=0.2, screening=0.5)
""",
    "tribo.potentials.as_potential": """
>>> print(tribo.potentials.as_potential(tribo.Coulomb(0.2)).energy(2.0))
0.1
""",
    "tribo.potentials.from_calculator": """
>>> from ase.calculators.lj import LennardJones
>>> contact = tribo.potentials.from_calculator(LennardJones())
>>> upper = tribo.Surface("upper", bob=(-1.0, 1.2), velocity=(0.5, 0.0), species="Ar")
>>> lower = tribo.Surface("lower", facing="up", species="Ar")
>>> pair = tribo.Scene([upper, lower], contact, duration=1.0)
>>> print(tribo.simulate(pair, method="verlet", step=0.05).status)
completed
""",
    "tribo.potentials.from_dimer": """
>>> from ase.calculators.lj import LennardJones
>>> table = tribo.potentials.from_dimer(
...     LennardJones(rc=10.0), ("Ar", "Ar"), low=0.9, high=3.0, tolerance=1e-5
... )
>>> print(f"{table.energy(1.122) - table.energy(2.0):.2f}")
-0.94
""",
    "tribo.potentials.as_calculator": """
>>> from ase import Atoms
>>> dimer = Atoms("Ar2", positions=[(0.0, 0.0, 0.0), (2.0, 0.0, 0.0)])
>>> dimer.calc = tribo.potentials.as_calculator(tribo.Morse(1.0, 2.0, 1.5))
>>> print(f"{dimer.get_potential_energy():.4f}")
-0.6004
""",
    "tribo.check": """
>>> card = tribo.check(tribo.Yukawa(0.2, 0.5))
>>> print(card.passed)
True
""",
    "tribo.units.from_energy": """
>>> argon = tribo.units.from_energy(length=3.4e-10, mass=6.63e-26, energy=1.65e-21)
>>> print(f"{argon.time:.3g} s")
2.16e-12 s
""",
    "tribo.work_precision.work_precision": """
>>> from tribo.work_precision import work_precision
>>> found = work_precision(scene, ["rkn8", "rk4"], seconds=1.0)
>>> print(found.best(1e-6).method)
rkn8
""",
    "tribo.work_precision.means_precision": """
>>> from tribo.work_precision import means_precision
>>> warm = tribo.Surface("warm", langevin=tribo.Langevin(gamma=1.0, temperature=0.1))
>>> noisy = tribo.Scene([warm, tribo.Surface("lower", facing="up", bob=(4, 0))],
...                     tribo.Coulomb(0.1), duration=2.0)
>>> rows = means_precision(noisy, ["warm.W"], seconds=0.1).rows
>>> print(rows[0].members)
16
""",
    "tribo.model.spectrum.valid_until": """
>>> from tribo.model.spectrum import valid_until
>>> drude = tribo.Spectrum("drude", gamma=1.0, cutoff=2.0, n=40)
>>> print(valid_until(drude, mass=3.0, frequency=1.0) > 10.0)
True
""",
    "tribo.model.spectrum.exact_decay": """
>>> from tribo.model.spectrum import exact_decay
>>> drude = tribo.Spectrum("drude", gamma=1.0, cutoff=2.0, n=40)
>>> energy = exact_decay(drude, 3.0, 1.0, np.array([0.0, 10.0]))
>>> print(energy[1] < 0.1 * energy[0])
True
""",
    "tribo.model.spectrum.discrete_decay": """
>>> from tribo.model.spectrum import discrete_decay
>>> energy = discrete_decay(np.array([0.1]), np.array([1.0]), 3.0, 1.0, np.array([0.0, 5.0]))
>>> print(energy[1] < energy[0])
True
""",
    "tribo.model.recurrence.normal_modes": """
>>> from tribo.model.spectrum import normal_modes
>>> frequencies, weights = normal_modes(np.array([0.1]), np.array([1.0]), 3.0, 1.0)
>>> print(len(frequencies), f"{weights.sum():.3f}")
2 1.000
""",
    "tribo.export.to_lammps": """
>>> from tribo.export import to_lammps
>>> files = to_lammps(scene, "lammps")
>>> print(files.run.exists())
True
""",
    "tribo.plotting.compare": """
>>> soft = tribo.simulate(scene)
>>> stiff = tribo.simulate(tribo.paper.scene("B"))
>>> ax = tribo.plotting.compare({"A": soft, "B": stiff}, "angles")
""",
    "tribo.plotting.histogram": """
>>> ax = tribo.plotting.histogram(np.random.default_rng(0).normal(size=500), "work")
""",
    "tribo.plotting.reflected_histogram": """
>>> gain = np.random.default_rng(0).normal(0.5, 1.0, 5000)
>>> ax = tribo.plotting.reflected_histogram(gain, temperature=1.0)
""",
    "tribo.plotting.style": """
>>> with tribo.plotting.style():
...     ax = tribo.plotting.axes()
""",
    "tribo.plotting.axes": """
>>> ax = tribo.plotting.axes(tribo.plotting.WIDE, 2.8)
>>> ax.set(xlabel="load", ylabel="friction")  # doctest: +SKIP
""",
    "tribo.plotting.save": """
>>> result = tribo.simulate(scene)
>>> print(tribo.plotting.save(result.plot.work("upper"), "works.pdf"))
works.pdf
""",
    "tribo.ensembles.figure.mean_band": """
>>> from tribo.ensembles.figure import mean_band
>>> from scipy import stats
>>> starts = {"upper.theta": stats.norm(0.0, 0.1)}
>>> data = tribo.ensemble(
...     scene, 32, starts, keep=["upper.W"], at="samples", accuracy=1e-6
... )
>>> ax = mean_band(data, "upper.W")
""",
    "tribo.sweeps.figure.law_lines": """
>>> from tribo.sweeps.figure import law_lines
>>> drive = tribo.Pulled(stiffness=0.5, speed=0.1)
>>> tip = tribo.Surface("tip", drive=drive, langevin=tribo.Langevin(1.0, 0.0))
>>> field = tribo.Field(tribo.Corrugation(0.1, 1.0), on=("tip",))
>>> pulled = tribo.Scene((tip,), (), 60.0, fields=(field,))
>>> law = tribo.friction_law(pulled, speeds=[0.2, 0.4], distance=10.0, accuracy=1e-4)
>>> print(law_lines(law).get_xlabel())
speed
""",
    "tribo.derivatives.figure.tornado": """
>>> from tribo.derivatives.figure import tornado
>>> keys = ["upper.velocity", "interaction.strength"]
>>> data = tribo.sensitivity(scene, ["upper.W"], keys, accuracy=1e-6)
>>> print([label.get_text() for label in tornado(data).get_yticklabels()])
['upper.velocity', 'interaction.strength']
""",
    "tribo.sweeps.figure.sweep_lines": """
>>> from tribo.sweeps.figure import sweep_lines
>>> data = tribo.sweep(scene, {"upper.velocity": [0.4, 0.5, 0.6]})
>>> ax = sweep_lines(data, "upper.W")
""",
    "tribo.paper.scene": """
>>> print(tribo.paper.scene("C").duration)
50.0
""",
    "tribo.paper.compare": """
>>> tables = tribo.paper.compare("D")
>>> print(all(row.agrees for row in tables["D"]))
True
""",
    "tribo.paper.report": """
>>> tables = tribo.paper.compare("D")
>>> print(tribo.paper.report(tables).count("agrees  "))
9
""",
    "tribo.paper.short_report": """
>>> print(tribo.paper.short_report(tribo.paper.compare("D")).splitlines()[4])
  D  free sliding, attractive                   -0.138  -0.137746     0.085   0.085312  8 of 8
""",
    "tribo.paper.draw_overview": """
>>> print(tribo.paper.draw_overview(tribo.paper.compare("D"), "d.png"))
d.png
""",
    "tribo.paper.published": """
>>> print(len(tribo.paper.published("A")))
42
""",
    "tribo.paper.boost_error": """
>>> moving, still = tribo.paper.Run.extended("E"), tribo.paper.Run.extended("C")
>>> print(tribo.paper.boost_error(moving, still) < 1e-9)
True
""",
    "tribo.paper.figures.draw": """
>>> from tribo.paper import figures
>>> print(figures.draw("figures", "")[0].name)
fig01_model.pdf
""",
}


def lines(name: str) -> list[str]:
    """The section of a docstring with the example of a function, if it has one."""
    if name not in EXAMPLES:
        return []
    program = START + EXAMPLES[name].strip()
    return ["", "Examples", "--------", *program.splitlines()]
