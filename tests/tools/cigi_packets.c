/* tests/tools/cigi_packets.c: writes CIGI packets with random fields, one behind each IG Control or Start of Frame, as
 * lines of hexadecimal for text2pcap on standard output, and their values as lines of JSON on standard error:
 * cigi_packets ROUNDS HOST|IG. */
#include "tests/dis/random_cigi.h"

#include <stdlib.h>

static void print_values(int datagram, const CigiPacket *packet)
{
    const CigiLayout *layout = cigi_layout(packet->id);
    fprintf(stderr, "{\"datagram\": %d, \"id\": %d, \"name\": \"%s\", \"octets\": %d, \"fields\": {", datagram,
            layout->id, layout->name, layout->octets);
    for (int i = 0; i < layout->count; i++)
        fprintf(stderr, "%s\"%s\": %.17g", i ? ", " : "", layout->field[i].name,
                cigi_field_value(packet, &layout->field[i]));
    fprintf(stderr, "}}\n");
}

int main(int argc, char **argv)
{
    const int        rounds = argc > 1 ? atoi(argv[1]) : 1;
    const CigiSender sender = argc > 2 && strcmp(argv[2], "IG") == 0 ? CIGI_FROM_IG : CIGI_FROM_HOST;
    const int        begins = sender == CIGI_FROM_HOST ? 0 : cigi_host_ids;
    const int        count = sender == CIGI_FROM_HOST ? cigi_host_ids : cigi_id_count - cigi_host_ids;
    for (int n = 0; n < rounds * count; n++) {
        Dice            d = dice((uint32_t)n);
        const CigiOrder order = n / count % 2 ? CIGI_LITTLE_ENDIAN : CIGI_BIG_ENDIAN;
        CigiPacket      packet[2] = {random_cigi_first(sender, &d), random_cigi(cigi_ids[begins + n % count], &d)};
        const int       packets = n % count == 0 ? 1 : 2; /* the first kind is that of the first packet itself */
        uint8_t         out[2 * cigi_most_octets];
        size_t          octets = 0;
        for (int i = 0; i < packets; i++) {
            octets += cigi_write(out + octets, sizeof out - octets, &packet[i], order);
            print_values(n, &packet[i]);
        }
        printf("000000");
        for (size_t i = 0; i < octets; i++) printf(" %02x", out[i]);
        printf("\n");
    }
    return 0;
}
