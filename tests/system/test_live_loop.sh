#!/usr/bin/env bash
# A live node with all its threads: the socket's, the pool's, the writer's; told to stop in the middle, with a disk that
# goes away. Under the thread sanitizer any race ends it with 66. labels: small threads
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

free_port
node loop --address 127.0.0.1 --port $port --size 64x48 --threads 3 --rate 10 --bands optical,lwir --for 240 \
    --set publish.dis=sensor --set exercise.listen_s=0.5 --set sensor.preset=staring_lwir \
    --record "$tmp/loop.pcapng"
check "it listens" heard_by loop 'listening on' 20
sender demo --set duration_s=400 --send 127.0.0.1:$port
check "it finds an entity" heard_by loop '^ground:' 60
pictures() { find "$tmp/loop/frames/lwir" -name '*.exr' 2>/dev/null | wc -l; }
# a sanitizer takes seconds for a frame, more on a busy machine
for ((i = 0; i < 1200; i++)); do [ "$(pictures)" -ge 5 ] && break; sleep 0.1; done
check "it shows something" [ "$(pictures)" -ge 5 ]
mv "$tmp/loop/frames" "$tmp/loop/elsewhere"
check "without a place for pictures it goes on, and says so" heard_by loop 'going on without picture files' 60
lines=$(wc -l <"$tmp/loop/truth.jsonl")
for ((i = 0; i < 900; i++)); do [ "$(wc -l <"$tmp/loop/truth.jsonl")" -gt $((lines + 3)) ] && break; sleep 0.1; done
kill -INT "${node[loop]}"
ended loop 60
end_sender
check "told to stop: ends well" [ $code = 0 ]
check "no race" [ "$(grep -c ThreadSanitizer "$tmp/loop.out")" = 0 ]
check "said once" [ "$(grep -c 'going on without' "$tmp/loop.out")" = 1 ]
check "and complained of once" [ "$(grep -c 'cannot write' "$tmp/loop.out")" -le 6 ] # the six files of one frame
made=$(numbered "$tmp/loop" | wc -l)
check "truth of every frame" [ "$(wc -l <"$tmp/loop/truth.jsonl")" = "$made" ]
check "frames after the pictures ended" [ "$made" -gt $((lines + 3)) ]
# a frame is whole with its six files: the folder may go away between two of one frame
whole=$(find "$tmp/loop/elsewhere" -regex '.*/\(optical\|lwir\|truth\)/[0-9]*\.\(exr\|png\)' -printf '%f\n' | cut -d. -f1 |
    sort | uniq -c | awk '$1 == 6' | wc -l)
lacking=$(($(live_counter "$tmp/loop" files_failed) + $(live_counter "$tmp/loop" files_left_out)))
check "$whole frames with files and $lacking without are all $made" [ $((whole + lacking)) = "$made" ]
check "raw counts of the sensor beside them" [ "$(find "$tmp/loop/raw/lwir" -name '*.png' | wc -l)" -ge 5 ]
check "two Data PDUs a frame, and its own came back" [ "$(run_json "$tmp/loop" | grep -oE '"own":[0-9]+')" = "\"own\":$((2 * made))" ]
# five frames of the middle: a sanitizer takes seconds for one
replay "$tmp/loop.pcapng" "$tmp/again" --causal --port 0 --size 64x48 --rate 10 --bands optical,lwir --no-files \
    --from "$(time_of "$tmp/loop" 3)" --to "$(awk -v t="$(time_of "$tmp/loop" 3)" 'BEGIN { print t + 0.4 }')" \
    --set exercise.listen_s=0.5 --set sensor.preset=staring_lwir
check "its recording replays" [ $code = 0 ]
check "to the same bits" agree "$tmp/loop" "$tmp/again" 1
[ "$failures" = 0 ] || { tail -n 40 "$tmp/loop.out"; cat "$tmp/stderr"; }
finish
