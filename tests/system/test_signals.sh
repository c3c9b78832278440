#!/usr/bin/env bash
# What would end the program in the middle of its products: a reader of its output that goes (`| head`), the signals that batch
# systems announce the end of a job's time with, the limit of a file's size.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
bare=("${quick[@]}")

# a node whose output is read no further, and which SIGUSR1 ends
free_port
flight "$tmp/flight.yaml"
: >"$tmp/node.out"
"$pitviper" run "${bare[@]}" --out "$tmp/node" --size 32x24 --threads 2 --for 900 --rate 5 --bands lwir --no-files \
    --set exercise.listen_s=0.3 --host observer --address 127.0.0.1 --port $port --record "$tmp/node.pcapng" 2>"$tmp/node.err" \
    > >(head -n 1 >"$tmp/node.out") &
node[node]=$!
until_of node grep -q 'listening on' "$tmp/node.err" "$tmp/node.out"
sender "$tmp/flight.yaml" --send 127.0.0.1:$port
check "a node whose output nobody reads goes on" makes node 3
kill -USR1 "${node[node]}"
ended node
check "SIGUSR1 ends it in order, not by the signal" [ $code = 0 ]
check "with run.json" grep -q '"status": *"stopped"' "$tmp/node/run.json"
end_sender
run inspect "$tmp/node.pcapng" --port $port
check "and its recording is whole" [ "$code" = 0 ]
check "without a cut end" not said 'ends early'

# a replay the same, by each signal; its code says which
exercise demo "$tmp/demo.pcap" duration_s=6
for signal in USR2:140 RTMIN:162; do
    rm -rf "$tmp/again"
    "$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/again" --size 16x16 --rate 20 --speed 1 --bands lwir --no-files \
        --set terrain.ground=trust >"$tmp/stdout" 2>"$tmp/stderr" &
    node[again]=$!
    makes again 1
    kill -${signal%:*} "${node[again]}"
    ended again
    check "SIG${signal%:*} ends a replay with ${signal#*:}, not $code" [ $code = "${signal#*:}" ]
    check "SIG${signal%:*}: with run.json" grep -q '"status": *"stopped"' "$tmp/again/run.json"
done
"$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/head" --size 16x16 --rate 1 --only 0,1 --bands lwir --no-files 2>"$tmp/stderr" |
    head -n 1 >/dev/null
check "a replay whose output is cut: done, and no failure" [ "${PIPESTATUS[0]}" = 0 ]
check "a replay whose output is cut: complete" grep -q '"status": *"complete"' "$tmp/head/run.json"

# a recorder
free_port
"$pitviper" record -o "$tmp/log.pcapng" --address 127.0.0.1 --port $port >"$tmp/stdout" 2>"$tmp/record.err" &
node[record]=$!
until_of record grep -qs "record" "$tmp/record.err"
until_of record test -e "$tmp/log.pcapng"
kill -USR2 "${node[record]}"
ended record
check "SIGUSR2 ends a recorder in order, not by the signal" [ $code -lt 128 ]
run inspect "$tmp/log.pcapng"
check "its recording is one" [ "$code" = 0 ]

# a limit of file size is a full disk
(ulimit -f 4; exec "$pitviper" exercise "$tmp/flight.yaml" -o "$tmp/large.pcapng" >"$tmp/stdout" 2>"$tmp/stderr")
check "a limit of file size ends it with 1" [ $? = 1 ]
check "and says why" complained 'large\.pcapng.*too large'

# what was ignored stays so, as under nohup; a reader that does nothing but print ends with what reads it
(trap '' USR1; exec "$pitviper" record -o "$tmp/deaf.pcapng" --address 127.0.0.1 --port $port --for 900 >"$tmp/stdout" 2>"$tmp/deaf.err") &
node[deaf]=$!
until_of deaf grep -qs record "$tmp/deaf.err"
kill -USR1 "${node[deaf]}"; kill -TERM "${node[deaf]}"
ended deaf
check "SIGUSR1 that was ignored stays so; SIGTERM ends it" [ $code = 0 ]
"$pitviper" inspect "$tmp/node.pcapng" --port 0 --pdus tsv | head -n 1 >"$tmp/first"
check "inspect | head is quiet" [ "$(wc -l <"$tmp/first")" = 1 ]

# a bench that is ended, also by what nothing can catch, leaves no node behind
for signal in TERM KILL; do
    TMPDIR=$tmp "$pitviper" bench network --quick >"$tmp/stdout" 2>"$tmp/bench.err" &
    node[bench]=$!
    children() { cat /proc/${node[bench]}/task/*/children 2>/dev/null; }
    has_two() { [ "$(children | wc -w)" -ge 2 ]; }
    until_of bench has_two
    left=($(children))
    check "bench: a node and an exercise" [ ${#left[@]} -ge 2 ]
    # of what the numbers are, in case they are used again
    is_ours() { local pid; for pid in "${left[@]}"; do [ "$(readlink /proc/$pid/exe)" = "$(readlink -f "$pitviper")" ] && return; done; return 1; }
    check "bench: they are ours" is_ours
    kill -$signal "${node[bench]}"
    ended bench 2>/dev/null
    check "SIG$signal: a bench's nodes end with it" until_true not is_ours
done
finish
