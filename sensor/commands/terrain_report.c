/* sensor/commands/terrain_report.c: an import in words, or as JSON. */
#include "sensor/commands/terrain_report.h"

#include "sensor/publish/json_write.h"

#include <stdlib.h>
#include <sys/stat.h>

/* ---- sources --------------------------------------------------------------------------------- */

static double octets_of(const Raster *raster)
{
    double      octets = 0;
    struct stat about;
    for (int k = 0; k < raster->sheet_count; k++)
        if (stat(raster->sheet[k].path, &about) == 0) octets += (double)about.st_size;
    return octets;
}

static void print_source(const ElevationSurvey *s)
{
    const Raster *r = s->raster;
    const char   *unit, *unit_from, *datum, *datum_from;
    elevation_survey_words(&unit, &unit_from, &datum, &datum_from, s);
    log_print("%s", r->sheet[0].path);
    if (r->sheet_count > 1) log_print(" and %d more", r->sheet_count - 1);
    log_print(": %d x %d posts %.3g m apart, %s, ", r->width, r->height, fmin(r->posting_m[0], r->posting_m[1]),
              r->stated.type);
    if (octets_of(r) > 0) log_print("%.1f kB; ", 1e-3 * octets_of(r)); /* none of a file in an archive */
    log_print("%s (--srs)\n", r->stated.crs);
    if (isfinite(s->low_m)) log_print("  heights %.1f .. %.1f m", s->low_m, s->high_m);
    else log_print("  no heights");
    log_print("%s; unit %s, %s (--unit); above %s, %s (--vertical)%s\n", s->whole ? "" : " where it was looked at", unit,
              unit_from, datum, datum_from,
              r->metres_per_unit < 0 ? "; depths, turned round (FILE@up)" : "");
    if (s->voids + s->outside + s->suspect_posts > 0)
        log_print("  voids %.2g %%%s\n", 100 * (s->voids + s->outside + s->suspect_posts) / s->posts,
                  s->outside + s->suspect_posts > 0 ? ", some of them not declared (--nodata)" : "");
    if (r->bands > 1) log_print("  band %d of %d (FILE:BAND)\n", r->choice.band ? r->choice.band : 1, r->bands);
}

static json_t *pair_of(double a, double b) { return json_pack("[f, f]", a, b); }

static void add_source(json_t *list, const ElevationSurvey *s)
{
    const Raster *r = s->raster;
    const char   *unit, *unit_from, *datum, *datum_from;
    json_t       *source = json_object(), *files = json_array(), *suspects = json_array();
    elevation_survey_words(&unit, &unit_from, &datum, &datum_from, s);
    for (int k = 0; k < r->sheet_count; k++) json_array_append_new(files, json_string(r->sheet[k].path));
    for (int k = 0; k < s->suspects; k++) json_array_append_new(suspects, json_real(s->suspect[k]));
    json_object_set_new(source, "files", files);
    json_object_set_new(source, "octets", json_real(octets_of(r)));
    json_object_set_new(source, "posts", json_pack("[i, i]", r->width, r->height));
    json_object_set_new(source, "posting_m", pair_of(r->posting_m[0], r->posting_m[1]));
    json_object_set_new(source, "type", json_string(r->stated.type));
    json_object_set_new(source, "band", json_integer(r->choice.band ? r->choice.band : 1));
    json_object_set_new(source, "bands", json_integer(r->bands));
    json_object_set_new(source, "crs", json_string(r->stated.crs));
    json_object_set_new(source, "unit", json_string(unit));
    json_object_set_new(source, "unit_from", json_string(unit_from));
    json_object_set_new(source, "turned_round", json_boolean(r->metres_per_unit < 0));
    json_object_set_new(source, "above", json_string(datum));
    json_object_set_new(source, "above_from", json_string(datum_from));
    json_object_set_new(source, "looked_at", json_real(s->posts));
    set_number(source, "low_m", s->low_m);
    set_number(source, "high_m", s->high_m);
    json_object_set_new(source, "voids_declared", json_real(s->voids));
    json_object_set_new(source, "no_heights_on_earth", json_real(s->outside));
    json_object_set_new(source, "suspected_voids", suspects);
    json_object_set_new(source, "suspected_posts", json_real(s->suspect_posts));
    json_array_append_new(list, source);
}

void source_lines_add(SourceLines *lines, const ElevationSurvey *survey)
{
    if (!lines->json) print_source(survey);
    else {
        if (!lines->list) lines->list = json_array();
        add_source(lines->list, survey);
    }
}

void source_lines_free(SourceLines *lines)
{
    json_decref(lines->list);
    lines->list = NULL;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static void print_classes(const CoverReport *cover)
{
    bool shown[SURFACE_COUNT] = {false};
    for (int n = 0; n < 5; n++) { /* the five that cover most */
        int best = 0;
        for (int s = 1; s < SURFACE_COUNT; s++)
            if (!shown[s] && cover->share[s] > (best ? cover->share[best] : 0)) best = s;
        if (!best) break;
        shown[best] = true;
        log_print("%s%s %.0f %%", n ? ", " : "classes: ", surface_name((SurfaceClass)best), 100 * cover->share[best]);
    }
    if (cover->posting_m > 0)
        log_print(" (pixels %.3g m apart, table %s, %ld cells with codes it lacks)", cover->posting_m, cover->table,
                  cover->unknown);
    log_print("\n");
}

static void print_words(const char *store, const TerrainReport *r, double seconds)
{
    const ElevationReport *e = &r->elevation;
    log_print("%s: %.1f M posts, %.3g m apart over %.2f x %.2f km, from %d file%s of posts %.3g m apart\n", store,
              1e-6 * r->nx * r->ny, e->spacing_m, 1e-3 * e->width_m[0], 1e-3 * e->width_m[1], e->sheets,
              e->sheets == 1 ? "" : "s", e->posting_m);
    if (e->ellipsoidal) log_print("heights: above the ellipsoid\n");
    else log_print("heights: above the geoid, which lies %+.2f m from the ellipsoid here; converted at each post\n",
                   e->geoid_m);
    if (r->apart)
        log_print("surface model taken apart%s: bare ground %.1f %%, buildings %.1f %% (%llu), trees %.1f %% (%llu "
                  "crowns)\n",
                  r->beside ? " with the terrain model beside it" : " by its own shape", 100 * r->kind_share[0],
                  100 * r->kind_share[1], (unsigned long long)r->store.buildings, 100 * r->kind_share[2],
                  (unsigned long long)r->store.crowns);
    if (e->places > 0)
        log_print("resampling: %.3f m rms, p99 %.3f, at most %.3f against the files\n", e->error_rms_m, e->error_p99_m,
                  e->error_max_m);
    if (e->voids > 0) log_print("voids: %ld posts filled from their surroundings\n", e->voids);
    if (e->voids_coarser > 0) log_print("voids: %ld posts filled from coarser files\n", e->voids_coarser);
    log_print("quantisation: steps of %.3g mm, at most %.3g mm off\n", 1e3 * r->store.step_m[0],
              1e3 * r->store.worst_m[0]);
    if (r->apart || r->cover.posting_m > 0) print_classes(&r->cover);
    if (r->photo_posting_m > 0) log_print("photograph: pixels %.3g m apart\n", r->photo_posting_m);
    if (r->canopy_scale_m > 0) log_print("canopy height: numbers of %.2g m\n", r->canopy_scale_m);
    log_print("%.1f MB in %.1f s (levels around %.1f, posts %.1f, cover and photograph %.1f, writing %.1f)\n",
              1e-6 * (double)r->store.octets, seconds, r->seconds[0], r->seconds[1], r->seconds[2], r->seconds[3]);
}

static Status print_json(const char *store, const TerrainReport *r, double seconds, const SourceLines *lines)
{
    const ElevationReport *e = &r->elevation;
    json_t *all = json_object(), *classes = json_object();
    json_object_set_new(all, "store", json_string(store));
    if (lines->list) json_object_set(all, "sources", lines->list);
    json_object_set_new(all, "posts", json_pack("[i, i]", r->nx, r->ny));
    json_object_set_new(all, "spacing_m", json_real(e->spacing_m));
    json_object_set_new(all, "width_m", pair_of(e->width_m[0], e->width_m[1]));
    json_object_set_new(all, "ellipsoidal", json_boolean(e->ellipsoidal));
    if (!e->ellipsoidal) set_number(all, "geoid_m", e->geoid_m);
    json_object_set_new(all, "voids_filled", json_integer(e->voids));
    json_object_set_new(all, "voids_filled_from_coarser", json_integer(e->voids_coarser));
    if (e->places > 0) {
        set_number(all, "resampling_rms_m", e->error_rms_m);
        set_number(all, "resampling_p99_m", e->error_p99_m);
        set_number(all, "resampling_max_m", e->error_max_m);
    }
    set_number(all, "quantisation_max_m", r->store.worst_m[0]);
    json_object_set_new(all, "buildings", json_integer((json_int_t)r->store.buildings));
    json_object_set_new(all, "crowns", json_integer((json_int_t)r->store.crowns));
    for (int s = 1; s < SURFACE_COUNT; s++)
        if (r->cover.share[s] > 0) set_number(classes, surface_name((SurfaceClass)s), r->cover.share[s]);
    json_object_set_new(all, "classes", classes);
    if (r->cover.posting_m > 0) json_object_set_new(all, "cover_table", json_string(r->cover.table));
    json_object_set_new(all, "octets", json_integer((json_int_t)r->store.octets));
    set_number(all, "seconds", seconds);
    char        *text = json_dumps(all, JSON_INDENT(1) | JSON_REAL_PRECISION(12));
    const Status status = text ? STATUS_OK : STATUS_NO_MEMORY;
    if (text) printf("%s\n", text);
    free(text);
    json_decref(all);
    return status;
}

Status terrain_report(const char *store, const TerrainReport *r, double seconds, const SourceLines *lines)
{
    if (lines->json) return print_json(store, r, seconds, lines);
    print_words(store, r, seconds);
    return STATUS_OK;
}
