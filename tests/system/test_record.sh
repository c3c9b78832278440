#!/usr/bin/env bash
# `pitviper record` as a user types it: datagrams by loopback while it listens, then what it wrote is read by inspect
# and by tshark. labels: small threads
. "$(dirname "$0")/common.sh"
judges tshark capinfos
recorder= # process of the recording that runs

# ---- usage and what cannot be ------------------------------------------------------------------------------
run record --help
check "--help ends well" [ $code = 0 ]
check "--help shows its usage" grep -q 'usage: pitviper record' "$tmp/stdout"
while read -r want named arguments; do
    # shellcheck disable=SC2086
    run record $arguments
    check "record $arguments: exit code $code" [ $code = "$want" ]
    check "record $arguments: names $named" complained "$named"
    check "record $arguments: one line" [ "$(wc -l <"$tmp/stderr")" -le 2 ]
done <<BAD
2 frob -o $tmp/x --frob
2 follows $tmp/x
2 65536 -o $tmp/x --port 65536
2 port -o $tmp/x --port 0
2 nan -o $tmp/x --for nan
2 -3 -o $tmp/x --for -3
2 1.5 -o $tmp/x --count 1.5
1 nosuch0 -o $tmp/x --interface nosuch0
1 localhost -o $tmp/x --address localhost
1 $tmp/absent/x.pcapng -o $tmp/absent/x.pcapng --port 39999 --address 127.0.0.1
BAD
check "nothing was made" [ ! -e "$tmp/x" ]
run record
check "no place: usage" complained 'usage: pitviper record'
check "no place: exit code" [ $code = 2 ]

# ---- recordings --------------------------------------------------------------------------------------------
# begin LOG OPTIONS: a recording on a port nobody has, $port, in the background; true once it listens
begin() {
    local log=$1 try
    shift
    for try in 1 2 3 4 5 6 7 8; do
        port=$((20000 + RANDOM % 12000))
        : >"$tmp/stderr" # what the one before said is not this one's
        # one that nobody ends, ends by itself
        "$pitviper" record -o "$log" --address 127.0.0.1 --port $port --for 900 "$@" >"$tmp/stdout" 2>"$tmp/stderr" &
        recorder=$!
        while kill -0 $recorder 2>/dev/null; do
            grep -q 'record: listening' "$tmp/stderr" && return 0
            sleep 0.02
        done
        grep -q 'in use' "$tmp/stderr" || break
    done
    fail "record did not listen: $(cat "$tmp/stderr")"
    return 1
}
# ending: waits for the recording, $code
ending() {
    wait $recorder 2>/dev/null
    code=$?
    recorder=
}
octets() { printf '%b' "$1" >"/dev/udp/127.0.0.1/$port"; } # in \xNN: one datagram
# zeros N, as octets takes them
zeros() { local i; for ((i = 0; i < $1; i++)); do printf '\\x00'; done; }
# entity N: an Entity State of 1:2:N, 144 octets, at a place on the equator
entity() {
    printf '\\x07\\x01\\x01\\x01\\x00\\x00\\x00\\x01\\x00\\x90\\x00\\x00\\x00\\x01\\x00\\x02\\x00\\x%02x' "$1"
    zeros 30
    printf '\\x41\\x58\\x54\\xa6\\x40\\x00\\x00\\x00' # 6378137 m
    zeros 88
}

if begin "$tmp/log.pcapng"; then
    log_port=$port
    for i in 1 2 3 4 5; do octets "$(entity $i)"; done
    octets 'not DIS at all'
    octets '\x07\x01\x01\x01\x00\x00\x00\x01\xff\xff\x00\x00'
    kill -INT $recorder
    ending
    check "Ctrl-C ends it well ($code)" [ $code = 0 ]
    check "it says what it recorded" complained '7 datagrams, 746 octets in .* lost 0'
    run inspect "$tmp/log.pcapng" --port $port
    check "inspect reads it" [ $code = 0 ]
    check "all entities are there" grep -qE '^ *5 +1 Entity State' "$tmp/stdout"
    check "what is malformed is there" grep -qE '7 datagrams' "$tmp/stdout"
    run inspect "$tmp/log.pcapng"
    check "inspect finds the port by itself" grep -qE '^ *5 +1 Entity State' "$tmp/stdout"
fi

# what a killed program had recorded a second before is whole
if begin "$tmp/killed.pcapng"; then
    octets "$(entity 1)"
    is_there() { "$pitviper" inspect "$tmp/killed.pcapng" --port $port 2>/dev/null | grep -q 'Entity State'; }
    until_true is_there
    kill -9 $recorder
    ending
    check "a killed recording is whole" grep -qE '1 Entity State' <("$pitviper" inspect "$tmp/killed.pcapng" --port $port)
fi

# as many as asked for, and the classic format
if begin "$tmp/log.pcap" --count 3; then
    pcap_port=$port
    for i in 1 2 3 4; do octets "$(entity $i)"; done
    ending
    check "--count ends it well ($code)" [ $code = 0 ]
    check "--count: no more than asked for" complained '3 datagrams, 432 octets'
    check "the name chooses pcap" [ "$(od -An -tx1 -N4 "$tmp/log.pcap" | tr -d ' ')" = 4d3cb2a1 ]
    run inspect "$tmp/log.pcap"
    check "inspect reads pcap" grep -qE '^ *3 +1 Entity State' "$tmp/stdout"
fi

# nothing at all, and SIGTERM
if begin "$tmp/none.pcapng" --for 0.2; then
    ending
    check "--for ends it well ($code)" [ $code = 0 ]
fi
if begin "$tmp/none.pcapng" --overwrite; then
    kill -TERM $recorder
    ending
    check "SIGTERM ends it well ($code)" [ $code = 0 ]
    run inspect "$tmp/none.pcapng"
    check "a recording of nothing is one" [ $code = 0 ]
fi

# a port that is taken, and a full disk: one line, and an older recording stays
if begin "$tmp/log2.pcapng"; then
    cp "$tmp/log.pcapng" "$tmp/older.pcapng"
    run record -o "$tmp/older.pcapng" --overwrite --address 127.0.0.1 --port $port
    check "a taken port: exit code" [ $code = 1 ]
    check "a taken port is named" complained "127.0.0.1 port $port.*another port"
    check "a taken port costs no older recording" cmp "$tmp/log.pcapng" "$tmp/older.pcapng"
    kill -INT $recorder
    ending
fi
if [ -w /dev/full ]; then
    run record -o /dev/full --address 127.0.0.1 --port $((20000 + RANDOM % 12000))
    check "a full disk: exit code" [ $code = 1 ]
    check "a full disk is named" complained '/dev/full'
    check "a full disk is one line" [ "$(wc -l <"$tmp/stderr")" = 1 ]
fi

# ---- tshark as the judge of the file -------------------------------------------------------------------------
if [ -s "$tmp/log.pcapng" ]; then
    # judge LOG PORT COUNT: every packet with good checksums (1), to where we listened; COUNT Entity States
    judge() {
        tshark -r "$tmp/$1" -o ip.check_checksum:TRUE -o udp.check_checksum:TRUE -d "udp.port==$2,dis" -T fields \
            -e ip.checksum.status -e udp.checksum.status -e ip.dst -e udp.dstport -e dis.pdu_type >"$tmp/tshark" 2>/dev/null
        check "$1: tshark finds checksums and addresses right" \
            [ "$(grep -cP "^1\t1\t127\.0\.0\.1\t$2\t" "$tmp/tshark")" = "$(grep -c . "$tmp/tshark")" ]
        check "$1: tshark finds the Entity States" [ "$(grep -cP '\t1$' "$tmp/tshark")" = "$3" ]
    }
    judge log.pcapng $log_port 6 # with the one that says it is longer
    judge log.pcap $pcap_port 3
    check "the comment says who made it" grep -q 'pitviper record: 127.0.0.1' <(capinfos "$tmp/log.pcapng" 2>/dev/null)
fi
finish
