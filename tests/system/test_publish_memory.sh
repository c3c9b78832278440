#!/usr/bin/env bash
# Memory is flat over ten minutes with all consumers of frames on but image files: a replay by the clock that writes shared
# memory, streams and writes video with KLV, sends Data PDUs, keeps the newest pictures and the latency ledger; and its file
# descriptors are as many as before. PITVIPER_MEMORY_S=20 is a short look. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

seconds=${PITVIPER_MEMORY_S:-600}
# what a frame shows decides what its own memory takes, which is kept: tanks that drive round for ever
cat >"$tmp/scene.yaml" <<Y
duration_s: $((seconds + 10))
dis: {heartbeat_s: 0.15, bundle: true}
vehicles:
  - {name: Tank, id: 11, type: tank, force: 2, count: 12, columns: 4, column_m: 20, spacing_m: 20, loop: true, route_m: [[0, 0], [0, 200], [60, 200], [60, 0]], speed_mps: 6, turret: swing}
Y
exercise "$tmp/scene.yaml" "$tmp/rounds.pcap"
free_port
options=(--memory pitviper_memory_$$ --latest --no-files --set publish.dis=sensor --address 127.0.0.1)
"$pitviper" replay --help | grep -q -- --stream && options+=(--stream udp://127.0.0.1:$((port + 1000)) --set publish.klv_files=true --video "$tmp/video")
"$pitviper" replay "${bare[@]}" "$tmp/rounds.pcap" --host observer --out "$tmp/out" --size 64x48 --bands lwir --rate 10 --to +$seconds --speed 1 --threads 2 "${options[@]}" >"$tmp/out.txt" 2>&1 &
replay=$!
rss_kb() { awk '/^RssAnon/ { print $2 }' /proc/$replay/status 2>/dev/null; } # pages of files come and go as the machine likes
files() { ls /proc/$replay/fd 2>/dev/null | wc -l; }
: >"$tmp/rss"
while kill -0 $replay 2>/dev/null; do
    sleep "$(awk -v s="$seconds" 'BEGIN { print s / 60 }')"
    kb=$(rss_kb)
    [ -z "$kb" ] || echo "$kb $(files)" >>"$tmp/rss"
done
wait $replay
check "the replay ends well" [ $? = 0 ] || cat "$tmp/out.txt"
check "the samples are enough" [ "$(wc -l <"$tmp/rss")" -ge 40 ]
# the first quarter is for the start; then the largest of the later half against the largest before it. Frames that show
# more take up to some MB more: 4 % are allowed, so that a loss of 4 kB a frame is seen
flat=$(awk '{ kb[NR] = $1 }
    END { for (i = int(NR / 4) + 1; i <= NR; i++) { late = i > NR * 5 / 8; if (kb[i] > most[late]) most[late] = kb[i] }
          print most[0], most[1], most[1] <= 1.04 * most[0] ? "flat" : "grows" }' "$tmp/rss")
echo "KB: $(cut -d' ' -f1 "$tmp/rss" | tr '\n' ' ')"
echo "resident, KB, at most, before and in the later half: $flat"
check "memory is flat" grep -q flat <<<"$flat"
check "no file is left open" [ "$(awk 'NR == 20 { print $2 }' "$tmp/rss")" = "$(tail -n 2 "$tmp/rss" | head -n 1 | cut -d' ' -f2)" ]
check "frames were made" [ "$(json_numbers "$tmp/out/run.json" frames | tail -n 1)" -ge $((seconds * 10 - 20)) ]
finish
