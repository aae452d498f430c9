"""Contacts, their forces, maps and profiles, against forces that are written by hand."""

from dataclasses import replace

import numpy as np
import pytest

import tribo
from tribo import DrivenBars, InputError, LennardJones, Output, Scene, Surface


def grid(samples=21, **lower):
    """Three asperites over a grid of twelve, periodic along x, in both kinds of contact."""
    upper = Surface(
        "upper",
        shape=(3, 1),
        spacing=(2.0, 0.0),
        bob=(0.1, 0.95),
        velocity=(0.4, 0.0),
        heights=[0.0, 0.05, 3.0],
        drive=DrivenBars(),
    )
    lower = Surface("lower", **({"facing": "up", "shape": (6, 2), "spacing": (1.0, 0.5)} | lower))
    output = Output(samples=samples, series=("forces", "contacts"))
    potential = LennardJones(0.1, 1.0).with_cutoff(2.5, "shift")
    periodic = tribo.Periodic(x=6.0)
    return Scene((upper, lower), potential, 4.0, output=output, periodic=periodic)


@pytest.fixture(scope="module")
def result():
    return tribo.simulate(grid(), accuracy=1e-6)


def by_hand(result, name, other):
    """Distances between all bobs of two surfaces at all times, (times, n, m)."""
    rest = [np.array(result.scene.surfaces[k].resting_bobs()) for k in (0, 1)]
    depth = dict(zip(("upper", "lower"), (each[:, 2] for each in rest), strict=True))
    mine, theirs = result[name], result[other]
    x = mine.x_bob[:, :, None] - theirs.x_bob[:, None]
    x -= 6.0 * np.round(x / 6.0)
    y = mine.y_bob[:, :, None] - theirs.y_bob[:, None]
    z = depth[name][:, None] - depth[other]
    return np.sqrt(x**2 + y**2 + z**2)


@pytest.mark.parametrize(("name", "other"), [("upper", "lower"), ("lower", "upper")])
def test_contacts_are_pairs_that_repel(result, name, other):
    """Closer than the minimum of Lennard-Jones; numbers, shares, and forces of each."""
    r = by_hand(result, name, other)
    touches = r < 2.0 ** (1.0 / 6.0)
    series = result[name]
    assert np.array_equal(series.contact_number, touches.sum(axis=(1, 2)))
    assert np.array_equal(series.in_contact, touches.any(axis=2))
    assert np.allclose(series.contact_share, touches.any(axis=2).mean(axis=1), atol=1e-15)
    assert np.array_equal(series.contact_number == 0, series.time_without_contact == 1.0)
    assert len(np.unique(series.contact_number)) > 2
    found = result.contacts(name, bins=8)
    assert np.array_equal(found["number"], series.contact_number)
    assert np.allclose(found["share"], series.contact_share)
    assert np.array_equal(found["force_count"].sum("bin"), found["number"])
    forces = LennardJones(0.1, 1.0).with_cutoff(2.5, "shift").force(r)
    expected = [forces[k][touches[k]].max(initial=-1.0) for k in range(len(r))]
    largest = found["force_largest"].fillna(-1.0)
    assert np.allclose(largest, expected)
    edges = [*found["force_low"].values, found["force_high"].values[-1]]
    counts = [np.histogram(forces[k][touches[k]], edges)[0] for k in range(len(r))]
    assert np.abs(found["force_count"].values - counts).sum() <= 1  # the largest is an edge


def test_forces_of_contacts_with_several_surfaces():
    """A bob that touches two surfaces, by a potential for each, has both forces."""
    rigid = {"asperite": tribo.Asperite(kappa=np.inf)}
    a = Surface("a", bob=(0.0, 0.0), **rigid)
    b = Surface("b", facing="up", bob=(0.0, -0.8), **rigid)
    c = Surface("c", facing="up", bob=(0.9, 0.0), **rigid)
    soft, hard = tribo.Hertz(2.0, 1.0), tribo.Hertz(5.0, 1.0)
    contacts = [
        tribo.Interaction(soft, between=("a", "b")),
        tribo.Interaction(hard, between=("a", "c")),
    ]
    scene = Scene([a, b, c], contacts, 1e-3, output=Output(samples=2))
    found = tribo.simulate(scene, accuracy=1e-6).contacts("a")
    forces = soft.force(0.8), hard.force(0.9)
    assert found["force_largest"].values[0] == pytest.approx(max(forces), rel=1e-4)
    assert found["force_mean"].values[0] == pytest.approx(np.mean(forces), rel=1e-4)


def test_normal_forces_point_away(result):
    """From what a surface faces; both surfaces feel the same, and attraction bears no load."""
    upper, lower = result["upper"], result["lower"]
    assert np.allclose(upper.normal_force, upper.f1_y.sum(axis=1))
    assert np.allclose(upper.normal_force, lower.normal_force, atol=1e-12)
    assert np.allclose(lower.load_bearing_share, np.mean(lower.f1_y < 0.0, axis=1))
    assert np.ptp(upper.load_bearing_share) > 0.0 and upper.load_bearing_share.max() < 1.0


def test_maps_add_up_to_averages(result):
    """Friction and normal force of each asperite; the sums are those of the surface."""
    found = result.friction_map("lower")
    assert found["friction"].sum().item() == pytest.approx(
        result.friction_force("lower").mean, abs=1e-12
    )
    t, normal = result.t, result["lower"].normal_force
    assert found["normal"].sum().item() == pytest.approx(tribo.time_average(t, normal, 0.0).mean)
    assert found["x"].values[:6] == pytest.approx(np.arange(6.0))
    assert np.unique(found["z"]).size == 2
    assert result.plot.friction_map("lower", "normal").get_ylabel() == "$z$"
    assert result.plot.friction_map("upper").get_ylabel() == "mean friction force"
    assert result.plot.contacts("lower").get_ylim()[0] == 0.0
    assert np.isnan(found["friction_half_width"]).all()  # 21 samples are too few
    plain = tribo.simulate(replace(result.scene, output=Output(samples=5)), accuracy=1e-3)
    with pytest.raises(InputError, match=r'output\.series: must contain "forces"'):
        plain.friction_map("lower")


def test_maps_of_a_grid_have_cells_around_its_bobs(result):
    """Cells of forces and of other quantities have one size, and are where the result has bobs."""
    found = result.friction_map("lower")
    for ax, values in (
        (result.plot.friction_map("lower", "normal"), found["normal"]),
        (result.plot.map("f1_y", "lower"), result["lower"].f1_y[-1]),
        (result.plot.map("height", "lower"), np.zeros(12)),
    ):
        (mesh,) = ax.collections
        corners = mesh.get_coordinates()
        assert np.allclose(np.diff(corners[0, :, 0]), 1.0)
        assert np.allclose(np.diff(corners[:, 0, 1]), 0.5)
        centres = (corners[1:, 1:] + corners[:-1, :-1]).reshape(-1, 2) / 2.0
        assert np.allclose(centres, np.stack([found["x"], found["z"]], axis=1), atol=1e-12)
        assert np.allclose(np.ravel(mesh.get_array()), values)


def test_discs_of_a_map_do_not_overlap():
    """Asperites at listed positions are discs around their bobs, of which none hides another."""
    places = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.2], [1.1, 0.0, 0.2], [0.5, 0.0, 3.0]]
    surface = Surface("upper", positions=places, drive="free")
    scene = Scene((surface,), (), 1.0, output=Output(samples=3, series=("forces",)))
    ax = tribo.simulate(scene, method="verlet", step=0.5).plot.friction_map("upper")
    (discs,) = ax.collections
    centres = discs.get_offsets()
    assert np.array_equal(centres, np.array(places)[:, [0, 2]])
    apart = np.hypot(*(centres[:, None] - centres).transpose(2, 0, 1))
    radii = discs.get_widths() / 2.0
    assert np.all(radii > 0.0)
    assert np.all(apart + 1e-12 >= (radii[:, None] + radii) * ~np.eye(4, dtype=bool))


def test_discs_of_asperites_at_one_place_are_seen():
    """One above the other in x and z, as wide as the way to the next place."""
    places = [[0.0, 0.0, 0.0]] * 4 + [[1.0, 0.0, 1.0]]
    surface = Surface("upper", positions=places, drive="free")
    scene = Scene((surface,), (), 1.0, output=Output(samples=3, series=("forces",)))
    ax = tribo.simulate(scene, method="verlet", step=0.5).plot.friction_map("upper")
    (discs,) = ax.collections
    assert np.all(discs.get_widths() >= 1.0)


def test_a_profile_of_velocities(result):
    """The upper surface slides at 0.4 over the lower one, which is below it."""
    profile = result.velocity_profile()
    assert profile["surface"].values.tolist() == ["upper", "lower"]
    assert profile["velocity"].sel(surface="lower").item() == pytest.approx(0.0, abs=0.05)
    slip = profile["velocity"].diff("surface").item()
    assert profile["slip"].values[0] == pytest.approx(-slip)
    assert np.isnan(profile["slip"].values[1])
    assert profile["velocity"].values[0] == pytest.approx(0.4, abs=0.05)


def test_a_profile_is_that_of_the_momentum():
    """Heavy asperites count more: the velocity of a surface is momentum over mass."""
    masses = np.array([2.0, 6.0])
    surface = Surface(
        "s",
        asperite=tribo.Asperite(kappa=np.inf, m1=1.0, m2=masses - 1.0),
        shape=(2, 1),
        spacing=(1.0, 0.0),
        drive="free",
        initial={"vx": np.array([0.8, 0.0])},
    )
    scene = Scene([surface], [], 2.0, output=Output(samples=51))
    profile = tribo.simulate(scene, accuracy=1e-6).velocity_profile()
    expected = 0.8 * masses[0] / masses.sum()
    assert profile["velocity"].values[0] == pytest.approx(expected, rel=1e-9)


def test_averages_of_contacts_are_kept(result):
    """At the end of a member or a point they are averages over time, with intervals."""
    keep = ["upper.contact_share", "upper.normal_force", "upper.load_bearing_share"]
    scene = replace(grid(201), numerics=tribo.Numerics(accuracy=1e-6))
    data = tribo.sweep(scene, {"interaction.epsilon": [0.1]}, keep=keep, progress=False)
    alone = tribo.simulate(scene)
    for name in keep:
        series = alone["upper"][name.partition(".")[2]]
        average = tribo.time_average(alone.t, series, 0.0)
        assert data[name].item() == pytest.approx(average.mean, rel=1e-9), name
        assert f"{name}_time_half_width" in data


def test_contacts_of_many_asperites_are_found_by_trees():
    """As those of all pairs, also across the period."""
    from tribo.layout.layout import lay_out
    from tribo.ledger import contact_pairs

    scene = grid(2, shape=(30, 8), spacing=(0.2, 0.4), bob=(0.0, 0.0), drive=DrivenBars())
    many = replace(scene, output=Output(samples=2, series=("contacts",)), duration=0.01)
    result = tribo.simulate(many, accuracy=1e-3)
    touches = by_hand(result, "upper", "lower") < 2.0 ** (1.0 / 6.0)
    assert touches.sum() > 6
    layout = lay_out(many)
    assert layout.asperites.size > contact_pairs.MOST_PAIRS // 3
    assert np.array_equal(result["upper"].contact_number, touches.sum(axis=(1, 2)))


def test_contacts_without_a_range_are_refused():
    """As those of Coulomb, which repels at any distance; they are no series either."""
    output = Output(samples=3, series=("contacts",))
    lower = Surface("lower", facing="up")
    scene = Scene(
        (Surface("upper", bob=(-2.0, 0.5)), lower), tribo.Coulomb(0.1), 1.0, output=output
    )
    plain = tribo.simulate(scene, accuracy=1e-3)
    with pytest.raises(InputError, match="contacts with a range"):
        plain.contacts("upper")
    assert "contact_number" not in plain["upper"]
