/* tests/fuzz/fuzz_cigi.c: any octets as datagrams of a CIGI host and of an image generator: walked, written again, and
 * fed to a session that answers, and to a scene, whose places are finite. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"
#include "tests/dis/random_cigi.h"

#include "dis/cigi/cigi_session.h"
#include "sensor/node/cigi/cigi_scene.h"

#include <stdlib.h>

const int fuzz_rounds = 40000;

/* Datagrams, each behind its length of 16 bits. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    Dice            d = dice(index);
    const CigiOrder order = index % 2 ? CIGI_LITTLE_ENDIAN : CIGI_BIG_ENDIAN;
    size_t          octets = 0;
    const uint32_t  datagrams = 1 + roll(&d) % 4;
    for (uint32_t n = 0; n < datagrams; n++) {
        uint8_t *const   head = out + octets;
        const CigiSender sender = roll(&d) % 4 ? CIGI_FROM_HOST : CIGI_FROM_IG;
        CigiPacket       packet = random_cigi_first(sender, &d);
        if (sender == CIGI_FROM_HOST) packet.of.ig_control.host_frame = n + roll(&d) % 3;
        octets += 2;
        octets += cigi_write(out + octets, cigi_most_octets, &packet, order);
        for (uint32_t i = roll(&d) % 4; i > 0; i--) {
            packet = random_cigi(cigi_ids[roll(&d) % (uint32_t)cigi_id_count], &d);
            octets += cigi_write(out + octets, cigi_most_octets, &packet, order);
        }
        const size_t length = octets - (size_t)(head - out) - 2;
        head[0] = (uint8_t)(length >> 8);
        head[1] = (uint8_t)length;
    }
    return octets;
}

/* What is read is written, and is then the same; counts add up. */
static void walk(const uint8_t *datagram, size_t octets, CigiSender sender)
{
    CigiCounters counters = {0};
    CigiReader   reader;
    CigiPacket   packet, again;
    uint8_t      back[2 * cigi_most_octets];
    if (cigi_open(&reader, &packet, &counters, datagram, octets, sender) != STATUS_OK) return;
    uint64_t read = 1;
    while (cigi_next(&packet, &reader, &counters)) {
        const CigiPacket first = {.id = sender == CIGI_FROM_HOST ? cigi_ig_control : cigi_start_of_frame};
        CigiCounters     others = {0};
        CigiReader       second;
        const size_t     head = cigi_write(back, sizeof back, &first, reader.order);
        const size_t     length = cigi_write(back + head, sizeof back - head, &packet, reader.order);
        if (head == 0 || length == 0) abort();
        if (cigi_open(&second, &again, &others, back, head + length, sender) != STATUS_OK) abort();
        if (!cigi_next(&again, &second, &others) || !same_cigi(&again, &packet)) abort();
        read++;
    }
    for (int i = 0; i < 256; i++) read -= counters.packets[i];
    if (read != 0) abort();
}

static void check_finite(const double *v, int count)
{
    for (int i = 0; i < count; i++)
        if (!isfinite(v[i])) abort();
}

static void look_at(const CigiScene *scene)
{
    double p[3], r[9], v[3], w[3];
    for (int i = 0; i < scene->entity_count; i++) {
        const uint16_t id = scene->entity[i].id;
        if (cigi_scene_entity(p, r, scene, id)) check_finite(p, 3), check_finite(r, 9);
        if (cigi_scene_rates(v, w, scene, id)) check_finite(v, 3), check_finite(w, 3);
    }
    for (int i = 0; i < scene->view_count; i++) {
        const uint16_t id = scene->view[i].view;
        if (cigi_scene_view(p, r, scene, id)) check_finite(p, 3), check_finite(r, 9);
        if (cigi_scene_view_rates(v, w, scene, id)) check_finite(v, 3), check_finite(w, 3);
        cigi_scene_carries(scene, id, 1);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static CigiSession      s;
    static CigiScene        scene;
    const CigiSessionConfig config = cigi_session_default_config();
    double                  now_s = 0, last_s = 0;
    cigi_session_begin(&s, &config, now_s);
    memset(&scene, 0, sizeof scene);
    for (size_t at = 0; at + 2 <= size;) {
        const size_t   wanted = (size_t)data[at] << 8 | data[at + 1], left = size - at - 2;
        const size_t   octets = wanted < left ? wanted : left;
        const uint8_t *datagram = data + at + 2, *sent;
        CigiPacket     packet;
        size_t         sent_octets;
        at += 2 + octets;
        now_s += 0.1;
        walk(datagram, octets, CIGI_FROM_HOST);
        walk(datagram, octets, CIGI_FROM_IG);
        const CigiEvent event = cigi_session_receive(&s, datagram, octets, now_s);
        while (cigi_session_packet(&packet, &s)) {
            cigi_session_answer(&s, &(CigiPacket){.id = cigi_los_extended_response});
            cigi_scene_take(&scene, &packet);
        }
        if (event == CIGI_DUE) {
            const double t_s = cigi_session_time_s(&s);
            if (!isfinite(t_s) || (t_s < last_s && !(s.events.restarts))) abort();
            last_s = t_s;
        }
        if (event == CIGI_DUE || event == CIGI_IDLE) cigi_session_delivered(&s, now_s);
        cigi_session_look(&s, now_s);
        if (cigi_session_send(&sent, &sent_octets, &s)) walk(sent, sent_octets, CIGI_FROM_IG);
    }
    look_at(&scene);
    return 0;
}
