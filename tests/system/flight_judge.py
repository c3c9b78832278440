"""Flights of `pitviper probe flight` against SciPy's DOP853, from the equations of etc/reference/flight.md alone.

    flight_judge.py MISSILES.csv RESULTS.csv

Gravity is the closed form of the level ellipsoid (Heiskanen & Moritz 1967), heights are iterated, the atmosphere is integrated
from the standard's lapse rates. Prints a line a row, to be read by test_flight_judge.sh:
    MISSILE END POINT_M SPEED_MPS MISS_M TRAVELLED_M      differences of position, of velocity, of the closest approach
"""
import csv
import math
import sys

import numpy as np
from scipy.integrate import solve_ivp

A, F, GM, TURN = 6378137.0, 1 / 298.257223563, 3.986004418e14, 7.292115e-5
B = A * (1 - F)
E = math.sqrt(A * A - B * B)
E2 = F * (2 - F)
Q0 = 0.5 * ((1 + 3 * B * B / E**2) * math.atan(E / B) - 3 * B / E)
MACH = [0, 0.8, 0.95, 1.05, 1.2, 2, 3, 5]


def gravitation(p):
    x, y, z = p
    s2, r2 = x * x + y * y, x * x + y * y + z * z
    half = 0.5 * (r2 - E * E)
    u = math.sqrt(half + math.sqrt(half * half + E * E * z * z))
    v = math.sqrt(u * u + E * E)
    beta = math.atan2(z * v, u * math.sqrt(s2))
    sb, cb = math.sin(beta), math.cos(beta)
    w = math.sqrt((u * u + E * E * sb * sb) / (v * v))
    q = 0.5 * ((1 + 3 * u * u / E**2) * math.atan(E / u) - 3 * u / E)
    q1 = 3 * (1 + u * u / E**2) * (1 - u / E * math.atan(E / u)) - 1
    gu = -(GM / v**2 + TURN**2 * A * A * E / v**2 * q1 / Q0 * (0.5 * sb * sb - 1 / 6)) / w
    gb = TURN**2 * A * A / v * q / Q0 * sb * cb / w
    level = u / (w * v) * cb * gu - sb / w * gb
    s = math.sqrt(s2)
    return np.array([level * x / s, level * y / s, sb / w * gu + u / (w * v) * cb * gb])


def geodetic(p):
    """Latitude and height, by iteration."""
    s, z = math.hypot(p[0], p[1]), p[2]
    lat = math.atan2(z, s * (1 - E2))
    for _ in range(6):
        n = A / math.sqrt(1 - E2 * math.sin(lat) ** 2)
        lat = math.atan2(z + E2 * n * math.sin(lat), s)
    return lat, s * math.cos(lat) + z * math.sin(lat) - A * math.sqrt(1 - E2 * math.sin(lat) ** 2)


LAYERS = [(0, -6.5e-3), (11e3, 0), (20e3, 1e-3), (32e3, 2.8e-3), (47e3, 0), (51e3, -2.8e-3), (71e3, -2e-3), (84852, 0)]
GAS = 8314.32 / 28.9644


def air(h):
    """Density and speed of sound."""
    level = 6356766.0 * h / (6356766.0 + h)
    temp, pressure = 288.15, 101325.0
    for k, (base, lapse) in enumerate(LAYERS):
        top = LAYERS[k + 1][0] if k + 1 < len(LAYERS) else math.inf
        up = min(level, top) - base
        if lapse == 0:
            pressure *= math.exp(-9.80665 * up / (GAS * temp))
        else:
            pressure *= ((temp + lapse * up) / temp) ** (-9.80665 / (GAS * lapse))
            temp += lapse * up
        if level <= top: break
    return pressure / (GAS * temp), math.sqrt(1.4 * GAS * temp)


def across(a, u):
    return a - u * (a @ u)


def unit(a):
    return a / math.sqrt(a @ a)


def number(row, key, otherwise):
    return float(row[key]) if row.get(key) else otherwise


class Flight:
    def __init__(self, m, row):
        self.m = {k: float(v) if k not in ("name", "guidance", "source") else v for k, v in m.items()}
        m = self.m
        lat, lon, h = math.radians(float(row["lat_deg"])), math.radians(float(row["lon_deg"])), float(row["height_m"])
        n = A / math.sqrt(1 - E2 * math.sin(lat) ** 2)
        self.origin = np.array([(n + h) * math.cos(lat) * math.cos(lon), (n + h) * math.cos(lat) * math.sin(lon),
                                (n * (1 - E2) + h) * math.sin(lat)])
        east = np.array([-math.sin(lon), math.cos(lon), 0])
        up = np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])
        self.axes = np.array([east, np.cross(up, east), up]).T
        self.h0 = h
        az, el = math.radians(float(row["azimuth_deg"])), math.radians(float(row["elevation_deg"]))
        speed = number(row, "speed_mps", m["launch_mps"])
        v0 = self.axes @ (speed * np.array([math.sin(az) * math.cos(el), math.cos(az) * math.cos(el), math.sin(el)]))
        self.y0 = np.concatenate([np.zeros(3), v0, np.zeros(6)])
        enu = lambda keys: self.axes @ np.array([number(row, k, 0) for k in keys])
        self.target = bool(row["target_e_m"])
        self.tp = enu(("target_e_m", "target_n_m", "target_u_m"))
        self.tv = enu(("target_ve_mps", "target_vn_mps", "target_vu_mps"))
        self.ta = enu(("target_ae_mps2", "target_an_mps2", "target_au_mps2"))
        earth = number(row, "earth", 1)
        self.gravity, self.turn, self.density = earth > 0, TURN * (earth == 1), number(row, "air", 1)
        self.area = math.pi / 4 * (m["diameter_mm"] / 1000) ** 2
        self.drag = [m[k] for k in ("cd_m0", "cd_m080", "cd_m095", "cd_m105", "cd_m120", "cd_m200", "cd_m300", "cd_m500")]
        self.guided = self.terminal = False
        a = m["ignite_s"]
        b = a + m["boost_s"]
        self.stages = [(a, b, m["boost_n"], m["boost_kg"]), (b, b + m["sustain_s"], m["sustain_n"], m["sustain_kg"])]
        self.thrust = 0.0

    def mass(self, t):
        return self.m["mass_kg"] - sum(kg * min(max((t - a) / (b - a), 0), 1) for a, b, _, kg in self.stages if b > a)

    def target_at(self, t):
        return self.tp + t * self.tv + 0.5 * t * t * self.ta, self.tv + t * self.ta

    def law(self, t, p, v, ahead, speed, falls):
        m, a = self.m, np.zeros(3)
        if self.guided:
            tp, tv = self.target_at(t)
            kind = m["guidance"]
            if kind == "command":
                far = math.sqrt(tp @ tp)
                los = tp / far
                rate = across(tv, los) / far
                along, out = p @ los, v @ los
                error, drift = along * los - p, along * rate - across(v, los)
                a = m["gain"] ** 2 * error + 2 * m["gain"] * drift + 2 * out * rate
            else:
                r, w = tp - p, tv - v
                far = math.sqrt(r @ r)
                los = r / far
                if kind == "pursuit":
                    a = m["gain"] * speed * across(los, ahead)
                elif kind == "loft" and not self.terminal:
                    lat, h = geodetic(self.origin + p)
                    lon = math.atan2(*(self.origin + p)[1::-1])
                    up = np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])
                    most = math.radians(m["loft_deg"])
                    angle = min(max(math.atan((m["loft_m"] - (h - self.h0)) / (2 * max(speed, 1))), -most), most)
                    a = speed / 0.6 * across(math.cos(angle) * unit(across(los, up)) + math.sin(angle) * up, ahead)
                else:
                    a = m["gain"] * max(-(los @ w), 0) * across(w, los) / far
                    if kind == "augmented": a = a + 0.5 * m["gain"] * across(self.ta, los)
        return across(a - m["gravity_share"] * falls, ahead)

    def slope(self, t, y):
        m, p, v, lag, rate = self.m, y[:3], y[3:6], y[6:9], y[9:]
        where = self.origin + p
        falls = gravitation(where) if self.gravity else np.zeros(3)
        w = self.turn
        falls = falls + w * np.array([w * where[0] + 2 * v[1], w * where[1] - 2 * v[0], 0])
        speed = math.sqrt(v @ v)
        ahead = v / speed
        rho, sound = air(geodetic(where)[1])
        push = 0.5 * self.density * rho * speed**2 * self.area
        mass = self.mass(t)
        lift = push * m["lift_per_rad"] + self.thrust
        most = min(m["lateral_g"] * 9.80665, lift * math.sin(math.radians(m["attack_deg"])) / mass)
        lateral = across(lag, ahead)
        size = math.sqrt(lateral @ lateral)
        if size > most: lateral, size = lateral * (most / size), most
        sine = mass * size / lift if lift > 0 else 0
        drag = push * (np.interp(speed / sound, MACH, self.drag) + m["lift_per_rad"] * sine**2)
        acc = falls + lateral + ahead * (self.thrust * math.sqrt(1 - sine**2) - drag) / mass
        wanted = self.law(t, p, v, ahead, speed, falls)
        asked = math.sqrt(wanted @ wanted)
        if asked > most: wanted = wanted * (most / asked)
        turn = np.cross(ahead, acc) / speed
        if m["damping"] > 0:
            tau = m["lag_s"]
            return np.concatenate([v, acc, rate + np.cross(turn, lag),
                                   (wanted - lag) / tau**2 - 2 * m["damping"] / tau * rate + np.cross(turn, rate)])
        return np.concatenate([v, acc, (wanted - lag) / m["lag_s"] + np.cross(turn, lag), np.zeros(3)])

    def depression(self, t, y):
        lat, _ = geodetic(self.origin + y[:3])
        lon = math.atan2(*(self.origin + y[:3])[1::-1])
        up = np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])
        return -unit(self.target_at(t)[0] - y[:3]) @ up - math.sin(math.radians(self.m["dive_deg"]))

    def piece(self, begin, end, y, events=()):
        return solve_ivp(self.slope, (begin, end), y, method="DOP853", rtol=1e-10, atol=1e-9, max_step=0.25,
                         events=list(events), dense_output=False)

    def fly(self, until):
        """To `until`, piece by piece; the state there, and the closest approach on the way."""
        m, t, y, miss = self.m, 0.0, self.y0, math.inf
        knots = {x for a, b, *_ in self.stages for x in (a, b)} | {m["guide_after_s"]}
        knots = sorted(x for x in knots if 0 < x < until) + [until]

        def closest(t, y):
            p, v = self.target_at(t)
            return (p - y[:3]) @ (v - y[3:6])
        closest.direction = 1

        def dives(t, y): return self.depression(t, y)
        dives.terminal, dives.direction = True, 1
        while t < until:
            end = next(x for x in knots if x > t + 1e-12)
            middle = 0.5 * (t + end)
            self.thrust = sum(n for a, b, n, _ in self.stages if a <= middle < b)
            self.guided = self.target and middle > m["guide_after_s"]
            watch = [closest] if self.target else []
            if m["guidance"] == "loft" and self.target and not self.terminal: watch.append(dives)
            got = self.piece(t, end, y, watch)
            assert got.success, got.message
            for when, near in zip(got.t_events[0], got.y_events[0]) if watch else ():
                miss = min(miss, np.linalg.norm(near[:3] - self.target_at(when)[0]))
            t, y = got.t[-1], got.y[:, -1]
            if got.status == 1:  # the dive begins on the next point of the grid
                grid = math.ceil(t * 1000 - 1e-7) / 1000
                if grid > t: y, t = self.piece(t, grid, y).y[:, -1], grid
                self.terminal = True
        return y, miss


missiles = {r["name"]: r for r in csv.DictReader(x for x in open(sys.argv[1]) if x[0] != "#")}
for row in csv.DictReader(open(sys.argv[2])):
    assert not row["error"], row["error"]
    f = Flight(missiles[row["missile"]], row)
    y, miss = f.fly(float(row["end_s"]))
    got = np.array([float(row[k]) for k in ("x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps")])
    point, speed = np.linalg.norm(got[:3] - f.origin - y[:3]), np.linalg.norm(got[3:] - y[3:6])
    apart = abs(float(row["miss_m"]) - miss) if row["miss_m"] and math.isfinite(miss) else 0
    print(row["missile"], row["end"], f"{point:.3g} {speed:.3g} {apart:.3g} {np.linalg.norm(y[:3]):.5g}", flush=True)
