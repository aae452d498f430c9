"""Inverse powers of the distance, and differences of two of them."""

from tribo.potentials.potential import Potential

# Distance of the minimum of Lennard-Jones, where this potential ends [sigma].
END = 2.0 ** (1.0 / 6.0)


class LennardJones(Potential):
    """U = 4 epsilon ((sigma/r)^12 - (sigma/r)^6): a minimum of depth epsilon, zero at sigma.

    Attributes
    ----------
    epsilon : float
        Depth of the minimum [energy], not negative.
    sigma : float
        Distance at which U changes sign [length], positive.

    References
    ----------
    J. E. Jones, Proc. R. Soc. Lond. A 106 (1924) 463.
    """

    epsilon: float
    sigma: float
    _limits = (("epsilon", ">=", "energy"), ("sigma", ">", "length"))
    _key = "lennard-jones"

    def energy(self, r):
        s6 = (self.sigma * (1.0 / r)) ** 6  # as below, so that both are computed once
        return 4.0 * self.epsilon * s6 * (s6 - 1.0)

    def force(self, r):
        inverse = 1.0 / r  # loops over pairs compute it too
        s6 = (self.sigma * inverse) ** 6
        return 24.0 * self.epsilon * inverse * s6 * (2.0 * s6 - 1.0)

    def acts_at_all(self):
        return self.epsilon != 0.0

    def feature(self):
        return self.sigma / 6.0, 2.0 * self.sigma

    def minimum(self):
        r = 2.0 ** (1.0 / 6.0) * self.sigma
        return r, -self.epsilon, 72.0 * self.epsilon / (r * r)


class WeeksChandlerAndersen(Potential):
    """U = 4 epsilon ((sigma/r)^12 - (sigma/r)^6) + epsilon below 2^(1/6) sigma, else 0.

    The repulsive part of Lennard-Jones, which ends where U and the force are zero.

    Attributes
    ----------
    epsilon : float
        Energy at sigma [energy], not negative.
    sigma : float
        Length of Lennard-Jones [length], positive.

    References
    ----------
    J. D. Weeks, D. Chandler, H. C. Andersen, J. Chem. Phys. 54 (1971) 5237.
    """

    epsilon: float
    sigma: float
    _limits = (("epsilon", ">=", "energy"), ("sigma", ">", "length"))
    _key = "weeks-chandler-andersen"

    def energy(self, r):
        s6 = (self.sigma / r) ** 6
        return (r < self.range()) * (4.0 * self.epsilon * s6 * (s6 - 1.0) + self.epsilon)

    def force(self, r):
        inverse = 1.0 / r  # loops over pairs compute it too
        s6 = (self.sigma * inverse) ** 6
        return (r < self.range()) * (24.0 * self.epsilon * inverse * s6 * (2.0 * s6 - 1.0))

    def acts_at_all(self):
        return self.epsilon != 0.0

    def feature(self):
        return self.sigma / 6.0, END * self.sigma

    def range(self):
        return END * self.sigma

    def smoothness(self):
        """Number of continuous derivatives of U: the force has a kink at its end."""
        return 1

    def smoothness_within(self):
        """Number of continuous derivatives of U below its end: all."""
        return float("inf")


class Mie(Potential):
    """U = c epsilon ((sigma/r)^n - (sigma/r)^m) with c = n/(n - m) (n/m)^(m/(n - m)).

    n = 12 and m = 6 give Lennard-Jones.

    Attributes
    ----------
    epsilon : float
        Depth of the minimum [energy], not negative.
    sigma : float
        Distance at which U changes sign [length], positive.
    n : float
        Power of the repulsion, above m.
    m : float
        Power of the attraction, positive.

    References
    ----------
    G. Mie, Ann. Phys. (Leipzig) 316 (1903) 657.
    """

    epsilon: float
    sigma: float
    n: float
    m: float
    _limits = (("epsilon", ">=", "energy"), ("sigma", ">", "length"), ("m", ">", ""))
    _key = "mie"

    def energy(self, r):
        n = self.n
        m = self.m
        s = self.sigma / r
        return self.epsilon * n / (n - m) * (n / m) ** (m / (n - m)) * (s**n - s**m)

    def force(self, r):
        inverse = 1.0 / r  # loops over pairs compute it too
        n = self.n
        m = self.m
        s = self.sigma * inverse
        scale = self.epsilon * n / (n - m) * (n / m) ** (m / (n - m))
        return scale * (n * s**n - m * s**m) * inverse

    def acts_at_all(self):
        return self.epsilon != 0.0

    def feature(self):
        return 2.0 * self.sigma / self.n, 2.0 * self.sigma

    def minimum(self):
        r = (self.n / self.m) ** (1.0 / (self.n - self.m)) * self.sigma
        return r, -self.epsilon, self.n * self.m * self.epsilon / (r * r)

    def constraints(self):
        return (*super().constraints(), ("n", self.n > self.m, f"must be above m = {self.m:g}"))


class SoftSphere(Potential):
    """U = epsilon (sigma/r)^n: a repulsion by an inverse power, smooth at every r.

    Attributes
    ----------
    epsilon : float
        Energy at sigma [energy], not negative.
    sigma : float
        Length [length], positive.
    n : float
        Power, positive.

    References
    ----------
    W. G. Hoover et al., J. Chem. Phys. 52 (1970) 4931.
    """

    epsilon: float
    sigma: float
    n: float
    _limits = (("epsilon", ">=", "energy"), ("sigma", ">", "length"), ("n", ">", ""))
    _key = "soft-sphere"

    def energy(self, r):
        return self.epsilon * (self.sigma / r) ** self.n

    def force(self, r):
        inverse = 1.0 / r  # loops over pairs compute it too
        return self.n * self.epsilon * (self.sigma * inverse) ** self.n * inverse

    def acts_at_all(self):
        return self.epsilon != 0.0

    def feature(self):
        return 2.0 * self.sigma / max(self.n, 2.0), 2.0 * self.sigma
