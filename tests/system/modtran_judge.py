"""Tape7 files of a made-up air whose band figures are known in closed form, as MODTRAN 5 and 3.7 lay them out.

    modtran_judge.py write FOLDER     the files, and want.csv: paths with their transmittance and radiance
    modtran_judge.py compare FOLDER   against FOLDER/got.csv of `probe atmosphere`: the worst differences
    modtran_judge.py sky FOLDER       the same of `probe sky` from the ground
    modtran_judge.py spoil FOLDER     each way to spoil a file, and whether the converter says what is wrong
    modtran_judge.py real             LOWTRAN7's own tape7 (tests/data) against the rows that it gave by another way

The air has one temperature and absorbs by KM[0] above 10 um and KM[1] below it, 1/km at the ground, less by height with the
scale height; haze adds HAZE everywhere alike in wavelength. Then the mean over 8-12 um is that of two exponentials, weighted by
the shares of Planck's radiance above and below 10 um, which are sums of a series (Chang and Rhee 1984).
"""
import contextlib
import csv
import io
import math
import os
import re
import sys

import numpy as np

REPOSITORY = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
MAKE = os.path.join(REPOSITORY, "etc", "atmosphere", "make")
sys.path.insert(0, MAKE)
KM, HAZE, SCALE_KM, AIR_K = (0.05, 0.4), 0.03, 2.0, 288.2
HEIGHTS_KM, TIMES, LEVEL_KM = (0.0, 1.0, 4.0), (1, 3, 10), (0.1, 2, 20)
C2_CM_K = 1.438776877
ROWS = [*np.arange(830, 1000, 10.0), 999.99, *np.arange(1000, 1261, 10.0)]


def above(um, kelvin):
    """W/(m2 sr) of a black body up to a wavelength: Stefan-Boltzmann's times a series."""
    x = 1e4 * C2_CM_K / (um * kelvin)
    share = 15 / math.pi ** 4 * sum(math.exp(-n * x) / n * (x ** 3 + 3 * x ** 2 / n + 6 * x / n ** 2 + 6 / n ** 3)
                                    for n in range(1, 200))
    return 5.670374419e-8 / math.pi * kelvin ** 4 * share


def band(kelvin):
    """Of 10-12 and of 8-10 um."""
    return above(12, kelvin) - above(10, kelvin), above(10, kelvin) - above(8, kelvin)


def amount(a_km, b_km, range_km):
    if a_km == b_km:
        return range_km * math.exp(-a_km / SCALE_KM)
    low, high = sorted((a_km, b_km))
    return range_km * SCALE_KM * (math.exp(-low / SCALE_KM) - math.exp(-high / SCALE_KM)) / (high - low)


def amount_round(a_km, b_km, range_km):
    """The same over the round Earth, where the program looks; refraction takes a seventh of its curvature."""
    s = (np.arange(1000) + 0.5) * range_km / 1000
    height = a_km + (b_km - a_km) * s / range_km - s * (range_km - s) / (2 * 6371 * 7 / 6)
    return range_km * float(np.mean(np.exp(-height / SCALE_KM)))


def paths():
    for a in HEIGHTS_KM:
        for b in HEIGHTS_KM:
            for r in LEVEL_KM if a == b else [abs(b - a) * t for t in TIMES]:
                yield a, b, r


def planck(v):
    """W/(cm2 sr cm-1)"""
    return 1.191042972e-12 * v ** 3 / np.expm1(C2_CM_K * v / AIR_K)


def cards(kind, emission, haze, h1, h2, angle, length):
    return [f"T F 6{kind:5d}{emission:5d}    0" + "    6" * 6 + "    1    0    0   0.000   0.00",
            f"{1 if haze else 0:5d}    1    1    0    0    0{23.0 if haze else 0.0:10.5f}" + "   0.00000" * 4,
            " -99.000 -99.000 -99.000", " -99.00000 -99.00000 -99.00000  1.416445  0.000736 ! H2O & O3 COLUMNS [GM/CM2]",
            "   361976 U S STANDARD   ",
            f"{h1:10.5f}{h2:10.5f}{angle:10.5f}{length:10.5f}{0:10.5f} 99999.00000    0        0.00000",
            "    0    0    1    0", "   0.00000" * 8, "     830.0    1260.0      10.0      10.0NW              ",
            "    0   0    0.000  0    0.000  0    1.000"]


HEAD = ("    FREQ  TOT_TRANS  PTH_THRML  THRML_SCT  SURF_EMIS   SOL_SCAT  SING_SCAT  GRND_RFLT  DRCT_RFLT  TOTAL_RAD  REF_SOL  "
        "SOL@OBS   DEPTH DIR_EM    TOA_SUN BBODY_T[K]")


def radiance_run(kind, haze, h1, h2, angle, length, air):
    """As MODTRAN 5: blank THRML_SCT, and TOA_SUN in proportion to a black body of 288.2 K, whose shares are known."""
    out = cards(kind, 1, haze, h1, h2, angle, length) + [HEAD]
    for v in ROWS:
        depth = air * (KM[int(v >= 1000)] + (HAZE if haze else 0))
        tau = math.exp(-depth)
        light = planck(v) * (1 - tau)
        out.append(f"{v:8.2f}{tau:11.8f}{light:11.4E}{'':11}{5e-6:11.4E}{0:11.4E}{0:11.4E}{1e-6:11.4E}{0:11.4E}"
                   f"{light + 6e-6:11.4E}{0:9.2E}{0:9.2E}{depth:8.3f}{1:7.4f}{planck(v):11.4E}{288.2:11.3f}")
    return out + [" -9999."]


def clear_run(a, b, length, air):
    """As MODTRAN 3.7: transmittances alone, of four digits, and the depth."""
    names = "  FREQ TOTAL   H2O  CO2+    O3 TRACE    N2   H2O MOLEC   AER  HNO3 AERab  -LOG   CO2    CO"
    out = cards(1 if a == b else 2, 0, False, a, b, angle_of(a, b, length), length)
    out += [names, "  CM-1 TRANS TRANS TRANS TRANS TRANS  CONT  CONT  SCAT TRANS TRANS TRANS TOTAL TRANS TRANS"]
    for v in ROWS:
        depth = air * KM[int(v >= 1000)]
        out.append(f"{v:8.2f}{math.exp(-depth):7.4f}" + " 1.0000" * 10 + f"{depth:9.5f} 1.0000 1.0000")
    return out + [" -9999."]


def angle_of(a, b, length):
    return math.degrees(math.acos((b - a) / length))


def write(folder):
    clear, hazy, sky = [], [], []
    with open(os.path.join(folder, "want.csv"), "w", encoding="ascii") as want:
        want.write("model,visibility_km,band,observer_m,target_m,range_km,temp_k,want_tau,want_radiance\n")
        for a, b, r in paths():
            air = amount(a, b, r)
            if b >= a:  # one way is enough
                clear += clear_run(a, b, r, air)
            hazy += radiance_run(1 if a == b else 2, True, a, 0.0 if a == b else b, angle_of(a, b, r), r, air)
            part, own = band(300), band(AIR_K)
            tau = [math.exp(-amount_round(a, b, r) * (k + HAZE)) for k in KM]
            want.write(f"{folder}/own,23,lwir,{1000 * a:g},{1000 * b:g},{r:g},300,{np.dot(part, tau) / sum(part):.9g},"
                       f"{np.dot(own, 1 - np.array(tau)):.9g}\n")
    for h in (0.0, 4.0):
        for z in (0.0, 60.0, 80.0):
            air = SCALE_KM * math.exp(-h / SCALE_KM) / math.cos(math.radians(z))
            sky += radiance_run(3, True, h, 100.0, z, 100.0, air)
    for name, lines in (("clear", clear), ("hazy", hazy), ("sky", sky)):
        with open(os.path.join(folder, name + ".tp7"), "w", encoding="ascii") as out:
            out.write("\n".join(lines) + "\n")
    with open(os.path.join(folder, "temperature.csv"), "w", encoding="ascii") as out:
        out.write(f"height_m,temp_k\n0,{AIR_K}\n100000,{AIR_K}\n")


def compare(folder):
    with (open(os.path.join(folder, "want.csv"), encoding="ascii") as want,
          open(os.path.join(folder, "got.csv"), encoding="ascii") as got):
        rows = list(zip(csv.DictReader(want), csv.DictReader(got)))
    for most_km in (4, 1000):
        some = [(w, g) for w, g in rows if float(w["range_km"]) <= most_km]
        tau = max(abs(float(g["tau"]) - float(w["want_tau"])) for w, g in some)
        light = max(abs(float(g["path_radiance"]) / float(w["want_radiance"]) - 1) for w, g in some)
        print(f"{len(some)} {tau:.6f} {light:.6f}")


def sky(folder):
    with open(os.path.join(folder, "got.csv"), encoding="ascii") as file:
        rows = list(csv.DictReader(file))
    miss = []
    for row in rows:
        air = SCALE_KM / math.cos(math.radians(float(row["zenith_deg"])))
        want = sum(light * -math.expm1(-air * (k + HAZE)) for light, k in zip(band(AIR_K), KM))
        miss.append(abs(float(row["radiance"]) / want - 1))
    print(f"{max(miss):.6f}" if len(miss) == 3 else "none")


def spoil(folder):
    """One change of one file at a time: what the converter must say."""
    good = {}
    for name in ("clear", "hazy", "sky"):
        with open(os.path.join(folder, name + ".tp7"), encoding="ascii") as file:
            good[name] = file.read()
    first = good["hazy"].index(" -9999.") + len(" -9999.\n")
    row = good["hazy"].split("\n")[11]
    def hazy(text):
        return {"hazy": text}
    ways = [
        (hazy(good["hazy"][:-8]), "the file ends before -9999."),
        (hazy(good["hazy"][first:]), r"hazy|missing.*\n.*visibility 23 km: from 0 to 0 m: range 100 m with emission"),
        (hazy(good["hazy"] + good["hazy"][:first]), "is there twice"),
        (hazy(good["hazy"].replace(row, row[:9] + "1.20000000" + row[19:], 1)), r"hazy.tp7:12: a transmittance of 1.2"),
        (hazy(good["hazy"].replace(row, row[:9] + "**********" + row[19:], 1)), r"hazy.tp7:12: not a row of numbers"),
        (hazy(good["hazy"].replace(row, row[:19] + "        NaN" + row[30:], 1)), r"hazy.tp7:12: not a row of numbers"),
        (hazy(good["hazy"].replace(row, row + "  1.0", 1)), r"hazy.tp7:12: the number 1.0 .* is under no name"),
        (hazy(good["hazy"].replace(row, row + "\n" + row, 1)), r"hazy.tp7:13: .* does not lie above"),
        (hazy(good["hazy"].replace("TOT_TRANS  PTH_THRML", "SOMETHING  ELSE_____", 1)),
         r"hazy.tp7:11: a header of unknown columns"),
        (hazy(good["hazy"].replace("    FREQ ", "  WAVLEN ", 1)), "a spectrum in wavelengths"),
        (hazy(good["hazy"].replace(" 99999.00000", "   637.12300")), r"lies \d+ m lower than in flat layers"),
        (hazy(good["hazy"].replace("T F 6", "T F 1")), "of another air .*--vapour is needed"),
        ({n: good[n].replace("  23.00000", "  17.00000") for n in ("hazy", "sky")},
         "visibility 17 km .*BASE has paths of 0.5, 2, 5, 23 km alone"),
        (hazy(good["hazy"].replace("T F 6    1", "T F 6    x", 1)), r"run 1 .*cards 1 to 3 cannot be read"),
        ({"sky": good["sky"].replace("  80.00000", "  85.00000", 1)}, r"sky .*from 0 m, 80 degrees"),
        ({"sky": ""}, "sky.tp7: no header line"),
        ({"clear": good["clear"].replace("-9999.", "no end")}, "clear.tp7:.* not a row of numbers"),
        ({"clear": good["clear"].replace(" 1.0000 1.0000\n", " 1.0000\n", 1)}, r"clear.tp7:13: 14 numbers, where 15"),
    ]
    for number, (change, want) in enumerate(ways):
        for name, text in (good | change).items():
            with open(os.path.join(folder, "spoilt", name + ".tp7"), "w", encoding="ascii") as out:
                out.write(text)
        said = run(os.path.join(folder, "spoilt"), folder)
        made = os.path.exists(os.path.join(folder, "spoilt", "own"))
        ok = said.startswith("modtran.py: ") and re.search(want, said) and not made
        print("ok" if ok else f"WRONG {number}: {said[:300]}")


def run(files, folder):
    """What the converter says; "" where it has nothing to say."""
    import modtran
    tape7 = [os.path.join(files, name + ".tp7") for name in ("clear", "hazy", "sky")]
    sys.argv = ["modtran.py", "us1976", os.path.join(files, "own"), *tape7,
                "--temperature", os.path.join(folder, "temperature.csv")]
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            modtran.main()
    except SystemExit as end:
        return str(end)
    return ""


def real():
    """What etc/atmosphere/us1976 has of the same runs, made from LOWTRAN7's numbers and not from its text."""
    import channel
    import modtran
    import tape7
    made = os.path.join(REPOSITORY, "etc", "atmosphere", "us1976", "23000")
    level, sun = tape7.read(os.path.join(REPOSITORY, "tests", "data", "lowtran7.tp7"))
    runs = modtran.Runs([os.path.join(REPOSITORY, "tests", "data", "lowtran7.tp7")], {})
    lwir = modtran.Channel("lwir", modtran.channels_in(os.path.join(REPOSITORY, "etc"))["lwir"], runs, [])
    head, rows = channel.rows_of(os.path.join(made, "paths_lwir.csv"))
    row = next(r for r in rows if r[:3] == [0, 0, 1000])
    worst = max(abs(lwir.depth(level, None if c == "depth_sun" else float(c[6:-1])) / x - 1)
                for c, x in zip(head[3:-1], row[3:-1]))
    light = abs(lwir.radiance(level) / row[-1] - 1)
    head, rows = channel.rows_of(os.path.join(made, "sun.csv"))
    row = next(r for r in rows if r[:2] == [1000, 60])
    direct = abs(1.10365 * math.exp(-lwir.depth(sun)) / row[head.index("direct_lwir")] - 1)
    # of 0.9998 and 2.345e-4 the latter is known to 2e-4, the former's logarithm to 25 %; and the other way round
    told = [(("0.9998", "2.345E-04"), 2.345e-4), (("0.74772996", "0.291"), -math.log(0.74772996)), (("0.0000", "99.990"), 700),
            (("0.0126", None), -math.log(0.0126)), (("1.0000", "1.23-101"), 1.23e-101)]
    wrong = sum(abs(tape7.best_depth(*texts) / want - 1) > 1e-12 for texts, want in told)
    # over wavelength a triangle of 8, 10 and 12 um has an area of 2: dw = 1e4 / v^2 dv
    v = np.arange(825.0, 1261, 5)
    area = channel.seen(v, 1e4 / v ** 2, (np.array([8.0, 10, 12]), np.array([0.0, 1, 0])))
    geometry = modtran.geometry(level) == ("path", 0, 0, 1000) and modtran.geometry(sun) == ("sun", 1000, 60)
    print(f"{worst:.2g} {light:.2g} {direct:.2g} {wrong} {abs(area / 2 - 1):.6f} {geometry}")


if __name__ == "__main__":
    {"write": write, "compare": compare, "sky": sky, "spoil": spoil, "real": real}[sys.argv[1]](*sys.argv[2:])
