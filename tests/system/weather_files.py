"""weather_files.py PITVIPER FOLDER: a year in EPW and in TMY3, written here, and the TMY3 files that pvlib comes with:
every hour of `pitviper probe weather` against pvlib.iotools. Values between rows are not pvlib's to say: each is asked for
where the file's own value stands, radiation and rain in the middle of their hour."""
import datetime
import glob
import os
import random
import subprocess
import sys

import pvlib

pitviper, folder = sys.argv[1:3]
YEAR, failed = 2015, 0
rng = random.Random(1)


def hours():
    start = datetime.datetime(YEAR, 1, 1)
    return [start + datetime.timedelta(hours=h) for h in range(8760)]


def one_year():
    """Values of each hour, None where the file will say `missing`, rarely."""
    rows = []
    for t in hours():
        sun = max(0, 12 - abs(t.hour - 12) * 2)
        row = dict(air=round(rng.uniform(-30, 40), 1), dew=round(rng.uniform(-40, 5), 1), rh=rng.randint(5, 100),
                   pressure=rng.randint(80000, 104000), ir=rng.randint(150, 450), dni=sun * rng.randint(0, 80),
                   dhi=sun * rng.randint(0, 30), wdir=rng.randint(0, 360), wspd=round(rng.uniform(0, 20), 1),
                   cover=rng.randint(0, 10), opaque=rng.randint(0, 10), vis=rng.randint(1, 70), rain=rng.randint(0, 9))
        rows.append(row)
    return rows


def write_epw(path, rows):
    with open(path, "w", newline="") as out:
        out.write("LOCATION,Nowhere,-,XXX,made,000000,47.5,8.5,1.0,400\r\nDESIGN CONDITIONS,0\r\nTYPICAL/EXTREME PERIODS,0\r\n"
                  "GROUND TEMPERATURES,0\r\nHOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0\r\nCOMMENTS 1,made by a test\r\nCOMMENTS 2\r\n"
                  "DATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31\r\n")
        for t, r in zip(hours(), rows):
            out.write(f"{YEAR},{t.month},{t.day},{t.hour + 1},60,?9?9?9E0,{r['air']},{r['dew']},{r['rh']},{r['pressure']},0,0,"
                      f"{r['ir']},0,{r['dni']},{r['dhi']},0,0,0,0,{r['wdir']},{r['wspd']},{r['cover']},{r['opaque']},{r['vis']},"
                      f"77777,9,999999999,10,0.1,0,88,0.2,{r['rain']},1.0\r\n")


def write_tmy3(path, rows):
    with open(path, "w") as out:
        out.write('000001,"NOWHERE",XX,-7.0,40.0,-105.0,1600\nDate (MM/DD/YYYY),Time (HH:MM),GHI (W/m^2),DNI (W/m^2),DHI (W/m^2),'
                  "TotCld (tenths),Dry-bulb (C),Dew-point (C),RHum (%),Pressure (mbar),Wdir (degrees),Wspd (m/s),Hvis (m),"
                  "Lprecip depth (mm),Lprecip quantity (hr)\n")
        for t, r in zip(hours(), rows):
            out.write(f"{t:%m/%d}/{1980 + t.month},{t.hour + 1:02}:00,0,{r['dni']},{r['dhi']},{r['cover']},{r['air']},{r['dew']},"
                      f"{r['rh']},{r['pressure'] / 100:.2f},{r['wdir']},{r['wspd']},{r['vis'] * 1000},{r['rain']},1\n")


def ours(path, times):
    said = subprocess.run([pitviper, "--quiet", "probe", "weather", path], text=True, capture_output=True,
                          input="unix_s\n" + "".join(f"{t:.0f}\n" for t in times))
    if said.returncode != 0:
        print(said.stderr)
        sys.exit(1)
    lines = [line.split(",") for line in said.stdout.split()]
    return [{k: float(v) if v else None for k, v in zip(lines[0], line)} for line in lines[1:]]


def compare(name, path, data, offset_h, wanted):
    """wanted: (our column, middle of the hour?, their value of a row, tolerance). Rows of data in order of the year."""
    global failed
    if len(data) != 8760:
        print(f"FAILED: {name}: pvlib has {len(data)} rows")
        failed += 1
        return
    base = datetime.datetime(YEAR, 1, 1, tzinfo=datetime.timezone.utc).timestamp() - 3600 * offset_h
    ends = ours(path, [base + 3600 * (i + 1) for i in range(8760)])
    middles = ours(path, [base + 3600 * i + 1800 for i in range(8760)])
    count, worst = 0, 0.0
    records = data.to_dict("records")
    for column, middle, theirs, tolerance in wanted:
        for i, record in enumerate(records):
            want, got = theirs(record), (middles if middle else ends)[i][column]
            if want is None:
                continue
            off = abs(got - want) if got is not None else float("inf")
            if column == "wind_from_deg":
                off = min(off, abs(off - 360))
            if not off <= tolerance:
                failed += 1
                if failed < 10:
                    print(f"FAILED: {name}: {column} of hour {i}: {got}, pvlib has {want}")
            count, worst = count + 1, max(worst, off / tolerance)
    print(f"{name}: {count} values, worst {worst:.1e} of the tolerance")
    if count < 8760 * 6:
        print(f"FAILED: {name}: too few values were compared")
        failed += 1


rows = one_year()
epw = os.path.join(folder, "year.epw")
write_epw(epw, rows)
data, meta = pvlib.iotools.read_epw(epw)
wanted = [
    ("air_temp_k", False, lambda r: r["temp_air"] + 273.15, 1e-9),
    ("humidity", False, lambda r: r["relative_humidity"] / 100, 1e-9),
    ("pressure_mbar", False, lambda r: r["atmospheric_pressure"] / 100, 1e-8),
    ("wind_mps", False, lambda r: r["wind_speed"], 1e-9),
    ("wind_from_deg", False, lambda r: r["wind_direction"], 1e-9),
    ("cloud", False, lambda r: r["total_sky_cover"] / 10, 1e-9),
    ("visibility_m", False, lambda r: r["visibility"] * 1000, 1e-6),
    ("direct_w_m2", True, lambda r: r["dni"], 1e-8),
    ("diffuse_w_m2", True, lambda r: r["dhi"], 1e-8),
    ("longwave_w_m2", True, lambda r: r["ghi_infrared"], 1e-8),
    ("rain_mm_h", True, lambda r: r["liquid_precipitation_depth"], 1e-9)]
compare("EPW", epw, data, meta["TZ"], wanted)


def given(value):
    return value is not None and value == value and value > -9900


def tmy3(name, path):
    data, meta = pvlib.iotools.read_tmy3(path, coerce_year=YEAR, map_variables=True)
    compare(name, path, data, meta.get("TZ", meta.get("tz")), [
        (ours_, middle, (lambda key, scale, shift: lambda r: r[key] * scale + shift if given(r[key]) else None)(
            theirs, scale, shift), tolerance)
        for ours_, middle, theirs, scale, shift, tolerance in (
            ("air_temp_k", False, "temp_air", 1, 273.15, 1e-9), ("humidity", False, "relative_humidity", 0.01, 0, 1e-9),
            ("pressure_mbar", False, "pressure", 1, 0, 1e-8), ("wind_mps", False, "wind_speed", 1, 0, 1e-9),
            ("wind_from_deg", False, "wind_direction", 1, 0, 1e-9), ("cloud", False, "TotCld (tenths)", 0.1, 0, 1e-9),
            ("direct_w_m2", True, "dni", 1, 0, 1e-8), ("diffuse_w_m2", True, "dhi", 1, 0, 1e-8))])


made = os.path.join(folder, "year.csv")
write_tmy3(made, rows)
tmy3("TMY3", made)
for path in sorted(glob.glob(os.path.join(os.path.dirname(pvlib.__file__), "data", "7*TY*.[cC][sS][vV]"))):
    tmy3(os.path.basename(path), path)

honest, made = failed, data.copy()  # its twin: one value that is off
made.iloc[4000, made.columns.get_loc("temp_air")] += 0.01
print("twin, to be noticed:")
compare("EPW", epw, made, meta["TZ"], wanted)
if failed != honest + 1:
    print("FAILED: a value that is off is not noticed")
    sys.exit(1)
sys.exit(honest > 0)
