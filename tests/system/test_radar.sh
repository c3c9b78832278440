#!/usr/bin/env bash
# The radar of radar.preset, end to end: a sphere of 10 m2 at 3 km against the radar equation on paper, and mirrored by the ground;
# each waveform; tables that are refused. Among ground, rain and chaff: test_radar_scene.sh. labels: slow
. "$(dirname "$0")/common.sh"
judges python3

# a sphere of pi a^2 = 10 m2, facets 60 um deep: a three-hundredth of the wavelength at 16.5 GHz
sphere() { # sphere N: N rings of 2 N facets
    awk -v n="$1" 'BEGIN { pi = atan2(0, -1); a = sqrt(10 / pi); m = 2 * n; print "o sphere"
        for (i = 0; i <= n; i++) for (j = 0; j < m; j++) {
            t = pi * i / n; p = 2 * pi * j / m; x = sin(t) * cos(p); y = cos(t); z = sin(t) * sin(p)
            printf "v %.9f %.9f %.9f\nvn %.9f %.9f %.9f\n", a * x, a + a * y, a * z, x, y, z }
        for (i = 0; i < n; i++) for (j = 0; j < m; j++) {
            a1 = i * m + j + 1; b1 = i * m + (j + 1) % m + 1; a2 = a1 + m; b2 = b1 + m
            if (i > 0) printf "f %d//%d %d//%d %d//%d\n", a1, a1, b1, b1, b2, b2
            if (i < n - 1) printf "f %d//%d %d//%d %d//%d\n", a1, a1, b2, b2, a2, a2 } }'
}
sphere 190 >"$tmp/sphere.obj"
printf 'materials: {"*": metal_steel_galvanized}\n' >"$tmp/sphere.yaml"
printf 'type,model,origin,length_m,width_m,height_m\n1.1.225.83.7.0.0,sphere.obj,base,3.568,3.568,3.568\n' >"$tmp/catalog.csv"
# and a rough one, where its echo is not looked at
sphere 12 >"$tmp/rough.obj"
cp "$tmp/sphere.yaml" "$tmp/rough.yaml"
sed 's/sphere/rough/' "$tmp/catalog.csv" >"$tmp/rough.csv"
cat >"$tmp/sphere_scene.yaml" <<'Y'
duration_s: 12
seed: 1
place: {lat_deg: 36, lon_deg: -123, height_m: 120}
dis: {site: 1, application: 3001, exercise: 1, version: 7}
vehicles:
  - {name: Ball, id: 11, type: 1.1.225.83.7.0.0, force: 2, route_m: [[0, 0]]}
  - {name: Watch, id: 31, type: 1.2.225.20.1.0.0, force: 1, route_m: [[-2985, 0]], height_m: 300}
Y
exercise "$tmp/sphere_scene.yaml" "$tmp/ball.pcap"
seen=(--host 1:3001:31 --set sensor.gimbal_limit_deg=180 --set exercise.aim=1:3001:11 --bands radar --threads 1
    --set models.catalog="$tmp/catalog.csv" "${coarse[@]}")
replay "$tmp/ball.pcap" "$tmp/ball" "${seen[@]}" --only 5 --set radar.preset=search_ku --set radar.ground=false --set radar.ground_bounce=false --set radar.warp_mm=0
check "a sphere" [ $code = 0 ]; [ $code = 0 ] || tail -n 3 "$tmp/stderr"
python3 - "$tmp/ball" <<'P' || fail "a sphere of 10 m2"
import json, math, sys
frame = json.loads(open(sys.argv[1] + "/truth.jsonl").read().splitlines()[-1])
radar, want = frame["radar"], []
target = [t for t in radar["targets"] if t["entity"] == "1:3001:11"][0]
range_m = math.hypot(target["range_m"], 0)
# search_ku: 2 kW, 6 dB, 0.6 m tapered to 0.75, 16.5 GHz, 128 pulses of 50 us, noise figure 3.5 dB; Hamming and Chebyshev of 60 dB,
# whose losses SciPy gives for these lengths: 1.364 (N = 512) and 1.532 bins (N = 128)
wave = 299792458 / 16.5e9
gain = 0.75 * (math.pi * 0.6 / wave) ** 2
received = 2000 * gain ** 2 * wave ** 2 * 10 / ((4 * math.pi) ** 3 * range_m ** 4 * 10 ** 0.6) * 10 ** (-0.2 * radar["air_db"])
snr = received * 128 * 50e-6 / (1.380649e-23 * 290 * 10 ** 0.35) / (1.364 * 1.532)
snr_db = 10 * math.log10(snr)
got = radar["detections"][0]
print("range %.1f m; sphere %.3f / %.3f dBsm; SNR %.2f, on paper %.2f dB; found at %+.3f m, %.2f dBsm, %.2f dB, %+.4f %+.4f deg" % (
    range_m, target["rcs_dbsm"]["hh"], target["rcs_dbsm"]["vv"], target["snr_db"], snr_db, got["range_m"] - range_m,
    got["rcs_dbsm"], got["snr_db"], got["az_deg"] - target["az_deg"], got["el_deg"] - target["el_deg"]))
good = abs(range_m - 3000) < 30
good &= all(d["rcs_dbsm"] < got["rcs_dbsm"] - 50 for d in radar["detections"][1:]) # its phase noise, 0.5 degrees over 128 pulses
good &= all(abs(target["rcs_dbsm"][p] - 10) < 0.2 for p in ("hh", "vv")) and target["rcs_dbsm"].get("hv", -99) < -15 # absent: none
good &= abs(target["snr_db"] - snr_db) < 0.2
good &= abs(got["rcs_dbsm"] - target["rcs_dbsm"]["hh"]) < 0.2   # I and Q differ by 0.1 dB
good &= got["snr_db"] > 45                                      # over what phase noise and windows leave of so strong an echo
good &= abs(got["range_m"] - (range_m - 1.78)) < 0.5            # its front; cells are 7.5 m
good &= abs(got["az_deg"] - target["az_deg"]) < 0.05 and abs(got["range_rate_mps"]) < 0.3
# almost all of the map is this echo, so that its error is the map's; transmitted h
error = frame["error"]["range_doppler"]
own = math.hypot((10 ** (0.1 * target["rcs_error_db"]["hh"]) - 1) / math.sqrt(2), error["level_of_detail"])
print("error of the map: " + ", ".join("%s %.2g" % pair for pair in error.items()) + "; of the sphere %.2g" % own)
both = ("sampling", "level_of_detail", "table", "total")
good &= set(error) == {s + unit for s in both for unit in ("", "_db")} | {"dead_reckoning"}
good &= abs(error["sampling_db"] - target["rcs_error_db"]["hh"]) < 1e-9 and abs(error["total"] / own - 1) < 0.1
good &= abs(sum(error[s] ** 2 for s in both[:3] + ("dead_reckoning",)) / error["total"] ** 2 - 1) < 1e-9
sys.exit(not good)
P
# the same by way of the ground: a sphere returns a / 2 at any of these angles, so of a ground that mirrors G once gives 4 G^2 and
# both ways G^4 of its cross section; all that is found in one cell is all four paths
replay "$tmp/ball.pcap" "$tmp/bounce" "${seen[@]}" --only 5 --set radar.preset=search_ku --set radar.ground=false --set radar.warp_mm=0
check "a sphere on the ground" [ $code = 0 ]; [ $code = 0 ] || tail -n 3 "$tmp/stderr"
python3 - "$tmp/bounce" <<'P' || fail "a sphere on the ground"
import json, math, sys
radar = json.loads(open(sys.argv[1] + "/truth.jsonl").read().splitlines()[-1])["radar"]
target = [t for t in radar["targets"] if t["entity"] == "1:3001:11"][0]
bounce, got = target["ground_bounce"], radar["detections"][0]
g_db = 20 * math.log10(bounce["coherence"]) # across: the larger of the two
alone = target["rcs_dbsm"]["hh"]
once_db, twice_db = bounce["once_dbsm"]["hh"] - alone - g_db - 20 * math.log10(2), bounce["twice_dbsm"]["hh"] - alone - 2 * g_db
print("mirrors %.3f; once %+.2f dB, twice %+.2f dB of a sphere's; all paths %.2f dBsm, found %.2f" % (
    bounce["coherence"], once_db, twice_db, bounce["rcs_dbsm"]["hh"], got["rcs_dbsm"]))
good = 0.02 < bounce["coherence"] < 1 and abs(once_db) < 0.5 and abs(twice_db) < 0.5
good &= abs(got["rcs_dbsm"] - bounce["rcs_dbsm"]["hh"]) < 0.3 and abs(bounce["rcs_dbsm"]["hh"] - alone) > 0.1
sys.exit(not good)
P

table=$(dirname "$0")/../../etc/radars.csv
# each waveform, from a table of one's own; a table that is not one
for kind in "stepped_35 stepped" "pulse_doppler_ku pulse_doppler" "fmcw_94 fmcw"; do
    set -- $kind
    { printf '# mine\n'; grep '^name,' "$table"; grep "^$1," "$table" | sed 's/^[a-z_0-9]*/mine/'; } >"$tmp/radars.csv"
    replay "$tmp/ball.pcap" "$tmp/$2" "${seen[@]}" --only 5 --set radar.preset=mine --set radar.table="$tmp/radars.csv" \
        --set models.catalog="$tmp/rough.csv" --set radar.ground=false --set radar.warp_mm=0 --set quality.budget=off
    check "$2, of a table of one's own" [ $code = 0 ]; [ $code = 0 ] || tail -n 3 "$tmp/stderr"
    check "without a budget no error is given" [ "$(grep -c '"error"' "$tmp/$2/truth.jsonl")" = 0 ]
    check "its kind in the truth, and a column of the canceller" grep -q "\"kind\": *\"$2\"" "$tmp/$2/truth.jsonl"
done
sed 's/,stepped,/,chirped,/; s/,fmcw,/,chirped,/' "$tmp/radars.csv" >"$tmp/bad.csv"
printf 'radar: {table: %s, preset: mine}\n' "$tmp/bad.csv" >"$tmp/bad.yaml"
run check "$tmp/bad.yaml"
check "check: a table of radars refused with its line and column" [ $code = 1 ] && complained 'bad.csv:3: column waveform: .chirped.'
printf 'radar: {preset: hubble}\n' >"$tmp/bad.yaml"
run check "$tmp/bad.yaml"
check "check: refused with file, line and key" [ $code = 1 ] && complained 'bad.yaml:1: radar.preset'
finish
