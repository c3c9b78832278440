"""Attenuation of radio waves as `pitviper probe propagation` gives it against ITU-Rpy.

    propagation_judge.py rows | PROBE | propagation_judge.py judge

rows: what to ask: frequencies 1 to 349 GHz in airs that no printed example has. judge: prints, to be read by
test_propagation_judge.sh, `gas|rain|cloud WORST`, the worst relative difference per km at the near end; `space WORST`,
that of the gases between the ground and space, straight up and 10 degrees above the horizon, through the mean global
reference atmosphere; `rows COUNT`.
Of gases it asks for P.676-12, whose lines and formulae of Annex 1 are those of P.676-13."""
import csv
import sys

import numpy as np
from itur.models.itu676 import change_version, gamma0_exact, gammaw_exact, gaseous_attenuation_slant_path
from itur.models.itu838 import rain_specific_attenuation
from itur.models.itu840 import specific_attenuation_coefficients

change_version(12)

FREQUENCIES = [1, 5.5, 9.7, 16.2, 22.2, 24.1, 35, 52.7, 59.9, 62.3, 77, 94, 118.6, 140, 183, 199, 220, 325, 349]
UP, EARTH_M = [90, 10], 6371e3
AIRS = [(250, 980, 0.9), (273.15, 1013.25, 0.3), (288.15, 900, 0.6), (308, 1030, 0.8)]

if sys.argv[1] == 'rows':
    print('frequency_ghz,from_m,to_m,range_m,air_temp_k,pressure_mbar,humidity,rain_mm_h,tilt_deg,cloud_low_m,'
          'cloud_high_m,cloud_g_m3')
    for f in FREQUENCIES:
        for n, (t, p, h) in enumerate(AIRS):
            cloud = '0,50,0.25' if f <= 200 else ',,'
            print(f'{f},0,{400 * n},2000,{t},{p},{h},{[2, 12, 60, 130][n]},{[0, 45, 90, 20][n]},{cloud}')
    for f in [5, 10, 16.5, 22.2, 35, 77, 94, 140, 183, 220]:
        for elevation in UP:
            sine = np.sin(np.radians(elevation))
            range_m = -EARTH_M * sine + np.sqrt((EARTH_M * sine) ** 2 + 20000 * (2 * EARTH_M + 20000))
            print(f'{f},0,20000,{range_m:.3f},288.15,1013.25,0.58346,,,,,')  # 7.5 g/m3 at the ground
    sys.exit(0)

worst = {'gas': 0.0, 'rain': 0.0, 'cloud': 0.0, 'space': 0.0}


def differ(what, got, want):
    worst[what] = max(worst[what], abs(float(got) / float(want) - 1))


count = 0
for row in csv.DictReader(sys.stdin):
    x = {k: float(v) if v else float('nan') for k, v in row.items() if k != 'error'}
    if row['error']:
        sys.exit('error in a row: ' + row['error'])
    f, t, rho = x['frequency_ghz'], x['air_temp_k'], x['vapour_g_m3']
    count += 1
    if x['to_m'] == 20000:
        up = UP[0] if x['range_m'] < 20001 else UP[1]
        differ('space', x['gas_db'], gaseous_attenuation_slant_path(f, up, rho, 1013.25, 288.15, mode='exact').value)
        continue
    dry = x['pressure_mbar'] - rho * t / 216.7
    differ('gas', x['dry_db_km'], gamma0_exact(f, dry, rho, t).value)
    differ('gas', x['wet_db_km'], gammaw_exact(f, dry, rho, t).value)
    if x['rain_top_m'] > 0:
        elevation = np.degrees(np.arcsin((x['to_m'] - x['from_m']) / x['range_m']))
        differ('rain', x['rain_db_km'], rain_specific_attenuation(x['rain_mm_h'], f, elevation, x['tilt_deg']).value)
    if f <= 200:
        differ('cloud', x['cloud_db_km'] / 0.25, specific_attenuation_coefficients(f, t - 273.15))
for what, value in worst.items():
    print(what, value)
print('rows', count)
