# What the tests of `pitviper inspect` share; source it after common.sh.
# expect CODE PATTERN ARGS...: exit code of `pitviper inspect` and something said, on either stream
expect() {
    local want=$1 pattern=$2; shift 2
    run inspect "$@"
    check "inspect $*: exit code $code, want $want" [ $code = "$want" ]
    check "inspect $*: says '$pattern'" grep -q -e "$pattern" "$tmp/stdout" "$tmp/stderr"
}
