/* tests/fuzz/fuzz_head.c: any octets as a head tracker's datagram, and as the notes of a recording: what is read is
 * within its ranges, and is written again as it was. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/node/session/head_notes.h"

#include <stdlib.h>

const int fuzz_rounds = 40000;

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    const double   u = (double)(index % 19) / 19 - 0.5;
    const HeadNote note = {.t_s = 1e4 * u,
                           .pose = {.flags = index / 2 % 4,
                                    .sequence = index * 0x01000193u,
                                    .buttons = index,
                                    .time_us = index * 16667ull,
                                    .yaw_deg = 720 * u,
                                    .pitch_deg = 180 * u,
                                    .roll_deg = -720 * u,
                                    .zoom = 1 + u,
                                    .lat_deg = 180 * u,
                                    .lon_deg = 720 * u,
                                    .height_m = 1000 * u}};
    char           text[head_note_size];
    if (index % 2) return head_pose_write(out, &note.pose);
    head_note_text(text, &note);
    return fuzz_seed_text(out, text);
}

static void walk(const uint8_t *data, size_t size)
{
    HeadPose p;
    uint8_t  back[head_octets_most];
    if (head_pose_read(&p, data, size) != HEAD_GOOD) return;
    if (!(fabs(p.yaw_deg) <= 360 && fabs(p.pitch_deg) <= 90 && fabs(p.roll_deg) <= 360 && p.zoom >= 0.04 &&
          p.zoom <= 100))
        abort();
    if (!(fabs(p.lat_deg) <= 90 && fabs(p.lon_deg) <= 360 && fabs(p.height_m) <= 1e5)) abort();
    if (head_pose_write(back, &p) != size || memcmp(back, data, size) != 0) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char      *notes = malloc(size + 1), text[head_note_size];
    HeadNotes *read = NULL;
    if (!notes) return 0;
    walk(data, size);
    memcpy(notes, data, size);
    notes[size] = 0;
    if (head_notes_read(&read, notes) == STATUS_OK && read)
        for (int i = 0; i < read->count; i++) {
            head_note_text(text, &read->note[i]);
            if (!strstr(notes, text) || (i > 0 && read->note[i].t_s < read->note[i - 1].t_s)) abort();
        }
    free(read);
    free(notes);
    return 0;
}
