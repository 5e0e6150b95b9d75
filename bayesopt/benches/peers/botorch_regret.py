"""Simple regret of BoTorch after 50 evaluations, on the given points of our own table: `botorch_regret.py SEEDS|FROM..TO FUNCTION…`

Its defaults: SingleTaskGP (dimension-scaled prior, standardised costs), hyper-parameters by marginal likelihood, q = 1 LogEI in the
Monte-Carlo form of qLogEI (or the analytic one, `--analytic`), 10 restarts of 512 raw samples. The functions are BoTorch's own.
Needs Python with `botorch`. Prints the regret of every seed, median and quartiles, and the processor time of a suggestion.
"""

import argparse
import statistics
import time
import warnings

import torch
from botorch.acquisition import LogExpectedImprovement, qLogExpectedImprovement
from botorch.fit import fit_gpytorch_mll
from botorch.models import SingleTaskGP
from botorch.models.transforms import Standardize
from botorch.optim import optimize_acqf
from botorch.test_functions import Ackley, Branin, Hartmann, Levy
from gpytorch.mlls import ExactMarginalLogLikelihood

MASK = (1 << 64) - 1


class RandomSource:
    """The random source of docs/optimiser_problems.md."""

    def __init__(self, k):
        self.state = (k * 0x9E3779B97F4A7C15 + 0xD1B54A32D192ED03) & MASK

    def uniform(self):
        self.state = (self.state * 6364136223846793005 + 1442695040888963407) & MASK
        z = self.state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
        return ((z ^ (z >> 31)) >> 11) * 2.0**-53


class OnUnitCube:
    """A function of BoTorch between `low` and `high`, its least value taken off."""

    def __init__(self, function, low, high):
        self.function, self.low, self.high = function, torch.tensor(low).double(), torch.tensor(high).double()

    def __call__(self, u):
        return self.function(self.low + (self.high - self.low) * u) - self.function.optimal_value


FUNCTIONS = {
    "branin2": (2, lambda: OnUnitCube(Branin(), [-5.0, 0.0], [10.0, 15.0])),
    "hartmann6": (6, lambda: OnUnitCube(Hartmann(dim=6), [0.0] * 6, [1.0] * 6)),
    "ackley14": (14, lambda: OnUnitCube(Ackley(dim=14), [-5.0] * 14, [10.0] * 14)),
    "levy14": (14, lambda: OnUnitCube(Levy(dim=14), [-5.0] * 14, [10.0] * 14)),
}


def regret(function, dimension, seed, analytic, seconds):
    torch.manual_seed(seed)
    source = RandomSource(1000 + seed)
    x = torch.tensor([[source.uniform() for _ in range(dimension)] for _ in range(10)], dtype=torch.double)
    y = function(x).unsqueeze(-1)
    cube = torch.stack([torch.zeros(dimension), torch.ones(dimension)]).double()
    while len(x) < 50:
        begin = time.process_time()
        # BoTorch maximises.
        gp = SingleTaskGP(x, -y, outcome_transform=Standardize(m=1))
        fit_gpytorch_mll(ExactMarginalLogLikelihood(gp.likelihood, gp))
        best = (-y).max()
        acquisition = LogExpectedImprovement(gp, best) if analytic else qLogExpectedImprovement(gp, best)
        point, _ = optimize_acqf(acquisition, bounds=cube, q=1, num_restarts=10, raw_samples=512)
        seconds.append(time.process_time() - begin)
        x, y = torch.cat([x, point]), torch.cat([y, function(point).unsqueeze(-1)])
    return y.min().item()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--analytic", action="store_true")
    parser.add_argument("seeds")
    parser.add_argument("functions", nargs="+", choices=FUNCTIONS)
    arguments = parser.parse_args()
    begin, _, end = arguments.seeds.rpartition("..")
    torch.set_num_threads(1)
    warnings.simplefilter("ignore")
    for name in arguments.functions:
        dimension, make = FUNCTIONS[name]
        seconds = []
        regrets = []
        for seed in range(int(begin or 0), int(end)):
            regrets.append(regret(make(), dimension, seed, arguments.analytic, seconds))
            print(f"{name} seed {seed}: {regrets[-1]:.4g}", flush=True)
        low, middle, high = statistics.quantiles(regrets, n=4) if len(regrets) > 1 else regrets * 3
        print(f"{name}: median {middle:.3g}, quartiles {low:.3g} – {high:.3g}, {1e3 * statistics.mean(seconds):.0f} ms", flush=True)


if __name__ == "__main__":
    main()
