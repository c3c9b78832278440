#!/usr/bin/env bash
# Same log, configuration and version: the same planes to the bit, for any number of threads, at any speed,
# with every skip or none. labels: small
. "$(dirname "$0")/common.sh"

exercise demo "$tmp/demo.pcap"
few=(--rate 2 --no-png)
replay "$tmp/demo.pcap" "$tmp/one" "${few[@]}" --threads 1
check "a replay" [ "$code" = 0 ]
check "some frames" [ "$(frames "$tmp/one")" -ge 8 ]
check "a hash a frame" [ "$(hashes "$tmp/one" | grep -oE '[0-9a-f]{64}' | sort -u | wc -l)" = "$(frames "$tmp/one")" ]

for threads in 2 4; do
    replay "$tmp/demo.pcap" "$tmp/t$threads" "${few[@]}" --threads $threads
    check "$threads threads, same bits" same_hashes "$tmp/one" "$tmp/t$threads"
done
replay "$tmp/demo.pcap" "$tmp/again" "${few[@]}" --threads 2 --speed 10
check "speed 10, same bits" same_hashes "$tmp/one" "$tmp/again"
first=$(json_numbers <(head -n 1 "$tmp/one/truth.jsonl") time_s | head -n 1)
span=(--from "$first" --to "$(awk -v t="$first" 'BEGIN { print t + 2 }')")
replay "$tmp/demo.pcap" "$tmp/real" "${few[@]}" "${span[@]}" --speed 1
replay "$tmp/demo.pcap" "$tmp/max" "${few[@]}" "${span[@]}" --speed max
check "speed 1, same bits as max" same_hashes "$tmp/real" "$tmp/max"
check "speed 1: all frames of 2 s" [ "$(frames "$tmp/real")" = 5 ]
replay "$tmp/demo.pcap" "$tmp/noskip" "${few[@]}" --no-skip
check "no skips, same bits" same_hashes "$tmp/one" "$tmp/noskip"

# from the middle: a frame does not depend on those before it
if [ "$(frames "$tmp/one")" -ge 8 ]; then
    first=$(json_numbers <(sed -n 4p "$tmp/one/truth.jsonl") time_s | head -n 1)
    replay "$tmp/demo.pcap" "$tmp/late" "${few[@]}" --from "$first"
    check "--from: its first frame is the fourth of the whole" \
        [ "$(hashes "$tmp/late" | grep -oE '[0-9a-f]{64}' | head -n 1)" = "$(hashes "$tmp/one" | grep -oE '[0-9a-f]{64}' | sed -n 4p)" ]
fi

# the twin: what should change the bits does
replay "$tmp/demo.pcap" "$tmp/seed" "${few[@]}" --seed 2
differ() { ! same_hashes "$@"; }
check "another seed, other bits" differ "$tmp/one" "$tmp/seed"
check "another seed still makes frames" [ "$(frames "$tmp/seed")" = "$(frames "$tmp/one")" ]
config_of() { grep -oE '"config_sha256": *"[0-9a-f]{64}"' "$1/run.json"; }
check "the configuration hash leaves out threads and speed" [ "$(config_of "$tmp/one")" = "$(config_of "$tmp/again")" ]
check "and knows the seed" [ "$(config_of "$tmp/one")" != "$(config_of "$tmp/seed")" ]

# nothing is made that was not asked for, and what is asked for does not change
replay "$tmp/demo.pcap" "$tmp/lwir" "${few[@]}" --bands lwir
check "--bands lwir: lwir frames" [ "$(frames "$tmp/lwir" lwir)" = "$(frames "$tmp/one" lwir)" ]
check "--bands lwir: no others" [ "$(frames "$tmp/lwir" optical)$(frames "$tmp/lwir" mwir)$(frames "$tmp/lwir" radar)" = 000 ]
last=$(find "$tmp/one/frames/lwir" -name '*.exr' -printf '%f\n' | sort | tail -n 1)
if command -v oiiotool >/dev/null; then
    sum() { oiiotool --hash --info -v "$1" | grep -o 'SHA-1.*'; }
    check "--bands lwir: the same picture" [ "$(sum "$tmp/one/frames/lwir/$last")" = "$(sum "$tmp/lwir/frames/lwir/$last")" ]
fi
check "--no-png: none" [ -z "$(find "$tmp/one" -name '*.png')" ]
finish
