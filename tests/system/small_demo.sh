# What the tests of keeping and overwriting share: a demonstration of a few quick frames; after common.sh.
bare=("${quick[@]}")

exercise demo "$tmp/demo.pcap"
small=(--size 16x16 --bands lwir --rate 1 --threads 1)
shown() { local out=$1; shift; run replay "$tmp/demo.pcap" --out "$out" "${small[@]}" "$@"; }
