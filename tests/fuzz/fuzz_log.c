/* tests/fuzz/fuzz_log.c: any octets as a capture file. Without a fuzzer run_corpus.c drives it; its seeds are plain,
 * and corpus/fuzz_log has compressed ones: a spoilt sum would end most runs before the first packet. */
#include "tests/fuzz/fuzz_seed.h"
#include "tests/dis/make_capture.h"

#include "dis/capture/log.h"

#include <stdlib.h>

const int fuzz_rounds = 5000;

/* A capture of three packets: a whole datagram and one in two fragments; pcap or pcapng, IPv4 or IPv6. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static Bytes         file, packet;
    static const uint8_t pdu[192] = {7, 1, 20, 5, 0, 0, 0, 0, 0, 192};
    const bool           ng = index & 1, v6 = index & 2, ethernet = index & 4;
    const uint32_t       link = ethernet ? 1 : 101;
    if (ng) pcapng_begin(&file, (uint16_t)link);
    else pcap_begin(&file, link, index & 8, index & 16);
    for (int i = 0; i < 3; i++) {
        const int    first = i == 2 ? 104 : 0, last = i == 1 ? 104 : 200; /* octets of the IP payload */
        static Bytes udp;
        udp.count = packet.count = 0;
        put_udp(&udp, 3000, pdu, sizeof pdu);
        if (ethernet) put_ethernet(&packet, v6 ? 0x86DD : 0x0800);
        if (v6) {
            put_ipv6(&packet, 44, (size_t)(8 + last - first));
            put_be16(&packet, 17 << 8);
            put_be16(&packet, (unsigned)first | (i == 1));
            put_be32(&packet, (uint32_t)i + 1 - (i == 2));
        } else {
            put_ipv4(&packet, 17, (size_t)(last - first), (unsigned)i - (i == 2),
                     (unsigned)first / 8 | (i == 1 ? 0x2000u : 0), 0);
        }
        put(&packet, udp.at + first, (size_t)(last - first));
        if (ng) pcapng_packet(&file, 1000, &packet);
        else pcap_packet(&file, 1000, 0, &packet, packet.count, index & 16);
    }
    memcpy(out, file.at, file.count);
    return file.count;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    log_set_level((LogLevel)(LOG_ERROR + 1));
    char      path[fuzz_path_size];
    const int file = fuzz_file(path, data, size);
    if (file < 0) return 0;
    DisLog log;
    if (dis_log_open(&log, path, (uint16_t)(size % 2 ? dis_port : 0)) == STATUS_OK) {
        size_t   kept = 0;
        unsigned sum = 0;
        for (int i = 0; i < log.count; i++) {
            kept += log.datagram[i].octets;
            for (uint32_t k = 0; k < log.datagram[i].octets; k++) sum += log.datagram[i].bytes[k];
        }
        const uint8_t first = size ? data[0] : 0; /* of gzip, zstd and its frames to be skipped, bzip2, xz */
        const bool    plain = first != 0x1F && first != 0x28 && first >> 4 != 5 && first != 'B' && first != 0xFD;
        const size_t  most = plain ? size : dis_stream_free_octets + dis_stream_ratio_most * size;
        if (kept > most || sum > 255 * kept) abort();
        dis_log_close(&log);
    }
    close(file);
    return 0;
}
