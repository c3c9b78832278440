/* sensor/node/choices/scenery_choice.c: what people built, from files or invented, and clutter. */
#include "sensor/node/choices/choices.h"

#include "entities/scenery/scenery_buildings.h"
#include "entities/scenery/scenery_clutter.h"
#include "terrain/culture/culture_invented.h"
#include "terrain/from_files/culture_import.h"

static const double clutter_half_m = 8000; /* half the width of a square with clutter, at most */

static double ground_at(void *user, double x_m, double y_m)
{
    const Landscape *landscape = user;
    return elevation_height(&landscape->elevation, x_m, y_m, NULL);
}

static Status invent(Culture *out, Choices *choices, const Config *config, const WoodsSquare *square,
                     const Landscape *landscape)
{
    const CultureConfig about = {.seed = (uint64_t)config->seed,
                                 .centre_m = {square->centre_m[0], square->centre_m[1]},
                                 .half_width_m = square->half_width_m};
    const Status        status = culture_invent(out, landscape, &about);
    if (status != STATUS_OK) return status;
    if (landscape_is_synthetic(landscape))
        choice_add(choices, "buildings: %d invented, %d walls, fences and lines, %d other works (terrain.buildings)",
                   out->buildings, out->lines, out->points);
    else
        choice_add(choices, "buildings: none are invented on terrain from files (terrain.buildings)");
    return status;
}

/* What of the files lies in the square about the frame's origin that holds the asked one. */
static Status read_files(Culture *out, Choices *choices, const Config *config, const WoodsSquare *square,
                         const Landscape *landscape)
{
    const bool         named = strcmp(config->terrain.buildings, "off") != 0;
    const CultureFiles from = {.buildings = named ? config->terrain.buildings : NULL,
                               .trees = config->terrain.trees,
                               .frame = &landscape->frame,
                               .ground = ground_at,
                               .user = (void *)landscape,
                               .half_m = square->half_width_m +
                                         fmax(fabs(square->centre_m[0]), fabs(square->centre_m[1]))};
    CultureReport      report;
    const Status       status = culture_open(out, &report, &from);
    if (status == STATUS_OK)
        choice_add(choices, "buildings: %d from files, %d lines, %d other works, %d trees (terrain.buildings, "
                            "terrain.trees)",
                   out->buildings, out->lines, out->points, out->trees);
    return status;
}

static Status find_culture(Culture *out, Choices *choices, const Config *config, const WoodsSquare *square,
                           const Landscape *landscape)
{
    if (strcmp(config->terrain.buildings, "invented") == 0) return invent(out, choices, config, square, landscape);
    if (strcmp(config->terrain.buildings, "off") == 0 && !*config->terrain.trees) return STATUS_OK;
    return read_files(out, choices, config, square, landscape);
}

static Status add_clutter(SceneryChoice *out, Choices *choices, const Config *config, const WoodsSquare *square,
                          const Landscape *landscape)
{
    const int     before = out->scenery.objects;
    ClutterConfig clutter = clutter_default_config();
    if (!(config->terrain.clutter > 0)) return STATUS_OK;
    clutter.density = config->terrain.clutter;
    clutter.seed = (uint64_t)config->seed;
    for (int k = 0; k < 2; k++) {
        clutter.south_west_m[k] = square->centre_m[k] - fmin(square->half_width_m, clutter_half_m);
        clutter.north_east_m[k] = square->centre_m[k] + fmin(square->half_width_m, clutter_half_m);
    }
    clutter.landscape = landscape;
    clutter.culture = out->culture.index ? &out->culture : NULL;
    const Status status = scenery_add_clutter(&out->scenery, &clutter);
    if (status == STATUS_OK)
        choice_add(choices, "clutter: %d things, %d of them driving, within %.1f km (terrain.clutter)",
                   out->scenery.objects - before, out->scenery.movers,
                   1e-3 * fmin(square->half_width_m, clutter_half_m));
    return status;
}

Status choice_scenery(SceneryChoice *out, Choices *choices, const ChoiceBasis *basis, const WoodsSquare *square,
                      const Landscape *landscape)
{
    const double begun_s = wall_clock_s();
    *out = (SceneryChoice){0};
    Status status = find_culture(&out->culture, choices, basis->config, square, landscape);
    if (status == STATUS_OK && out->culture.index)
        status = scenery_add_buildings(&out->scenery, &out->culture, ground_at, (void *)landscape);
    if (status == STATUS_OK) status = add_clutter(out, choices, basis->config, square, landscape);
    if (status != STATUS_OK)
        log_error("scenery: %s; terrain.buildings=off and terrain.clutter=0 show none", status_name(status));
    else if (out->scenery.objects > 0)
        log_detail("scenery: %d objects of %d models in %.0f ms", out->scenery.objects, out->scenery.models,
                   1e3 * (wall_clock_s() - begun_s));
    return status;
}

void choice_scenery_free(SceneryChoice *scenery)
{
    scenery_free(&scenery->scenery);
    culture_free(&scenery->culture);
    *scenery = (SceneryChoice){0};
}
