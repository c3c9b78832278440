/* sensor/node/choices/ground_choice.c: the ground: a terrain store, the files that the configuration names, or
 * synthetic terrain fitted to the positions in the exercise; and the entities clamped to it. */
#include "sensor/node/choices/choices.h"

#include "entities/table/contact.h"
#include "sensor/node/choices/ground_evidence_private.h"
#include "terrain/elevation/raster.h"
#include "terrain/import/terrain_import.h"
#include "terrain/from_files/elevation_import.h"
#include "terrain/ground/placed.h"
#include "terrain/store/store.h"

#include <stdlib.h>
#include <unistd.h>

/* ---- a terrain store: made again where it is old ---------------------------------------------------- */

/* Makes a store again that cannot be used, but still has the options that it was made with. */
static Status made_again(TerrainStore *store, const char *path, const char *why)
{
    char *options = store_recall(path);
    if (!options) {
        log_error("terrain.store: %s cannot be used: %s; make it again with `pitviper terrain import`", path, why);
        return STATUS_BAD_VALUE;
    }
    char outside[1024];
    if (terrain_store_foreign(outside, sizeof outside, path, options)) {
        log_error(
            "terrain.store: %s cannot be used: %s; it was made of %s, outside its own folder: where you trust that, "
            "`pitviper terrain again %s` makes it again",
            path, why, outside, path);
        free(options);
        return STATUS_BAD_VALUE;
    }
    log_print("ground: %s cannot be used: %s; it is made again with the options that it was made with\n", path, why);
    Status status = terrain_store_rebuild(path, options, false);
    free(options);
    if (status == STATUS_OK) return store_open(store, path);
    log_error("terrain.store: %s cannot be used: %s, nor made again; run `pitviper terrain import` with sources that "
              "are here",
              path, why);
    return status;
}

static const char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Opens the store, which is made again before where its sources have changed. */
static Status open_fresh(TerrainStore *store, Choices *choices, const char *path)
{
    char        which[1024], outside[1024];
    const char *why;
    Status      status = store_open_why(store, &why, path);
    if (status == STATUS_BAD_VALUE || status == STATUS_UNSUPPORTED) return made_again(store, path, why);
    if (status != STATUS_OK) {
        log_error("terrain.store: cannot open %s: %s; `pitviper terrain import` makes a terrain store", path, why);
        return status;
    }
    switch (store_sources(store, which, sizeof which)) {
    case STORE_FRESH:
        return STATUS_OK;
    case STORE_SOURCES_MISSING:
        choice_add(choices, "ground: the terrain store is used as it is: %s, of which it was made, is not here", which);
        return STATUS_OK;
    case STORE_CHANGED:
        break;
    }
    if (terrain_store_foreign(outside, sizeof outside, path, store->options)) {
        choice_add(choices,
                   "ground: the terrain store is used as it is: %.50s has changed, but %.50s lies outside the store's "
                   "own folder (`pitviper terrain again`)",
                   name_of(which), name_of(outside));
        return STATUS_OK;
    }
    log_print("ground: %s has changed since %s was made of it (%s); it is made again\n", which, path, store->made);
    status = terrain_store_rebuild(path, store->options, false);
    store_close(store);
    return status == STATUS_OK ? store_open(store, path) : status;
}

/* ---- a terrain store: whether it is of this place --------------------------------------------------- */

static Status on_its_ground(const TerrainStore *store, const double p_ecef[3], const char *path)
{
    const ElevationLevel *wide = &store->elevation.level[store->elevation.level_count - 1];
    double                p_enu[3];
    Geodetic              aim = {0};
    enu_from_ecef(p_enu, &store->frame, p_ecef);
    const double x = (p_enu[0] - wide->x0_m) / wide->spacing_m, y = (p_enu[1] - wide->y0_m) / wide->spacing_m;
    /* a place on the Earth's other side has small x and y, and a z far below */
    if (x >= 0 && y >= 0 && x <= wide->nx - 1 && y <= wide->ny - 1 && fabs(p_enu[2]) < 1e6) return STATUS_OK;
    geodetic_from_ecef(&aim, p_ecef);
    log_error("terrain.store: %s has the ground about %.4f N, %.4f E; the exercise is at %.4f N, %.4f E, %.0f km away: "
              "name the store of that place, or leave it out for synthetic terrain",
              path, store->frame.origin.lat_rad / rad_per_deg, store->frame.origin.lon_rad / rad_per_deg,
              aim.lat_rad / rad_per_deg, aim.lon_rad / rad_per_deg, 1e-3 * v3_length(p_enu));
    return STATUS_BAD_VALUE;
}

Status choice_store_frame(LocalFrame *out, Choices *choices, const Config *config, const double p_ecef[3])
{
    TerrainStore store;
    const char  *path = config->terrain.store;
    Status       status = open_fresh(&store, choices, path);
    if (status != STATUS_OK) return status;
    status = on_its_ground(&store, p_ecef, path);
    *out = store.frame;
    store_close(&store);
    return status;
}

/* ---- a terrain store: what it has ------------------------------------------------------------------- */

static void report_store(Choices *choices, const TerrainStore *store, const char *path)
{
    const ElevationLevel *fine = &store->elevation.level[0];
    const char           *name = strrchr(path, '/');
    choice_add(choices,
               "ground: terrain store %s, %.3g m posts shown at %.3g m over %.1f x %.1f km, %.0f MB (terrain.store)",
               name ? name + 1 : path, store->posting_m, fine->spacing_m, 1e-3 * (fine->nx - 1) * fine->spacing_m,
               1e-3 * (fine->ny - 1) * fine->spacing_m, 1e-6 * (double)store->octets);
    if (*store->vertical_datum) choice_add(choices, "ground: heights from %s", store->vertical_datum);
    if (store->crown_count || store->building_count)
        choice_add(choices, "ground: %llu trees were taken off it, %llu buildings stand on it",
                   (unsigned long long)store->crown_count, (unsigned long long)store->building_count);
    if (store->surface[0].nx) choice_add(choices, "cover: %.3g m classes of the store", store->surface[0].cell_m);
    else choice_add(choices, "cover: by slope and height, the store has no classes");
    if (store->photo.mips)
        choice_add(choices, "photograph: %.2g m pixels of the store, scaled to each class's reflectance",
                   store->photo.cell_m);
}

/* Opens the store's landscape, and reports what is in it as choices. */
static Status open_store(Landscape *out, Choices *choices, const Config *config)
{
    TerrainStore store;
    const char  *path = config->terrain.store;
    Status       status = store_open(&store, path);
    if (status != STATUS_OK) return status;
    report_store(choices, &store, path);
    store_close(&store);
    return store_open_landscape(out, path, (uint64_t)config->seed);
}

/* ---- synthetic -------------------------------------------------------------------------------------- */

static int on_land(const GroundEvidence *e) { return e->count[STANCE_GROUND] + e->count[STANCE_LANDED]; }

static void report_sea(Choices *choices, const GroundEvidence *e)
{
    const int afloat = e->count[STANCE_AFLOAT], submerged = e->count[STANCE_SUBMERGED];
    if (afloat + submerged == 0) return;
    choice_add(choices, "sea: flat at %.1f m above the ellipsoid, where %d ship%s or submarine%s; %s",
               round(10 * e->said.sea_h_m) / 10 + 0.0 /* no -0.0 */, afloat + submerged,
               afloat + submerged == 1 ? "" : "s", afloat + submerged == 1 ? " was" : "s were",
               on_land(e) ? "a shore half-way to what is on land" : "to the horizon, nothing is on land");
    if (submerged)
        choice_add(choices, "sea: %d submarine%s under water and cannot be seen: the water is opaque", submerged,
                   submerged == 1 ? " is" : "s are");
}

/* Reports the fit. misfits: entities whose positions are inconsistent with it, which are not counted as fitted. */
static void report_synthetic(Choices *choices, const Landscape *landscape, const GroundEvidence *e, int misfits)
{
    const int fitted = on_land(e) - misfits;
    if (fitted == 0 && e->impacts == 0)
        choice_add(choices, "ground: invented, nothing is known to stand on it (terrain.*)");
    else
        choice_add(choices,
                   "ground: invented, fitted to %d land entit%s and %d ground impact%s within %.2f m (terrain.*)",
                   fitted, fitted == 1 ? "y" : "ies", e->impacts, e->impacts == 1 ? "" : "s", landscape->fit_worst_m);
    report_sea(choices, e);
    if (landscape->fixes_dropped > 0)
        choice_add(choices, "ground: %d of %d places contradict others or a flight path and were left out",
                   landscape->fixes_dropped, e->said.fix_count);
}

static LandscapeConfig land_of(const Config *config)
{
    LandscapeConfig land = landscape_default_config();
    land.seed = (uint64_t)config->seed;
    land.relief_m = config->terrain.relief_m;
    if (config->terrain.spacing_m > 0) land.spacing_m = config->terrain.spacing_m;
    return land;
}

static Status invent(Landscape *out, const ChoiceBasis *basis, const LocalFrame *frame)
{
    const LandscapeConfig land = land_of(basis->config);
    const Status          status = landscape_create_kept(out, &land, frame, &basis->evidence->said, basis->cache);
    if (status != STATUS_OK) log_error("replay: no landscape could be made: %s", status_name(status));
    return status;
}

Status choice_placed_ground(Landscape *out, const Config *config, Cache *cache)
{
    const LandscapeConfig land = land_of(config);
    Geodetic              place;
    Status                status = STATUS_BAD_VALUE;
    if (landscape_place_parse(&place, config->terrain.place)) status = landscape_placed(out, &land, &place, cache);
    if (status != STATUS_OK) log_error("replay: no landscape could be made: %s", status_name(status));
    return status;
}

/* ---- from files ------------------------------------------------------------------------------------- */

static void report_cover(Choices *choices, const CoverReport *cover)
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
        n += snprintf(text + n, sizeof text - (size_t)n, "%s%s %.0f %%", n ? ", " : "",
                      surface_name((SurfaceClass)best), 100 * cover->share[best]);
        if (n >= (int)sizeof text) break;
    }
    choice_add(choices, "cover: %s (band %d, table %s)%s", text, cover->band, cover->table,
               cover->unknown > 0 ? "; codes the table lacks were taken by slope and height" : "");
}

static Status import(Landscape *out, Choices *choices, const Config *config, const LocalFrame *frame,
                     const GroundEvidence *e, bool fit)
{
    static const ElevationVertical vertical[] = {[TERRAIN_VERTICAL_AUTO] = ELEVATION_BY_FILE,
                                                 [TERRAIN_VERTICAL_GEOID] = ELEVATION_GEOID,
                                                 [TERRAIN_VERTICAL_ELLIPSOID] = ELEVATION_ELLIPSOID};
    LandscapeReport                r;
    const LandscapeFiles           files = {.elevation = {.paths = config->terrain.elevation,
                                                          .geoid_path = config->terrain.geoid,
                                                          .vertical = vertical[config->terrain.vertical],
                                                          .spacing_m = config->terrain.spacing_m,
                                                          .horizon_m = landscape_default_config().horizon_m},
                                            .cover = config->terrain.cover,
                                            .cover_table = config->terrain.cover_table,
                                            .cover_band = config->terrain.cover_band,
                                            .photo = config->terrain.orthophoto,
                                            .seed = (uint64_t)config->seed};
    raster_sources_from(config->terrain.sources_from);
    const Status status = landscape_import(out, &r, &files, frame, e->fix, fit ? e->said.fix_count : 0);
    if (status != STATUS_OK) return status;

    choice_add(
        choices,
        "ground: %d elevation sheet%s, posts %.3g m apart shown at %.3g m over %.1f x %.1f km (terrain.elevation, "
        "terrain.spacing_m)",
        r.elevation.sheets, r.elevation.sheets == 1 ? "" : "s", r.elevation.posting_m, r.elevation.spacing_m,
        1e-3 * r.elevation.width_m[0], 1e-3 * r.elevation.width_m[1]);
    if (r.elevation.ellipsoidal)
        choice_add(choices, "ground: heights taken as above the ellipsoid%s (terrain.vertical)",
                   config->terrain.vertical == TERRAIN_VERTICAL_AUTO ? ", as the files' CRS says" : "");
    else
        choice_add(choices,
                   "ground: heights taken as above the geoid, which lies %+.2f m from the ellipsoid here "
                   "(terrain.vertical, terrain.geoid)",
                   r.elevation.geoid_m);
    if (r.elevation.places > 0)
        choice_add(choices, "ground: resampling left %.2f m rms, p99 %.2f, at most %.2f; %ld void posts filled",
                   r.elevation.error_rms_m, r.elevation.error_p99_m, r.elevation.error_max_m, r.elevation.voids);
    choice_add(
        choices,
        "ground: real %s %.1f km to the nearest edge and %.1f to the farthest; then a plain at %.0f m, over %.1f km",
        r.elevation.reach_m[0] < 0 ? "data begin" : "for", 1e-3 * fabs(r.elevation.reach_m[0]),
        1e-3 * r.elevation.reach_m[1], r.elevation.beyond_h_m, 1e-3 * r.elevation.blend_m);
    if (fit)
        choice_add(
            choices,
            "ground: led through %d land entities and %d ground impacts by a smooth correction of at most %.1f m "
            "(terrain.ground)",
            on_land(e), e->impacts, r.elevation.correction_m);
    if (*config->terrain.cover) report_cover(choices, &r.cover);
    else choice_add(choices, "cover: by slope and height, no file says what grows there (terrain.cover)");
    if (*config->terrain.orthophoto)
        choice_add(choices, "photograph: %.2g m pixels, scaled to each class's reflectance (terrain.orthophoto)",
                   r.photo_posting_m);
    return STATUS_OK;
}

/* ---- clamped entities ------------------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Reports how far the reported positions are from this ground. */
static Status report_contact(Choices *choices, bool clamp, const Landscape *landscape, const Survey *survey,
                             const GroundEvidence *e)
{
    const ContactGround ground = {.frame = &landscape->frame, .elevation = &landscape->elevation};
    size_t              points = 0, count = 0;
    for (int i = 0; i < survey->track_count; i++)
        if (contact_applies(survey->track[i].type)) points += (size_t)survey->track[i].count;
    double *off_m = calloc(points + 1, sizeof *off_m), sum = 0;
    if (!off_m) return STATUS_NO_MEMORY;
    for (int i = 0; i < survey->track_count; i++) {
        const Track *track = &survey->track[i];
        if (!contact_applies(track->type)) continue;
        for (int n = 0; n < track->count; n++) {
            double base_ecef[3];
            ground_evidence_base(base_ecef, &track->point[n], e->below_m[i]);
            const double above_m = contact_above_m(&ground, base_ecef);
            if (!isfinite(above_m)) continue;
            sum += above_m;
            off_m[count++] = fabs(above_m);
        }
    }
    if (count > 0) {
        qsort(off_m, count, sizeof *off_m, by_value);
        const double median_m = off_m[count / 2];
        choice_add(choices,
                   "contact: land entities %s; they were sent %.2f m (median), at most %.1f m %s it (terrain.ground)",
                   clamp ? "are set onto the ground" : "stay where they were sent", median_m, off_m[count - 1],
                   sum > 0 ? "mostly above" : "mostly below");
        if (clamp && median_m > 20)
            choice_add(
                choices,
                "contact: the exercise was run over other ground; terrain.ground: fit leads this one through it");
    }
    free(off_m);
    return STATUS_OK;
}

typedef struct InconsistentPosition {
    int    track;
    double above_m;
} InconsistentPosition;

static int worst_first(const void *pa, const void *pb)
{
    const InconsistentPosition *a = pa, *b = pb;
    const double                x = fabs(a->above_m), y = fabs(b->above_m);
    if (x != y) return x > y ? -1 : 1;
    return (a->track > b->track) - (a->track < b->track);
}

/* Finds the entity whose report is farthest from this ground, or from its sea. */
static double farthest_m(const ContactGround *ground, const Track *track, const GroundEvidence *e, int t)
{
    double farthest = 0;
    for (int n = 0; n < track->count; n++) {
        double base_ecef[3];
        if (e->stance[t] == STANCE_GROUND && !e->fixed[e->first[t] + (size_t)n]) continue; /* carried, falling */
        ground_evidence_base(base_ecef, &track->point[n], e->below_m[t]);
        const double above_m = contact_above_m(ground, base_ecef);
        if (fabs(above_m) > fabs(farthest)) farthest = above_m;
    }
    return farthest;
}

/* Reports the synthetic terrain and the entities that are on it only because they are clamped, the worst by name. */
static Status report_fit(Choices *choices, GroundContact contact, const Landscape *landscape, const Survey *survey,
                         const GroundEvidence *e)
{
    enum { most_named = 3 };
    const ContactGround   ground = {.frame = &landscape->frame, .elevation = &landscape->elevation};
    InconsistentPosition *misfit = calloc((size_t)survey->track_count + 1, sizeof *misfit);
    int                   count = 0, n = 0, on_ground = 0;
    char                  text[choice_text_size / 2] = "";
    if (!misfit) return STATUS_NO_MEMORY;
    for (int t = 0; t < survey->track_count; t++) {
        const Track *track = &survey->track[t];
        if (!(e->stance[t] == STANCE_GROUND && contact_applies(track->type)) &&
            !(e->stance[t] == STANCE_AFLOAT && contact_floats(track->type)))
            continue;
        const double above_m = farthest_m(&ground, track, e, t);
        if (!(contact_share(track->type, above_m) > 0.5)) continue;
        misfit[count++] = (InconsistentPosition){t, above_m};
        on_ground += e->stance[t] == STANCE_GROUND;
    }
    report_synthetic(choices, landscape, e, on_ground);
    if (count > 1) qsort(misfit, (size_t)count, sizeof *misfit, worst_first);
    for (int k = 0; k < count && k < most_named; k++) {
        const Track *track = &survey->track[misfit[k].track];
        char         id[dis_id_text_size], marking[48];
        dis_entity_id_text(id, track->id);
        text_escape(marking, sizeof marking, track->marking, strnlen(track->marking, 11));
        n += snprintf(text + n, sizeof text - (size_t)n, "%s%s%s%s, sent %.1f m %s it", k ? "; " : "", id,
                      *marking ? " " : "", marking, fabs(misfit[k].above_m), misfit[k].above_m < 0 ? "under" : "above");
        if (n >= (int)sizeof text) break;
    }
    const char *what = contact == GROUND_CONTACT_NONE ? (count == 1 ? "stays off it" : "stay off it")
                       : count == 1                   ? "is set onto it"
                                                      : "are set onto it";
    if (count && contact != GROUND_CONTACT_ALL)
        choice_add(choices, "ground: %d %s not fit it and %s: %s%s (terrain.ground)", count,
                   count == 1 ? "entity does" : "entities do", what, text, count > most_named ? " ..." : "");
    free(misfit);
    return STATUS_OK;
}

void choice_report_submerged(Choices *choices, const Survey *survey, const GroundEvidence *e, const HostPlan *plan)
{
    char         id[dis_id_text_size];
    const Track *aim = survey_track(survey, plan->aim);
    if (!aim || e->stance[aim - survey->track] != STANCE_SUBMERGED) return;
    dis_entity_id_text(id, plan->aim);
    choice_add(choices, "aim: %s is under water, so pictures show the sea above it; exercise.aim=ID looks at another%s",
               id, dis_entity_id_is_none(plan->host) ? ", --host ID rides on one" : "");
}

/* ---- the choice ------------------------------------------------------------------------------------- */

Status choice_ground(Landscape *out, GroundContact *contact, Choices *choices, const ChoiceBasis *basis,
                     const LocalFrame *frame)
{
    const Survey         *survey = basis->survey;
    const Config         *config = basis->config;
    const GroundEvidence *e = basis->evidence;
    enum TerrainGround    said = config->terrain.ground;
    const bool            stored = *config->terrain.store, real = stored || *config->terrain.elevation;
    const bool            by_itself = said == TERRAIN_GROUND_AUTO;
    const GroundContact   fitted = said == TERRAIN_GROUND_TRUST ? GROUND_CONTACT_NONE : GROUND_CONTACT_INCONSISTENT;
    const GroundContact   set = said == TERRAIN_GROUND_CLAMP || (by_itself && real) ? GROUND_CONTACT_ALL
                                : real                                              ? GROUND_CONTACT_NONE
                                                                                    : fitted;
    Status                status = stored ? open_store(out, choices, config)
                                   : real ? import(out, choices, config, frame, e, said == TERRAIN_GROUND_FIT)
                                          : invent(out, basis, frame);
    if (status == STATUS_OK && !real) status = report_fit(choices, set, out, survey, e);
    if (status == STATUS_OK && (real || set == GROUND_CONTACT_ALL))
        status = report_contact(choices, set == GROUND_CONTACT_ALL, out, survey, e);
    if (status == STATUS_OK) *contact = set;
    return status;
}

Status choice_placed_contact(GroundContact *contact, Choices *choices, const ChoiceBasis *basis,
                             const Landscape *landscape)
{
    const Config *config = basis->config;
    *contact = config->terrain.ground == TERRAIN_GROUND_TRUST ? GROUND_CONTACT_NONE : GROUND_CONTACT_ALL;
    choice_add(choices, "ground: invented by seed %lld and place %s, whatever the exercise (terrain.place, seed)",
               config->seed, config->terrain.place);
    report_sea(choices, basis->evidence);
    return report_contact(choices, *contact == GROUND_CONTACT_ALL, landscape, basis->survey, basis->evidence);
}
