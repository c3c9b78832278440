#!/usr/bin/env bash
# A frame's account of its own error, and settings picked by what they must keep, from the command line. How the table of
# settings is measured: test_quality_deep.sh.
. "$(dirname "$0")/common.sh"

cat >"$tmp/two.yaml" <<'Y'
duration_s: 8
vehicles:
  - {name: Tank, type: tank, route_m: [[-15, -4], [0, 3], [20, 0], [50, 6]], speed_mps: 6}
  - {name: Truck, type: truck, route_m: [12, 8]}
Y
exercise "$tmp/two.yaml" "$tmp/two.pcap"
# shown OUT options: two frames of two vehicles 150 m away, on one thread
shown() {
    local out=$1; shift
    replay "$tmp/two.pcap" "$tmp/$out" --size 48x32 --only 4,6 --threads 1 --no-png --no-files --planes none \
        --set observer.range_m=150 --set observer.height_m=40 "$@"
}
config_hash() { run_json "$1" | grep -oE '"config_sha256":"[0-9a-f]+"'; }
errors() { grep -o '"error":{.*' "$1/truth.jsonl"; }

shown plain --set quality.budget=off
check "a replay" [ "$code" = 0 ]
check "no budget, no errors" [ "$(grep -c '"error"' "$tmp/plain/truth.jsonl")" = 0 ]
shown on
check "with the median, and the share beyond 1 K, of thermal bands; none of the pseudo-radar" eval \
    '[ "$(grep -oE "\"median_k\":[0-9.e-]+,\"beyond_1k\":[0-9.e-]+" "$tmp/on/truth.jsonl" | wc -l)" -ge 2 ] && ! errors "$tmp/on" | grep -q "\"radar\":{\"sampling"'
check "errors by default, in every line" \
    [ "$(grep -c '"error":{"optical":{"sampling"' "$tmp/on/truth.jsonl")" = 2 -a "$(wc -l <"$tmp/on/truth.jsonl")" = 2 ]
check "the same planes" same_hashes "$tmp/plain" "$tmp/on"
check "the same configuration" [ "$(config_hash "$tmp/plain")" = "$(config_hash "$tmp/on")" ]
shown two --threads 2
check "the same errors on two threads as on one" [ -n "$(errors "$tmp/on")" -a "$(errors "$tmp/on")" = "$(errors "$tmp/two")" ]
for source in sampling level_of_detail table heat dead_reckoning total total_k; do
    check "$source" grep -q "\"$source\":" "$tmp/on/truth.jsonl"
done

# asked for, picked, said; the same pictures as with those settings by name, under the same hash
shown asked --only 6 --set quality.radiance_rmse_percent=3
check "the pick is said" grep -q 'quality: samples' "$tmp/stderr" "$tmp/stdout"
choice=$(run_json "$tmp/asked" | grep -oE '"quality:[^"]*"')
check "and recorded" [ -n "$choice" ]
number() { grep -oE "$1[0-9]+" <<<"$choice" | head -n 1 | grep -oE '[0-9]+$'; }
shown named --only 6 --set sensor.samples="$(number '"quality:samples')" \
    --set sensor.edge_samples="$(number ,edge_samples)" --set sensor.target_samples="$(number target_samples)"
check "the same as by name" same_hashes "$tmp/asked" "$tmp/named"
check "under the same hash" [ "$(config_hash "$tmp/asked")" = "$(config_hash "$tmp/named")" ]
check "not as by default" [ "$(config_hash "$tmp/asked")" != "$(config_hash "$tmp/on")" ]

# time: by the table and the factor, not by a clock. A row takes its time a megapixel by the table, for 1536 pixels
cat >"$tmp/times.csv" <<'T'
samples,edge_samples,target_samples,optical_percent,mwir_percent,lwir_percent,mwir_k,lwir_k,ms_megapixel
1,0,0,16,44,7,2,2.4,300
2,4,48,5,4,0.8,0.4,0.5,1400
3,6,64,3,2.4,0.4,0.2,0.3,2700
T
time_asked() {
    shown "$1" --only 4 --causal --set quality.table="$tmp/times.csv" --set quality.frame_ms=20 --set quality.machine_factor="$2"
}
samples_of() { run_json "$tmp/$1" | grep -oE '"quality:samples[0-9]+' | grep -oE '[0-9]+$'; }
time_asked fast 0.01
time_asked again 0.01
time_asked slow 100
check "the same again" same_hashes "$tmp/fast" "$tmp/again"
check "a fast machine does most" [ "$(samples_of fast)" = 3 ]
check "a slow machine does less" \
    [ "$(samples_of slow)" = 1 -a "$(config_hash "$tmp/fast")" != "$(config_hash "$tmp/slow")" ]
check "and says that it is not enough" grep -q 'NOTreached' <(run_json "$tmp/slow")

printf 'samples,edge_samples\n1,2\n' >"$tmp/bad.csv"
shown bad --set quality.table="$tmp/bad.csv" --set quality.frame_ms=20
check "a broken table is refused" [ "$code" != 0 ]
check "by name" grep -q 'bad.csv' "$tmp/stderr"
finish
