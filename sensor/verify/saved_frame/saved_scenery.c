/* sensor/verify/saved_frame/saved_scenery.c: scenery of a frame file: made again from what it follows from, and
 * compared with that of the frame by its hash. */
#include "sensor/verify/saved_frame/saved_frame_private.h"
#include "sensor/verify/saved_frame/saved_scene.h"
#include "terrain/culture/culture_ground.h"

#include <stdlib.h>

/* ---- its hash ------------------------------------------------------------------------------------ */

static void object_bytes(ByteSink *s, const SceneryObject *o)
{
    const int32_t number[5] = {o->kind, o->class, o->damage, o->model, o->state};
    sink_bytes(s, &o->id, sizeof o->id);
    sink_bytes(s, number, sizeof number);
    sink_bytes(s, o->p_enu, sizeof o->p_enu);
    sink_bytes(s, o->r_enu_from_body, sizeof o->r_enu_from_body);
}

static void state_bytes(ByteSink *s, const SceneryState *of)
{
    const EntityDrives *d = &of->drives;
    const float         number[9] = {d->engine, d->speed_mps, d->flying,       d->alive,   d->burning,
                                     d->motor,  d->flare,     of->heading_rad, of->stood_s};
    const double        real[3] = {d->since_s, d->fired_kg[0], d->fired_kg[1]};
    sink_bytes(s, &(int32_t){of->model}, sizeof(int32_t));
    sink_bytes(s, number, sizeof number);
    sink_bytes(s, real, sizeof real);
}

static void mover_bytes(ByteSink *s, const SceneryMover *m)
{
    const int32_t number[3] = {m->object, m->first, m->count};
    const double  real[2] = {m->speed_mps, m->phase_m};
    sink_bytes(s, number, sizeof number);
    sink_bytes(s, real, sizeof real);
}

static void lamp_bytes(ByteSink *s, const SceneryLamp *l)
{
    const int32_t number[4] = {l->kind, l->object, l->facet, l->facets};
    const float   real[5] = {l->area_m2, l->type, l->draw, l->bed_h, l->rise_h};
    sink_bytes(s, number, sizeof number);
    sink_bytes(s, l->p, sizeof l->p);
    sink_bytes(s, l->n, sizeof l->n);
    sink_bytes(s, real, sizeof real);
}

Status saved_scenery_sha256(char out[sha256_text_size], const Scenery *scenery)
{
    ByteSink s = {0};
    Status   status = STATUS_OK;
    for (int m = 0; m < scenery->models && status == STATUS_OK; m++) {
        char sha256[sha256_text_size];
        status = saved_model_sha256(sha256, &scenery->model[m]);
        sink_text(&s, sha256);
    }
    for (int k = 0; k < scenery->objects; k++) object_bytes(&s, &scenery->object[k]);
    for (int k = 0; k < scenery->states; k++) state_bytes(&s, &scenery->state[k]);
    for (int k = 0; k < scenery->movers; k++) mover_bytes(&s, &scenery->mover[k]);
    for (int k = 0; k < scenery->lamps; k++) lamp_bytes(&s, &scenery->lamp[k]);
    for (int k = 0; k < scenery->harms; k++) {
        const SceneryHarm *h = &scenery->harm[k];
        sink_bytes(&s, (const int32_t[2]){h->object, h->damage}, 2 * sizeof(int32_t));
        sink_bytes(&s, &h->t_s, sizeof h->t_s);
    }
    if (scenery->paths > 0) sink_bytes(&s, scenery->path_enu, (size_t)scenery->paths * sizeof *scenery->path_enu);
    if (status == STATUS_OK) status = s.failed ? STATUS_NO_MEMORY : sha256_bytes(out, s.bytes, s.count);
    sink_free(&s);
    return status;
}

/* ---- made again ---------------------------------------------------------------------------------- */

static bool copy_records(void *out, const void *from, int count, size_t size)
{
    void **const to = out;
    if (count == 0) return true;
    *to = malloc((size_t)count * size);
    if (*to) memcpy(*to, from, (size_t)count * size);
    return *to != NULL;
}

/* The file's are in its arena. */
static Status copy_culture(Culture *out, const Culture *from)
{
    *out = (Culture){.corners = from->corners,
                     .buildings = from->buildings,
                     .lines = from->lines,
                     .points = from->points,
                     .trees = from->trees,
                     .room = {from->corners, from->buildings, from->lines, from->points, from->trees}};
    const bool whole = copy_records(&out->corner_m, from->corner_m, from->corners, sizeof *out->corner_m) &&
                       copy_records(&out->building, from->building, from->buildings, sizeof *out->building) &&
                       copy_records(&out->line, from->line, from->lines, sizeof *out->line) &&
                       copy_records(&out->point, from->point, from->points, sizeof *out->point) &&
                       copy_records(&out->tree, from->tree, from->trees, sizeof *out->tree);
    return whole ? culture_index(out) : STATUS_NO_MEMORY;
}

Status saved_scenery_make(FrameScenery *out, Landscape *landscape, const SavedFrame *file, bool forced)
{
    const SavedScenery *was = &file->scenery;
    char                sha256[sha256_text_size];
    Status              status = STATUS_OK;
    *out = (FrameScenery){0};
    if (!file->built) return STATUS_OK;
    if (was->plan.from == CULTURE_FROM_RECORDS) status = copy_culture(&out->culture, &was->culture);
    if (status == STATUS_OK && !copy_records(&out->driven, was->driven, was->drivens, sizeof *out->driven))
        status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) out->drivens = was->drivens, status = frame_scenery_make(out, &was->plan, landscape);
    if (status == STATUS_OK) status = saved_scenery_sha256(sha256, &out->scenery);
    if (status != STATUS_OK) {
        log_error("frame: its buildings and clutter cannot be made again: %s", status_name(status));
        return status;
    }
    if (out->culture.index) culture_lay(landscape, &out->culture);
    if (out->scenery.objects == was->objects && strcmp(sha256, was->sha256) == 0) return STATUS_OK;
    saved_say(forced, "what is built and stands there", "is not made as it was");
    return forced ? STATUS_OK : STATUS_BAD_VALUE;
}
