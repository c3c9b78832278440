#!/usr/bin/env bash
# What `pitviper terrain import` says of files of heights before it uses them: NetCDF with several variables, archives,
# options for all files, --json; `check` and a configuration see the same. The answers are the numbers that the files
# were made from. labels: small
. "$(dirname "$0")/common.sh"
judges gdal_translate python3.scipy

python3 - "$tmp" <<'PY'
import sys
import numpy as np
from scipy.io import netcdf_file
f = netcdf_file(sys.argv[1] + '/two.nc', 'w')
f.createDimension('lat', 120), f.createDimension('lon', 150)
for name, start, count, unit in ('lat', 46, 120, 'degrees_north'), ('lon', 11, 150, 'degrees_east'):
    v = f.createVariable(name, 'd', (name,))
    v[:] = start + 1e-4 * np.arange(count)
    v.units = unit
z = 300 + 20 * np.sin(np.arange(150) / 9)[None, :] + np.zeros((120, 1))
for name, values in ('height', z), ('depth', -z), ('depth_cm', -100 * z):
    v = f.createVariable(name, 'f', ('lat', 'lon'))
    v[:] = values
    v.units = 'cm' if name == 'depth_cm' else 'm'
    if name != 'height': v.positive = 'down'
with open(sys.argv[1] + '/pits.asc', 'w') as asc: # without a number that is no height
    asc.write('ncols 150\nnrows 120\nxllcorner 11\nyllcorner 46\ncellsize 1e-4\n')
    for row in np.where(z < 285, -9999, np.rint(z)).astype(int): asc.write(' '.join(map(str, row)) + '\n')
PY
few=(-o "$tmp/x.store" --overwrite --horizon 1 --threads 2)
run terrain import "$tmp/two.nc" "${few[@]}"
check "several variables: refused" [ $code = 1 ]
check "and the choice named" complained 'height, depth, depth_cm; choose one: .*two\.nc@part=NAME'
for part in height depth depth_cm; do
    run terrain import "$tmp/two.nc@part=$part" --srs EPSG:4326 "${few[@]}"
    check "$part: taken" [ $code = 0 ]
    check "$part: heights" said 'heights 280\.[0-9] \.\. 320\.[0-9] m; unit c?m, stated'
done
check "depth: said to be turned round" said 'turned round'
run terrain import "$tmp/two.nc@part=depth" "${few[@]}"
check "no coordinate system: refused, with the option" complained '@srs=EPSG'
run terrain import "$tmp/two.nc@part=width" "${few[@]}"
check "no such variable" complained 'none that is called so: height'

gdal_translate -q -ot Int16 -a_srs EPSG:4326 "NETCDF:\"$tmp/two.nc\":height" "$tmp/dem.tif" 2>/dev/null
gzip -k "$tmp/dem.tif"
(cd "$tmp" && python3 -c "import zipfile; zipfile.ZipFile('dem.zip', 'w').write('dem.tif')")
for ending in tif.gz:/vsigzip/ zip:/vsizip/; do
    run terrain import "$tmp/dem.${ending%%:*}" "${few[@]}"
    check "${ending%%:*}: refused, with GDAL's name for it" complained "${ending#*:}$tmp/dem"
done
for name in "/vsigzip/$tmp/dem.tif.gz" "/vsizip/$tmp/dem.zip/dem.tif"; do
    run terrain import "$name" "${few[@]}"
    check "$name: taken" said 'heights 2(79|80)\.[0-9] \.\. 320\.[0-9] m'
done

# one option corrects a wrong guess; and is kept in the store
run terrain import "$tmp/dem.tif" --unit us-ft "${few[@]}"
check "--unit: heights" said 'heights 85\.[0-9] \.\. 97\.[0-9] m; unit us-ft, named'
run terrain import "$tmp/dem.tif" --unit furlong "${few[@]}"
check "--unit: what there is" complained 'us-ft'
mkdir "$tmp/two" && cp "$tmp/dem.tif" "$tmp/two/a.tif"
run terrain import "$tmp/two@us-ft" "${few[@]}"
check "a folder with a choice" said 'unit us-ft, named'

# as JSON: the same, for programs
run terrain import "$tmp/pits.asc" --srs EPSG:4326 --json "${few[@]}"
check "--json: exit code" [ $code = 0 ]
check "--json: parsed, and what belongs" python3 - "$tmp/stdout" <<'PY'
import json, sys
all = json.load(open(sys.argv[1]))
source, = all['sources']
assert source['suspected_voids'] == [-9999] and source['suspected_posts'] > 0, source
assert source['posts'] == [150, 120] and source['octets'] > 1000 and source['type'] == 'Int32', source
assert 285 <= source['low_m'] <= 286 and 319 <= source['high_m'] <= 320, source
assert source['unit'] == 'm' or source['unit_from'] == 'not stated', source
assert all['voids_filled'] > 0 and all['octets'] > 1000, all
PY
check "--json: the warning all the same" complained 'nodata=-9999'

# a configuration: relative names with choices, and `check`
mkdir "$tmp/node" && cp "$tmp/two.nc" "$tmp/dem.tif" "$tmp/node/"
echo 'terrain: {elevation: "two.nc"}' >"$tmp/node/bad.yaml"
echo 'terrain: {elevation: "two.nc@part=depth@srs=EPSG:4326"}' >"$tmp/node/good.yaml"
echo 'terrain: {elevation: "dem.tif@furlong"}' >"$tmp/node/unit.yaml"
run check "$tmp/node/bad.yaml"
check "check: a file of several grids" complained 'two\.nc@part=NAME'
run check "$tmp/node/unit.yaml"
check "check: a choice that is none" complained '@furlong'
run check "$tmp/node/good.yaml"
check "check: chosen" [ $code = 0 ]
finish
