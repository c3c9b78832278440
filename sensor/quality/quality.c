/* sensor/quality/quality.c: the table of settings, the selection from it, and its application to the configuration. */
#include "sensor/quality/quality.h"
#include "pitviper_table.h"
#include "pitviper_output.h"

#include <errno.h>

#define FIELD(member) TABLE_AT(QualityRow, member)

static const TableColumn columns[] = {
    {"scene", TABLE_CHOICE, FIELD(scene), .choices = "bare, woods", .absent = TABLE_LATER,
     .otherwise = quality_any_scene},
    {"samples", TABLE_INT, FIELD(samples), .low = 1, .high = 16},
    {"edge_samples", TABLE_INT, FIELD(edge_samples), .low = 0, .high = 16},
    {"target_samples", TABLE_INT, FIELD(target_samples), .low = 0, .high = 256},
    {"optical_percent", TABLE_DOUBLE, FIELD(percent[0]), .low = 0, .high = 1e6},
    {"mwir_percent", TABLE_DOUBLE, FIELD(percent[1]), .low = 0, .high = 1e6},
    {"lwir_percent", TABLE_DOUBLE, FIELD(percent[2]), .low = 0, .high = 1e6},
    {"mwir_k", TABLE_DOUBLE, FIELD(kelvin[1]), .low = 0, .high = 1e6},
    {"lwir_k", TABLE_DOUBLE, FIELD(kelvin[2]), .low = 0, .high = 1e6},
    {"ms_megapixel", TABLE_DOUBLE, FIELD(ms_megapixel), .low = 1e-3, .high = 1e9},
};
enum { column_count = sizeof columns / sizeof *columns };
static const TableFormat table_format = {
    "quality",       columns,
    column_count,    .next = "`pitviper bench quality --table FILE` writes a complete table",
    .least_rows = 1, .most_rows = quality_rows_max};

static const char *const scene_names[quality_scenes] = {"bare", "woods"};

const char *quality_scene_name(QualityScene scene) { return scene_names[scene]; }

/* ---- the table -------------------------------------------------------------------------------- */

static Status take_row(void *user, const void *read, const TableRows *rows, int number)
{
    QualityTable *table = user;
    QualityRow    row = *(const QualityRow *)read;
    const bool    off = row.edge_samples == 0 && row.target_samples == 0;
    if (!off && !(row.edge_samples >= 2 && row.target_samples >= 8))
        return table_rows_refuse(rows, number, NULL,
                                 "edge_samples %d and target_samples %d: both 0, or 2 .. 16 and 8 .. 256",
                                 row.edge_samples, row.target_samples);
    row.kelvin[0] = NAN;
    table->row[table->count++] = row;
    return STATUS_OK;
}

static bool holds_in(const QualityRow *r, QualityScene scene)
{
    return r->scene == scene || r->scene == quality_any_scene || scene == quality_any_scene;
}

/* NULL: it has none. */
static const QualityRow *fastest(const QualityTable *table, QualityScene scene)
{
    const QualityRow *best = NULL;
    for (int k = 0; k < table->count; k++) {
        const QualityRow *r = &table->row[k];
        if (holds_in(r, scene) && (!best || r->ms_megapixel < best->ms_megapixel)) best = r;
    }
    return best;
}

Status quality_open(QualityTable *out, const char *path)
{
    QualityRow row;
    out->count = 0;
    const Status status = table_each(&table_format, path, &row, sizeof row, take_row, out);
    for (int k = 0; k < quality_scenes && status == STATUS_OK; k++) {
        if (fastest(out, (QualityScene)k)) continue;
        log_error("quality: %s: no row of scene `%s`; %s", path, scene_names[k], table_format.next);
        return STATUS_BAD_VALUE;
    }
    return status;
}

Status quality_write(const char *path, const QualityTable *table, const char *comment)
{
    FILE      *file = output_begin(path, OUTPUT_STREAM);
    bool       ok = file != NULL;
    const bool scenes = table->count > 0 && table->row[0].scene != quality_any_scene; /* else none has one */
    ok = ok && fprintf(file, "# %s\n%s", comment, scenes ? "scene," : "") > 0;
    for (int c = 1; ok && c < column_count; c++)
        ok = fprintf(file, "%s%s", columns[c].name, c + 1 < column_count ? "," : "\n") > 0;
    for (int k = 0; ok && k < table->count; k++) {
        const QualityRow *r = &table->row[k];
        if (scenes) ok = fprintf(file, "%s,", scene_names[r->scene]) > 0;
        ok = ok &&
             fprintf(file, "%d,%d,%d,%.3g,%.3g,%.3g,%.3g,%.3g,%.4g\n", r->samples, r->edge_samples, r->target_samples,
                     r->percent[0], r->percent[1], r->percent[2], r->kelvin[1], r->kelvin[2], r->ms_megapixel) > 0;
    }
    if (file && ok) ok = output_end(file, path);
    else if (file) output_abandon(file, path);
    if (!ok) log_error("quality: cannot write %s: %s", path, output_reason(errno));
    return ok ? STATUS_OK : STATUS_IO;
}

/* ---- the selection --------------------------------------------------------------------------------- */

static double frame_ms(const QualityRow *r, const QualityTarget *t)
{
    return r->ms_megapixel * t->megapixels * t->machine_factor;
}

static double worst(const double *value, unsigned bands, int first)
{
    double most = 0;
    for (int b = first; b < quality_bands; b++)
        if (bands >> b & 1) most = fmax(most, value[b]);
    return most;
}

/* Ratio of errors to their targets, at least 1; without a target the error itself, so that smaller is better. */
static double excess(const QualityRow *r, const QualityTarget *t)
{
    const double percent = worst(r->percent, t->bands, BAND_OPTICAL), kelvin = worst(r->kelvin, t->bands, BAND_MWIR);
    if (isnan(t->percent) && isnan(t->kelvin)) return percent;
    double over = 1;
    if (t->percent > 0) over = fmax(over, percent / t->percent);
    if (t->kelvin > 0) over = fmax(over, kelvin / t->kelvin);
    return over;
}

int quality_pick(bool *reached, const QualityTable *table, const QualityTarget *target)
{
    const bool errors = !isnan(target->percent) || !isnan(target->kelvin);
    int        best = -1;
    bool       best_in_time = false;
    for (int k = 0; k < table->count; k++) {
        const QualityRow *r = &table->row[k], *b = best >= 0 ? &table->row[best] : NULL;
        if (!holds_in(r, target->scene)) continue;
        const bool in_time = isnan(target->frame_ms) || frame_ms(r, target) <= target->frame_ms;
        bool       better = !b || (in_time && !best_in_time);
        if (b && in_time == best_in_time) {
            const double mine = excess(r, target), others = excess(b, target);
            better = !in_time ? frame_ms(r, target) < frame_ms(b, target) /* none within frame_ms: the fastest */
                              : mine < others || (mine == others && frame_ms(r, target) < frame_ms(b, target));
        }
        if (better) best = k, best_in_time = in_time;
    }
    *reached = best >= 0 && best_in_time && (!errors || excess(&table->row[best], target) <= 1);
    return best;
}

bool quality_wanted(const QualityTable *table, int row)
{
    const QualityRow *r = &table->row[row];
    for (unsigned bands = 1; bands < 1u << quality_bands; bands++) {
        /* the tightest targets of this row: a faster row that meets them is better in all */
        const QualityTarget target = {
            worst(r->percent, bands, BAND_OPTICAL), worst(r->kelvin, bands, BAND_MWIR), NAN, 1, 1, bands, r->scene};
        bool quicker = false;
        for (int k = 0; k < table->count; k++) {
            const QualityRow *q = &table->row[k];
            const bool first = q->ms_megapixel < r->ms_megapixel || (q->ms_megapixel == r->ms_megapixel && k < row);
            quicker |= k != row && first && holds_in(q, r->scene) &&
                       worst(q->percent, bands, BAND_OPTICAL) <= target.percent &&
                       worst(q->kelvin, bands, BAND_MWIR) <= target.kelvin;
        }
        if (!quicker) return true;
    }
    return false;
}

/* ---- the configuration ------------------------------------------------------------------------ */

static bool asks(const Config *c)
{
    return !isnan(c->quality.radiance_rmse_percent) || !isnan(c->quality.temperature_rms_k) ||
           !isnan(c->quality.frame_ms);
}

bool quality_wants_factor(const Config *config)
{
    return !isnan(config->quality.frame_ms) && !config_given(config, "quality.machine_factor");
}

static void add(char *text, size_t size, const char *format, double value)
{
    const size_t n = strlen(text);
    if (!isnan(value)) snprintf(text + n, size - n, format, value);
}

static void take(char *kept, size_t size, int *to, int value, const Config *config, const char *key)
{
    if (!config_given(config, key)) *to = value;
    else snprintf(kept + strlen(kept), size - strlen(kept), "; %s as given", key);
}

static bool has_plants(const Config *config) { return config->terrain.woods && config->terrain.woods_trees > 0; }

Status quality_choose(Config *config, Choices *choices, unsigned bands)
{
    QualityTable table;
    char         path[512], wants[80] = "", kept[128] = "", k_text[32] = "";
    bool         reached;
    if (!asks(config)) return STATUS_OK;
    const bool given = *config->quality.table;
    if (!given && !etc_path(path, sizeof path, "quality.csv")) return STATUS_BAD_VALUE;
    const Status status = quality_open(&table, given ? config->quality.table : path);
    if (status != STATUS_OK) return status;
    const QualityTarget target = {config->quality.radiance_rmse_percent,
                                  config->quality.temperature_rms_k,
                                  config->quality.frame_ms,
                                  1e-6 * config->sensor.width_px * config->sensor.height_px,
                                  config->quality.machine_factor,
                                  bands,
                                  has_plants(config) ? QUALITY_WOODS : QUALITY_BARE};
    const QualityRow   *r = &table.row[quality_pick(&reached, &table, &target)];
    take(kept, sizeof kept, &config->sensor.samples, r->samples, config, "sensor.samples");
    if (r->edge_samples > 0) {
        take(kept, sizeof kept, &config->sensor.edge_samples, r->edge_samples, config, "sensor.edge_samples");
        take(kept, sizeof kept, &config->sensor.target_samples, r->target_samples, config, "sensor.target_samples");
    }
    if (!config_given(config, "sensor.antialias"))
        config->sensor.antialias = r->edge_samples > 0 ? ANTIALIAS_ADAPTIVE : ANTIALIAS_OFF;
    add(wants, sizeof wants, " %g %% rmse", target.percent);
    add(wants, sizeof wants, " %g K rms", target.kelvin);
    add(wants, sizeof wants, " %g ms", target.frame_ms);
    if (bands & (1u << BAND_MWIR | 1u << BAND_LWIR))
        add(k_text, sizeof k_text, ", %.2g K", worst(r->kelvin, bands, BAND_MWIR));
    char grids[64] = "";
    if (r->edge_samples > 0)
        snprintf(grids, sizeof grids, ", edge_samples %d, target_samples %d", r->edge_samples, r->target_samples);
    const char *where = target.scene == QUALITY_WOODS ? "in woods" : "on bare ground";
    choice_add(choices, "quality: samples %d%s for%s%s (%s: at most %.2g %%%s; %.3g ms, %.2g x the fastest)%s",
               r->samples, grids, wants, reached ? "" : ": NOT reached, the closest",
               r->scene == quality_any_scene ? "table without scenes" : where, worst(r->percent, bands, BAND_OPTICAL),
               k_text, frame_ms(r, &target), r->ms_megapixel / fastest(&table, target.scene)->ms_megapixel, kept);
    if (!reached)
        log_warn("quality: no row of the table meets%s; the closest is used (`pitviper bench quality` lists them)",
                 wants);
    return STATUS_OK;
}
