#!/usr/bin/env bash
# The figures of etc/reference/speed.md are those of the run in etc/figures, none by hand and none older than the code; README is short, and every
# link of the documentation leads to a file, every anchor to a heading.
. "$(dirname "$0")/common.sh"
needs git command -v git
page=etc/reference/speed.md
check "speed.md is as etc/make_figures writes it, of this code" etc/make_figures --check

mkdir -p "$tmp/house/etc/reference" "$tmp/house/tests"
cp -r etc/figures etc/make_figures "$tmp/house/etc/"
cp tests/cost.csv "$tmp/house/tests/"
cp tests/cost.csv "$tmp/house/etc/figures/"
cp $page "$tmp/house/$page"
make_figures() { "$tmp/house/etc/make_figures" "$@" >"$tmp/stdout" 2>"$tmp/stderr"; }
check "nor in a copy of them" make_figures --check
refused() { ! make_figures "${@:2}" && grep -q "$1" "$tmp/stderr"; }
sed -i 's/\(one ray per pixel.*| \)[0-9.]* |/\11.5 |/' "$tmp/house/$page"
check "a figure by hand is seen" refused 'not what etc/figures makes' --check
check "and written over" make_figures
check "with what was there" cmp -s $page "$tmp/house/$page"
# frame NAME FACTOR: what the frame costs, beside when the figures were measured
frame() { awk -F, -v OFS=, -v n="$1" -v f="$2" '$1 == n { $2 = sprintf("%.0f", $2 * f) } { print }' tests/cost.csv >"$tmp/house/tests/cost.csv"; }
frame smoke 1.08
check "a frame of 8 % more makes them no older" make_figures --check
for factor in 1.12 0.88; do
    frame smoke $factor
    check "a frame of $factor times its cost does" refused 'older than the code: .*: smoke [+-]12 %; next.*--run' --check
done
frame smoke 1
check "and not when it is as it was" make_figures --check
sed 's/^| pseudo-radar/{{if dis|Fire: decode}}\nWITH\n{{else}}\nWITHOUT\n{{end}}\n{{if dis|nothing}}\nNEVER {{dis|nothing|s}}\n{{end}}\n&/' \
    etc/figures/tables.md >"$tmp/house/etc/figures/tables.md"
check "text for a row that there is" make_figures
check "is alone written" [ "$(grep -cE 'WITH$|WITHOUT|NEVER' "$tmp/house/$page")" = 1 ]
cp etc/figures/tables.md "$tmp/house/etc/figures/"

# a run is kept with the commit and the costs that it is of
in_house() { git -C "$tmp/house" -c user.name=a -c user.email=a@example.org -c commit.gpgsign=false "$@" >/dev/null 2>&1; }
in_house init
in_house add .
in_house commit -m all
echo "<svg/>" >"$tmp/rays-a-pixel.svg"
cp etc/figures/bench_all.csv "$tmp/full.csv"
echo more >>"$tmp/house/$page"
check "of a checkout that differs from its commit: refused" refused 'commit first' "$tmp/full.csv" "$tmp"
in_house checkout .
frame smoke 1.5
in_house commit -am dearer
check "of a commit: kept" make_figures "$tmp/full.csv" "$tmp"
check "the page says which" grep -q "(commit $(git -C "$tmp/house" rev-parse --short=8 HEAD); " "$tmp/house/$page"
check "and the costs are those of now" cmp -s "$tmp/house/tests/cost.csv" "$tmp/house/etc/figures/cost.csv"
check "which are of this code" make_figures --check

# a suite alone: its rows, its frames' costs and a line that says so; the rest is as it was
in_house commit -am kept
awk -F, -v OFS=, '$1 == "woods-near" { $2 = sprintf("%.0f", 1.5 * $2) } { print }' "$tmp/house/etc/figures/cost.csv" >"$tmp/house/tests/cost.csv"
in_house commit -am dearer
{ grep '^#' "$tmp/full.csv"; grep '^bench,' "$tmp/full.csv"; grep '^woods,' "$tmp/full.csv" | sed '$d'; } >"$tmp/woods.csv"
check "before, the figures of woods are older" refused 'woods-near' --check
check "a suite alone: kept" make_figures --suite woods "$tmp/woods.csv"
check "the page says so" grep -q "; woods alone: commit $(git -C "$tmp/house" rev-parse --short=8 HEAD), " <(tr '\n' ' ' <"$tmp/house/$page")
others() { diff <(grep -v '^woods,\|^# woods: \|^# commit: ' "$tmp/full.csv") <(grep -v '^woods,\|^# woods: \|^# commit: ' "$tmp/house/etc/figures/bench_all.csv"); }
check "all other rows are kept" others
check "its own are the new ones" [ "$(grep -c '^woods,' "$tmp/house/etc/figures/bench_all.csv")" = "$(grep -c '^woods,' "$tmp/woods.csv")" ]
check "with their costs they are of this code" make_figures --check
in_house commit -am kept
check "a suite that the run has not: refused" refused 'no row of the suite dis' --suite dis "$tmp/woods.csv"
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
