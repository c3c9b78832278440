#!/usr/bin/env bash
# `pitviper fly` in the loop, whose recogniser is killed in flight from outside (SIGKILL, by its own process id): the missile
# coasts, the run ends by itself and long before the answer's limit, and by the recording it flies so again.
. "$(dirname "$0")/common.sh"

judges python3.numpy
. "$(dirname "$0")/../tools/loop_common.sh"
export TMPDIR=$tmp

# it answers ten frames, then sleeps on the eleventh for longer than this test has
"$pitviper" fly "$tmp/short.yaml" --frames "$tmp/killed" --limit 600 -o "$tmp/killed.pcap" \
    --recogniser "echo \$\$ >'$tmp/pid'; exec $knows --slow 10,600" -- "${small[@]}" --threads 2 >"$tmp/killed.csv" 2>"$tmp/killed.err" &
flight=$!
tenth() { has_lines "$tmp/killed/truth.jsonl" 10 || ! kill -0 "$flight" 2>/dev/null; }
until_true tenth
ten=$(lines_in "$tmp/killed/truth.jsonl")
check "it flies, and waits for the answer: $ten frames" [ "$ten" -ge 10 ]
asleep() { [ "$(lines_in "$tmp/killed/truth.jsonl")" = 11 ] || ! kill -0 "$flight" 2>/dev/null; } # it has the frame in whose answer it sleeps
until_true asleep
sleep 0.5 # until it has read it
pid=$(cat "$tmp/pid")
check "the recogniser is what is killed" grep -q loop_recogniser "/proc/$pid/cmdline"
kill -KILL "$pid"
ended() { ! kill -0 "$flight" 2>/dev/null; }
until_true ended
check "it ends by itself" ended
kill -KILL "$flight" 2>/dev/null
wait "$flight"; code=$?
check "ended with $code: $(tail -n 2 "$tmp/killed.err")" [ "$code" = 0 ]
check "said" grep -qE 'recogniser (ended with code 137|was ended by signal 9)' "$tmp/killed.err"
check "its ten answers were used: $(cell killed seen)" [ "$(cell killed seen)" = 10 ]
check "no further one" [ "$(cell killed none)" = "$(($(cell killed frames) - 10))" ]
check "guided until then: $(cell killed guided_share)" is "$(cell killed guided_share)" '>' 0.1
check "coasts after" is "$(cell killed guided_share)" '<' 0.6
check "no recogniser is left" [ ! -e "/proc/$pid" ]
check "nor its folder" [ -z "$(find "$tmp" -maxdepth 1 -name 'pitviper-fly-*')" ]
more=(--threads 1)
loop again --sights "$tmp/killed/sights.csv" -o "$tmp/again.pcap"
check "the same exercise by the recording" cmp -s "$tmp/killed.pcap" "$tmp/again.pcap"
finish
