"""leaf_optics.py plant_optics.csv: its leaves against PROSPECT-D as PyPI's prosail computes it, by the parameters that the table states."""
import csv
import re
import sys

import numpy as np
import prosail

CAROTENOIDS = {"alder": 10, "hedge": 10, "birch": 8, "reed": 8, "grass_tuft": 8, "dry_tuft": 6}  # others 9
BROWN = {"pine": 0.1, "reed": 0.1, "bush": 0.05, "grass_tuft": 0.05}


def rows(path):
    return list(csv.DictReader(line for line in open(path) if not line.startswith("#")))


edges = {r["name"]: (1000 * float(r["low_um"]), 1000 * float(r["high_um"])) for r in rows("etc/channels.csv")}
worst, count = 0.0, 0
for row in rows(sys.argv[1]):
    if not row["name"].startswith("leaf_"): continue
    kind, says = row["name"][5:], dict(re.findall(r"(N|Cab|Cw|Cm|Cbrown) (\d*\.?\d+)", row["source"]))
    nm, rho, tau = prosail.run_prospect(float(says["N"]), float(says["Cab"]), CAROTENOIDS.get(kind, 9),
                                        float(says.get("Cbrown", BROWN.get(kind, 0))), float(says["Cw"]), float(says["Cm"]),
                                        ant=1, prospect_version="D")
    nm = nm.astype(float)
    sun = nm ** -5 / (np.exp(1.4388e7 / (nm * 5778)) - 1)
    for band in ("b", "g", "r", "pan", "nir", "swir"):
        within = (nm >= edges[band][0]) & (nm <= edges[band][1])
        for name, spectrum in (("rho_", rho), ("tau_", tau)):
            off = abs(float(row[name + band]) - np.average(spectrum[within], weights=sun[within]))
            if off > 1e-3: print(f"FAILED: {row['name']} {name}{band} is {off:.4f} off")
            worst, count = max(worst, off), count + 1
print(f"{count} values, worst {worst:.1e}")
sys.exit(worst > 1e-3 or count < 100)
