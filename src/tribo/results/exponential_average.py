"""The mean of exp(-w / T), with an interval, and whether that interval can be trusted.

The mean may be carried by values that are rarely drawn: a gain w of -5 T counts 150 times as much
as one of zero.  If exp(-w / T) exceeds z with a probability that falls as z^-a, its variance is
finite for a > 2 only, and the usual interval is too short otherwise.  The index a is estimated from
the largest values (B. M. Hill, Annals of Statistics 3, 1163 (1975)).  The interval includes the
mean's part from values above the largest drawn, max / (n (1 - 1 / a)) for such a tail.

Over 400 to 4000 samples of 300 to 30,000 values with a = 3 and 4, or of Gaussian works, 0.91 to
0.99 of the trusted intervals contained the mean.  With a = 2.1 no sample was trusted; with 2.4 at
most 1 % were, and 0.2 to 0.3 % of all were trusted and missed the mean.  With an index above 2 as
the criterion, and without the part beyond the largest value, 0.2 to 0.8 of the trusted ones
contained it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tribo.results.averages import mean_text
from tribo.validation import POSITIVE, InputError, number, vector

# Of a normal deviate: 95 % are below it in magnitude.
NORMAL = 1.959964
# Fewest values that carry half of the mean in a trusted interval: so many have nearly normal sums.
FEWEST_CARRIERS = 100
# Smallest trusted tail index: near 2, where variances become finite, samples may lack their tail.
SMALLEST_INDEX = 2.5
# Fewest values that can be judged.
FEWEST = 100


@dataclass(frozen=True)
class ExponentialAverage:
    """The mean of exp(-w / T).

    Attributes
    ----------
    mean : float
        Mean over all values.
    half_width : float
        Half-width of the 95 % interval of the mean, from the central limit theorem and an
        estimate for values larger than any drawn. Infinite where the tail index is at most 1.
    tail_index : float
        Index a of the largest values: the probability of exceeding z falls as z^-a.
    carriers : int
        Number of the largest values that add up to half of the sum.
    trusted : bool
        Whether the interval can be trusted: the index is above 2.5 by two standard errors, and
        there are at least 100 carriers.  Values that are rarer than one in all drawn remain
        unknown.
    """

    mean: float
    half_width: float
    tail_index: float
    carriers: int
    trusted: bool

    def __str__(self) -> str:
        text = mean_text(self.mean, self.half_width)
        if self.trusted:
            return text
        return (
            f"{text} (not to be trusted: half of it is carried by {self.carriers} values, whose "
            f"tail index is {self.tail_index:.2g})"
        )


def exponential_average(work: ArrayLike, temperature: float) -> ExponentialAverage:
    """Estimate the mean of exp(-w / T), as in the equalities of Bochkov, Kuzovlev and Jarzynski.

    Parameters
    ----------
    work : array_like, (members,)
        Works w, or gains of energy [energy]; at least 100.
    temperature : float
        Temperature T [energy], with k_B = 1.  For surfaces at different temperatures, take the sum
        of their gains over their temperatures as `work`, and 1 here.

    Raises
    ------
    InputError
        The works are no list of at least 100 finite numbers, or the temperature is not positive.
    """
    works = np.sort(vector("work", work))
    if works.size < FEWEST:
        raise InputError("work", f"must have at least {FEWEST} values, got {works.size}")
    exponents = -works / number("temperature", temperature, POSITIVE, "energy")
    top = exponents[0]
    weights = np.exp(exponents - top)  # relative to the largest, descending
    carriers = int(np.searchsorted(np.cumsum(weights), 0.5 * weights.sum())) + 1
    tail = int(np.sqrt(works.size))
    excess = float(np.mean(exponents[:tail] - exponents[tail]))
    index = np.inf if excess == 0.0 else 1.0 / excess
    enough = index * (1.0 - 2.0 / np.sqrt(tail)) > SMALLEST_INDEX
    unseen = 1.0 / (works.size * (1.0 - excess)) if excess < 1.0 else np.inf
    half = NORMAL * np.std(weights, ddof=1) / np.sqrt(works.size) + unseen
    scale = np.exp(top)
    return ExponentialAverage(
        float(scale * weights.mean()),
        float(scale * half),
        float(index),
        carriers,
        bool(enough and carriers >= FEWEST_CARRIERS),
    )
