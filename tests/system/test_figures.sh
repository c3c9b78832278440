#!/usr/bin/env bash
# The figures of etc/reference/speed.md are those of the run in etc/figures, and none by hand; README is short, and every
# link of the documentation leads to a file, every anchor to a heading.
. "$(dirname "$0")/common.sh"
page=etc/reference/speed.md
check "speed.md is as etc/make_figures writes it" etc/make_figures --check

mkdir -p "$tmp/house/etc/reference"
cp -r etc/figures etc/make_figures "$tmp/house/etc/"
cp $page "$tmp/house/$page"
make_figures() { "$tmp/house/etc/make_figures" "$@" >"$tmp/stdout" 2>"$tmp/stderr"; }
check "nor in a copy of them" make_figures --check
refused() { ! make_figures "${@:2}" && grep -q "$1" "$tmp/stderr"; }
sed -i 's/\(one ray per pixel.*| \)[0-9.]* |/\11.5 |/' "$tmp/house/$page"
check "a figure by hand is seen" refused 'not what etc/figures makes' --check
check "and written over" make_figures
check "with what was there" cmp -s $page "$tmp/house/$page"
sed -i '/^dis,Entity State: decode/d' "$tmp/house/etc/figures/bench_all.csv"
check "a row that is gone" refused 'no such row: dis|Entity State: decode' --check
cp etc/figures/bench_all.csv "$tmp/quick.csv"
sed -i 's/^# rounds: .*/# rounds: quick/' "$tmp/quick.csv"
check "quick rounds are no figures" refused 'quick rounds' "$tmp/quick.csv" "$tmp"
check "plots are asked for" refused 'CSV PLOTS' "$tmp/quick.csv"

# links NAME: a line for each link of a page that leads nowhere
links() {
    local target file
    grep -oE '\]\([^)]+\)' "$1" | sed 's/^](//; s/)$//' | while read -r target; do
        case $target in http*) continue ;; esac
        file=${target%%#*}
        if [ -n "$file" ]; then file=$(dirname "$1")/$file; else file=$1; fi
        if [ ! -e "$file" ]; then echo "$1: no $target"; continue; fi
        case $target in *'#'*) ;; *) continue ;; esac
        # a heading's anchor: lower case, blanks to hyphens, punctuation away
        sed -nE 's/^#+ +//p' "$file" | tr 'A-Z ' 'a-z-' | tr -cd 'a-z0-9_\n-' | grep -qx -e "${target#*#}" || echo "$1: no $target"
    done
}
for text in README.md etc/*.md etc/*/*.md; do links "$text"; done >"$tmp/dead"
check "every link leads somewhere" [ ! -s "$tmp/dead" ] || cat "$tmp/dead"
for each in etc/reference/*.md; do check "README links to $each" grep -qF "($each)" README.md; done
printf '# A\n[a](#a) [b](b.md) [c](#c) [d](http://d)\n' >"$tmp/page.md"
links "$tmp/page.md" >"$tmp/dead"
check "dead links are seen" [ "$(wc -l <"$tmp/dead")" = 2 ]
check "README is short" [ "$(wc -l <README.md)" -le 130 ]
finish
