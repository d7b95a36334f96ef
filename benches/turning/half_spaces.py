"""Two equal elastic half-spaces in contact over a circle, with Coulomb friction at every point: shifted, spun and rolled.

The pressure is Hertz's and stays: between equal bodies no shear changes it. The plane is cut into squares of constant
traction, whose displacements are closed forms (Cerruti's solution, integrated). In each step the tractions minimise a
quadratic form on discs, as its matrix is symmetric: an accelerated projected gradient, products by fast Fourier
transforms. Lengths in the contact radius, stresses such that G = 1; the greatest pressure is 1. With numpy.
"""

import math

import numpy as np

F_N = 2 * math.pi / 3


def corners(f, x, y, half):
    """The integral over a square of side 2 half of what f is the antiderivative of."""
    return f(x + half, y + half) - f(x - half, y + half) - f(x + half, y - half) + f(x - half, y - half)


def hertz(n):
    """The pressure on squares of side 1/n, from -1 - 1/n to 1 + 1/n: means over each of them."""
    fine = (np.arange(-8 * (n + 1), 8 * (n + 1)) + 0.5) / (8 * n)
    inside = np.maximum(1.0 - fine[:, None] ** 2 - fine[None, :] ** 2, 0.0)
    means = np.sqrt(inside).reshape(2 * n + 2, 8, 2 * n + 2, 8).mean(axis=(1, 3))
    return means * (F_N * n * n / means.sum())


class HalfSpaces:
    """With n squares along the contact radius."""

    def __init__(self, n, nu, mu):
        self.nu, self.mu, self.side = nu, mu, 1.0 / n
        self.pressure = hertz(n)
        self.touches = self.pressure > 0
        middle = (np.arange(-n - 1, n + 1) + 0.5) * self.side
        self.x, self.y = np.meshgrid(middle, middle, indexing="ij")
        m = 2 * n + 2
        offset = np.fft.ifftshift(np.arange(-m, m)) * self.side
        x, y = np.meshgrid(offset, offset, indexing="ij")
        along_x = corners(lambda x, y: y * np.log(x + np.hypot(x, y)), x, y, self.side / 2)  # of x^2/r^3
        along_y = corners(lambda x, y: x * np.log(y + np.hypot(x, y)), x, y, self.side / 2)  # of y^2/r^3
        across = corners(lambda x, y: -np.hypot(x, y), x, y, self.side / 2)  # of x y/r^3
        scale = 2.0 / (2.0 * math.pi)  # both bodies; 1/(2 pi G)
        parts = (along_x + (1.0 - nu) * along_y, along_y + (1.0 - nu) * along_x, nu * across)
        self.xx, self.yy, self.xy = (np.fft.rfft2(scale * part) for part in parts)
        self.traction = np.zeros((2, m, m))
        v = self.pressure * np.array([1.0, 0.3]).reshape(2, 1, 1)
        for _ in range(30):
            v = self.displacements(v / np.linalg.norm(v))
        self.stiffness = 1.05 * np.linalg.norm(v)

    def displacements(self, q):
        """Of one surface on the other, where they touch, by tractions."""
        m = q.shape[1]
        x, y = np.fft.rfft2(q, s=(2 * m, 2 * m))
        both = np.array([self.xx * x + self.xy * y, self.xy * x + self.yy * y])
        return np.fft.irfft2(both, s=(2 * m, 2 * m))[:, :m, :m] * self.touches

    def slip(self):
        """Cattaneo's and Mindlin's displacement, at which everything slips."""
        return 2 * 3 * self.mu * F_N * (2 - self.nu) / 16

    def within(self, q):
        size = np.hypot(q[0], q[1])
        return q * np.minimum(1.0, self.mu * self.pressure / np.maximum(size, 1e-300))

    def move(self, d, start=None):
        """Moves one over the other by d (a vector, or one at each square), from tractions `start`; gives F_T."""
        start = self.traction if start is None else start
        d = np.broadcast_to(d, start.shape) * self.touches
        q, y, t = self.within(start * self.touches), self.within(start * self.touches), 1.0
        for _ in range(5000):
            new = self.within(y + (d - self.displacements(y - start)) / self.stiffness)
            change = new - q
            if np.sum((y - new) * change) > 0:
                t = 1.0
            after = 0.5 * (1 + math.sqrt(1 + 4 * t * t))
            y, q, t = new + (t - 1) / after * change, new, after
            if np.abs(change).max() < 1e-7 * self.mu:
                break
        self.traction = q
        return self.force()

    def shift(self, x, y):
        """By a displacement along x and y; gives F_T."""
        return self.move(np.array([x, y]).reshape(2, 1, 1))

    def roll(self, longitudinal, lateral, spin):
        """Rolls along x by the side of a square, slipping by these creepages; gives F_T."""
        start = np.zeros_like(self.traction)
        start[:, :-1] = self.traction[:, 1:]  # what has been passed lies further back
        return self.move(self.side * np.array([longitudinal - spin * self.y, lateral + spin * self.x]), start)

    def force(self):
        return self.traction.sum(axis=(1, 2)) * self.side**2

    def moment(self):
        return float((self.x * self.traction[1] - self.y * self.traction[0]).sum() * self.side**2)
