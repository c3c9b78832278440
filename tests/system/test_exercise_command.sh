#!/usr/bin/env bash
# `pitviper exercise`: recordings that others read, the same octets each time, what it sends is what it would have
# recorded, by the clock; Ctrl-C ends it with its summary; what is wrong is named.
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"

play() { run exercise "$@"; }
octets() { wc -c <"$1"; }

# ---- recordings
play demo -o "$tmp/demo.pcap"
check "demo: ends well" [ "$code" = 0 ]
check "demo: one line of summary" grep -qE '^30\.0 s, 7 entities, [0-9]+ PDUs, [0-9]+ datagrams, [0-9]+ octets$' "$tmp/stdout"
check "demo: less than a megabyte" [ "$(octets "$tmp/demo.pcap")" -lt 1000000 ]
play demo -o "$tmp/again.pcap"
check "the same octets again" cmp -s "$tmp/demo.pcap" "$tmp/again.pcap"
play demo -o "$tmp/other.pcap" --set seed=2
differ() { ! cmp -s "$@"; }
check "another seed, other octets" differ "$tmp/demo.pcap" "$tmp/other.pcap"
play etc/scenarios/demo.yaml -o "$tmp/file.pcapng"
check "by its file, pcapng" [ "$code" = 0 ]

mkdir "$tmp/in" "$tmp/in/demo"
(cd "$tmp/in" && "$(cd "$OLDPWD" && realpath "$pitviper")" exercise demo -o demo.pcap >/dev/null 2>&1)
check "a folder of its name does not hide a scenario" cmp -s "$tmp/demo.pcap" "$tmp/in/demo.pcap"

# ---- datagrams as files
play empty --datagrams "$tmp/none"
check "empty: no datagram" [ "$code" = 0 -a -z "$(ls "$tmp/none")" ]
play bad-pdus --datagrams "$tmp/pdu"
n=$(find "$tmp/pdu" -name '*.pdu' | wc -l)
check "a file a datagram" grep -q " $n datagrams" "$tmp/stdout"
check "malformed ones are counted" grep -q '180 malformed' "$tmp/stdout"

# ---- faults
play crowd -o "$tmp/lossy.pcap" --set scale=0.01 --set duration_s=30 --set dis.bundle=false --set faults.loss=0.25
lost=$(grep -oE '[0-9]+ lost' "$tmp/stdout" | cut -d' ' -f1)
left=$(grep -oE '[0-9]+ datagrams' "$tmp/stdout" | cut -d' ' -f1)
check "a quarter is lost ($lost of $((lost + left)))" is "$(awk -v a="$lost" -v b="$left" 'BEGIN { d = a / (a + b) - 0.25; print d < 0 ? -d : d }')" '<' 0.04

# ---- sent: by the clock, the same datagrams as recorded
free_port
"$pitviper" record -o "$tmp/heard.pcap" --address 127.0.0.1 --port $port --for 20 >/dev/null 2>"$tmp/record.err" &
recorder=$!
for _ in $(seq 100); do grep -q listening "$tmp/record.err" && break; sleep 0.05; done
begun=$(date +%s%N)
play demo --send 127.0.0.1:$port --set duration_s=2
spent=$((($(date +%s%N) - begun) / 1000000))
check "sent: ends well" [ "$code" = 0 ]
check "sent: two seconds take two ($spent ms)" [ "$spent" -ge 1990 ]
sleep 0.3
kill -INT $recorder
wait $recorder
play demo -o "$tmp/would.pcap" --set duration_s=2
run inspect "$tmp/would.pcap" --pdus tsv; cut -f2- "$tmp/stdout" >"$tmp/would.tsv"
run inspect "$tmp/heard.pcap" --pdus tsv; cut -f2- "$tmp/stdout" >"$tmp/heard.tsv"
check "sent: heard as it would be recorded" [ "$(wc -l <"$tmp/would.tsv")" -gt 7 -a "$(cat "$tmp/would.tsv")" = "$(cat "$tmp/heard.tsv")" ]
begun=$(date +%s%N)
play demo --send 127.0.0.1:$port --set duration_s=10 --speed 10
spent=$((($(date +%s%N) - begun) / 1000000))
check "sent at ten times the pace ($spent ms)" [ "$spent" -ge 990 -a "$spent" -lt 9900 ]

# told to stop once it is heard, however long this machine takes to begin
"$pitviper" record -o "$tmp/first.pcap" --address 127.0.0.1 --port $port --count 1 --for 60 >/dev/null 2>"$tmp/record.err" &
recorder=$!
for _ in $(seq 200); do grep -q listening "$tmp/record.err" && break; sleep 0.05; done
"$pitviper" exercise demo --send 127.0.0.1:$port >"$tmp/int.out" 2>"$tmp/int.err" &
sender=$!
wait $recorder
kill -INT $sender
wait $sender
check "Ctrl-C: ends well" [ $? = 0 ]
check "Ctrl-C: says what it sent" grep -qE '^[0-9.]+ s, [67] entities, [1-9][0-9]* PDUs' "$tmp/int.out"

# ---- what is wrong
wrong() { # CODE WORDS ARGUMENTS
    local want=$1 words=$2; shift 2
    play "$@"
    check "$*: exit code $want, not $code" [ "$code" = "$want" ]
    check "$*: says $words" complained "$words"
}
wrong 2 'usage: pitviper exercise' demo
wrong 2 'usage: pitviper exercise' -o "$tmp/x.pcap"
wrong 2 'KEY=VALUE' demo -o "$tmp/x.pcap" --set seed
wrong 2 'no such key: sed' demo -o "$tmp/x.pcap" --set sed=1
wrong 2 "dis.version: '9' is not .* 5 \.\. 7" demo -o "$tmp/x.pcap" --set dis.version=9
wrong 2 '1 \.\. 65535' demo --send 127.0.0.1:99999
wrong 2 'example 239' demo --send '[::1'
wrong 2 '0 \.\. 255' demo --send 127.0.0.1 --ttl 300
wrong 2 '0\.01 \.\. 1000' demo --send 127.0.0.1 --speed 0
for option in '--speed 2' '--ttl 1' '--interface lo'; do
    wrong 2 "${option% *} is of datagrams that are sent" demo -o "$tmp/x.pcap" $option
done
wrong 1 'exercise --help' nosuch -o "$tmp/x.pcap"
wrong 1 'nosuch\.yaml.*No such file' nosuch.yaml -o "$tmp/x.pcap"
wrong 1 'nowhere/x\.pcap' demo -o "$tmp/nowhere/x.pcap"
wrong 1 'nosuch0' demo --send 239.1.2.3 --interface nosuch0
printf 'vehicles:\n  - {name: A, route_m: [0, 0]}\nshots:\n  - {from: B 1, at_m: [9, 9], hit: ground}\n' >"$tmp/bad.yaml"
wrong 1 "bad\.yaml:4: shots: from: there is no 'B 1'" "$tmp/bad.yaml" -o "$tmp/x.pcap"
check "nothing was made" [ ! -e "$tmp/x.pcap" ]

play --help
check "--help" [ "$code" = 0 ]
for option in --out --send --datagrams --set --interface --ttl --speed --keys; do
    check "--help names $option" grep -q -- "$option" "$tmp/stdout"
done
for scenario in etc/scenarios/*.yaml; do
    name=${scenario##*/}
    check "--help names $name" grep -qE "^  ${name%.yaml} " "$tmp/stdout"
done
play --keys
check "--keys: as many as it reads" [ "$(grep -cE '^ *(# )?[a-z_]+: ?' "$tmp/stdout")" -gt 70 ]
finish
