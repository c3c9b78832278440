#!/usr/bin/env bash
# A live node with all its threads: the socket's, the pool's, the writer's; told to stop in the middle, with a disk that
# goes away. Under the thread sanitizer any race ends it with 66. labels: small threads
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

few=(--size 32x24 --rate 10 --bands optical,lwir --set exercise.listen_s=0.3 --set sensor.preset=staring_lwir)
free_port
node loop --address 127.0.0.1 --port $port "${few[@]}" --threads 3 --set publish.dis=sensor --record "$tmp/loop.pcapng"
check "it listens" heard_by loop 'listening on'
sender demo --set duration_s=900 --send 127.0.0.1:$port
pictures() { [ "$(find "$tmp/loop/frames/lwir" -name '*.exr' 2>/dev/null | wc -l)" -ge 5 ]; }
check "it makes pictures" until_of loop pictures
mv "$tmp/loop/frames" "$tmp/loop/elsewhere"
check "without a place for pictures it goes on, and says so" heard_by loop 'going on without picture files'
lines=$(lines_in "$tmp/loop/truth.jsonl")
check "and makes frames" makes loop $((lines + 4))
stop loop
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
check "two Data PDUs a frame" [ "$(live_counter "$tmp/loop" sent)" = $((2 * made)) ]
own=$(run_json "$tmp/loop" | grep -oE '"own":[0-9]+' | cut -d: -f2)
check "its own came back, but for those of the last frame that were still on their way" [ "$own" -le $((2 * made)) -a "$own" -ge $((2 * made - 2)) ]
# three of them: a sanitizer takes seconds for a frame
replay "$tmp/loop.pcapng" "$tmp/again" --causal --port 0 --to "$(time_of "$tmp/loop" '$')" "${few[@]}" --no-files --only "$(frames_of loop | cut -d, -f3-5)"
check "its recording replays" [ $code = 0 ]
check "to the same bits" agree "$tmp/loop" "$tmp/again" 3
[ "$failures" = 0 ] || { tail -n 40 "$tmp/loop.out"; cat "$tmp/stderr"; }
finish
