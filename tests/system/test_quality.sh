#!/usr/bin/env bash
# A frame's account of its own error, and settings picked by what they must keep, from the command line.
. "$(dirname "$0")/common.sh"

exercise demo "$tmp/demo.pcap"
few=(--rate 0.5 --no-png --no-files)
replay "$tmp/demo.pcap" "$tmp/plain" "${few[@]}" --set quality.budget=off
check "a replay" [ "$code" = 0 ]
check "no budget, no errors" [ "$(grep -c '"error"' "$tmp/plain/truth.jsonl")" = 0 ]
replay "$tmp/demo.pcap" "$tmp/on" "${few[@]}"
check "errors by default, in every line" \
    [ "$(grep -c '"error":{"optical":{"sampling"' "$tmp/on/truth.jsonl")" = "$(wc -l <"$tmp/on/truth.jsonl")" ]
check "the same planes" same_hashes "$tmp/plain" "$tmp/on"
config_hash() { run_json "$1" | grep -oE '"config_sha256":"[0-9a-f]+"'; }
check "the same configuration" [ "$(config_hash "$tmp/plain")" = "$(config_hash "$tmp/on")" ]
replay "$tmp/demo.pcap" "$tmp/one" "${few[@]}" --threads 1
errors() { grep -o '"error":{.*' "$1/truth.jsonl"; }
check "the same errors on one thread" [ "$(errors "$tmp/on")" = "$(errors "$tmp/one")" ]
for source in sampling level_of_detail table heat dead_reckoning total total_k; do
    check "$source" grep -q "\"$source\":" "$tmp/on/truth.jsonl"
done

# asked for, picked, said; the same pictures as with those settings by name, under the same hash
replay "$tmp/demo.pcap" "$tmp/asked" "${few[@]}" --set quality.radiance_rmse_percent=3
check "the pick is said" grep -q 'quality: samples' "$tmp/stderr" "$tmp/stdout"
choice=$(run_json "$tmp/asked" | grep -oE '"quality:[^"]*"')
check "and recorded" [ -n "$choice" ]
number() { grep -oE "$1[0-9]+" <<<"$choice" | head -n 1 | grep -oE '[0-9]+$'; }
replay "$tmp/demo.pcap" "$tmp/named" "${few[@]}" --set sensor.samples="$(number '"quality:samples')" \
    --set sensor.edge_samples="$(number ,edge_samples)" --set sensor.target_samples="$(number target_samples)"
check "the same as by name" same_hashes "$tmp/asked" "$tmp/named"
check "under the same hash" [ "$(config_hash "$tmp/asked")" = "$(config_hash "$tmp/named")" ]
check "not as by default" [ "$(config_hash "$tmp/asked")" != "$(config_hash "$tmp/on")" ]

# time: by the table and the factor, not by a clock
time_asked() {
    replay "$tmp/demo.pcap" "$1" "${few[@]}" --causal --set quality.frame_ms=20 --set quality.machine_factor="$2"
}
time_asked "$tmp/fast" 0.01
time_asked "$tmp/again" 0.01
time_asked "$tmp/slow" 100
check "the same again" same_hashes "$tmp/fast" "$tmp/again"
check "a slow machine does less" [ "$(config_hash "$tmp/fast")" != "$(config_hash "$tmp/slow")" ]
check "and says that it is not enough" grep -q 'NOTreached' <(run_json "$tmp/slow")

# measured again: the same errors to the digit, by whatever number of threads; no time is judged
run bench quality --quick --table "$tmp/q1.csv" --threads 1
check "a table" [ "$code" = 0 ]
run bench quality --quick --table "$tmp/q2.csv" --threads 2
measured() { grep '^[0-9]' "$1" | cut -d, -f1-8 | sort; }
# rows that a time leaves out of one of them are not compared
grep '^[0-9]' "$tmp/q1.csv" | cut -d, -f1-3 | sort >"$tmp/q1.rows"
check "a table with rows" [ "$(wc -l <"$tmp/q1.rows")" -ge 8 ]
check "the quickest first" grep -q '^1,0,0,' <(grep -m 1 '^[0-9]' "$tmp/q1.csv")
check "the same errors" [ -z "$(comm -3 <(measured "$tmp/q1.csv") <(measured "$tmp/q2.csv") |
    cut -d, -f1-3 | tr -d '\t' | sort | uniq -d)" ]

printf 'samples,edge_samples\n1,2\n' >"$tmp/bad.csv"
replay "$tmp/demo.pcap" "$tmp/bad" "${few[@]}" --set quality.table="$tmp/bad.csv" --set quality.frame_ms=20
check "a broken table is refused" [ "$code" != 0 ]
check "by name" grep -q 'bad.csv' "$tmp/stderr"
finish
