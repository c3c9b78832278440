/* sensor/node/ground_choice.c: the ground: of the files that the configuration names, or invented to fit what the
 * exercise says of it; and who is set onto it. */
#include "sensor/node/choices.h"

#include "dis/enumerations.h"
#include "entities/contact.h"
#include "terrain/landscape_import.h"

#include <stdlib.h>

/* ---- what the exercise says of it ------------------------------------------------------------- */

typedef struct Evidence {
    GroundFix *fix;
    ClearLine *line;
    int        fixes, lines, vehicles, impacts;
} Evidence;

/* Places far outside the landscape say nothing about it. */
static const double evidence_reach_m = 60000;

static void add_fix(Evidence *e, const LocalFrame *frame, const double p_ecef[3])
{
    GroundFix fix;
    enu_from_ecef(fix.p_enu, frame, p_ecef);
    if (hypot(fix.p_enu[0], fix.p_enu[1]) < evidence_reach_m) e->fix[e->fixes++] = fix;
}

static void add_line(Evidence *e, const LocalFrame *frame, const double a_ecef[3], const double b_ecef[3])
{
    ClearLine line;
    double    d[3];
    enu_from_ecef(line.a_enu, frame, a_ecef);
    enu_from_ecef(line.b_enu, frame, b_ecef);
    v3_sub(d, line.b_enu, line.a_enu);
    if (v3_length(d) < evidence_reach_m && hypot(line.a_enu[0], line.a_enu[1]) < evidence_reach_m)
        e->line[e->lines++] = line;
}

/* How far the base is below what the sender reports. */
static double base_below_m(const Catalog *catalog, const Track *track)
{
    Origin    origin;
    const int model = catalog_find(catalog, track->type, &origin, NULL);
    return origin == ORIGIN_CENTRE ? 0.5 * catalog_model(catalog, model)->height_m : 0;
}

/* A vehicle's base at its reports. */
static void add_vehicle(Evidence *e, const LocalFrame *frame, const Track *track, double below_m)
{
    for (int i = 0; i < track->count; i++) {
        const TrackPoint *point = &track->point[i];
        double            base_ecef[3];
        for (int k = 0; k < 3; k++) /* third column: body z, down */
            base_ecef[k] = point->p_ecef[k] + below_m * point->r_ecef_from_body[3 * k + 2];
        add_fix(e, frame, base_ecef);
    }
}

static void add_flight(Evidence *e, const LocalFrame *frame, const Survey *survey, const Track *track,
                       const HostPlan *plan)
{
    const Shot  *shot   = track->type.kind == dis_kind_munition ? choice_shot_of(survey, track->id) : NULL;
    const Track *target = shot ? survey_track(survey, shot->hit) : NULL;
    /* a hit that names nobody: what the host's own was found to have hit */
    if (shot && !target && shot->result == dis_result_entity_impact && dis_entity_id_compare(track->id, plan->host) == 0)
        target = survey_track(survey, plan->aim);
    for (int i = 0; i + 1 < track->count; i++)
        add_line(e, frame, track->point[i].p_ecef, track->point[i + 1].p_ecef);
    /* a shot that hit saw its target all the way */
    for (int i = 0; target && i < track->count; i++) {
        TrackPose pose;
        double    centre_ecef[3];
        track_at(&pose, target, track->point[i].t_s);
        for (int k = 0; k < 3; k++) centre_ecef[k] = pose.p_ecef[k] - pose.r_ecef_from_body[3 * k + 2];
        add_line(e, frame, track->point[i].p_ecef, centre_ecef);
    }
}

static Status gather(Evidence *e, const Survey *survey, const LocalFrame *frame, const Catalog *catalog, const HostPlan *plan)
{
    size_t points = (size_t)survey->shot_count;
    for (int i = 0; i < survey->track_count; i++) points += (size_t)survey->track[i].count;
    e->fix  = calloc(points + 1, sizeof *e->fix);
    e->line = calloc(2 * points + (size_t)survey->track_count + 1, sizeof *e->line);
    if (!e->fix || !e->line) return STATUS_NO_MEMORY;
    for (int i = 0; i < survey->track_count; i++) {
        const Track *track = &survey->track[i];
        if (choice_is_land(track)) {
            add_vehicle(e, frame, track, base_below_m(catalog, track));
            e->vehicles++;
        } else if (choice_flies(track)) {
            add_flight(e, frame, survey, track, plan);
        }
    }
    for (int i = 0; i < survey->shot_count; i++)
        if (survey->shot[i].result == dis_result_ground_impact && isfinite(survey->shot[i].detonation_s)) {
            add_fix(e, frame, survey->shot[i].p_burst_ecef);
            e->impacts++;
        }
    return STATUS_OK;
}

static Status invent(Landscape *out, Choices *choices, const Config *config, const LocalFrame *frame, const Evidence *e)
{
    LandscapeConfig land = landscape_default_config();
    land.seed     = (uint64_t)config->seed;
    land.relief_m = config->terrain.relief_m;
    if (config->terrain.spacing_m > 0) land.spacing_m = config->terrain.spacing_m;
    const Status status = landscape_create(out, &land, frame, e->fix, e->fixes, e->line, e->lines);
    if (status != STATUS_OK) {
        log_error("replay: no landscape could be made: %s", status_name(status));
        return status;
    }
    choice_add(choices, "ground: invented, fitted to %d land entities and %d ground impacts within %.2f m (terrain.*)",
               e->vehicles, e->impacts, out->fit_worst_m);
    if (out->fixes_dropped > 0)
        choice_add(choices, "ground: %d of %d places contradict others or a flight path and were left out", out->fixes_dropped,
                   e->fixes);
    return STATUS_OK;
}

/* ---- from files ------------------------------------------------------------------------------- */

static void say_cover(Choices *choices, const CoverReport *cover)
{
    char text[choice_text_size / 2] = "";
    bool said[SURFACE_COUNT] = {false};
    int  n = 0;
    for (int shown = 0; shown < 4; shown++) { /* the four that cover most */
        int best = 0;
        for (int s = 1; s < SURFACE_COUNT; s++)
            if (!said[s] && cover->share[s] > (best ? cover->share[best] : 0)) best = s;
        if (!best) break;
        said[best] = true;
        n += snprintf(text + n, sizeof text - (size_t)n, "%s%s %.0f %%", n ? ", " : "", surface_name((SurfaceClass)best),
                      100 * cover->share[best]);
        if (n >= (int)sizeof text) break;
    }
    choice_add(choices, "cover: %s (band %d, table %s)%s", text, cover->band, cover->table,
               cover->unknown > 0 ? "; codes the table lacks were taken by slope and height" : "");
}

static Status import(Landscape *out, Choices *choices, const Config *config, const LocalFrame *frame, const Evidence *e, bool fit)
{
    LandscapeReport r;
    const char *vertical = config->terrain.vertical;
    const LandscapeFiles files = {
        .elevation = {.paths = config->terrain.elevation, .geoid_path = config->terrain.geoid,
                      .vertical = strcmp(vertical, "geoid") == 0       ? ELEVATION_GEOID
                                  : strcmp(vertical, "ellipsoid") == 0 ? ELEVATION_ELLIPSOID
                                                                       : ELEVATION_BY_FILE,
                      .spacing_m = config->terrain.spacing_m,
                      .horizon_m = landscape_default_config().horizon_m},
        .cover = config->terrain.cover, .cover_table = config->terrain.cover_table, .cover_band = config->terrain.cover_band,
        .photo = config->terrain.orthophoto, .seed = (uint64_t)config->seed};
    const Status status = landscape_import(out, &r, &files, frame, e->fix, fit ? e->fixes : 0);
    if (status != STATUS_OK) return status;

    choice_add(choices, "ground: %d elevation sheet%s, posts %.3g m apart shown at %.3g m over %.1f x %.1f km (terrain.elevation, "
               "terrain.spacing_m)", r.elevation.sheets, r.elevation.sheets == 1 ? "" : "s", r.elevation.posting_m,
               r.elevation.spacing_m, 1e-3 * r.elevation.width_m[0], 1e-3 * r.elevation.width_m[1]);
    if (r.elevation.ellipsoidal)
        choice_add(choices, "ground: heights taken as above the ellipsoid%s (terrain.vertical)",
                   strcmp(vertical, "auto") == 0 ? ", as the files' CRS says" : "");
    else
        choice_add(choices, "ground: heights taken as above the geoid, which lies %+.2f m from the ellipsoid here "
                   "(terrain.vertical, terrain.geoid)", r.elevation.geoid_m);
    if (r.elevation.places > 0)
        choice_add(choices, "ground: resampling left %.2f m rms, p99 %.2f, at most %.2f; %ld void posts filled",
                   r.elevation.error_rms_m, r.elevation.error_p99_m, r.elevation.error_max_m, r.elevation.voids);
    choice_add(choices, "ground: real %s %.1f km to the nearest edge and %.1f to the farthest; then a plain at %.0f m, over %.1f km",
               r.elevation.reach_m[0] < 0 ? "data begin" : "for", 1e-3 * fabs(r.elevation.reach_m[0]), 1e-3 * r.elevation.reach_m[1],
               r.elevation.beyond_h_m, 1e-3 * r.elevation.blend_m);
    if (fit)
        choice_add(choices, "ground: led through %d land entities and %d ground impacts by a smooth correction of at most %.1f m "
                   "(terrain.ground)", e->vehicles, e->impacts, r.elevation.correction_m);
    if (*config->terrain.cover) say_cover(choices, &r.cover);
    else choice_add(choices, "cover: by slope and height, no file says what grows there (terrain.cover)");
    if (*config->terrain.orthophoto)
        choice_add(choices, "photograph: %.2g m pixels, scaled to each class's reflectance (terrain.orthophoto)", r.photo_posting_m);
    return STATUS_OK;
}

/* ---- who is set onto it ----------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* How far the senders' own places are from this ground. */
static Status say_contact(Choices *choices, bool clamp, const Landscape *landscape, const Survey *survey, const Catalog *catalog)
{
    const ContactGround ground = {.frame = &landscape->frame, .elevation = &landscape->elevation};
    size_t points = 0, count = 0;
    for (int i = 0; i < survey->track_count; i++)
        if (contact_applies(survey->track[i].type)) points += (size_t)survey->track[i].count;
    double *off_m = calloc(points + 1, sizeof *off_m), sum = 0;
    if (!off_m) return STATUS_NO_MEMORY;
    for (int i = 0; i < survey->track_count; i++) {
        const Track *track = &survey->track[i];
        if (!contact_applies(track->type)) continue;
        const double below_m = base_below_m(catalog, track);
        for (int n = 0; n < track->count; n++) {
            double base_ecef[3];
            for (int k = 0; k < 3; k++)
                base_ecef[k] = track->point[n].p_ecef[k] + below_m * track->point[n].r_ecef_from_body[3 * k + 2];
            const double above_m = contact_above_m(&ground, base_ecef);
            if (!isfinite(above_m)) continue;
            sum += above_m;
            off_m[count++] = fabs(above_m);
        }
    }
    if (count > 0) {
        qsort(off_m, count, sizeof *off_m, by_value);
        const double median_m = off_m[count / 2];
        choice_add(choices, "contact: land entities %s; they were sent %.2f m (median), at most %.1f m %s it (terrain.ground)",
                   clamp ? "are set onto the ground" : "stay where they were sent", median_m, off_m[count - 1],
                   sum > 0 ? "mostly above" : "mostly below");
        if (clamp && median_m > 20)
            choice_add(choices, "contact: the exercise was run over other ground; terrain.ground: fit leads this one through it");
    }
    free(off_m);
    return STATUS_OK;
}

Status choose_ground(Landscape *out, bool *clamp, Choices *choices, const Survey *survey, const Config *config,
                     const LocalFrame *frame, const Catalog *catalog, const HostPlan *plan)
{
    Evidence   e = {0};
    const bool real = *config->terrain.elevation, by_itself = strcmp(config->terrain.ground, "auto") == 0;
    const bool set_onto = by_itself ? real : strcmp(config->terrain.ground, "clamp") == 0;
    Status     status = gather(&e, survey, frame, catalog, plan);
    if (status == STATUS_OK)
        status = real ? import(out, choices, config, frame, &e, strcmp(config->terrain.ground, "fit") == 0)
                      : invent(out, choices, config, frame, &e);
    if (status == STATUS_OK && (real || !by_itself)) status = say_contact(choices, set_onto, out, survey, catalog);
    if (status == STATUS_OK) *clamp = set_onto;
    free(e.fix);
    free(e.line);
    return status;
}
