/* tests/tools/cigi_ig.c: an image generator without pictures, in step with a CIGI host over UDP: cigi_ig PORT SECONDS.
 *
 * Listens on 127.0.0.1:PORT; the first sender there is the host. Every event and packet is a line of JSON on
 * standard output. A HAT/HOT Request is answered by latitude + longitude as the height of terrain, and a Line of Sight
 * request by invalid; a datagram of the host that says `end` ends it. */
#include "dis/cigi/cigi_fields.h"
#include "dis/cigi/cigi_session.h"

#include <arpa/inet.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

static const char *const event_name[] = {"refused", "old", "repeated", "extra", "idle", "due"};

static void print_packet(const CigiPacket *packet)
{
    const CigiLayout *layout = cigi_layout(packet->id);
    printf("{\"packet\": \"%s\", \"fields\": {", layout->name);
    for (int i = 0; i < layout->count; i++)
        printf("%s\"%s\": %.17g", i ? ", " : "", layout->field[i].name, cigi_field_value(packet, &layout->field[i]));
    printf("}}\n");
}

static void answer(CigiSession *s, const CigiPacket *p)
{
    CigiPacket response = {0};
    if (p->id == cigi_hat_hot_request) {
        const CigiHatHotRequest *r = &p->of.hat_hot_request;
        const double             hot_m = r->p[0] + r->p[1], hat_m = r->p[2] - hot_m;
        if (r->type == cigi_request_extended) {
            response.id = cigi_hat_hot_extended_response;
            response.of.hat_hot_extended_response = (CigiHatHotExtendedResponse){
                .id = r->id, .valid = true, .hat_m = hat_m, .hot_m = hot_m, .normal_elevation_deg = 90};
        } else {
            const bool hot = r->type == cigi_request_hot;
            response.id = cigi_hat_hot_response;
            response.of.hat_hot_response =
                (CigiHatHotResponse){.id = r->id, .valid = true, .hot = hot, .height_m = hot ? hot_m : hat_m};
        }
    } else if (p->id == cigi_los_segment_request || p->id == cigi_los_vector_request) {
        response.id = cigi_los_response;
        response.of.los_response = (CigiLosResponse){
            .id = p->id == cigi_los_vector_request ? p->of.los_vector_request.id : p->of.los_segment_request.id,
            .count = 1};
    } else return;
    cigi_session_answer(s, &response);
}

static void print_counters(const CigiSession *s)
{
    const CigiSessionCounters *c = &s->events;
    printf(
        "{\"frames\": %llu, \"idle\": %llu, \"repeats\": %llu, \"repeated\": %llu, \"old\": %llu, \"extra\": %llu, "
        "\"lost\": %llu, \"restarts\": %llu, \"silences\": %llu, \"time_back\": %llu, \"time_ahead\": %llu, \"unstamped\": %llu, "
        "\"unanswered\": %llu, \"dropped\": {",
        (unsigned long long)c->frames, (unsigned long long)c->idle, (unsigned long long)c->repeats,
        (unsigned long long)c->repeated, (unsigned long long)c->old, (unsigned long long)c->extra,
        (unsigned long long)c->lost, (unsigned long long)c->restarts, (unsigned long long)c->silences,
        (unsigned long long)c->time_back, (unsigned long long)c->time_ahead, (unsigned long long)c->unstamped,
        (unsigned long long)c->unanswered);
    for (int i = 0; i < CIGI_DROP_COUNT; i++)
        printf("%s\"%s\": %llu", i ? ", " : "", cigi_drop_cause((CigiDrop)i),
               (unsigned long long)s->counters.dropped[i]);
    printf("}, \"skipped\": {");
    for (int i = 0, n = 0; i < 256; i++)
        if (s->counters.skipped[i])
            printf("%s\"%d\": %llu", n++ ? ", " : "", i, (unsigned long long)s->counters.skipped[i]);
    printf("}}\n");
}

static void send_what_is_due(CigiSession *s, int udp, const struct sockaddr_in *host)
{
    const uint8_t *datagram;
    size_t         octets;
    if (host->sin_port && cigi_session_send(&datagram, &octets, s))
        sendto(udp, datagram, octets, 0, (const struct sockaddr *)host, sizeof *host);
}

int main(int argc, char **argv)
{
    const double       seconds = argc > 2 ? atof(argv[2]) : 10;
    struct sockaddr_in here = {.sin_family = AF_INET, .sin_port = htons((uint16_t)(argc > 1 ? atoi(argv[1]) : 8004))};
    struct sockaddr_in host = {0};
    CigiSession        s;
    CigiSessionConfig  config = cigi_session_default_config();
    const int          udp = socket(AF_INET, SOCK_DGRAM, 0);
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (udp < 0 || bind(udp, (struct sockaddr *)&here, sizeof here) != 0) return perror("cigi_ig"), 1;
    socklen_t size = sizeof here;
    getsockname(udp, (struct sockaddr *)&here, &size);
    setsockopt(udp, SOL_SOCKET, SO_RCVTIMEO, &(struct timeval){.tv_usec = 20000}, sizeof(struct timeval));
    printf("{\"port\": %d}\n", ntohs(here.sin_port));
    fflush(stdout);
    config.repeat_s = 0.1;
    config.silent_s = 0.4;
    const double begun_s = wall_clock_s();
    cigi_session_begin(&s, &config, begun_s);
    while (wall_clock_s() - begun_s < seconds) {
        uint8_t            datagram[65536];
        struct sockaddr_in from;
        size = sizeof from;
        const ssize_t octets = recvfrom(udp, datagram, sizeof datagram, 0, (struct sockaddr *)&from, &size);
        if (octets == 3 && memcmp(datagram, "end", 3) == 0) break;
        if (octets >= 0) {
            CigiPacket      packet;
            const CigiEvent event = cigi_session_receive(&s, datagram, (size_t)octets, wall_clock_s());
            if (!host.sin_port && event != CIGI_REFUSED) host = from;
            printf("{\"event\": \"%s\", \"news\": %u, \"t_s\": %.17g, \"mode\": %d}\n", event_name[event],
                   cigi_session_news(&s), cigi_session_time_s(&s), cigi_session_mode(&s));
            while (cigi_session_packet(&packet, &s)) {
                print_packet(&packet);
                answer(&s, &packet);
            }
            if (event == CIGI_DUE || event == CIGI_IDLE) cigi_session_delivered(&s, wall_clock_s());
        }
        if (cigi_session_look(&s, wall_clock_s())) printf("{\"event\": \"silent\"}\n");
        send_what_is_due(&s, udp, &host);
    }
    print_counters(&s);
    close(udp);
    return 0;
}
