/* dis/capture/recorder.c: blocks of a capture file, and the IP and UDP headers in front of each datagram.
 *
 * Sources: PCAP Next Generation (draft-ietf-opsawg-pcapng), the pcap file format of libpcap (pcap-savefile(5)),
 * link type RAW (101), RFC 791 (IPv4), RFC 8200 (IPv6), RFC 768 (UDP), RFC 1071 (checksum). */
#include "dis/capture/recorder.h"
#include "pitviper_output.h"
#include "dis/pdu/octets.h"

#include <errno.h>
#include <stdlib.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    link_raw_ip = 101,
    protocol_udp = 17,
    udp_octets = 8,
    ipv4_octets = 20,
    ipv6_octets = 40,
    hop_limit = 64,
    file_buffer_octets = 1 << 20,
    longest_text = 4096, /* most octets of an option's text */
    snap_length = 262144,
};

static const int64_t ns_per_s = 1000000000;

struct DisRecorder {
    FILE    *file;
    char    *path;
    char    *comment;
    bool     pcapng, failed;
    bool     older, begun;   /* older: another recording has the name still; begun: the file is this recording's */
    uint16_t identification; /* identification of the next IPv4 packet */
    uint8_t  to4[16], to6[16];
    uint16_t to_port;
};

static const uint8_t mapped[12] = {[10] = 0xFF, [11] = 0xFF};
static const uint8_t loopback4[16] = {[10] = 0xFF, [11] = 0xFF, [12] = 127, [15] = 1};
static const uint8_t loopback_broadcast[16] = {[10] = 0xFF, [11] = 0xFF, 127, 255, 255, 255};
static const uint8_t all_nodes[16] = {0xFF, 2, [15] = 1};

static bool is_ipv4(const uint8_t address[16]) { return memcmp(address, mapped, sizeof mapped) == 0; }

/* ---- the file: little-endian, which this machine is ------------------------------------------------- */

static Status fail(DisRecorder *r)
{
    if (!r->failed)
        log_error("recorder: cannot write %s: %s; the recording ends here: make room, or record elsewhere", r->path,
                  strerror(errno));
    r->failed = true;
    return STATUS_IO;
}

/* Once the disk is full every write fails: report it once. */
static void put(DisRecorder *r, const void *bytes, size_t octets)
{
    if (!r->failed && octets && fwrite(bytes, 1, octets, r->file) != octets) fail(r);
}

static size_t padding(size_t octets) { return -octets & 3; }

static void put_padding(DisRecorder *r, size_t octets)
{
    static const uint8_t zeros[4];
    put(r, zeros, padding(octets));
}

static void put_option(DisRecorder *r, uint16_t code, const void *value, uint16_t octets)
{
    put(r, (const uint16_t[2]){code, octets}, 4);
    put(r, value, octets);
    put_padding(r, octets);
}

static size_t option_octets(size_t octets) { return 4 + octets + padding(octets); }

static void put_section(DisRecorder *r, const char *comment)
{
    enum { section = 0x0A0D0D0A, byte_order = 0x1A2B3C4D, opt_comment = 1, shb_userappl = 4, end_of_options = 4 };
    static const char program[] = "Pitviper " PITVIPER_VERSION;
    const size_t      said = comment ? strnlen(comment, longest_text) : 0;
    const uint32_t    length =
        (uint32_t)(28 + (said ? option_octets(said) : 0) + option_octets(strlen(program)) + end_of_options);
    const uint32_t head[] = {section, length, byte_order, 1 /* version 1.0 */, UINT32_MAX, UINT32_MAX};
    put(r, head, sizeof head);
    if (said) put_option(r, opt_comment, comment, (uint16_t)said);
    put_option(r, shb_userappl, program, (uint16_t)strlen(program));
    put_option(r, 0, NULL, 0);
    put(r, &length, 4);
}

static void put_interface(DisRecorder *r)
{
    enum { interface = 1, if_tsresol = 9 };
    static const uint8_t  nanoseconds = 9;
    static const uint32_t length = 32;
    put(r, (const uint32_t[]){interface, length, link_raw_ip, snap_length}, 16);
    put_option(r, if_tsresol, &nanoseconds, 1);
    put_option(r, 0, NULL, 0);
    put(r, &length, 4);
}

static void put_pcap_header(DisRecorder *r)
{
    enum { version_2_4 = 4 << 16 | 2 };
    put(r, (const uint32_t[]){0xA1B23C4D /* nanoseconds */, version_2_4, 0, 0, snap_length, link_raw_ip}, 24);
}

/* ---- packets ------------------------------------------------------------------------------------------ */

/* One's complement sum of 16-bit words, as RFC 1071: big-endian, the last octet padded. */
static uint64_t sum_words(const uint8_t *bytes, size_t octets)
{
    uint64_t sum = 0;
    for (size_t i = 0; i + 1 < octets; i += 2) sum += dis_load_u16(bytes + i);
    if (octets % 2) sum += (uint64_t)bytes[octets - 1] << 8;
    return sum;
}

static uint16_t checksum(uint64_t sum)
{
    while (sum >> 16) sum = (sum & 0xFFFF) + (sum >> 16);
    return (uint16_t)~sum;
}

/* IP and UDP headers of a datagram; returns their octets. */
static size_t make_headers(uint8_t out[ipv6_octets + udp_octets], DisRecorder *r, const uint8_t from[16], uint16_t port,
                           const uint8_t *bytes, size_t octets)
{
    const bool     v4 = is_ipv4(from);
    const uint8_t *to = v4 ? r->to4 : r->to6;
    const size_t   ip = v4 ? ipv4_octets : ipv6_octets;
    const uint16_t udp_length = (uint16_t)(udp_octets + octets);
    memset(out, 0, ip + udp_octets);
    if (v4) {
        out[0] = 4 << 4 | ipv4_octets / 4;
        dis_store_u16(out + 2, (uint16_t)(ipv4_octets + udp_length));
        dis_store_u16(out + 4, r->identification++);
        out[8] = hop_limit;
        out[9] = protocol_udp;
        memcpy(out + 12, from + 12, 4);
        memcpy(out + 16, to + 12, 4);
        dis_store_u16(out + 10, checksum(sum_words(out, ipv4_octets)));
    } else {
        out[0] = 6 << 4;
        dis_store_u16(out + 4, udp_length);
        out[6] = protocol_udp;
        out[7] = hop_limit;
        memcpy(out + 8, from, 16);
        memcpy(out + 24, to, 16);
    }
    uint8_t *udp = out + ip;
    dis_store_u16(udp, port);
    dis_store_u16(udp + 2, r->to_port);
    dis_store_u16(udp + 4, udp_length);
    /* the checksum covers both addresses, protocol and length too; 0 would mean that there is none */
    const size_t   addresses = v4 ? 8 : 32;
    const uint64_t sum =
        sum_words(udp - addresses, addresses + udp_octets) + protocol_udp + udp_length + sum_words(bytes, octets);
    const uint16_t check = checksum(sum);
    dis_store_u16(udp + 6, check ? check : 0xFFFF);
    return ip + udp_octets;
}

static void put_pcapng_packet(DisRecorder *r, uint64_t ns, const uint8_t *headers, size_t header_octets,
                              const uint8_t *bytes, size_t octets)
{
    enum { enhanced_packet = 6 };
    const size_t   whole = header_octets + octets;
    const uint32_t length = (uint32_t)(32 + whole + padding(whole));
    put(r,
        (const uint32_t[]){enhanced_packet, length, 0 /* number of the interface */, (uint32_t)(ns >> 32), (uint32_t)ns,
                           (uint32_t)whole, (uint32_t)whole},
        28);
    put(r, headers, header_octets);
    put(r, bytes, octets);
    put_padding(r, whole);
    put(r, &length, 4);
}

Status dis_recorder_add(DisRecorder *r, int64_t capture_ns, const uint8_t from[16], uint16_t port, const uint8_t *bytes,
                        size_t octets)
{
    uint8_t headers[ipv6_octets + udp_octets];
    if (!from) from = loopback4;
    if (octets > (size_t)(is_ipv4(from) ? dis_recorder_ipv4_octets : dis_recorder_ipv6_octets) || capture_ns < 0 ||
        (!r->pcapng && capture_ns / ns_per_s > UINT32_MAX))
        return STATUS_BAD_VALUE;
    if (dis_recorder_begin(r) != STATUS_OK) return STATUS_IO;

    const size_t header_octets = make_headers(headers, r, from, port, bytes, octets);
    if (r->pcapng) {
        put_pcapng_packet(r, (uint64_t)capture_ns, headers, header_octets, bytes, octets);
    } else {
        const uint32_t whole = (uint32_t)(header_octets + octets);
        const uint32_t s = (uint32_t)(capture_ns / ns_per_s), ns = (uint32_t)(capture_ns % ns_per_s);
        put(r, (const uint32_t[]){s, ns, whole, whole}, 16);
        put(r, headers, header_octets);
        put(r, bytes, octets);
    }
    return r->failed ? STATUS_IO : STATUS_OK;
}

Status dis_recorder_note(DisRecorder *r, int64_t capture_ns, const char *text)
{
    enum { interface_statistics = 5, opt_comment = 1, end_of_options = 4 };
    if (!r->pcapng) return STATUS_UNSUPPORTED;
    if (capture_ns < 0) return STATUS_BAD_VALUE;
    if (dis_recorder_begin(r) != STATUS_OK) return STATUS_IO;
    const uint64_t ns = (uint64_t)capture_ns;
    const size_t   said = strnlen(text, longest_text);
    const uint32_t length = (uint32_t)(24 + option_octets(said) + end_of_options);
    put(r,
        (const uint32_t[]){interface_statistics, length, 0 /* number of the interface */, (uint32_t)(ns >> 32),
                           (uint32_t)ns},
        20);
    put_option(r, opt_comment, text, (uint16_t)said);
    put_option(r, 0, NULL, 0);
    put(r, &length, 4);
    return r->failed ? STATUS_IO : STATUS_OK;
}

/* ---- open and close --------------------------------------------------------------------------------------------- */

bool dis_recorder_name(const char *what, const char *path)
{
    const char *ending = output_ending(path);
    if (!*ending || strcasecmp(ending, ".pcapng") == 0 || strcasecmp(ending, ".pcap") == 0) return true;
    log_error("%s: '%s': recordings are pcapng or pcap: choose a name that ends with .pcapng or .pcap", what, path);
    return false;
}

Status dis_recorder_open(DisRecorder **out, const char *path, const char *comment)
{
    DisRecorder *r = calloc(1, sizeof *r);
    if (!r) return STATUS_NO_MEMORY;
    r->path = strdup(path);
    r->comment = comment ? strdup(comment) : NULL;
    if (!r->path || (comment && !r->comment)) {
        dis_recorder_close(r);
        return STATUS_NO_MEMORY;
    }
    r->pcapng = strcasecmp(output_ending(path), ".pcap") != 0;
    dis_recorder_to(r, NULL, dis_port);
    r->file = output_file(path, OUTPUT_STREAM | OUTPUT_KEEP);
    if (!r->file) {
        log_error("recorder: cannot make %s: %s; the folder must exist and be writable", path, output_reason(errno));
        dis_recorder_close(r);
        return STATUS_IO;
    }
    setvbuf(r->file, NULL, _IOFBF, file_buffer_octets);
    struct stat about;
    r->older = lstat(path, &about) == 0 && S_ISREG(about.st_mode) && about.st_size > 0;
    if (!r->older && dis_recorder_begin(r) != STATUS_OK) {
        dis_recorder_close(r);
        return STATUS_IO;
    }
    *out = r;
    return STATUS_OK;
}

Status dis_recorder_begin(DisRecorder *r)
{
    if (r->begun) return r->failed ? STATUS_IO : STATUS_OK;
    r->begun = true;
    if (r->older && ftruncate(fileno(r->file), 0) != 0) return fail(r);
    if (r->pcapng) {
        put_section(r, r->comment);
        put_interface(r);
    } else {
        put_pcap_header(r);
    }
    return dis_recorder_flush(r);
}

bool dis_recorder_begun(const DisRecorder *r) { return r->begun; }

void dis_recorder_to(DisRecorder *r, const uint8_t to[16], uint16_t port)
{
    r->to_port = port;
    if (!to) {
        memcpy(r->to4, loopback_broadcast, sizeof r->to4);
        memcpy(r->to6, all_nodes, sizeof r->to6);
    } else {
        memcpy(is_ipv4(to) ? r->to4 : r->to6, to, 16);
    }
}

Status dis_recorder_flush(DisRecorder *r)
{
    if (!r->failed && fflush(r->file) != 0) fail(r);
    return r->failed ? STATUS_IO : STATUS_OK;
}

Status dis_recorder_close(DisRecorder *r)
{
    if (!r) return STATUS_OK;
    if (r->file && fclose(r->file) != 0 && !r->failed) fail(r);
    const Status status = r->failed || !r->file ? STATUS_IO : STATUS_OK;
    free(r->comment);
    free(r->path);
    free(r);
    return status;
}
