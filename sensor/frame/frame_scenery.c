/* sensor/frame/frame_scenery.c: scenery of a world, from its plan. */
#include "sensor/frame/frame_scenery.h"

#include "entities/scenery/scenery_buildings.h"
#include "entities/scenery/scenery_lamps.h"

#include <stdlib.h>

double frame_scenery_ground(void *user, double x_m, double y_m)
{
    const Landscape *landscape = user;
    return elevation_height(&landscape->elevation, x_m, y_m, NULL);
}

/* Places along what is driven, as reports: clutter keeps clear of them. */
static Status places_of(LandscapeEvidence *out, const FrameScenery *s)
{
    static const double step_m = 6;
    int                 room = 0;
    for (int pass = 0; pass < 2; pass++) {
        GroundFix *fix = pass ? malloc(((size_t)room + 1) * sizeof *fix) : NULL;
        int        count = 0;
        if (pass && !fix) return STATUS_NO_MEMORY;
        for (int n = 0; n < s->drivens; n++) {
            const DrivenPath *p = &s->driven[n];
            const double      length_m = hypot(p->b_m[0] - p->a_m[0], p->b_m[1] - p->a_m[1]);
            const int         steps = (int)fmin(ceil(length_m / step_m), 1 << 16);
            for (int k = 0; k <= steps; k++, count++) {
                const double t = steps ? (double)k / steps : 0;
                if (fix)
                    fix[count] = (GroundFix){
                        {p->a_m[0] + t * (p->b_m[0] - p->a_m[0]), p->a_m[1] + t * (p->b_m[1] - p->a_m[1]), 0}, n + 1};
            }
        }
        room = count;
        if (fix) *out = (LandscapeEvidence){.fix_count = count, .fix = fix};
    }
    return STATUS_OK;
}

static Status add_clutter(FrameScenery *s, const Landscape *landscape)
{
    const SceneryPlan *plan = &s->plan;
    ClutterConfig      clutter = clutter_default_config();
    if (!(plan->clutter > 0)) return STATUS_OK;
    clutter.density = plan->clutter;
    clutter.seed = plan->clutter_seed;
    clutter.table = *plan->clutter_table ? plan->clutter_table : NULL;
    memcpy(clutter.south_west_m, plan->south_west_m, sizeof clutter.south_west_m);
    memcpy(clutter.north_east_m, plan->north_east_m, sizeof clutter.north_east_m);
    clutter.landscape = landscape;
    clutter.culture = s->culture.index ? &s->culture : NULL;
    LandscapeEvidence driven = {0};
    Status            status = s->drivens > 0 ? places_of(&driven, s) : STATUS_OK;
    if (s->drivens > 0) clutter.evidence = &driven;
    if (status == STATUS_OK) status = scenery_add_clutter(&s->scenery, &clutter);
    free((void *)driven.fix);
    return status;
}

Status frame_scenery_culture(FrameScenery *s, const SceneryPlan *plan, const Landscape *landscape)
{
    if (plan->from != CULTURE_FROM_SEED || s->culture.index) return STATUS_OK;
    const Status status = culture_invent(&s->culture, landscape, &plan->invented);
    return status == STATUS_OK ? culture_give_way(&s->culture, &s->gave_way, s->driven, s->drivens) : status;
}

Status frame_scenery_make(FrameScenery *s, const SceneryPlan *plan, const Landscape *landscape)
{
    s->plan = *plan;
    Status status = frame_scenery_culture(s, plan, landscape);
    if (status == STATUS_OK && s->culture.index)
        status = scenery_add_harmed_buildings(&s->scenery, &s->culture, plan->harm, plan->harms, frame_scenery_ground,
                                              (void *)landscape);
    s->scenery.smokes = plan->smoke;
    if (status == STATUS_OK) status = add_clutter(s, landscape);
    return status == STATUS_OK && plan->lamps ? scenery_add_lamps(&s->scenery, plan->clutter_seed) : status;
}

void frame_scenery_free(FrameScenery *s)
{
    scenery_free(&s->scenery);
    culture_free(&s->culture);
    free(s->driven);
    *s = (FrameScenery){0};
}

void frame_scenery_count(SceneryCounts *out, const FrameScenery *s)
{
    *out = (SceneryCounts){.objects = s->scenery.objects,
                           .models = s->scenery.models,
                           .driving = s->scenery.movers,
                           .buildings = s->culture.buildings,
                           .lines = s->culture.lines,
                           .points = s->culture.points,
                           .trees = s->culture.trees};
    for (int k = 0; k < s->scenery.objects; k++) {
        const SceneryObject *o = &s->scenery.object[k];
        for (int h = 0; h < s->scenery.harms; h++)
            if (s->scenery.harm[h].object == k) out->damaged++, h = s->scenery.harms;
        if (o->kind == SCENERY_BUILDINGS) out->cells++;
        else out->clutter++, out->of_class[o->class]++;
    }
    for (int k = 0; k < s->scenery.lamps; k++) out->lamps[s->scenery.lamp[k].kind]++;
}
