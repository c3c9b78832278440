#!/usr/bin/env bash
# 101,000 invented entities in 2.5 s (20,200 and a smaller table where that will do), and a missile that is fired afterwards: it carries the sensor, whoever sends them and
# wherever they are; the same pictures at any rate and with any number of threads; what went is counted and said.
. "$(dirname "$0")/common.sh"

flood=$build/tests/flood
"$pitviper" exercise demo -o "$tmp/demo.pcapng" >/dev/null
look=(--causal --host munition --size 48x32 --bands lwir --no-files --set entities.shown=50)
entities() { run_json "$1" | grep -oE '"entities":\{[^}]*\}' | grep -oE "\"$2\":[0-9]+" | cut -d: -f2; }
frame() { grep -E "\"time_s\":$2[,}]" "$1/truth.jsonl" | grep -oE '"frame_sha256":"[0-9a-f]*"'; }
case=0
full=100000
for of in "senders=1" "senders=1000" "senders=1 reach_m=1500"; do
    case=$((case + 1))
    [ $case = 1 ] || full=20000
    more=$((full / 100))
    # shellcheck disable=SC2086
    "$flood" "$tmp/demo.pcapng" "$tmp/flood.pcapng" ids=$((full + more)) from_s=6 for_s=2.5 $of
    replay "$tmp/flood.pcapng" "$tmp/$case" "${look[@]}" --set entities.capacity=$full --rate 2 --from 1363 --to 1364 --threads 1
    check "$of: it replays" [ $code = 0 ]
    check "$of: the missile carries the sensor" grep -q '"hosts":\["1:3001:41"\]' <(run_json "$tmp/$case")
    check "$of: it has its target" grep -q 'aim: 1:3001:22' "$tmp/stderr"
    check "$of: the table is full, and that is said" grep -q "the table of $full entities is full: " "$tmp/stderr"
    check "$of: those that went are counted" [ "$(entities "$tmp/$case" evicted)" = $((more + 7)) ]
    check "$of: those that no picture shows are counted" [ "$(entities "$tmp/$case" most_left_out_of_a_frame)" = $((full - 50)) ]
done
replay "$tmp/flood.pcapng" "$tmp/often" "${look[@]}" --set entities.capacity=$full --rate 10 --from 1363.5 --to 1364 --threads 2
check "at another rate it replays" [ $code = 0 ]
for t in 1363.5 1364.0; do
    check "the same picture at $t s" [ -n "$(frame "$tmp/$case" $t)" -a "$(frame "$tmp/$case" $t)" = "$(frame "$tmp/often" $t)" ]
done
[ "$failures" = 0 ] || { tail -n 20 "$tmp/stderr"; head -c 600 "$tmp/often/truth.jsonl"; }
finish
