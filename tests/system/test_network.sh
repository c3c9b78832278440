#!/usr/bin/env bash
# What loopback cannot carry: tests/dis/test_udp_loop.c again on an interface of its own, in a network of its own, where
# broadcast and IPv6 multicast come back. labels: threads
. "$(dirname "$0")/common.sh"
test=$build/tests/dis_tests
needs "$test" test -x "$test"
judges ip
# a pair of Ethernet ends; what is sent by one comes back to who listens on it
set_up='ip link set lo up && ip link add exercise0 type veth peer name exercise1 &&
    ip addr add 10.77.0.1/24 brd 10.77.0.255 dev exercise0 && ip addr add fd00:77::1/64 dev exercise0 nodad &&
    sysctl -qw net.ipv6.conf.exercise0.accept_dad=0 && ip link set exercise0 up && ip link set exercise1 up'
needs "network of one's own for this user" unshare -rn bash -c "$set_up"
said=$(PITVIPER_TEST_INTERFACE=exercise0 PITVIPER_TEST_BROADCAST=10.77.0.255 \
    timeout 120 unshare -rn bash -c "$set_up && exec '$test' test_udp_loop" 2>&1)
code=$?
echo "$said"
[ $code = 0 ] || exit 1
# this is where nothing about addresses may be skipped
! grep -qE '^skipped: .*(multicast|no way to|cannot)' <<<"$said" || { echo "FAILED: something was skipped"; exit 1; }
