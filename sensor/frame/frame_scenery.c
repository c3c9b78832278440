/* sensor/frame/frame_scenery.c: scenery of a world, from its plan. */
#include "sensor/frame/frame_scenery.h"

#include "entities/scenery/scenery_buildings.h"
#include "entities/scenery/scenery_lamps.h"

double frame_scenery_ground(void *user, double x_m, double y_m)
{
    const Landscape *landscape = user;
    return elevation_height(&landscape->elevation, x_m, y_m, NULL);
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
    return scenery_add_clutter(&s->scenery, &clutter);
}

Status frame_scenery_culture(FrameScenery *s, const SceneryPlan *plan, const Landscape *landscape)
{
    if (plan->from != CULTURE_FROM_SEED || s->culture.index) return STATUS_OK;
    return culture_invent(&s->culture, landscape, &plan->invented);
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
