#!/usr/bin/env bash
# `pitviper inspect` as a user types it: usage and failures. On recordings: test_inspect_logs.sh. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/inspect.sh"

: >"$tmp/empty.pcap"
echo "# not a capture" >"$tmp/text.dislog"
expect 0 'usage: pitviper inspect' --help
expect 2 'usage: pitviper inspect'
expect 2 'no such option' --nonsense x.pcap
expect 2 '0 .. 65535' --port 65536 x.pcap
expect 2 '0 .. 255' x.pcap --exercise all
expect 2 'one LOG at a time' a.pcap b.pcap
expect 2 'tsv' x.pcap --pdus json
expect 2 'applies to --pdus tsv' x.pcap --full
expect 1 'cannot open' "$tmp/absent.pcap"
expect 1 'empty' "$tmp/empty.pcap"
expect 1 'not a capture' "$tmp/text.dislog"
finish
