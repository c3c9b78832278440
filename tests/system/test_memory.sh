#!/usr/bin/env bash
# Frames in shared memory, and readers with no build step beyond cc: each takes exactly the planes of the files while
# the node runs; one is killed, one is stopped and continued, and the run's frames stay the same. A name in use is
# refused, a ring that a killed node left is replaced, no room is an error at the start; at the end nothing is left.
. "$(dirname "$0")/common.sh"

judges python3.numpy
needs "writable /dev/shm" test -w /dev/shm
name=pitviper-test-$$
ring=/dev/shm/$name
trap 'clean_up; rm -f "$ring"* "/dev/shm/.pitviper-$name"*' EXIT
check "the example is built by cc alone" cc -std=c99 -O1 -Wall -Wextra -Werror -I etc/include etc/examples/read_memory.c -o "$tmp/read_memory"
check "and the recogniser" cc -std=c99 -O1 -Wall -Wextra -Werror -I etc/include etc/examples/recognise_hottest.c -lm -o "$tmp/recognise_hottest"
printf '#include <pitviper_memory.h>\nint main() { PitviperMemory m; return pitviper_memory_open(&m, "") == 0; }\n' >"$tmp/a.cpp"
check "the header is C++ too" c++ -std=c++11 -Wall -Wextra -Werror -fsyntax-only -I etc/include "$tmp/a.cpp"

# reader NAME COMMAND...: in the background, what it says in $tmp/NAME.said, its process in ${reader[NAME]}
declare -A reader
reader() {
    local who=$1; shift
    "$@" >"$tmp/$who.said" 2>&1 &
    reader[$who]=$!
}
lines() { grep -cE '^(frame|[0-9]+ [0-9.]+ )' "$tmp/$1.said"; } # of the examples, and of the manual's
reads() { [ "$(lines "$1")" -ge "$2" ]; }
has_read() { until_true reads "$@"; } # NAME COUNT: until it has read so many frames
# waits_again NAME: it has read a frame, and done with it what it does: of a node that is stopped there is no other
waits_again() { reads "$1" 1 && [ "$(cut -d' ' -f3 "/proc/${reader[$1]}/stat")" = S ]; }
# waits_nudged NAME: the same; a node that was stopped between a frame and waking who waits for it goes on for a moment
waits_nudged() {
    waits_again "$1" && return
    sleep 2
    waits_again "$1" && return
    kill -CONT "$node"
    sleep 0.02
    kill -STOP "$node"
    return 1
}
ended_well() { wait "${reader[$1]}" || { tail -n 3 "$tmp/$1.said"; return 1; }; }
# node NAME options: a paced replay in the background; its process in $node
node() {
    local out=$1; shift
    "$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/$out" --size 32x24 --threads 2 --bands lwir --memory "$name" \
        --set publish.memory_slots=32 "$@" >"$tmp/$out.said" 2>&1 &
    node=$!
}

exercise demo "$tmp/demo.pcap"
few=(--rate 2 --from +12 --to +18)
run replay "$tmp/demo.pcap" --out "$tmp/plain" --size 32x24 --threads 2 --bands lwir --no-files "${few[@]}"
frames=$(wc -l <"$tmp/plain/truth.jsonl")
[ "$code" = 0 ] && [ "$frames" -ge 10 ] || { fail "a run to compare with"; cat "$tmp/stderr"; finish; }

# ---- four readers of one run: C, Python, one that is killed, one that is stopped for a while -------------------------
port=$((20000 + $$ % 20000))
mkdir "$tmp/raw_c" "$tmp/raw_python"
reader c "$tmp/read_memory" "$name" --wait $patience --in-order --raw "$tmp/raw_c" --detect
reader python python3 -u etc/examples/read_memory.py "$name" --wait $patience --in-order --raw "$tmp/raw_python"
# one that computes for minutes is killed meanwhile
reader killed "$tmp/read_memory" "$name" --wait $patience --slow 600000
reader stopped "$tmp/read_memory" "$name" --wait $patience --slow 300
node taken --speed 2 --set publish.memory_record=truth --set publish.detections_port="$port" "${few[@]}"
has_read stopped 1 && has_read killed 1
kill -STOP "$node" # until the others have done their part
kill -STOP "${reader[stopped]}"
kill -KILL "${reader[killed]}"
wait "${reader[killed]}" 2>/dev/null
check "the killed one is dead" [ $? = 137 ]
for who in c python; do check "the reader $who reads" until_true waits_nudged "$who"; done
kill -CONT "$node"
has_read c 6
kill -CONT "${reader[stopped]}"
wait "$node"
check "the node ends well" [ $? = 0 ]
check "its frames are those of a run without readers" same_hashes "$tmp/plain" "$tmp/taken"
truth() { sed 's/,"latency_ms":.*/}/' "$1/truth.jsonl"; } # of a paced replay: times of the wall clock, at the end
check "its truth is, too" cmp -s <(truth "$tmp/plain") <(truth "$tmp/taken")
for who in c stopped python; do check "the reader $who ends with the node" ended_well "$who"; done
for who in c python; do
    check "the reader $who has every frame" grep -q "^$frames frames read, 0 missed, 0 copies torn" "$tmp/$who.said"
    check "the planes of the reader $who are those of the files" eval '"$build/tests/memory_planes" "$tmp/taken" "$tmp/raw_$who" | grep -q "^$frames planes"'
done
check "the stopped one has missed some, and counts them" eval \
    'sed -n "s/ frames read, / /; s/ missed.*//p" "$tmp/stopped.said" | { read -r got missed; [ "$missed" -ge 2 ] && [ $((got + missed)) -le "$frames" ]; }'
boxes() { grep -oE '"box_px":\[[0-9,]*\]' "$1" | tr -d '"a-z_:[]' | tr ',' ' '; }
check "targets have the boxes of the truth" eval \
    '[ "$(boxes "$tmp/taken/truth.jsonl")" = "$(grep "^frame" "$tmp/c.said" | grep -oE "box [0-9 ]*[0-9]" | cut -c5- | grep -v "^0 0 0 0")" ]'
check "both readers say the same of targets" cmp -s <(grep -oE '  [a-z_]+ [0-9:]+ box .*' "$tmp/c.said") \
    <(grep -oE '  [a-z_]+ [0-9:]+ box .*' "$tmp/python.said")
check "the reader's detections are taken" eval \
    'taken=$(sed -nE "s/^answers: ([0-9]+) datagrams taken$/\1/p" "$tmp/taken.said"); [ "${taken:-0}" -ge 1 ] && [ "$taken" -le "$frames" ]'
taken=$(sed -nE "s/^answers: ([0-9]+) datagrams taken$/\1/p" "$tmp/taken.said")
check "and each is a line of answers.jsonl, with its frame, class and latency" eval \
    '[ "$(grep -cE "^\{\"frame\":[0-9]+,\"band\":\"lwir\",.*\"class\":\"bright\",.*\"latency_ms\":[0-9.]+,\"age_ms\":[0-9.]+,\"late\":false,\"form\":\"ring\"\}$" "$tmp/taken/answers.jsonl")" = "$taken" ]'
check "run.json says that a recogniser was attached" eval 'grep -q "\"memory\": \"$name\"" "$tmp/taken/run.json" &&
    grep -q "\"detections_port\": $port" "$tmp/taken/run.json" && grep -q "\"lines\": $taken" "$tmp/taken/run.json"'
check "and nothing where there was none" not grep -qE '"(memory|detections_port|answers)"' "$tmp/plain/run.json"
check "nothing is left in /dev/shm" [ -z "$(find /dev/shm -name "*$name*")" ]

# ---- a node that is killed; the next one replaces its ring, with raw counts ---------------------------------------------
rm "$tmp"/*.said
reader widow "$tmp/read_memory" "$name" --wait $patience
node dead --speed 0.01 --no-files "${few[@]}"
has_read widow 1
run replay "$tmp/demo.pcap" --out "$tmp/clash" --size 32x24 --bands lwir --memory "$name"
check "a name in use is refused, with the next step" eval '[ $code != 0 ] && complained "in use by a living node, process $node; choose another name"'
check "for its user alone" [ "$(stat -c %a "$ring")" = 600 ]
kill -KILL "$node"
wait "$node" 2>/dev/null >&2
check "a reader notices that the node died" ended_well widow
check "its ring is still there" [ -e "$ring" ]
rm -r "$tmp/raw_c" && mkdir "$tmp/raw_c"
reader c "$tmp/read_memory" "$name" --wait $patience --in-order --raw "$tmp/raw_c"
sample=$(sed -n '/^```python/,/^```/{/^```/d;p}' etc/reference/memory.md) # as a reader of the manual has it
reader python python3 -u -c "${sample//seeker/$name}"
reader hottest "$tmp/recognise_hottest" "$name" mwir
node counts --bands lwir,mwir --set publish.memory_planes=counts --set sensor.preset=staring_lwir,staring_mwir --set detector.raw=true --speed 1 --rate 1 --from +14 --to +16 --set publish.detections_port="$port"
has_read c 1 # the node does not end before Python has some
kill -STOP "$node"
check "Python has its first frame" until_true waits_nudged python
check "the recogniser in C has, too" until_true waits_nudged hottest
kill -CONT "$node"
wait "$node"
check "a node with raw counts ends well" [ $? = 0 ]
check "the dead node's ring was replaced, and it says so" grep -q "memory: replaced '$name', left behind by process" "$tmp/counts.said"
for who in c python hottest; do check "its reader $who ends with it" ended_well "$who"; done
check "detections of both bands are taken" grep -qE "^answers: [2-6] datagrams taken$" "$tmp/counts.said"
check "with the answers of Python" eval '[ "$(grep -cE "\"band\":\"lwir\",.*\"class\":\"hot\"" "$tmp/counts/answers.jsonl")" -ge 1 ]'
# the recogniser in C by the ring is the one in Python by the files
answered() { sed -nE 's/^\{"frame": ?([0-9]+), ?"band": ?"mwir",.*"box_px": ?\[([^]]*)\], ?"score": ?([0-9.]+).*/\1 \2 \3/p' "$1" | tr -d , | boxes_of; }
boxes_of() { awk '{ printf "%d %d %d %d %d %.4f\n", $1, $2, $3, $4, $5, $6 }'; }
cp "$tmp/counts/answers.jsonl" "$tmp/live.jsonl"
check "the recogniser in Python reads the run's files" eval \
    'python3 etc/examples/recognise_hottest.py "$tmp/counts" --bands mwir --answers "$tmp/offline.jsonl" >/dev/null'
check "which says of a frame what the one in C answered" eval \
    '[ "$(answered "$tmp/live.jsonl" | wc -l)" -ge 1 ] && [ -z "$(comm -23 <(boxes_of <"$tmp/hottest.said" | sort) <(answered "$tmp/offline.jsonl" | sort))" ]'
check "raw counts are those of the files" eval '"$build/tests/memory_planes" "$tmp/counts" "$tmp/raw_c" >/dev/null'
check "nothing is left in /dev/shm" [ -z "$(find /dev/shm -name "*$name*")" ]

# ---- several hosts; no room ------------------------------------------------------------------------------------------------
run replay "$tmp/demo.pcap" --out "$tmp/two" --size 32x24 --threads 2 --bands lwir --memory "$name" --no-files --rate 1 \
    --from +15 --to +15.5 --host 1:3001:41 --host observer
check "each host has a ring of its own" eval '[ $code = 0 ] && said "/dev/shm/$name-1-3001-41:" && said "/dev/shm/$name-observer:"'
(trap '' XFSZ; ulimit -f 4096; "$pitviper" replay "${bare[@]}" "$tmp/demo.pcap" --out "$tmp/full" --size 640x480 --memory "$name" --bands lwir \
    >"$tmp/stdout" 2>"$tmp/stderr")
code=$?
check "no room is an error at the start, with the next step" eval '[ $code != 0 ] && complained "no room for .* MB in /dev/shm.*publish.memory_slots"'
check "and leaves nothing" [ -z "$(find /dev/shm -name "*$name*")" ]
finish
