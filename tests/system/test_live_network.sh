#!/usr/bin/env bash
# A network of its own, where an interface is deleted and made anew under who listens and who sends: each says so once,
# and once that it is back, and goes on. And nodes that have nothing to show, or cannot send: each ends with 1 and says
# why. Two nodes on one exercise, as etc/reference/network.md has them.
if [ -z "${PITVIPER_OWN_NETWORK:-}" ]; then
    { command -v unshare && command -v ip; } >/dev/null || { echo "skipped: needs unshare and ip"; exit 77; }
    unshare -rn true 2>/dev/null || { echo "skipped: this user may not make a network of their own"; exit 77; }
    PITVIPER_OWN_NETWORK=1 exec unshare -rn bash "$0" "$@"
fi
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

group=239.71.7.9
make_interface() { # a pair of Ethernet ends; what is sent by one comes back to who listens on it
    ip link add exercise0 type veth peer name exercise1 "$@" && ip addr add 10.77.0.1/24 brd 10.77.0.255 dev exercise0 &&
        ip addr add fd00:77::1/64 dev exercise0 nodad && ip link set exercise1 up && ip link set exercise0 up &&
        ip route add 239.0.0.0/8 dev exercise0
}
{ ip link set lo up && make_interface; } || { echo "skipped: no pair of interfaces here"; exit 77; }

few=(--size 32x24 --no-files --bands lwir --rate 4 --threads 1 --set exercise.listen_s=0.3)
recorder() { # NAME options: a recording in the background
    local name=$1; shift
    "$pitviper" record -o "$tmp/$name.pcapng" --for 900 "$@" >"$tmp/$name.out" 2>&1 &
    node[$name]=$!
}
sent=() # processes of senders
send() { # OPTIONS: an exercise, fast, in the background
    "$pitviper" exercise demo --set duration_s=3600 --speed 4 "$@" >"$tmp/send${#sent[@]}.out" 2>&1 &
    sent+=($!)
}
# What is recorded, in octets: an Entity State is 144 and more. To start a program for each look takes longer.
recorded() { stat -c %s "$tmp/$1.pcapng"; }
has_recorded() { [ "$(recorded "$1")" -ge "$2" ]; }
hears() { until_of "$1" has_recorded "$1" "$2"; } # NAME OCTETS

# ---- nodes that have nothing to show or cannot send, two on one exercise, one on a terminal --------------------------
node other --address 127.0.0.1 --port 3010 "${few[@]}" --set exercise.exercise=9 --record "$tmp/other.pcapng"
node junk --address 127.0.0.1 --port 3011 "${few[@]}" --record "$tmp/junk.pcapng"
node itself --address 127.0.0.1 --port 3012 "${few[@]}" --set node.site=1 --set node.application=3001 --record "$tmp/itself.pcapng"
node hostless --address 127.0.0.1 --port 3013 "${few[@]}" --host 9:9:9
node routeless --port 3014 "${few[@]}" --frames 2 --set publish.dis=sensor # to 255.255.255.255
# a broadcast within this machine reaches both
node seeker --address 127.255.255.255 --port 3020 "${few[@]}" --frames 6 --set publish.dis=sensor
heard_by seeker 'listening on'
second=(--out "$tmp/observer" --address 127.255.255.255 --port 3020 "${few[@]}" --for 900 --set publish.dis=sensor
    --set node.application=2 --host observer --frames 8)
if command -v script >/dev/null; then # on a terminal
    script -qefc "'$pitviper' run ${bare[*]} ${second[*]}" /dev/null </dev/null >"$tmp/observer.out" 2>&1 &
else
    echo "without the line of a terminal: no script"
    "$pitviper" run "${bare[@]}" "${second[@]}" >"$tmp/observer.out" 2>&1 &
fi
node[observer]=$!
node watch --address $group --interface exercise0 --port 3000 "${few[@]}"
recorder named --address $group --interface exercise0 --port 3000
recorder chosen --address $group --port 3001        # the system chooses the interface
recorder own --address 10.77.0.1 --port 3002
recorder broadcast --address 10.77.0.255 --interface exercise0 --port 3003
recorder six --address ff15::d15 --interface exercise0 --port 3004
for name in other junk itself hostless routeless observer watch named chosen own broadcast six; do
    check "$name listens" heard_by $name 'listening on'
done
silent=$(recorded other) # what a recording of nothing has
for port in 3010 3012 3013 3014; do send --send 127.0.0.1:$port; done
send --send 127.255.255.255:3020
for i in 1 2 3; do echo "no DIS at all" >/dev/udp/127.0.0.1/3011; done
run run --address 127.0.0.1 --port 3011 "${few[@]}" --for 9 --out "$tmp/alone"
check "a port that is taken: exit code" [ $code = 1 ]
check "a port that is taken: what to do" complained 'another program has the port.*127.255.255.255'

# ---- an interface that goes and comes --------------------------------------------------------------------------------
"$pitviper" exercise demo --set duration_s=3600 --set dis.heartbeat_s=0.2 --send $group:3000 --interface exercise0 >"$tmp/away.out" 2>&1 &
node[away]=$!
check "before: hears the exercise" hears named 1000
ip link del exercise0
listeners=(watch named chosen own broadcast six)
for name in "${listeners[@]}" away; do check "$name: says that it is gone" heard_by $name 'until it is back'; done
before=$(recorded named)
make_interface
for name in "${listeners[@]}"; do check "$name: says that it is back" heard_by $name 'there again, listening'; done
send --send $group:3001
send --send 10.77.0.1:3002
send --send 10.77.0.255:3003
send --send "[ff15::d15]:3004" --interface exercise0
# the sender goes on by itself, so who listens hears more of its exercise
check "the sender says that it is back" heard_by away 'there again, sending'
check "named: hears more of the exercise" hears named $((before + 1000))
for name in chosen own broadcast six; do check "$name: hears the exercise" hears $name 1000; done
check "watch: makes frames" makes watch 3
once() { [ "$(grep -c "$2" "$tmp/$1.out")" = 1 ]; }
for name in "${listeners[@]}" away; do
    check "$name: gone is said once" once $name 'until it is back'
    check "$name: back is said once" once $name 'there again'
done
for name in watch named chosen own broadcast six; do
    stop $name
    check "$name: ends well" [ $code = 0 ]
done
kill "${node[away]}"

# ---- those who made nothing say why ----------------------------------------------------------------------------------
check "hostless: knows others, and says what it lacks" heard_by hostless 'host 9:9:9 is not heard so far'
for name in other junk itself; do check "$name: hears something" hears $name $((silent + 210)); done # all three of the malformed
for name in other junk itself hostless; do kill -INT "${node[$name]}"; done
because() { # NAME TEXT: it made nothing, and said that
    ended "$1"
    check "$1: ends with 1 ($code)" [ $code = 1 ]
    check "$1: says '$2'" grep -q "^pitviper: error: run: .*$2" "$tmp/$1.out"
}
because other 'other exercises are heard.* 1 (.* PDUs); this node hears exercise 9: --set exercise.exercise=1 '
because junk 'no DIS is heard.*: 3 malformed datagrams.*--port'
because itself "come from 1:3001, this node's own.*--set node.application=3002"
because hostless 'host 9:9:9 is not heard so far.*--host ID'
because routeless 'nothing can be sent to 255.255.255.255 port 3014: Network is unreachable.*--interface'
check "no line of a terminal in a file" [ "$(grep -lc $'\r' "$tmp"/*.out | grep -vc observer.out)" = 0 ]

# ---- two nodes, one exercise -----------------------------------------------------------------------------------------
for name in seeker observer; do
    ended $name
    check "$name: ends well ($code)" [ $code = 0 ]
    check "$name: sends" [ "$(live_counter "$tmp/$name" sent)" -ge 1 ]
done
check "who is second is told how both hear" grep -q 'another program of this machine listens on port 3020' "$tmp/observer.out"

# ---- the line of a terminal ------------------------------------------------------------------------------------------
if command -v script >/dev/null; then
    health=$'\r.*[1-9][0-9]* entities  kept [0-9.]+ of [0-9.]+ frames/s  ([a-z]+  )?[0-9]+ late  [0-9]+ ms  [0-9]+ lost'
    check "a terminal: a line of health, rewritten" grep -qE "$health" "$tmp/observer.out"
    lines=$(grep -o ' frames/s ' "$tmp/observer.out" | wc -l)
    check "a terminal: at most once a second ($lines)" [ "$lines" -ge 1 -a "$lines" -le $((SECONDS + 1)) ]
fi
kill "${sent[@]}" 2>/dev/null
wait
[ "$failures" = 0 ] || tail -n 12 "$tmp"/*.out
finish
