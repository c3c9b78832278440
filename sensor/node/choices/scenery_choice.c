/* sensor/node/choices/scenery_choice.c: what people built, from files or invented, and clutter. */
#include "sensor/node/choices/choices.h"

#include "terrain/from_files/culture_import.h"

static const double clutter_half_m = 8000; /* half the width of a square with clutter, at most */

static bool is_invented(const Config *config) { return strcmp(config->terrain.buildings, "invented") == 0; }

/* What of the files lies in the square about the frame's origin that holds the asked one. */
static Status read_files(Culture *out, const Config *config, const WoodsSquare *square, const Landscape *landscape)
{
    const bool         named = strcmp(config->terrain.buildings, "off") != 0 && !is_invented(config);
    const CultureFiles from = {.buildings = named ? config->terrain.buildings : NULL,
                               .trees = config->terrain.trees,
                               .frame = &landscape->frame,
                               .ground = frame_scenery_ground,
                               .user = (void *)landscape,
                               .half_m =
                                   square->half_width_m + fmax(fabs(square->centre_m[0]), fabs(square->centre_m[1]))};
    CultureReport      report;
    return culture_open(out, &report, &from);
}

/* Trees of a table beside what is invented: all of it is records then. */
static Status add_trees(FrameScenery *out, SceneryPlan *plan, const Config *config, const WoodsSquare *square,
                        const Landscape *landscape)
{
    Culture trees = {0};
    if (plan->from != CULTURE_FROM_SEED || !*config->terrain.trees) return STATUS_OK;
    Status status = read_files(&trees, config, square, landscape);
    for (int k = 0; k < trees.trees && status == STATUS_OK; k++)
        status = culture_add_tree(&out->culture, &trees.tree[k]);
    culture_free(&trees);
    plan->from = CULTURE_FROM_RECORDS;
    return status;
}

static SceneryPlan plan_of(const Config *config, const WoodsSquare *square)
{
    const double half_m = fmin(square->half_width_m, clutter_half_m);
    const bool   off = strcmp(config->terrain.buildings, "off") == 0 && !*config->terrain.trees;
    SceneryPlan  plan = {.from = is_invented(config) ? CULTURE_FROM_SEED
                                 : off               ? CULTURE_FROM_NOTHING
                                                     : CULTURE_FROM_RECORDS,
                         .invented = {.seed = (uint64_t)config->seed,
                                      .centre_m = {square->centre_m[0], square->centre_m[1]},
                                      .half_width_m = square->half_width_m},
                         .clutter = config->terrain.clutter,
                         .clutter_seed = (uint64_t)config->seed,
                         .lamps = config->terrain.lamps,
                         .smoke = true};
    snprintf(plan.clutter_table, sizeof plan.clutter_table, "%s", config->terrain.clutter_table);
    for (int k = 0; k < 2; k++) {
        plan.south_west_m[k] = square->centre_m[k] - half_m;
        plan.north_east_m[k] = square->centre_m[k] + half_m;
    }
    return plan;
}

static void report(Choices *choices, const FrameScenery *s, const Config *config, const Landscape *landscape)
{
    SceneryCounts n;
    frame_scenery_count(&n, s);
    if (s->plan.from == CULTURE_FROM_RECORDS && !is_invented(config))
        choice_add(choices,
                   "buildings: %d from files, %d lines, %d other works, %d trees (terrain.buildings, "
                   "terrain.trees)",
                   n.buildings, n.lines, n.points, n.trees);
    else if (is_invented(config) && landscape_is_synthetic(landscape))
        choice_add(choices, "buildings: %d invented, %d walls, fences and lines, %d other works (terrain.buildings)",
                   n.buildings, n.lines, n.points);
    if (s->gave_way > 0)
        choice_add(choices,
                   "buildings: %d records are not there for what the log's vehicles drive through (terrain.place)",
                   s->gave_way);
    if (is_invented(config) && !landscape_is_synthetic(landscape))
        choice_add(choices, "buildings: none are invented on terrain from files (terrain.buildings)");
    if (is_invented(config) && n.trees > 0) choice_add(choices, "trees: %d of a table (terrain.trees)", n.trees);
    if (s->plan.clutter > 0)
        choice_add(choices, "clutter: %d things, %d of them driving, within %.1f km (terrain.clutter)", n.clutter,
                   n.driving, 0.5e-3 * (s->plan.north_east_m[0] - s->plan.south_west_m[0]));
    if (n.damaged > 0)
        choice_add(choices, "damage: of %d buildings, by bursts near them and entities that stand for them (kind 5)",
                   n.damaged);
    if (s->scenery.lamps > 0)
        choice_add(choices, "lamps: %d windows, %d street lamps, %d pairs of headlamps, lit by night (terrain.lamps)",
                   n.lamps[LAMP_WINDOW], n.lamps[LAMP_STREET], n.lamps[LAMP_VEHICLE]);
}

Status choice_scenery(FrameScenery *out, Choices *choices, const ChoiceBasis *basis, const WoodsSquare *square,
                      const Landscape *landscape)
{
    const double begun_s = wall_clock_s();
    SceneryPlan  plan = plan_of(basis->config, square);
    Status       status = STATUS_OK;
    *out = (FrameScenery){0};
    if (plan.from == CULTURE_FROM_RECORDS) status = read_files(&out->culture, basis->config, square, landscape);
    if (status == STATUS_OK && basis->evidence && (plan.from == CULTURE_FROM_SEED || plan.clutter > 0))
        status = choice_driven(&out->driven, &out->drivens, basis, square, landscape);
    if (status == STATUS_OK) status = frame_scenery_culture(out, &plan, landscape);
    if (status == STATUS_OK) status = add_trees(out, &plan, basis->config, square, landscape);
    if (status == STATUS_OK) status = choice_harm(&plan, &out->culture, basis, &landscape->frame);
    if (status == STATUS_OK) status = frame_scenery_make(out, &plan, landscape);
    if (status != STATUS_OK)
        log_error("scenery: %s; terrain.buildings=off and terrain.clutter=0 show none", status_name(status));
    else report(choices, out, basis->config, landscape);
    if (status == STATUS_OK && out->scenery.objects > 0)
        log_detail("scenery: %d objects of %d models in %.0f ms", out->scenery.objects, out->scenery.models,
                   1e3 * (wall_clock_s() - begun_s));
    return status;
}
