#!/usr/bin/env bash
# What is published and cannot arrive: a stream without a route, a ring of frames whose name another program has taken. Said, and
# counted in run.json; their twins arrive, and are not. labels: video
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
needs "video: built without FFmpeg's libraries" has_video
needs "network namespaces for users" unshare -rn true
needs "a writable /dev/shm" test -w /dev/shm

exercise demo "$tmp/demo.pcap"
look=("${quick[@]}" --bands lwir --no-files --size 96x64 --rate 5)
counter() { python3 -c 'import json, sys
of = json.load(open(sys.argv[1]))["counters"]
for key in sys.argv[2].split("."): of = of.get(key, {})
print(of or 0)' "$1/run.json" "$2"; }

# ---- a stream
free_port
replay "$tmp/demo.pcap" "$tmp/there" "${look[@]}" --only 3,4 --stream udp://127.0.0.1:$port
check "a stream to this machine: datagrams leave" [ "$(counter "$tmp/there" streams.sent)" -gt 0 ]
check "a stream to this machine: there is a route" [ "$(counter "$tmp/there" streams.no_route)" = 0 ]
check "a stream to this machine: no warning" not complained 'no route'
unshare -rn "$pitviper" replay "$tmp/demo.pcap" --out "$tmp/nowhere" "${look[@]}" --only 3,4 --stream udp://192.0.2.7:$port \
    >"$tmp/stdout" 2>"$tmp/stderr"
check "a stream without a route: frames go on" [ $? = 0 -a "$(wc -l <"$tmp/nowhere/truth.jsonl")" = 2 ]
check "a stream without a route: said" complained 'no route to it: .*sending goes on'
check "a stream without a route: said at the end, with what to do" complained 'never a route to it, so nothing was sent; check publish.stream'
check "a stream without a route: nothing sent" [ "$(counter "$tmp/nowhere" streams.sent)" = 0 ]
check "a stream without a route: counted" [ "$(counter "$tmp/nowhere" streams.no_route)" -gt 0 ]

# ---- a ring
ring=test-sent-$$
trap 'rm -f "/dev/shm/$ring"; clean_up' EXIT
takes_it() { # what becomes of the name while a replay goes on
    replay_of=$1; shift
    "$pitviper" replay "$tmp/demo.pcap" --out "$tmp/$replay_of" "${look[@]}" --from 1362 --to 1368 --speed 1 --memory "$ring" \
        >"$tmp/stdout" 2>"$tmp/$replay_of.err" &
    node[$replay_of]=$!
    makes "$replay_of" 3
    "$@"
    ended "$replay_of"
}
takes_it own true
check "a ring left alone: no frame is lost" [ $code = 0 -a "$(counter "$tmp/own" frames_in_a_lost_ring)" = 0 ]
check "a ring left alone: is removed at the end" [ ! -e "/dev/shm/$ring" ]
replaced() { printf mine >"/dev/shm/$ring.new" && mv "/dev/shm/$ring.new" "/dev/shm/$ring"; }
takes_it taken replaced
check "a ring whose name was taken: said once, with what to do" [ "$(grep -c 'was removed or replaced by another program.*start it anew' "$tmp/taken.err")" = 1 ]
check "a ring whose name was taken: counted" [ "$(counter "$tmp/taken" frames_in_a_lost_ring)" -gt 0 ]
check "a ring whose name was taken: the other's file stays" [ "$(cat "/dev/shm/$ring")" = mine ]
replay "$tmp/demo.pcap" "$tmp/refused" "${look[@]}" --only 3 --memory "$ring"
check "a name that is there: refused" [ $code = 1 ]
check "a name that is there: says by what" complained 'is not a ring of frames; choose another name'
rm "/dev/shm/$ring"; ln -s "$tmp/demo.pcap" "/dev/shm/$ring"
replay "$tmp/demo.pcap" "$tmp/refused" "${look[@]}" --only 3 --memory "$ring"
check "a link: refused, and said" eval '[ $code = 1 ] && complained "it is a symbolic link"'
finish
