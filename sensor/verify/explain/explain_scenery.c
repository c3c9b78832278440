/* sensor/verify/explain/explain_scenery.c: buildings, works and clutter that rays of a pixel met: names, and where
 * their heat comes from. */
#include "sensor/verify/explain/explain_private.h"

#include "sensor/frame/json_object.h"
#include "terrain/from_files/culture_import.h"

#include <inttypes.h>

/* ---- names --------------------------------------------------------------------------------------- */

/* What a record of culture is: house, fence, pole. */
static const char *kind_of(const Culture *c, uint64_t id)
{
    for (int n = 0; n < c->buildings; n++)
        if (c->building[n].id == id) return culture_use_name(c->building[n].use);
    for (int n = 0; n < c->lines; n++)
        if (c->line[n].id == id) return culture_line_name(c->line[n].kind);
    for (int n = 0; n < c->points; n++)
        if (c->point[n].id == id) return culture_point_name(c->point[n].kind);
    return "building";
}

void explain_scenery_name(char *out, size_t size, const Explained *e, const PixelSample *s)
{
    const FrameScenery *of = &e->scene->scenery;
    const Scenery      *scenery = &of->scenery;
    if (s->plant == 0 || s->plant > (uint32_t)scenery->objects) {
        snprintf(out, size, "scenery");
        return;
    }
    const SceneryObject *o = &scenery->object[s->plant - 1];
    const Model         *model = &scenery->model[o->model];
    const char          *part = s->part && (int)s->part <= model->part_count ? model->part[s->part - 1].name : "";
    const int            first = scenery->part_first ? scenery->part_first[o->model] : -1;
    const uint64_t       record = first >= 0 && s->part ? scenery->part_of[first + (int)s->part - 1] : 0;
    if (o->kind == SCENERY_CLUTTER)
        snprintf(out, size, "%s %016" PRIx64 " (clutter), %s", scenery_class_name((SceneryClass)o->class), o->id, part);
    else snprintf(out, size, "%s %016" PRIx64 ", %s", kind_of(&of->culture, record), record, part);
}

/* ---- heat ---------------------------------------------------------------------------------------- */

static const char *behind_name(ConstructionInside inside)
{
    static const char *const name[] = {[BEHIND_HEATED] = "a heated room",
                                       [BEHIND_UNHEATED] = "an unheated room",
                                       [BEHIND_FLUE] = "a flue",
                                       [BEHIND_BACK] = "the open on its other side",
                                       [BEHIND_NONE] = "nothing that gives or takes heat"};
    return name[inside];
}

static void state_text(char *out, size_t size, const SceneryState *s)
{
    if (s->drives.burning > 0) snprintf(out, size, "it burns");
    else if (s->drives.speed_mps > 0) snprintf(out, size, "it drives at %.0f m/s", (double)s->drives.speed_mps);
    else if (s->stood_s > 0) snprintf(out, size, "its engine stopped %.0f s before the exercise", (double)s->stood_s);
    else if (s->drives.engine > 0) snprintf(out, size, "its engine runs");
    else if (s->drives.alive > 0) snprintf(out, size, "it lives");
    else snprintf(out, size, "it stands in the weather alone");
}

void explain_scenery_heat(FILE *to, const SceneryHeatOf *h)
{
    char state[80];
    if (h->of) {
        fprintf(to, "            first ray: construction %s (etc/constructions.csv), %d layer%s", h->of->name,
                h->of->layers, h->of->layers == 1 ? "" : "s");
        if (h->of->inside == BEHIND_NONE) fprintf(to, " before %s", behind_name(h->of->inside));
        else fprintf(to, " before %s of %.2f K", behind_name(h->of->inside), h->behind_k);
        fprintf(to, "; %.2f K in the sun of the hours before, %.2f K in its shade, which it had %.0f %% of\n", h->sun_k,
                h->shade_k, 100 * h->taken);
    }
    if (!h->state) return;
    state_text(state, sizeof state, h->state);
    fprintf(to, "            first ray: %s", state);
    for (int k = 0; k < h->patches && k < 2 && (k == 0 || h->patch[k].share >= 0.005); k++)
        fprintf(to, "; %.0f %% patch %d (%s) %.2f K", 100 * h->patch[k].share, h->patch[k].index,
                heat_role_name(h->patch[k].role), h->patch[k].temp_k);
    fprintf(to, "\n");
}

void explain_scenery_json(json_t *heat, const SceneryHeatOf *h)
{
    char state[80];
    if (h->of) {
        const char *behind = behind_name(h->of->inside);
        json_set_text(heat, "construction", h->of->name, strlen(h->of->name));
        json_set_text(heat, "behind", behind, strlen(behind));
        if (h->of->inside != BEHIND_NONE) json_set_number(heat, "behind_k", h->behind_k);
        json_set_number(heat, "in_sun_k", h->sun_k);
        json_set_number(heat, "in_shade_k", h->shade_k);
        json_set_number(heat, "shaded", h->taken);
    }
    if (!h->state) return;
    state_text(state, sizeof state, h->state);
    json_set_text(heat, "state", state, strlen(state));
    if (h->patches == 0) return;
    json_t *patches = json_array();
    for (int k = 0; k < h->patches; k++) {
        json_t *patch = json_object();
        json_object_set_new(patch, "patch", json_integer(h->patch[k].index));
        json_object_set_new(patch, "role", json_string(heat_role_name(h->patch[k].role)));
        json_set_number(patch, "share", h->patch[k].share);
        json_set_number(patch, "temp_k", h->patch[k].temp_k);
        json_array_append_new(patches, patch);
    }
    json_object_set_new(heat, "patches", patches);
}
