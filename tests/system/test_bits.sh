#!/usr/bin/env bash
# etc/bits: a line of the same bits, another line when a table differs by one number; an unknown part is refused.
. "$(dirname "$0")/common.sh"
judges python3

etc/bits -v "$build" probes >"$tmp/bits" 2>"$tmp/stderr"
check "it ends well" [ $? = 0 ] || cat "$tmp/stderr"
check "a line a product, and one in all" grep -qE '^[0-9a-f]{64}  20 products: probes$' <(tail -n 1 "$tmp/bits")
check "each product differs" [ "$(cut -c 1-64 "$tmp/bits" | sort -u | wc -l)" = 21 ]
cp -r etc "$tmp/etc"
awk -F, -v OFS=, '/^surface,/ { for (i = 1; i <= NF; i++) if ($i == "nu") c = i } /^grass,/ { $c += 1 } { print }' \
    etc/radar/clutter.csv >"$tmp/etc/radar/clutter.csv"
check "a table is another" not cmp -s etc/radar/clutter.csv "$tmp/etc/radar/clutter.csv"
PITVIPER_ETC=$tmp/etc etc/bits -v "$build" probes >"$tmp/other" 2>"$tmp/stderr"
check "another table: another line" [ "$(tail -n 1 "$tmp/bits")" != "$(tail -n 1 "$tmp/other")" ]
check "and the product is named" [ "$(diff "$tmp/bits" "$tmp/other" | grep -oE '^> .* (probes/[a-z-]*)' | cut -d/ -f2 | sort -u | head -n 1)" = clutter ]
etc/bits "$build" nonsense >"$tmp/stdout" 2>"$tmp/stderr"
check "an unknown part: refused" [ $? = 1 ] && check "and named" complained "no part 'nonsense'; there are: cases"
finish
