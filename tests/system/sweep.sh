# What the tests of sweeps share; source it after common.sh.
exercise demo "$tmp/demo.pcap"
few=(--from 1366 --to 1366 --bands lwir --size 48x32 --threads 1 "${coarse[@]}")
sweep() { local file=$1 out=$2; shift 2; replay "$tmp/demo.pcap" "$out" "${few[@]}" --sweep "$file" "$@"; }
statuses() { grep -oE '"status":"[a-z]+"' "$1/manifest.jsonl" | sort | uniq -c | tr -s ' \n' ' '; }
cat >"$tmp/grid.yaml" <<'Y'
axes:
  weather:
    visibility_m: [5000, 23000]
  seed: [1, 2]
  sensor.hfov_deg: 5
Y
