#!/usr/bin/env bash
# A stream that nothing receives, and an encoder that fails at the sixth frame: every frame that is due is made; what is lost is
# counted and said once. labels: small
. "$(dirname "$0")/common.sh"
. "$(dirname "$0")/live.sh"
. "$(dirname "$0")/publish_failures.sh"
needs "encoder that can be made to fail in this build" can_fail_encoder

exercise demo "$tmp/demo.pcap"
free_port
stream=udp://127.0.0.1:$port
LD_PRELOAD=$build/tests/libfail_encoder.so FAIL_ENCODER=5,1 watched encoder --stream "$stream"
check "the replay ends well" [ "$code" = 0 ] || cat "$tmp/encoder.out"
check "every frame is made" [ "$(frames_of encoder)" = 11 ]
check "the stream is named" grep -q "^video: $stream" "$tmp/encoder.out"
check "nothing receives: said once" [ "$(said_times encoder 'no program receives it')" = 1 ]
check "and counted" grep -qE "datagrams: sent=[0-9]+ refused=[1-9]" "$tmp/encoder.out"
check "an encoder that fails: said once" \
    [ "$(said_times encoder 'the encoder .* failed')" = 1 -a "$(said_times encoder 'going on without')" = 1 ]
check "and counted" grep -qE ' 6 frames lack the video of lwir' "$tmp/encoder.out"
check "and it gets every frame" [ "$(consumer encoder video count)" = 11 -a "$(consumer encoder video left_out)" = 0 ]
finish
