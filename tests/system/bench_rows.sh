# What the tests of bench check of every run; source it after common.sh.
# ends_whole CSV LEAST: the run in $code and $tmp/stdout ended well, and its file is whole, of so many lines at least
ends_whole() {
    local key
    check "it ends well" [ $code = 0 ]
    [ $code = 0 ] || { grep -F '**' "$tmp/stdout"; cat "$tmp/stderr"; }
    check "it names the machine first" grep -q "pitviper [0-9]" <(head -n 1 "$tmp/stdout")
    check "the file too" grep -q "^# .*pitviper [0-9]" <(head -n 1 "$1")
    for key in version machine rounds threads libraries; do
        check "the file says its $key" grep -q "^# $key: [^ ]" "$1"
    done
    check "every error keeps its limit" not grep -q ',no,' "$1"
    # the rows without comments and quoted texts
    sed -e '/^#/d' -e 's/"[^"]*"//g' "$1" >"$tmp/bare.csv"
    check "every row has as many columns as the header" \
        awk -F, -v least="$2" 'NR == 1 { n = NF } NF != n { print; exit 1 } END { exit NR < least }' "$tmp/bare.csv"
    # what a version or a machine does not have is named, and has none
    check "every row has a figure: a time, a rate, a ratio or an error" \
        awk -F, 'NR > 1 && !($3 > 0 || $6 > 0 || $8 > 0 || $10 != "") { print; exit 1 }' \
        <(grep -vE ': (none in this version|no grid here)' "$1" | sed -e '/^#/d' -e 's/"[^"]*"//g')
}
