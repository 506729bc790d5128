"""Evidences of C1's two models by quadrature, with an integrator of its own."""
import numpy as np

MASS, DAMPING, RATE = 0.5, 0.1, 100.0


def simulate(force, k, k3):
    """Displacements [samples × parameter sets] of m y'' + c y' + k y + k3 y³ = f from rest: classical
    Runge-Kutta, four steps a sample, f linear between samples."""
    steps, h = 4, 1.0 / RATE / 4
    y, v = np.zeros_like(k), np.zeros_like(k)
    out = np.empty((len(force), len(k)))

    def acceleration(f, y, v):
        return (f - DAMPING * v - k * y - k3 * y**3) / MASS

    for n in range(len(force)):
        out[n] = y
        if n + 1 == len(force):
            break
        for s in range(steps):
            f0, f1 = (force[n] + (force[n + 1] - force[n]) * (s + w) / steps for w in (0.0, 1.0))
            fm = 0.5 * (f0 + f1)
            a1 = acceleration(f0, y, v)
            y2, v2 = y + 0.5 * h * v, v + 0.5 * h * a1
            a2 = acceleration(fm, y2, v2)
            y3, v3 = y + 0.5 * h * v2, v + 0.5 * h * a2
            a3 = acceleration(fm, y3, v3)
            y4, v4 = y + h * v3, v + h * a3
            a4 = acceleration(f1, y4, v4)
            y, v = y + h / 6 * (v + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return out


def log_sum(values):
    top = values.max()
    return top + np.log(np.exp(values - top).sum())


def refine(log_likelihood, low, high, points):
    """∫ likelihood dx over a box [ln], and the box that holds what is within e^-18 of the top, found by
    shrinking; the midpoint rule on it (the integrand vanishes at its edges or ends at the prior's)."""
    while True:
        axes = [a + (b - a) * (np.arange(points) + 0.5) / points for a, b in zip(low, high)]
        grid = np.stack([g.ravel() for g in np.meshgrid(*axes, indexing="ij")])
        values = log_likelihood(*grid)
        cell = (high - low) / points
        inside = grid[:, values > values.max() - 18.0]
        new_low = np.maximum(low, inside.min(axis=1) - cell)
        new_high = np.minimum(high, inside.max(axis=1) + cell)
        if np.all(new_high - new_low > 0.6 * (high - low)):
            return log_sum(values) + np.log(np.prod(cell)), low, high
        low, high = new_low, new_high


def log_bayes_factors(force, displacement, sigma, lengths):
    """ln B(Duffing : linear) from the first n samples, for growing n, with k ~ U(0, 100) and
    k3 ~ U(100, 10 000). The search for the posterior of n begins around that of the n before."""
    priors = [(np.array([0.0]), np.array([100.0])), (np.array([0.0, 100.0]), np.array([100.0, 1e4]))]
    points = [(4000, 200), (120, 50)]  # of the first search, of the later ones
    boxes = list(priors)
    out = []
    for count, n in enumerate(lengths):
        def log_likelihood(k, k3=None, n=n):
            with np.errstate(over="ignore", invalid="ignore"):
                y = simulate(force[:n], k, np.zeros_like(k) if k3 is None else k3)
                sums = ((displacement[:n, None] - y) ** 2).sum(axis=0)
            return np.where(np.isfinite(sums), -0.5 * sums / sigma**2, -np.inf)
        evidence = []
        for m, (low, high) in enumerate(priors):
            width = boxes[m][1] - boxes[m][0]
            value, *box = refine(log_likelihood, np.maximum(low, boxes[m][0] - 0.3 * width),
                                 np.minimum(high, boxes[m][1] + 0.3 * width), points[m][count > 0])
            boxes[m] = box
            evidence.append(value - np.log(np.prod(high - low)))
        out.append(evidence[1] - evidence[0])
    return out
