"""From the numbers of a page to what the pair's loop and its quantities read."""

from tribo.compiler.jit import kernel
from tribo.kernels.kinematics import equation
from tribo.live_pages import inputs
from tribo.live_pages.quantities import Side
from tribo.model.asperite import rod_of
from tribo.pair.bodies import Body

masses_and_arms = equation(rod_of)


@kernel
def body_of(numbers, at, origin_x, origin_y, vx, vy):
    """An asperite whose numbers begin at `at`, relative to a bob and a velocity."""
    mass, l1, l2, inertia = masses_and_arms(
        numbers[at + inputs.M1], numbers[at + inputs.M2], numbers[at + inputs.LENGTH]
    )
    facing = numbers[at + inputs.FACING]
    y = (numbers[at + inputs.BOB_Y] - origin_y) + numbers[at + inputs.HEIGHT]
    return Body(
        mass,
        inertia,
        numbers[at + inputs.KAPPA],
        l1,
        l2,
        numbers[at + inputs.HELD_BAR] * l2,
        facing,
        numbers[at + inputs.BOB_X] - origin_x,
        y + facing * l1,
        numbers[at + inputs.VELOCITY_X] - vx,
        numbers[at + inputs.VELOCITY_Y] - vy,
        numbers[at + inputs.DEPTH],
        numbers[at + inputs.CHARGE],
        numbers[at + inputs.SLIDES],
    )


@kernel
def side_of(numbers, at, body, sign, observer_x, observer_y):
    """A surface as the observer sees it, from the numbers of the page behind `at`."""
    return Side(
        body,
        numbers[at + inputs.REST],
        sign,
        numbers[inputs.BOB_X] + body.x,
        numbers[inputs.BOB_Y] + body.y,
        numbers[at + inputs.VELOCITY_X] - observer_x,
        numbers[at + inputs.VELOCITY_Y] - observer_y,
        numbers[at + inputs.BAR_LENGTH],
        numbers[at + inputs.HELD_BAR],
        numbers[at + inputs.CLAMPED],
    )


@kernel
def bodies_of(numbers):
    """Both asperites, relative to the first one's bob and velocity."""
    x, y = numbers[inputs.BOB_X], numbers[inputs.BOB_Y]
    vx, vy = numbers[inputs.VELOCITY_X], numbers[inputs.VELOCITY_Y]
    second = inputs.OF_SURFACE
    return body_of(numbers, 0, x, y, vx, vy), body_of(numbers, second, x, y, vx, vy)


@kernel
def sides_of(numbers, bodies, observer_x, observer_y):
    one, other = bodies
    second = inputs.OF_SURFACE
    return (
        side_of(numbers, 0, one, 1.0, observer_x, observer_y),
        side_of(numbers, second, other, -1.0, observer_x, observer_y),
    )


@kernel
def set_times(duration, times):
    """Evenly spaced times, as numpy.linspace spaces them."""
    last = times.size - 1
    step = duration / last
    for k in range(last):
        times[k] = k * step
    times[last] = duration


@kernel
def move_times(times, part):
    """Move every other time by this part of the time between two; the last stays."""
    step = times[1] - times[0]
    for k in range(1, times.size - 1, 2):
        times[k] += part * step
