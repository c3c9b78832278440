#!/usr/bin/env bash
# Ten thousand entities, 30 frames a second of 320x216 asked for: every datagram that was sent is heard, and what is shown
# is what the recording shows. How many frames there are is this machine's business, and only said. labels: deep
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

free_port
few=(--size 320x216 --bands lwir --rate 30 --no-files --set entities.shown=10000)
node crowd --address 127.0.0.1 --port $port "${few[@]}" --record "$tmp/crowd.pcapng"
check "it listens" heard_by crowd 'listening on'
sender crowd --send 127.0.0.1:$port
check "it finds them" heard_by crowd '^ground:'
# until it has shown eight seconds of them, by the exercise's clock: they are announced one after the other
long() { is "$(time_of "$tmp/crowd" '$')" '>' "$(awk -v t="$(time_of "$tmp/crowd" 1)" 'BEGIN { print t + 8 }')"; }
check "it makes frames" makes crowd 2
check "of eight seconds" until_of crowd long
kill "$sender"; wait "$sender" # TERM: what a script has in the background may not hear INT
sent=$(grep -oE '[0-9]+ datagrams' "$tmp/sender.out" | cut -d' ' -f1)
# until what was sent is recorded: the recording goes on growing until then
settled() { local was=$(stat -c %s "$tmp/crowd.pcapng"); sleep 1; [ "$was" = "$(stat -c %s "$tmp/crowd.pcapng")" ]; }
until_true settled
stop crowd
check "ends well" [ $code = 0 ]
check "sent $sent datagrams, heard $(live_counter "$tmp/crowd" datagrams)" [ "${sent:-none}" = "$(live_counter "$tmp/crowd" datagrams)" ]
check "none lost" [ "$(live_counter "$tmp/crowd" lost_kernel)$(live_counter "$tmp/crowd" lost_queue)" = 00 ]
check "10 000 entities" [ "$(run_json "$tmp/crowd" | grep -oE '"entities":\{"created":[0-9]+' | grep -oE '[0-9]+$')" = 10000 ]
made=$(wc -l <"$tmp/crowd/truth.jsonl")
first=$(time_of "$tmp/crowd" 1)
last=$(time_of "$tmp/crowd" '$')
awk -v n="$made" -v a="$first" -v b="$last" -v late="$(live_counter "$tmp/crowd" frames_late)" \
    'BEGIN { printf "%d frames in %.1f s: %.1f a second; %d left out\n", n, b - a, (n - 1) / (b - a), late }'
# the last half second
replay "$tmp/crowd.pcapng" "$tmp/again" --causal --port 0 "${few[@]}" --to "$last" \
    --from "$(awk -v t="$last" 'BEGIN { printf "%.6f", t - 0.5 }')"
check "its recording replays" [ $code = 0 ]
check "the same pictures" agree "$tmp/crowd" "$tmp/again" 1
[ "$failures" = 0 ] || { tail -n 20 "$tmp/crowd.out"; cat "$tmp/stderr"; }
finish
