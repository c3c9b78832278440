"""A vehicle's network of thermal nodes as Pitviper solves it against SciPy's Radau.

    network_judge.py FILE.csv       of tests/tools/plate_vehicle.c

Prints, to be read by test_network_judge.sh:
    node WORST_K MOVED_K            over the nodes, at the end; how far they moved, at most
    heat SHARE                      heat from outside against heat stored, of it
"""
import csv
import sys

import numpy as np
from scipy.integrate import solve_ivp

SIGMA = 5.670374419184429e-8
rows = {}
for row in csv.reader(open(sys.argv[1])):
    rows.setdefault(row[0], []).append([float(x) for x in row[1:]])
_, capacity, start, end = np.array(rows["node"]).T
count = len(capacity)


def laplacian(flows):
    out = np.zeros((count, count))
    for a, b, size in flows:
        a, b = int(a), int(b)
        out[a, a] -= size
        out[b, b] -= size
        out[a, b] += size
        out[b, a] += size
    return out


conducts, radiates = laplacian(rows["link"]), laplacian(rows["exchange"])
knots = sorted({row[0] for row in rows["load"]})
loads = np.zeros((len(knots), count, 4))
for t, i, *load in rows["load"]:
    loads[knots.index(t), int(i)] = load

temp = start.copy()
for k in range(len(knots) - 1):
    begin, length = knots[k], knots[k + 1] - knots[k]

    def load_at(t):
        return (loads[k] + (t - begin) / length * (loads[k + 1] - loads[k])).T

    def slope(t, y):
        heat, film, fluid, emits = load_at(t)
        fourth = SIGMA * y**4
        return (conducts @ y + radiates @ fourth + heat + film * (fluid - y) - emits * fourth) / capacity

    def jacobian(t, y):
        _, film, _, emits = load_at(t)
        cubed = 4 * SIGMA * y**3
        return (conducts + radiates * cubed - np.diag(film + emits * cubed)) / capacity[:, None]

    solved = solve_ivp(slope, (begin, knots[k + 1]), temp, method="Radau", rtol=1e-10, atol=1e-9, jac=jacobian,
                       t_eval=[knots[k + 1]])
    assert solved.success, solved.message
    temp = solved.y[:, -1]

print("node", f"{np.abs(temp - end).max():.3g}", f"{np.abs(temp - start).max():.3g}")
heat, stored = rows["heat"][0]
print("heat", f"{abs(heat - stored) / abs(heat):.3g}")
