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
# compare FOLDER: each variant is the run of its settings, alone
compare() {
    local number=0 folder
    for folder in $(grep -oE '"folder":"v[0-9a-f]{10}"' "$1/manifest.jsonl" | cut -d'"' -f4); do
        number=$((number + 1))
        "$pitviper" replay "$tmp/demo.pcap" -c "$1/$folder/settings.yaml" --threads 1 --out "$tmp/alone" --overwrite >"$tmp/alone.txt" 2>&1
        check "variant $number: the bits of a run alone" same_hashes "$tmp/alone" "$1/$folder"
        check "variant $number: its pictures" cmp -s <(cat "$tmp"/alone/frames/*/*.png) <(cat "$1/$folder"/frames/*/*.png)
        check "variant $number: its truth" cmp -s "$tmp/alone/truth.jsonl" "$1/$folder/truth.jsonl"
        check "variant $number: its messages" cmp -s <(grep -v 'frames in' "$tmp/alone.txt") <(grep -v 'frames in' "$1/$folder/log.txt")
        (cd "$tmp/alone" && cat frames/lwir/*.png truth.jsonl | sha256sum) >>"$1/all"
    done
    check "no two are alike: every axis counts" [ "$(sort -u "$1/all" | wc -l)" = "$2" ]
}
