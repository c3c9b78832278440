/* sensor/commands/rcs/rcs_sweep.c: computes a target's fields over aspect and frequency; their table and polar plot. */
#include "sensor/commands/rcs/rcs_private.h"

#include "sensor/publish/files/svg_plot.h"

#include <stdlib.h>

enum { checked_looks = 8 }; /* those computed with another grid of tubes as well */

double rcs_look_deg(const RcsConfig *config, int look) { return config->from_deg + look * config->step_deg; }

const char *rcs_target_name(const RcsSweep *sweep)
{
    return sweep->given ? sweep->config.name : sweep->model.model.name;
}

static double highest_hz(const RcsConfig *config)
{
    double highest = 0;
    for (int f = 0; f < config->frequencies; f++) highest = fmax(highest, config->frequency_hz[f]);
    return highest;
}

/* Lists the names of the joints, for a message. */
static void list_joints(char *text, size_t size, const Model *model)
{
    size_t at = 0;
    *text = 0;
    for (int n = 0; n < model->node_count && at < size; n++)
        if (model->node[n].joint != JOINT_FIXED)
            at += (size_t)snprintf(text + at, size - at, "%s%s", at ? ", " : "", model->node[n].name);
}

static Status set_joint(double *value, const Model *model, const RcsJoint *joint)
{
    char list[512];
    for (int n = 0; n < model->node_count; n++) {
        const ModelNode *node = &model->node[n];
        if (node->joint == JOINT_FIXED || strcmp(node->name, joint->name) != 0) continue;
        const double scale = node->joint == JOINT_ROTATION ? rad_per_deg : 1;
        value[n] = joint->value * scale;
        if (node->low <= node->high && !(value[n] >= node->low && value[n] <= node->high)) {
            log_error("rcs: --joint %s: %g is outside its limits, %g .. %g", joint->name, joint->value,
                      node->low / scale, node->high / scale);
            return STATUS_BAD_VALUE;
        }
        return STATUS_OK;
    }
    list_joints(list, sizeof list, model);
    log_error("rcs: --joint: %s has no joint %s; it has %s", model->name, joint->name, *list ? list : "none");
    return STATUS_BAD_VALUE;
}

static Status pose(RcsSweep *sweep)
{
    const Model *model = &sweep->model.model;
    double      *value = calloc((size_t)model->node_count + 1, sizeof *value);
    NodePose    *at = calloc((size_t)model->node_count + 1, sizeof *at);
    Status       status = value && at ? STATUS_OK : STATUS_NO_MEMORY;
    for (int j = 0; j < sweep->config.joints && status == STATUS_OK; j++)
        status = set_joint(value, model, &sweep->config.joint[j]);
    if (status == STATUS_OK) {
        model_pose(at, model, value);
        radar_target_pose(sweep->model.target, sweep->config.joints > 0 ? at : NULL, 0);
    }
    free(value);
    free(at);
    return status;
}

Status rcs_sweep_open(RcsSweep *out, const RcsConfig *config)
{
    const double highest = highest_hz(config);
    *out = (RcsSweep){.config = *config, .tubes = tubes_default_config(highest), .grid_db = NAN};
    if (config->rays_per_wavelength > 0) {
        out->tubes.rays_per_radius *= config->rays_per_wavelength / out->tubes.rays_per_wavelength;
        out->tubes.rays_per_wavelength = config->rays_per_wavelength;
    }
    if (config->splits >= 0) out->tubes.splits = config->splits;
    out->tubes.warp_m = config->warp_mm * 1e-3;
    out->tubes.polygon_faces = config->no_polygons ? 0 : polygon_faces_few;
    const char *given = given_signature_path(config->name);
    Status      status = radar_materials_load(&out->materials);
    if (status == STATUS_OK && given) status = given_signature_open(&out->given, given);
    else if (status == STATUS_OK)
        status = radar_model_open(&out->model, config->name, &out->materials, radar_sag_m(highest));
    if (status == STATUS_OK) status = pool_create(&out->pool, thread_processors());
    if (status == STATUS_OK) {
        out->s = calloc((size_t)config->looks * (size_t)config->frequencies, sizeof *out->s);
        if (!out->s) status = STATUS_NO_MEMORY;
    }
    if (status == STATUS_OK && !given) status = pose(out);
    if (status != STATUS_OK) rcs_sweep_close(out);
    return status;
}

void rcs_sweep_close(RcsSweep *sweep)
{
    total_field_free(&sweep->field);
    pool_destroy(sweep->pool);
    radar_model_close(&sweep->model);
    given_signature_close(sweep->given);
    radar_materials_close(&sweep->materials);
    free(sweep->s);
    *sweep = (RcsSweep){0};
}

static void look_up(ScatterMatrix *s, RcsSweep *sweep, const ScatterAntenna *antenna)
{
    for (int f = 0; f < sweep->config.frequencies; f++) {
        sweep->unknown += !given_signature_knows(sweep->given, antenna, sweep->config.frequency_hz[f]);
        given_signature_field(&s[f], sweep->given, antenna, sweep->config.frequency_hz[f]);
    }
}

static Status look_at(ScatterMatrix *s, RcsSweep *sweep, int look, uint64_t seed)
{
    ScatterAntenna antenna;
    TubeConfig     tubes = sweep->tubes;
    tubes.seed = seed;
    radar_look(&antenna, rcs_look_deg(&sweep->config, look) * rad_per_deg, sweep->config.elevation_deg * rad_per_deg,
               sweep->config.range_m);
    if (sweep->given) {
        look_up(s, sweep, &antenna);
        return STATUS_OK;
    }
    Status status = total_field_trace(&sweep->field, sweep->model.target, &antenna, &antenna, &tubes,
                                      !sweep->config.no_edges, sweep->pool);
    sweep->rays += sweep->field.hits.rays;
    sweep->hit_count += (long long)sweep->field.hits.count;
    for (int f = 0; f < sweep->config.frequencies && status == STATUS_OK; f++)
        status = total_field_sweep(&s[f], &(FrequencySweep){.count = 1, .first_hz = sweep->config.frequency_hz[f]},
                                   &sweep->field, sweep->pool);
    return status;
}

/* Computes some looks again with another grid of tubes: the difference is the error of both. */
static Status check_grid(RcsSweep *sweep)
{
    ScatterMatrix again[rcs_most_frequencies];
    double        off = 0, whole = 0;
    const int     count = sweep->config.looks < checked_looks ? sweep->config.looks : checked_looks;
    for (int i = 0; i < count; i++) {
        const int            look = (int)((long long)i * sweep->config.looks / count);
        const ScatterMatrix *s = sweep->s + (size_t)look * (size_t)sweep->config.frequencies;
        const Status         status = look_at(again, sweep, look, 1);
        if (status != STATUS_OK) return status;
        for (int f = 0; f < sweep->config.frequencies; f++) {
            off += scatter_power(again[f].hh - s[f].hh) + scatter_power(again[f].vv - s[f].vv);
            whole += scatter_power(s[f].hh) + scatter_power(s[f].vv);
        }
    }
    /* half of it is each grid's own; none where no tube was shot */
    sweep->grid_db = whole > 0 && off > 0 ? 10 * log10(off / whole / 2) : NAN;
    return STATUS_OK;
}

Status rcs_sweep_run(RcsSweep *sweep)
{
    Status status = STATUS_OK;
    char   line[96];
    for (int look = 0; look < sweep->config.looks && status == STATUS_OK; look++) {
        snprintf(line, sizeof line, "rcs: look %d of %d", look + 1, sweep->config.looks);
        log_status(line);
        status = look_at(sweep->s + (size_t)look * (size_t)sweep->config.frequencies, sweep, look, 0);
    }
    if (status == STATUS_OK && !sweep->given) status = check_grid(sweep);
    log_status(NULL);
    if (sweep->unknown > 0)
        log_warn("rcs: %s ends before %lld of these looks and frequencies, whose rows are empty; see --azimuth, "
                 "--elevation and "
                 "--frequency",
                 sweep->config.name, sweep->unknown);
    return status;
}

/* ---- table ------------------------------------------------------------------------------------------ */

static void write_dbsm(FILE *to, double complex s)
{
    if (s == 0) fputs(",", to);
    else fprintf(to, ",%.4f", rcs_dbsm(s));
}

void rcs_write_csv(FILE *to, const RcsSweep *sweep)
{
    const RcsConfig *config = &sweep->config;
    fputs("az_deg,el_deg,f_ghz,hh_dbsm,hv_dbsm,vh_dbsm,vv_dbsm,hh_re_m,hh_im_m,hv_re_m,hv_im_m,vh_re_m,vh_im_m,"
          "vv_re_m,vv_im_m\n",
          to);
    for (int look = 0; look < config->looks; look++)
        for (int f = 0; f < config->frequencies; f++) {
            const ScatterMatrix *s = &sweep->s[(size_t)look * (size_t)config->frequencies + (size_t)f];
            const double complex value[4] = {s->hh, s->hv, s->vh, s->vv};
            fprintf(to, "%.10g,%.10g,%.10g", rcs_look_deg(config, look), config->elevation_deg,
                    config->frequency_hz[f] * 1e-9);
            for (int p = 0; p < 4; p++) write_dbsm(to, value[p]);
            for (int p = 0; p < 4; p++) fprintf(to, ",%.9g,%.9g", creal(value[p]), cimag(value[p]));
            fputc('\n', to);
        }
}

/* ---- polar plot over azimuth: SVG, the nose up ------------------------------------------------------ */

enum { width_px = 800, height_px = 640, middle_x = 320, middle_y = 344, radius_px = 252, legend_x = width_px - 206 };

static const char *const colours[2] = {"#1f77b4", "#d1495b"};

static double complex field_of(const RcsSweep *sweep, int look, int p)
{
    const ScatterMatrix *s = &sweep->s[(size_t)look * (size_t)sweep->config.frequencies];
    return p ? s->vv : s->hh;
}

/* The rings of the plot: from the highest value, rounded up to a ten, down to 60 dB below it. */
static SvgAxis rings_of(const RcsSweep *sweep)
{
    double high = -INFINITY;
    for (int look = 0; look < sweep->config.looks; look++)
        for (int p = 0; p < 2; p++)
            if (field_of(sweep, look, p) != 0) high = fmax(high, rcs_dbsm(field_of(sweep, look, p)));
    if (isinf(high)) high = 0;
    high = 10 * ceil(high / 10 + 1e-9);
    SvgAxis rings = {.low = high - 60, .high = high, .to_px = radius_px};
    for (double dbsm = rings.low + 10; dbsm <= high; dbsm += 10) rings.tick[rings.ticks++] = dbsm;
    return rings;
}

/* Draws a curve, and its row of the legend with the mean over its looks. */
static void draw_curve(FILE *to, const RcsSweep *sweep, const SvgAxis *rings, int p)
{
    char   text[64];
    double mean_m2 = 0;
    svg_curve_begin(to, &(SvgPen){colours[p], 1.2, NULL});
    for (int look = 0; look < sweep->config.looks; look++) {
        const double complex s = field_of(sweep, look, p);
        const double         az = rcs_look_deg(&sweep->config, look) * rad_per_deg;
        const double         r = s == 0 ? 0 : clamp(svg_at(rings, rcs_dbsm(s)), 0, radius_px);
        svg_curve_point(to, middle_x + r * sin(az), middle_y - r * cos(az));
        mean_m2 += 4 * pi_rad * (creal(s) * creal(s) + cimag(s) * cimag(s)) / sweep->config.looks;
    }
    svg_curve_end(to);
    snprintf(text, sizeof text, "%s, mean %.1f dBsm", p ? "VV" : "HH", mean_m2 > 0 ? 10 * log10(mean_m2) : -INFINITY);
    svg_legend(to, &(SvgPen){colours[p], 2, NULL}, legend_x, 96 + 22 * p, text);
}

void rcs_plot(FILE *to, const RcsSweep *sweep)
{
    const RcsConfig *config = &sweep->config;
    const SvgAxis    rings = rings_of(sweep);
    char             below[256], range[48] = "far field";
    if (!isinf(config->range_m)) snprintf(range, sizeof range, "range %g m", config->range_m);
    snprintf(below, sizeof below,
             "%g GHz, elevation %g deg, %s; azimuth clockwise from the nose, deg; ray tubes and edges",
             config->frequency_hz[0] * 1e-9, config->elevation_deg, range);
    svg_begin(to, width_px, height_px, rcs_target_name(sweep), ": radar cross section, dBsm", below);
    svg_polar_grid(to, middle_x, middle_y, &rings);
    for (int p = 0; p < 2; p++) draw_curve(to, sweep, &rings, p);
    if (!isnan(sweep->grid_db))
        svg_text(to, SVG_DIM, SVG_LEFT, legend_x, 144, "another grid of tubes: %.0f dB", sweep->grid_db);
    svg_end(to);
}
