#!/usr/bin/env bash
# README's figures are those of the run that is kept beside it, and none by hand.
. "$(dirname "$0")/common.sh"
check "README.md is as etc/make_figures writes it" etc/make_figures --check

mkdir -p "$tmp/house/etc"
cp -r etc/figures etc/make_figures "$tmp/house/etc/"
cp README.md "$tmp/house/"
make_figures() { "$tmp/house/etc/make_figures" "$@" >"$tmp/stdout" 2>"$tmp/stderr"; }
check "nor in a copy of them" make_figures --check
refused() { ! make_figures "${@:2}" && grep -q "$1" "$tmp/stderr"; }
sed -i 's/\(one ray a pixel.*| \)[0-9.]* |/\11.5 |/' "$tmp/house/README.md"
check "a figure by hand is seen" refused 'not what etc/figures makes' --check
check "and written over" make_figures
check "with what was there" cmp -s README.md "$tmp/house/README.md"
sed -i '/^dis,Entity State: decode/d' "$tmp/house/etc/figures/bench_all.csv"
check "a row that is gone" refused 'no such row: dis|Entity State: decode' --check
cp etc/figures/bench_all.csv "$tmp/quick.csv"
sed -i 's/^# rounds: .*/# rounds: quick/' "$tmp/quick.csv"
check "quick rounds are no figures" refused 'quick rounds' "$tmp/quick.csv" "$tmp"
check "plots are asked for" refused 'CSV PLOTS' "$tmp/quick.csv"
finish
