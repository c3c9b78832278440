/* sensor/publish/pair_record.c: the lines of pairs.jsonl. */
#include "sensor/publish/pair_record.h"

#include <jansson.h>
#include <stdlib.h>

static void set_file(json_t *object, const char *key, const char *below, const char *place, const char *band, int frame,
                     const char *ending)
{
    char path[128];
    snprintf(path, sizeof path, "%s%s%s/%s/%06d.%s", below, *below ? "/" : "", place, band, frame, ending);
    json_object_set_new(object, key, json_string(path));
}

static json_t *member_json(const PairRecord *r, const PairMember *m)
{
    json_t *member = json_pack("{s:b,s:b}", "target", m->target, "noise", m->noise), *bands = json_object();
    if (r->truth) set_file(member, "truth", m->radiance, "frames", "truth", r->frame, "exr");
    for (int b = 0; b < BAND_COUNT; b++) {
        if (!(r->bands >> b & 1)) continue;
        const char *name = band_name((Band)b);
        json_t     *band = json_object();
        set_file(band, "radiance", m->radiance, "frames", name, r->frame, "exr");
        /* radar has no detector noise: its image is listed with its radiance */
        if (r->png)
            set_file(band, "display", b == BAND_RADAR ? m->radiance : m->shown, "frames", name, r->frame, "png");
        if (r->raw >> b & 1) set_file(band, "raw", m->shown, "raw", name, r->frame, "png");
        if (r->png && b != BAND_RADAR)
            json_object_set_new(band, "level", json_pack("[f,f]", m->display[b].level.low, m->display[b].level.high));
        json_object_set_new(bands, name, band);
    }
    json_object_set_new(member, "bands", bands);
    return member;
}

Status record_write_pair(FILE *file, const PairRecord *r)
{
    json_t *removed = json_array(), *members = json_array();
    for (int i = 0; i < r->removed_count; i++) {
        char id[dis_id_text_size];
        dis_entity_id_text(id, r->removed[i]);
        json_array_append_new(removed, json_string(id));
    }
    for (int m = 0; m < pair_members; m++) json_array_append_new(members, member_json(r, &r->member[m]));
    json_t *line = json_pack("{s:i,s:f,s:I,s:o,s:s,s:s,s:o}", "frame", r->frame, "time_s", r->time_s, "seed",
                             (json_int_t)r->seed, "removed", removed, "frame_sha256", r->frame_sha256,
                             "background_sha256", r->background_sha256, "members", members);
    char *text = line ? json_dumps(line, JSON_COMPACT | JSON_REAL_PRECISION(15)) : NULL;
    json_decref(line);
    if (!text) return STATUS_NO_MEMORY;
    const bool ok = fprintf(file, "%s\n", text) > 0 && fflush(file) == 0;
    free(text);
    return ok ? STATUS_OK : STATUS_IO;
}
