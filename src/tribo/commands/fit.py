"""The commands `tribo fit` and `tribo sensitivity`: parameters from data, and what they change."""

from __future__ import annotations

import argparse
import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from tribo.commands import scene_options as shared
from tribo.files import strict_json
from tribo.interrupts import COMPLETED
from tribo.validation import InputError, must_be

if TYPE_CHECKING:
    import xarray

# Options that have other names than arguments of `tribo.fit` and `tribo.sensitivity`.
OPTIONS = {"ranges": "--vary", "quantities": "--keep", "scales": "--scale"}


def add_fit(fit: argparse.ArgumentParser) -> None:
    """Add the options of `tribo fit`."""
    shared.add_scene(fit)
    trace = "the measured series: columns of times and values with commas between them"
    fit.add_argument("trace", type=Path, metavar="TRACE.csv", help=trace)
    vary = "a parameter to find, in its range, as 'field.amplitude=0.05:0.2'; may be repeated"
    fit.add_argument("--vary", action="append", required=True, metavar="KEY=LOW:HIGH", help=vary)
    quantity = "the quantity that was measured, as upper.pull_force"
    fit.add_argument("--quantity", required=True, metavar="NAME", help=quantity)
    noise = "standard deviation of the values (default: found from the residuals)"
    fit.add_argument("--noise", metavar="SIZE", help=noise)
    members = "number of runs whose mean is fitted, where the scene has noise"
    fit.add_argument("--members", type=int, metavar="N", help=members)
    starts = "number of starts in the ranges (default: 32 for each parameter)"
    fit.add_argument("--starts", type=int, metavar="N", help=starts)
    fit.add_argument("--no-profiles", action="store_true", help="do not check the intervals")
    fit.add_argument("--seed", type=int, default=0, help="seed of the starts (default: 0)")
    shared.add_numerics(fit)
    shared.add_output(fit, "the fit", "draw the measured and the fitted series")
    fit.set_defaults(command=_fit)


def add_sensitivity(sensitivity: argparse.ArgumentParser) -> None:
    """Add the options of `tribo sensitivity`."""
    shared.add_scene(sensitivity)
    keep = "quantities at the end of the run, separated by commas, as upper.W"
    sensitivity.add_argument("--keep", required=True, metavar="NAMES", help=keep)
    keys = "parameters, separated by commas, as upper.velocity,interaction.strength"
    sensitivity.add_argument("--keys", required=True, metavar="KEYS", help=keys)
    scale = "size of the changes of a key whose value is zero; may be repeated"
    sensitivity.add_argument("--scale", metavar="KEY=SIZE", help=scale, **shared.REPEATED)
    members = "number of runs at each point, where the scene has noise"
    sensitivity.add_argument("--members", type=int, metavar="N", help=members)
    sensitivity.add_argument("--seed", type=int, default=0, help="seed of the members (default: 0)")
    shared.add_numerics(sensitivity)
    figure = "draw the relative derivatives of the first quantity, the largest on top"
    shared.add_output(sensitivity, "the derivatives", figure)
    sensitivity.set_defaults(command=_sensitivity)


def _fit(options: argparse.Namespace) -> int:
    """Fit the keys of a scene to a measured series, and print or draw the result."""
    from tribo.fitting import fit
    from tribo.plotting.style import save

    shared.check_figure(options.figure)
    scene = shared.load_with_values(options)
    ranges = dict(_range(key, text) for key, text in shared.by_key("--vary", options.vary).items())
    noise = shared.as_number("--noise", options.noise)
    names = ("members", "starts", "seed")
    try:
        found = fit(
            scene,
            options.trace,
            ranges,
            options.quantity,
            noise=noise,
            profiles=not options.no_profiles,
            **{name: getattr(options, name) for name in names},
            **shared.numerics_of(options),
        )
    except InputError as error:
        raise _of_option(error) from None
    print(found.to_json() if options.json else found)
    shared.draw_to(options.figure, lambda path: save(found.plot(), path))
    return COMPLETED


def _sensitivity(options: argparse.Namespace) -> int:
    """Print or draw the derivatives of quantities by keys."""
    from tribo.derivatives import sensitivity

    shared.check_figure(options.figure)
    scene = shared.load_with_values(options)
    scales = {
        key: shared.as_number(f"--scale {key}", text) or 0.0
        for key, text in shared.by_key("--scale", options.scale).items()
    }
    quantities, keys = (_listed(text) for text in (options.keep, options.keys))
    members = {"members": options.members, "seed": options.seed}
    try:
        data = sensitivity(
            scene, quantities, keys, scales=scales, **members, **shared.numerics_of(options)
        )
    except InputError as error:
        raise _of_option(error) from None
    print(_as_json(data) if options.json else _as_text(data))
    shared.draw_to(options.figure, partial(_draw, data))
    return COMPLETED


def _draw(data: xarray.Dataset, path: Path) -> None:
    from tribo.derivatives.figure import tornado
    from tribo.plotting.style import save

    save(tornado(data), path)


def _range(key: str, text: str) -> tuple[str, tuple[float, float]]:
    """The range of a key in a text as "0.05:0.2".  Raises InputError."""
    low, colon, high = text.partition(":")
    if not colon:
        raise must_be(f"--vary {key}", "LOW:HIGH", text)
    both = (shared.as_number(f"--vary {key}", each) for each in (low, high))
    first, second = both
    assert first is not None and second is not None
    return key, (first, second)


def _listed(text: str) -> list[str]:
    return [word.strip() for word in text.split(",") if word.strip()]


def _of_option(error: InputError) -> InputError:
    """The error with the option of the command that has the value."""
    first, _, rest = error.field.partition(".")
    if first == "data":
        return InputError("TRACE.csv", error.problem)
    if first in OPTIONS:
        return InputError(f"{OPTIONS[first]} {rest}".strip(), error.problem)
    return error


def _as_json(data: xarray.Dataset) -> str:
    """For each quantity and key its derivative with the half-width, and the relative ones."""
    names = ("derivative", "half_width", "relative", "relative_half_width", "step")
    rows = []
    for quantity in data["quantity"].values.tolist():
        for key in data["key"].values.tolist():
            one = data.sel(quantity=quantity, key=key)
            row = {"quantity": quantity, "key": key, "value": one["value"].item()}
            rows.append(row | {name: one[name].item() for name in names})
    values = {str(one["quantity"].item()): one.item() for one in data["quantity_value"]}
    notes = json.loads(data.attrs["notes"])
    whole = {"derivatives": rows, "quantities": values, "runs": data.attrs["runs"], "notes": notes}
    return strict_json(whole)


def _as_text(data: xarray.Dataset) -> str:
    """A table for each quantity, the largest relative derivative first."""
    lines = []
    for quantity in data["quantity"].values.tolist():
        own = data.sel(quantity=quantity)
        lines.append(f"{quantity} = {own['quantity_value'].item():.6g}")
        heading = f"  {'key':<28}{'value':>12}{'derivative':>14}{'+-':>10}{'relative':>12}"
        lines.append(heading)
        order = abs(own["relative"]).fillna(-1.0).argsort().values[::-1]
        for one in (own.isel(key=int(k)) for k in order):
            key, value = str(one["key"].item()), one["value"].item()
            numbers = f"{one['derivative'].item():14.6g}{one['half_width'].item():10.2g}"
            lines.append(f"  {key:<28}{value:12.6g}{numbers}{one['relative'].item():12.4g}")
    return "\n".join([*lines, f"{data.attrs['runs']} runs", *json.loads(data.attrs["notes"])])
