"""anchors.py ETC ANCHORS: the values of tables of the folder ETC that a list of published ones names (tests/data/anchors.csv),
and orderings that hold in nature. Each anchor's row is found by its first cells."""
import csv
import glob
import math
import os
import sys

etc, failed, checks = sys.argv[1], 0, 0


def read(path):
    with open(path) as lines:
        return [[cell.strip() for cell in row] for row in
                csv.reader((x for x in lines if x.strip() and x[0] != "#"), skipinitialspace=True)]


def expect(good, what):
    global failed, checks
    checks += 1
    if not good:
        failed += 1
        print("FAILED:", what)


tables = {}


def table(name):
    if name not in tables: tables[name] = read(os.path.join(etc, name))
    return tables[name]


anchored = set()
for name, key, columns, values, within, source in read(sys.argv[2])[1:]:
    head, cells = table(name)[0], key.split("/")
    anchored.add(name)
    row = next((r for r in table(name)[1:] if r[: len(cells)] == cells), None)
    columns, values = columns.split(), values.split()
    expect(len(columns) == len(values), f"{sys.argv[2]}: {name} {key}: {len(columns)} columns, {len(values)} values")
    expect(row is not None, f"{name} {key}: no such row ({source})")
    for column, value in zip(columns, values) if row else ():
        if column not in head:
            expect(False, f"{name} {key}: no column {column}")
            continue
        got = row[head.index(column)]
        try:
            # half of the last digit of a float is no difference
            good = abs(float(got) - float(value)) <= float(within) + 1e-9 * abs(float(value))
            expect(float(value) == 0 or float(within) < 0.9 * abs(float(value)),
                   f"{sys.argv[2]}: {name} {key}: {column}: {value} within {within} says nothing")
        except ValueError:
            good = got == value
        expect(good, f"{name} {key}: {column} is {got}, not {value} within {within} ({source})")

# a table is anchored by its name, those of an atmosphere's visibilities by that of any
ours = [os.path.relpath(p, etc) for f in ("*.csv", "radar/*.csv", "atmosphere/*.csv", "atmosphere/*/*.csv") for p in
        glob.glob(os.path.join(etc, f))]
for name in sorted(ours):
    if os.path.basename(name) in ("quality.csv", "phase.csv", "phase_swir.csv"): continue  # orderings below
    expect(name in anchored, f"{name} has no anchor; add a published value of it to tests/data/anchors.csv")

if failed:  # orderings are of whole tables
    print(f"{checks} checks, {failed} failed")
    sys.exit(1)


def columns(name, *names):
    """{key: numbers}: names[0] has the columns of the key, with blanks between, all others are columns of numbers"""
    key, head = names[0].split(), table(name)[0]
    at = [head.index(n) for n in names[1:]]
    return {tuple(r[head.index(k)] for k in key): tuple(float(r[i] or "nan") for i in at) for r in table(name)[1:]}


def falling(name, what, values, strictly=True):
    """values: [(row, number)], the greatest first"""
    for (a, x), (b, y) in zip(values, values[1:]):
        expect(x > y if strictly else x >= y, f"{name}: {what} of {a} ({x}) is not above that of {b} ({y})")


# materials: snow, soil, water in the visible; green plants jump at 0.7 um; bare metal mirrors in LWIR; a mean lies within its
# parts; bark and stone of plant_optics.csv are those of materials.csv
optics = columns("materials.csv", "name", "rho_b", "rho_g", "rho_r", "rho_pan", "rho_nir", "rho_lwir", "solar_absorptance")
falling("materials.csv", "rho_g", [(m, optics[m,][1]) for m in ("snow_fine", "snow_coarse", "concrete", "soil_loam_brown",
        "grass_green", "soil_plowed_dark", "water_tap")])
falling("materials.csv", "rho_g", [(m, optics[m,][1]) for m in ("paint_white_missile", "paint_sand", "paint_ship_grey",
        "paint_air_grey", "paint_olive", "paint_deck_grey", "metal_dark", "motor_nozzle")])
falling("materials.csv", "rho_lwir", [(m, optics[m,][5]) for m in ("metal_aluminium_bare", "steel_worn", "paint_olive",
        "water_tap")])
for m, (b, g, r, pan, nir, lwir, sun) in optics.items():
    expect(min(b, g, r) <= pan <= max(b, g, r), f"materials.csv: rho_pan of {m[0]} is not between its parts")
    expect(0.2 < sun + max(b, g, r, nir) and sun + min(b, g, r, nir) < 1.11,
           f"materials.csv: solar_absorptance of {m[0]} and what it reflects do not make 1")
for m in ("grass_green", "leaf_deciduous", "needle_conifer"):
    expect(optics[m,][4] > 3 * optics[m,][2], f"materials.csv: {m} is no green plant: rho_nir, rho_r")
leaves = columns("plant_optics.csv", "name", "rho_g", "rho_r", "rho_nir", "tau_nir", "solar_absorptance")
for (m,), (g, r, nir, through, sun) in leaves.items():
    expect(nir + through < 1 and 0 < sun < 1, f"plant_optics.csv: {m} sends on more than it gets")
    if m.startswith("leaf_") and m != "leaf_dry_tuft":
        expect(g > r and nir > 3 * r, f"plant_optics.csv: {m} is no green leaf: rho_g, rho_r, rho_nir")
shared = [c for c in table("materials.csv")[0] if c.startswith("rho_")] + [
    "solar_absorptance", "gloss", "roughness_rad", "radar_gamma", "conductivity_w_mk", "density_kg_m3", "heat_capacity_j_kgk"]
theirs, own = columns("materials.csv", "name", *shared), columns("plant_optics.csv", "name", *shared)
for m, of in (("bark_pine", "bark_pine"), ("bark_english_oak", "bark_oak"), ("bark_sessile_oak", "bark_oak"),
              ("bark_red_oak", "bark_oak"), ("bark_white_oak", "bark_oak"), ("stone_boulder", "stone_granite")):
    expect(own[m,] == theirs[of,], f"plant_optics.csv: {m} is not {of} of materials.csv")

# effects: no smoke, gas or dust takes more of a longer wave among visible, MWIR and LWIR (exhaust's soot is left out in the
# visible); swir lies between its neighbours
for (m,), (blue, nir, swir, mwir, lwir) in columns("effects.csv", "name", "ext_b", "ext_nir", "ext_swir", "ext_mwir",
                                                   "ext_lwir").items():
    falling("effects.csv", "extinction", [(m + " b", blue)] * (m != "exhaust") + [
        (m + " mwir", mwir), (m + " lwir", lwir)], False)
    expect(min(nir, mwir) <= swir <= max(nir, mwir), f"effects.csv: ext_swir of {m} is not between nir and mwir")

# clutter: rougher to shorter waves, and rougher classes above smoother ones in every band; crossed below VV
clutter = columns("radar/clutter.csv", "surface band", "gamma_db", "hv_vv_db", "roughness_mm")
for band in ("Ku", "Ka", "W"):
    falling("radar/clutter.csv", "gamma_db, " + band, [(s, clutter[s, band][0]) for s in (
        "built", "forest_broadleaf", "scrub", "grass", "dry_grass", "bare_soil", "sand", "road", "water")])
for (surface, band), (gamma, crossed, rms) in clutter.items():
    expect(crossed < 0, f"radar/clutter.csv: {surface} {band}: hv_vv_db is not below 0")
    if band != "W" and surface != "water":
        above = clutter[surface, "Ka" if band == "Ku" else "W"]
        expect(above[0] > gamma and above[1] > crossed, f"radar/clutter.csv: {surface}: gamma or hv_vv_db falls from {band}")

# radar's ground: wetter soil mirrors more, and all soils less at higher frequencies
ground = columns("radar/ground.csv", "surface f_ghz", "eps_re", "eps_im", "rms_mm")
for f in ("10", "35", "94"):
    falling("radar/ground.csv", f"eps_re, {f} GHz", [(s, ground[s, f][0]) for s in (
        "wetland", "grass", "bare_soil", "dry_grass", "track")])
for (surface, f), (re, im, rms) in ground.items():
    if f == "94" and surface != "built":
        falling("radar/ground.csv", "eps_re", [(surface + " " + g, ground[surface, g][0]) for g in ("10", "35", "94")])
    expect(rms == clutter[surface, "Ku"][2], f"radar/ground.csv: {surface}: rms_mm is not roughness_mm of clutter.csv")

# heat of the ground: wind's roughness; layers conduct between down and granite and hold between down and water; mixed water
# conducts more; the air of an engine's gas is hotter than its block; shares of woods make 1
for (surface,), values in columns("ground_heat.csv", "surface", "top_m", "top_w_mk", "top_j_m3k", "under_m", "under_w_mk",
                                  "under_j_m3k", "porosity", "rock_w_mk", "rock_j_m3k").items():
    for thick, w_mk, j_m3k in (values[:3], values[3:6]):
        expect((thick, w_mk, j_m3k) == (0, 0, 0) or (0.001 < thick < 4 and 1e4 < j_m3k < 4.3e6 and
               (0.03 < w_mk < 4 or surface == "water")), f"ground_heat.csv: {surface}: no layer has {thick} m, {w_mk}, {j_m3k}")
    expect((values[6] == 0) == (values[7] > 0) == (values[8] > 0), f"ground_heat.csv: {surface} is soil and rock")
for (model,), (kw, kj, block, gas, cabin) in columns("heat_machines.csv", "model", "engine_kw", "engine_kj_k", "engine_k",
                                                     "exhaust_k", "cabin_kj_k").items():
    expect(290 < block < 380 and (kw == 0) == (gas == 300) and (kw == 0 or gas > block + 200),
           f"heat_machines.csv: {model}: engine_k {block}, exhaust_k {gas}")
    expect(kw == 0 or (1.5 * kw < kj < 6 * kw and cabin < kj), f"heat_machines.csv: {model}: {kw} kW of engine hold {kj} kJ/K")
layers = {name: float(w_mk or 0) for (name, w_mk) in ((r[0], r[1]) for r in table("construction_layers.csv")[1:])}
falling("construction_layers.csv", "w_mk", [(n, layers[n]) for n in (
    "aluminium", "steel", "concrete", "limestone", "brick", "block_aerated", "softwood", "mineral_wool", "pir")])
rough = columns("ground_heat.csv", "surface", "roughness_m", "porosity", "saturation")
falling("ground_heat.csv", "roughness_m", [(s, rough[s,][0]) for s in ("forest_conifer", "scrub", "grass", "road", "water")])
for row in table("woods.csv")[1:]:
    head = table("woods.csv")[0]
    share = sum(float(row[head.index(k)]) for k in head[4:12])
    expect(abs(share - 1) < 0.011, f"woods.csv: shares of {row[0]} make {share:.3f}")
    expect(float(row[2]) < float(row[3]), f"woods.csv: {row[0]}: low_m is not below high_m")

# quality: of one scene, the cheapest picture errs most in the visible, the dearest least, and more rays take longer
quality = [(r[0], int(r[1]), float(r[4]), float(r[9])) for r in table("quality.csv")[1:]]
for scene in ("bare", "woods"):
    rows = [q for q in quality if q[0] == scene]
    falling("quality.csv", "error", [(f"{scene} {n} rays", e) for s, n, e, t in rows if n != 8] + [
        (f"{scene} 8 rays", rows[-1][2])], False)
    for n in (1, 2, 3, 4, 5, 6):
        least = min(t for s, m, e, t in rows if m == n)
        expect(min(t for s, m, e, t in rows if m > n) > least, f"quality.csv: {scene}: more than {n} rays take less time")
    expect(max(rows, key=lambda q: q[3]) == rows[-1], f"quality.csv: {scene}: the last row is not the dearest")
# dL/dT over L of a black body of 300 K is 1.64 % a kelvin in 8-12 um and 3.71 in 3.4-4.8 um; hot parts weigh more in the radiance
for r in table("quality.csv")[1:]:
    optical, mwir, lwir, mwir_k, lwir_k = map(float, r[4:9])
    expect(mwir > 2 * lwir and mwir / mwir_k > 3.7, f"quality.csv: {r[:4]}: MWIR of {mwir} % and {mwir_k} K")
    expect(1.5 < lwir / lwir_k < 2.9, f"quality.csv: {r[:4]}: LWIR of {lwir} % and {lwir_k} K")

# light: haze scatters forwards most, and its phase function has the mean 1 over the sphere (trapezoids over the cosine to 10 %)
for model in ("us1976", "midlat_summer"):
    phase = [[float(x) for x in r] for r in table(f"atmosphere/{model}/phase.csv")[1:] if r[0] == "0"]
    for band in range(2, 8):
        mean = sum((math.cos(math.radians(a[1])) - math.cos(math.radians(b[1]))) * (a[band] + b[band]) / 4
                   for a, b in zip(phase, phase[1:]))
        expect(abs(mean - 1) < 0.1, f"atmosphere/{model}/phase.csv: column {band}: mean {mean:.3f} over the sphere")
        expect(phase[0][band] == max(p[band] for p in phase), f"atmosphere/{model}/phase.csv: column {band} is greater aside")

print(f"{checks} checks, {failed} failed")
sys.exit(failed > 0 or checks < 500)
