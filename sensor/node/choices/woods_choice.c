/* sensor/node/choices/woods_choice.c: the square in which plants stand, paths that are cleared of them, and what
 * there is. */
#include "sensor/node/choices/choices.h"

#include "dis/pdu/pdu.h"
#include "dis/pdu/decode.h"
#include "sensor/node/choices/ground_evidence_private.h"

#include <stdlib.h>

/* ---- the square ---------------------------------------------------------------------------------- */

static void enu_of(double p_enu[3], const Landscape *landscape, const double p_ecef[3])
{
    enu_from_ecef(p_enu, &landscape->frame, p_ecef);
}

/* How far an entity's reports reach from the centre, east or north; reports beyond far_m do not count. */
static double reach_of(const Track *track, const LocalFrame *frame, const double centre_m[2], double far_m)
{
    double reach_m = 0;
    for (int n = 0; n < track->count; n++) {
        double p_enu[3];
        enu_from_ecef(p_enu, frame, track->point[n].p_ecef);
        const double off_m = fmax(fabs(p_enu[0] - centre_m[0]), fabs(p_enu[1] - centre_m[1]));
        if (off_m < far_m) reach_m = fmax(reach_m, off_m);
    }
    return reach_m;
}

/* The square is about the origin of the world and reaches as far as the host and what is on the ground go, in steps of
 * a factor of 2^0.5, and sight_m more. */
Status choice_square(WoodsSquare *out, const Survey *survey, const Config *config, const LocalFrame *frame,
                     const HostPlan *plan)
{
    static const double sight_m = 4000, far_m = 12000, least_m = 50, most_m = 50000, first_m = 1000;
    LocalFrame          world;
    double              p_ecef[3], p_enu[3], reach_m = 0, step_m = first_m;
    const Status        status = choice_world_frame(&world, survey, config, plan);
    if (status != STATUS_OK) return status;
    const bool own = config->terrain.woods_half_m >= least_m && choice_aim_place(p_ecef, survey, plan);
    enu_from_ecef(p_enu, frame, own ? p_ecef : world.origin_ecef);
    memcpy(out->centre_m, p_enu, sizeof out->centre_m);
    out->own = config->terrain.woods_half_m >= least_m;
    out->half_width_m = config->terrain.woods_half_m;
    if (out->own) return STATUS_OK;
    for (int t = 0; t < survey->track_count; t++) {
        const Track *track = &survey->track[t];
        if (choice_is_land(track) || dis_entity_id_compare(track->id, plan->host) == 0)
            reach_m = fmax(reach_m, reach_of(track, frame, out->centre_m, far_m));
    }
    reach_m = fmax(reach_m, dis_entity_id_is_none(plan->host) ? config->observer.range_m : 0);
    while (step_m < reach_m && step_m < most_m) step_m *= sqrt(2);
    out->half_width_m = fmin(step_m + sight_m, most_m);
    return STATUS_OK;
}

/* ---- what trees stand about ------------------------------------------------------------------------ */

/* Where anything was on the ground, of the aims that have this square; a place in each square of woods_square_m. */
static Status find_places(WoodsChoice *out, const Survey *survey, const GroundEvidence *e, const Landscape *landscape)
{
    enum { side = 128 };
    const double half = 0.5 * side * woods_square_m;
    bool(*here)[side] = calloc(side, sizeof *here);
    int places = 0;
    if (!here) return STATUS_NO_MEMORY;
    for (int t = 0; t < survey->track_count; t++) {
        const Track *track = &survey->track[t];
        for (int n = 0; n < track->count; n++) {
            double p_enu[3];
            if (!e->fixed[e->first[t] + (size_t)n]) continue;
            enu_of(p_enu, landscape, track->point[n].p_ecef);
            const double i = floor((p_enu[0] - out->config.centre_m[0] + half) / woods_square_m);
            const double j = floor((p_enu[1] - out->config.centre_m[1] + half) / woods_square_m);
            if (!(i >= 0 && j >= 0 && i < side && j < side) || here[(int)j][(int)i]) continue;
            here[(int)j][(int)i] = true;
            places++;
        }
    }
    out->place = malloc(((size_t)places + 1) * sizeof *out->place);
    for (int n = 0; out->place && n < side * side; n++) {
        if (!here[n / side][n % side]) continue;
        WoodsPlace *place = &out->place[out->config.place_count++];
        for (int k = 0; k < 2; k++)
            place->p_m[k] = out->config.centre_m[k] - half + ((k ? n / side : n % side) + 0.5) * woods_square_m;
    }
    free(here);
    out->config.place = out->place;
    return out->place ? STATUS_OK : STATUS_NO_MEMORY;
}

/* ---- paths ----------------------------------------------------------------------------------------- */

typedef struct Paths {
    WoodsPath         *path;
    int                count, capacity;
    const WoodsConfig *square;
    const Landscape   *landscape;
    bool               placed; /* the exercise was placed among these plants */
    bool               no_memory;
} Paths;

static void add_path(Paths *p, const double a_m[2], const double b_m[2], double half_m)
{
    /* plants stand in whole squares, which reach beyond */
    const double *c = p->square->centre_m,
                 reach_m = fmax(p->square->half_width_m, p->square->far_half_m) + 2 * woods_square_m + half_m;
    for (int k = 0; k < 2; k++) /* both ends beyond the same side of the square */
        if ((a_m[k] - c[k] > reach_m && b_m[k] - c[k] > reach_m) ||
            (a_m[k] - c[k] < -reach_m && b_m[k] - c[k] < -reach_m))
            return;
    if (p->count == p->capacity) {
        const int  capacity = p->capacity ? 2 * p->capacity : 256;
        WoodsPath *larger = realloc(p->path, (size_t)capacity * sizeof *larger);
        if (!larger) {
            p->no_memory = true;
            return;
        }
        p->path = larger;
        p->capacity = capacity;
    }
    p->path[p->count++] = (WoodsPath){{a_m[0], a_m[1]}, {b_m[0], b_m[1]}, half_m, 0};
}

/* No stem is within a vehicle that passes: half its width, with room for an error of the path between reports. What is
 * cleared is no wider than that, and grass and crops stay: a path still to come must not show (test_no_prophecy.c). */
static const double path_room_m = 0.25;
static double       half_of(const Model *model) { return 0.5 * model->width_m + path_room_m; }

/* Its footprint with half a metre about it, where it stands at all of its reports. False: it does not. */
static bool add_standing(Paths *p, const Track *track, const bool *fixed, const Model *model)
{
    static const double still_m = 1;
    double              first[3] = {0}, here[3], r_ecef_from_body[9], nose_ecef[3], nose_enu[3];
    for (int n = 0; n < track->count; n++) {
        if (!fixed[n]) return false;
        enu_of(here, p->landscape, track->point[n].p_ecef);
        if (n == 0) memcpy(first, here, sizeof first);
        if (hypot(here[0] - first[0], here[1] - first[1]) > still_m) return false;
    }
    if (track->count == 0) return false;
    survey_point_rotation(r_ecef_from_body, &track->point[0]);
    for (int k = 0; k < 3; k++) nose_ecef[k] = r_ecef_from_body[3 * k];
    m3_tmul_v3(nose_enu, p->landscape->frame.r_ecef_from_enu, nose_ecef);
    const WoodsPath path = woods_footprint(first, nose_enu, model->box_high[0], model->box_low[0], model->width_m);
    add_path(p, path.a_m, path.b_m, path.half_m);
    return true;
}

/* From report to report on the ground. The pieces between are straight: a report in less than step_m of the last that
 * was taken is within its path. Reports that no drive joins are places; there, and at both ends, it is as long as wide.
 */
static void add_track(Paths *p, const Track *track, const bool *fixed, const Model *model)
{
    const double        half_m = half_of(model), round_m = 0.5 * hypot(model->length_m, model->width_m) + path_room_m;
    static const double step_m = 1, jump_m = 500;
    double              last[3], here[3];
    bool                any = false;
    for (int n = 0; n < track->count; n++) {
        if (!fixed[n]) {
            any = false;
            continue;
        }
        enu_of(here, p->landscape, track->point[n].p_ecef);
        const double d_m = any ? hypot(here[0] - last[0], here[1] - last[1]) : INFINITY;
        if (any && d_m < step_m) continue;
        if (any && d_m < jump_m) add_path(p, last, here, half_m);
        if (!any || !(d_m < jump_m) || n == track->count - 1) add_path(p, here, here, round_m);
        memcpy(last, here, sizeof last);
        any = true;
    }
}

/* Clears the parts of a flight, or of the sight of a shot that hit, that are lower than the highest trees; low plants
 * stay. */
static void add_line(Paths *p, const ClearLine *line)
{
    static const double tree_m = 35, half_m = 5 /* of a crown, about it */, step_m = 25;
    const double *const a = line->a_enu, *const b = line->b_enu;
    const int pieces = 1 + (int)(hypot(b[0] - a[0], b[1] - a[1]) / step_m);
    double    from[3] = {0}, to[3] = {0};
    bool      low = false;
    for (int k = 0; k <= pieces; k++) { /* neighbouring low pieces become one */
        double at[3];
        for (int c = 0; c < 3; c++) at[c] = a[c] + (b[c] - a[c]) * k / pieces;
        const bool below = at[2] - elevation_height(&p->landscape->elevation, at[0], at[1], NULL) < tree_m;
        if (below && !low) memcpy(from, at, sizeof from);
        if (below) memcpy(to, at, sizeof to);
        if ((low && !below) || (below && k == pieces)) add_path(p, from, to, half_m);
        low = below;
    }
}

static void add_vehicles(Paths *p, const Survey *survey, const Catalog *catalog, const GroundEvidence *e)
{
    for (int t = 0; t < survey->track_count && !p->no_memory; t++) {
        const Track *track = &survey->track[t];
        const Model *model = catalog_model(catalog, catalog_find(catalog, track->type, NULL, NULL));
        const bool  *fixed = e->fixed + e->first[t];
        if (e->stance[t] != STANCE_GROUND && e->stance[t] != STANCE_LANDED) continue;
        if (p->placed && add_standing(p, track, fixed, model)) continue;
        add_track(p, track, fixed, model);
    }
}

/* Clears the paths of everything known to have been on the ground or low above it. */
static void add_known(Paths *p, int *impacts, const Survey *survey, const Catalog *catalog, const GroundEvidence *e)
{
    static const double burst_m = 1; /* it fell between the stems; what it tears down is not cleared before */
    add_vehicles(p, survey, catalog, e);
    for (int i = 0; i < e->said.line_count && !p->no_memory; i++) add_line(p, &e->said.line[i]);
    for (int i = 0; i < survey->shot_count; i++) {
        const Shot *shot = &survey->shot[i];
        double      p_enu[3];
        if (shot->result != dis_result_ground_impact || !isfinite(shot->detonation_s)) continue;
        enu_of(p_enu, p->landscape, shot->p_burst_ecef);
        add_path(p, p_enu, p_enu, burst_m);
        ++*impacts;
    }
}

Status choice_driven(DrivenPath **out, int *count, const ChoiceBasis *basis, const WoodsSquare *square,
                     const Landscape *landscape)
{
    const WoodsConfig about = {.centre_m = {square->centre_m[0], square->centre_m[1]},
                               .half_width_m = square->half_width_m};
    Paths             paths = {.square = &about, .landscape = landscape, .placed = true};
    add_vehicles(&paths, basis->survey, basis->catalog, basis->evidence);
    DrivenPath *driven = calloc((size_t)paths.count + 1, sizeof *driven);
    for (int n = 0; n < paths.count && driven; n++) {
        const WoodsPath *p = &paths.path[n];
        driven[n] = (DrivenPath){{p->a_m[0], p->a_m[1]}, {p->b_m[0], p->b_m[1]}, p->half_m};
    }
    const bool made = driven && !paths.no_memory;
    free(paths.path);
    if (!made) free(driven);
    else *out = driven, *count = paths.count;
    return made ? STATUS_OK : STATUS_NO_MEMORY;
}

/* ---- entities within a trunk ----------------------------------------------------------------------- */

static void count_in_trunks(WoodsChoice *w, const Survey *survey, const Landscape *landscape, const Catalog *catalog,
                            const GroundEvidence *e)
{
    for (int t = 0; t < survey->track_count; t++) {
        const Track *track = &survey->track[t];
        const bool  *fixed = e->fixed + e->first[t];
        int          first = 0, trunk;
        double       p_enu[3];
        if (e->stance[t] != STANCE_GROUND) continue;
        while (first < track->count && !fixed[first]) first++;
        if (first == track->count) continue;
        const Model *model = catalog_model(catalog, catalog_find(catalog, track->type, NULL, NULL));
        enu_of(p_enu, landscape, track->point[first].p_ecef);
        w->entities++;
        w->in_trunks += woods_near(&trunk, 1, &w->woods, p_enu[0], p_enu[1], 0.5 * model->width_m) > 0;
    }
}

/* ---- choice lines -------------------------------------------------------------------------------- */

static int trees_of(const Woods *woods)
{
    int trees = 0;
    for (int k = 0; k < PLANT_TREES; k++) trees += woods->by_kind[k];
    return trees;
}

/* Names the four kinds with the most trees, with their numbers. */
static void kinds_text(char *text, size_t size, const Woods *woods)
{
    bool   said[PLANT_TREES] = {false};
    size_t n = 0;
    *text = 0;
    for (int shown = 0; shown < 4; shown++) {
        int best = -1;
        for (int k = 0; k < PLANT_TREES; k++)
            if (!said[k] && woods->by_kind[k] > (best < 0 ? 0 : woods->by_kind[best])) best = k;
        if (best < 0) return;
        said[best] = true;
        n += (size_t)snprintf(text + n, size - n, "%s%s %d", shown ? ", " : "", plant_name((PlantKind)best),
                              woods->by_kind[best]);
        if (n >= size) return;
    }
    for (char *at = text; *at; at++)
        if (*at == '_') *at = ' ';
}

static void report(Choices *choices, const WoodsChoice *w, const Config *config, bool real, int impacts)
{
    const Woods *woods = &w->woods;
    const int    trees = trees_of(woods);
    const char  *about = w->config.place_count ? "what is on the ground" : "the middle of the square";
    char         kinds[100];
    kinds_text(kinds, sizeof kinds, woods);
    choice_add(choices, "woods: %d trees%s%s%s, %d bushes and hedges, %.1f km about the %s (terrain.woods)", trees,
               *kinds ? " (" : "", kinds, *kinds ? ")" : "", woods->count - trees, 1e-3 * w->config.half_width_m,
               config->terrain.woods_half_m >= 50 ? "aim" : "exercise");
    if (woods->left_out > 0 && woods->far) /* what is chosen here holds for any distance */
        choice_add(
            choices,
            "woods: %d more, those beyond %.0f m of %s, and others farther out stand where the sensor is nearer than "
            "terrain.woods_far_m (terrain.woods_trees)",
            woods->left_out, woods->reach_m, about);
    else if (woods->left_out > 0)
        choice_add(
            choices,
            "woods: %d more are left out, those beyond %.0f m of %s: the ground there shows their canopy (terrain.woods_trees)",
            woods->left_out, woods->reach_m, about);
    if (!real)
        choice_add(choices,
                   "woods: cleared along the paths of %d entit%s on the ground, where %d shot%s hit it, and "
                   "under low flights and sights (terrain.woods)",
                   w->entities, w->entities == 1 ? "y" : "ies", impacts, impacts == 1 ? "" : "s");
    else if (w->config.store && *w->config.store)
        choice_add(choices, "woods: %d from marked trunks, %d by the canopy's height, %d by surface classes",
                   woods->from_crowns, woods->from_canopy, woods->from_classes);
    if (w->in_trunks > 0)
        choice_add(choices, "woods: %d of %d entities on the ground begin within a trunk%s (terrain.woods)",
                   w->in_trunks, w->entities, real ? "; real trees stay" : "");
    if (!config->terrain.woods_leaves) choice_add(choices, "woods: deciduous trees are bare (terrain.woods_leaves)");
}

/* ---- all of it ----------------------------------------------------------------------------------- */

Status choice_woods(WoodsChoice *out, Choices *choices, const ChoiceBasis *basis, const WoodsSquare *square,
                    const Landscape *landscape, const Culture *culture, Pool *pool)
{
    const Survey         *survey = basis->survey;
    const Config         *config = basis->config;
    const Catalog        *catalog = basis->catalog;
    const GroundEvidence *e = basis->evidence;
    const bool            stored = *config->terrain.store, real = stored || *config->terrain.elevation;
    static const double   far_half_m = 50000; /* of any distance of terrain.woods_far_m about any sensor near by */
    int                   impacts = 0;
    *out = (WoodsChoice){.on = config->terrain.woods};
    if (!out->on) return STATUS_OK;
    out->config = (WoodsConfig){.seed = (uint64_t)config->seed,
                                .centre_m = {square->centre_m[0], square->centre_m[1]},
                                .half_width_m = square->half_width_m,
                                .most_trees = config->terrain.woods_trees,
                                .far_half_m = square->own ? 0 : far_half_m,
                                .store = stored ? config->terrain.store : NULL,
                                .cache = real ? NULL : basis->cache, /* files may change and keep their names */
                                .culture = culture->index || culture->trees > 0 ? culture : NULL,
                                .follows = basis->follows};
    Paths paths = {.square = &out->config, .landscape = landscape, .placed = *config->terrain.place != 0};
    if (!real) add_known(&paths, &impacts, survey, catalog, e);
    out->path = paths.path;
    out->config.path = paths.path;
    out->config.path_count = paths.count;
    const double begun_s = wall_clock_s();
    Status       status = paths.no_memory ? STATUS_NO_MEMORY : STATUS_OK;
    if (status == STATUS_OK && !square->own) status = find_places(out, survey, e, landscape);
    if (status == STATUS_OK) status = woods_create(&out->woods, landscape, &out->config, pool);
    log_detail("woods: placed in %.0f ms, %d pieces of paths", 1e3 * (wall_clock_s() - begun_s), paths.count);
    if (status == STATUS_OK) {
        count_in_trunks(out, survey, landscape, catalog, e);
        report(choices, out, config, real, impacts);
    } else {
        log_error("woods: no plants could be placed: %s; terrain.woods=off shows bare ground, terrain.woods_trees "
                  "fewer trees",
                  status_name(status));
    }
    return status;
}

void choice_woods_free(WoodsChoice *woods)
{
    woods_destroy(&woods->woods);
    free(woods->path);
    free(woods->place);
    *woods = (WoodsChoice){0};
}
