#!/usr/bin/env bash
# Every source is laid out as .clang-format says, to the last blank, by the one version of clang-format in tests/judges.txt;
# `etc/format` lays them out.
. "$(dirname "$0")/common.sh"
judges clang-format

mapfile -t sources < <(git ls-files '*.c' '*.h' '*.cpp' 2>/dev/null || find . -path ./build -prune -o -name '*.[ch]' -print -o -name '*.cpp' -print)
check "there are sources" [ ${#sources[@]} -gt 500 ]
check "each is laid out as .clang-format says" sh -c 'clang-format --dry-run -Werror "$@" 2>"$0" || { grep error: "$0" | head -n 20; false; }' "$tmp/said" "${sources[@]}"

# its twin: a blank too many, a line too long
cp .clang-format "$tmp/"
sed '0,/;$/s/;$/ ;/' pitviper_log.c >"$tmp/blank.c"
{ cat pitviper_log.c; echo "/* $(printf 'long %.0s' {1..30})*/"; } >"$tmp/long.c"
for bad in blank long; do
    check "$bad is noticed" not quiet clang-format --dry-run -Werror "$tmp/$bad.c"
done
finish
