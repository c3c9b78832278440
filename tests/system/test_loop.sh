#!/usr/bin/env bash
# The frame loop with more threads than cores, all bands, files and all. Under the thread sanitizer any race ends it
# with 66. labels: small threads
. "$(dirname "$0")/common.sh"

exercise demo "$tmp/demo.pcap"
replay "$tmp/demo.pcap" "$tmp/loop" --threads 4 --rate 1 --size 48x32 "${coarse[@]}"
check "the loop ends well" [ "$code" = 0 ]
check "no race" [ "$(grep -c ThreadSanitizer "$tmp/stderr")" = 0 ]
check "all frames" [ "$(frames "$tmp/loop")" -ge 8 ]
replay "$tmp/demo.pcap" "$tmp/two" --threads 3 --rate 0.5 --size 48x32 "${coarse[@]}" --host 1:3001:41 --host 1:3001:31
check "two hosts: ends well" [ "$code" = 0 ]
check "two hosts: no race" [ "$(grep -c ThreadSanitizer "$tmp/stderr")" = 0 ]
for host in 1-3001-41 1-3001-31; do
    check "two hosts: $host has its folder" [ "$(frames "$tmp/two/$host")" -ge 4 ]
done
[ "$failures" = 0 ] || tail -n 40 "$tmp/stderr"
finish
