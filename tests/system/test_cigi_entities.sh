#!/usr/bin/env bash
# Entities of a CIGI host's own, by a host in Python: a tank that stands, drives and is gone, and one that is mounted on it; who is
# there, where by pyproj, how fast, and where in the picture; tables of types that are wrong. labels: small
. "$(dirname "$0")/common.sh"
judges python3.numpy python3.pyproj
entities=$(dirname "$0")/../tools/cigi_entities.py

exercise demo "$tmp/demo.pcap"
quick=("${bare[@]}" --size 96x64 --bands lwir --threads 2 --no-files)
fly() { python3 "$entities" "$pitviper" "$tmp/demo.pcap" "$@" "${quick[@]}" >"$tmp/stdout" 2>"$tmp/stderr" || { cat "$tmp/stdout" "$tmp/stderr"; return 1; }; }
check "a host with entities of its own" fly "$tmp/one"
counted() { run_json "$tmp/$1" | grep -oE '"cigi":\{[^}]*\}' | grep -q "$2"; }
check "one whose type is in no row is counted" counted one '"unmapped":1'
check "and said" complained 'exercise.cigi_types'
{ cat etc/cigi_types.csv; echo '999, 1.1.222.7.1.0.0, neutral, of our own'; } >"$tmp/types.csv"
check "with a table of its own" not fly "$tmp/two" --set exercise.cigi_types="$tmp/types.csv"
check "that one is there, too" grep -q '"4711:1:21"' "$tmp/two/truth.jsonl"
check "and is not counted" counted two '"unmapped":0'
printf 'exercise:\n  cigi_types: types.csv\n' >"$tmp/node.yaml"
run check "$tmp/node.yaml"
check "a configuration with it is right" [ $code = 0 ]
wrong() { # wrong WHAT ROW TEXT
    { cat etc/cigi_types.csv; echo "$2"; } >"$tmp/types.csv"
    run replay "$tmp/demo.pcap" --out "$tmp/not" --cigi 127.0.0.1:9 --set exercise.cigi_types="$tmp/types.csv"
    check "$1 is refused" [ $code != 0 ]
    check "$1: it says why" complained "$3"
    run check "$tmp/node.yaml"
    check "$1: check says it, too" complained 'exercise.cigi_types'
}
wrong "a type that is none" '50, tank, neutral, x' 'type'
wrong "a number twice" '1, 1.1.222.7.1.0.0, neutral, x' 'number'
wrong "a force that is none" '50, 1.1.222.7.1.0.0, blue, x' 'force'
finish
