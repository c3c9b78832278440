/* tests/bench/render/precision_radar.c: the field that a target scatters: ray tubes a wavelength, their divisions at
 * edges, mirrors of a path; flat faces by ray tubes and in closed form; what a list of hits saves when it is used
 * again. */
#include "render/scattering/field/radar_target_private.h"
#include "tests/bench/bench.h"
#include "render/scattering/field/radar_model.h"
#include "render/scattering/field/total_field.h"
#include "render/scattering/signatures/centres.h"
#include "tests/bench/suites.h"

#include <limits.h>
#include <stdlib.h>

/* Root of the power of the difference over the power, over so many frequencies or looks, co-polarised, %. */
static double off_percent(const ScatterMatrix *got, const ScatterMatrix *want, int count)
{
    double apart = 0, whole = 0;
    for (int i = 0; i < count; i++) {
        apart += scatter_power(got[i].hh - want[i].hh) + scatter_power(got[i].vv - want[i].vv);
        whole += scatter_power(want[i].hh) + scatter_power(want[i].vv);
    }
    return 100 * sqrt(apart / whole);
}

/* ---- flat faces ------------------------------------------------------------------------------- */

/* Compares the first bounce by ray tubes and in closed form: the time of a look against its error. Plates and boxes are
 * compared with their formulas, others with tubes divided to the finest. */

enum { face_looks = 3 };

typedef struct Case {
    const char *what[2]; /* tubes; closed form */
    const char *name;    /* NULL: a box */
    double      hz;
    double      side_m[3]; /* of a plate across x, or a box; 0: no formula */
    bool        long_run;  /* not in quick runs */
} Case;

typedef struct Faces {
    RadarTarget  *target;
    Pool         *pool;
    TubeConfig    tubes;
    TotalField    field;
    ScatterMatrix s[face_looks];
    Status        status;
} Faces;

static void look_of(ScatterAntenna *antenna, int i)
{
    radar_look(antenna, (3 + 17 * i) * rad_per_deg, (2 + 5 * i) * rad_per_deg, INFINITY);
}

static void run_looks(void *user)
{
    Faces *w = user;
    for (int i = 0; i < face_looks && w->status == STATUS_OK; i++) {
        ScatterAntenna antenna;
        look_of(&antenna, i);
        w->status = total_field_trace(&w->field, w->target, &antenna, &antenna, &w->tubes, false, w->pool);
        if (w->status == STATUS_OK)
            w->status = total_field_sweep(&w->s[i], &(FrequencySweep){.count = 1, .first_hz = w->tubes.frequency_hz},
                                          &w->field, w->pool);
    }
    bench_keep(w);
}

/* Adds a side of a box, or a plate, by the axis of its normal and the sense of it. */
static void add_side(ScatterMatrix *s, const Case *c, const ScatterAntenna *a, int axis, double sign)
{
    const int    u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double k = 2 * pi_rad * c->hz / light_mps, cosine = sign * a->u[axis];
    if (!(cosine > 0)) return;
    const double         shape = scatter_sinc(k * c->side_m[u] * a->u[u]) * scatter_sinc(k * c->side_m[v] * a->u[v]);
    const double complex wave = cexp(I * k * cosine * c->side_m[axis]); /* twice half a side nearer */
    const double complex whole = CMPLX(0, -k / (2 * pi_rad) * c->side_m[u] * c->side_m[v] * cosine * shape) * wave;
    s->hh += whole;
    s->vv += whole;
}

static void formula(ScatterMatrix *s, const Case *c)
{
    memset(s, 0, face_looks * sizeof *s);
    for (int i = 0; i < face_looks; i++) {
        ScatterAntenna a;
        look_of(&a, i);
        for (int axis = 0; axis < (c->name ? 1 : 3); axis++)
            for (int sign = -1; sign <= 1; sign += 2) add_side(&s[i], c, &a, axis, sign);
    }
}

/* About the origin; each side has its own corners. */
static Status box_model(Model *m, const double side_m[3])
{
    *m = (Model){.name = "box", .node_count = 1, .part_count = 1, .vertex_count = 24, .triangle_count = 12};
    m->node = calloc(1, sizeof *m->node);
    m->part = calloc(1, sizeof *m->part);
    m->vertex = calloc(24, sizeof *m->vertex);
    m->normal = calloc(24, sizeof *m->normal);
    m->triangle = calloc(12, sizeof *m->triangle);
    m->triangle_part = calloc(12, sizeof *m->triangle_part);
    if (!m->node || !m->part || !m->vertex || !m->normal || !m->triangle || !m->triangle_part) return STATUS_NO_MEMORY;
    m->node[0].parent = -1;
    m3_identity(m->node[0].r_parent_from_node);
    m->part[0].triangle_count = 12;
    for (int f = 0; f < 6; f++) {
        const int axis = f / 2, u = (axis + 1) % 3, v = (axis + 2) % 3, sign = f % 2 ? -1 : 1;
        for (int q = 0; q < 4; q++) {
            double *p = m->vertex[4 * f + q];
            p[axis] = 0.5 * sign * side_m[axis];
            p[u] = (q == 1 || q == 2 ? 0.5 : -0.5) * sign * side_m[u];
            p[v] = (q >= 2 ? 0.5 : -0.5) * side_m[v];
            m->normal[4 * f + q][axis] = (float)sign;
        }
        for (int t = 0; t < 2; t++)
            for (int q = 0; q < 3; q++) m->triangle[2 * f + t][q] = (uint32_t)(4 * f + (q ? q + t : 0));
    }
    return model_measure(m);
}

static Status open_case(RadarModel *out, const Case *c, const RadarMaterials *materials)
{
    if (c->name) return radar_model_open(out, c->name, materials, radar_sag_m(c->hz));
    const Status status = box_model(&out->model, c->side_m);
    return status == STATUS_OK ? radar_target_create(&out->target, &out->model, NULL, "avx2") : status;
}

static Status run_case(Bench *bench, const Case *c, const RadarMaterials *materials, Pool *pool)
{
    RadarModel    model = {0};
    ScatterMatrix want[face_looks];
    Faces         w = {.pool = pool, .tubes = tubes_default_config(c->hz)};
    const bool    known = c->side_m[1] > 0;
    w.status = open_case(&model, c, materials);
    if (w.status != STATUS_OK) goto done;
    w.target = model.target;
    radar_target_pose(model.target, NULL, 0);
    if (known) {
        formula(want, c);
    } else {
        w.tubes.splits = bench_quick(bench) ? 3 : 4;
        w.tubes.cuts_per_radius = 1e6;
        w.tubes.seed = 1;
        run_looks(&w);
        memcpy(want, w.s, sizeof want);
        w.tubes = tubes_default_config(c->hz);
    }
    for (int on = 0; on < 2 && w.status == STATUS_OK; on++) {
        const BenchWork work = {run_looks, &w, face_looks};
        BenchTime       time;
        w.tubes.polygon_faces = on ? INT_MAX : 0;
        bench_time(&time, bench, &work, 1);
        BenchRow row = bench_row_of(c->what[on], &time, "/s", 1);
        row.error = off_percent(w.s, want, face_looks), row.error_unit = "%";
        row.against = known ? "its formula" : "tubes divided further, another grid";
        bench_add(bench, &row);
    }

done:
    total_field_free(&w.field);
    radar_model_close(&model);
    return w.status;
}

static Status faces_in_closed_form(Bench *bench, const RadarMaterials *materials, Pool *pool)
{
    static const Case cases[] = {
        {.what = {"radar: a look at a plate of 10 wavelengths, ray tubes", "radar: the same plate, closed form"},
         .name = "plate:0.3x0.2",
         .hz = 10e9,
         .side_m = {0, 0.3, 0.2}},
        {.what = {"radar: a look at a plate of 310 wavelengths, 94 GHz, ray tubes",
                  "radar: the same at 94 GHz, closed form"},
         .name = "plate:1x0.7",
         .hz = 94e9,
         .side_m = {0, 1, 0.7}},
        {.what = {"radar: a look at a box of 4 m, 10 GHz, ray tubes", "radar: the same box, closed form"},
         .hz = 10e9,
         .side_m = {4, 2, 1.6}},
        {.what = {"radar: a look at a box of 4 m, 94 GHz, ray tubes", "radar: the same box at 94 GHz, closed form"},
         .hz = 94e9,
         .side_m = {4, 2, 1.6}},
        {.what = {"radar: a look at a trihedral of squares, 10 GHz, ray tubes",
                  "radar: the same trihedral, its first bounce in closed form"},
         .name = "corner:0.45",
         .hz = 10e9},
        {.what = {"radar: a look at a tank, 10 GHz, ray tubes",
                  "radar: the same tank, faces wholly seen in closed form"},
         .name = "tank",
         .hz = 10e9,
         .long_run = true}};
    Status status = STATUS_OK;
    bench_progress(bench, "flat faces in closed form");
    for (size_t i = 0; i < sizeof cases / sizeof *cases && status == STATUS_OK; i++)
        if (!cases[i].long_run || !bench_quick(bench)) status = run_case(bench, &cases[i], materials, pool);
    return status;
}

/* ---- hits used again -------------------------------------------------------------------------- */

/* A tank's field without its edges, from a list of another aspect, and from scattering centres: what each saves, and
 * how wrong it is. */

static const double full_hz = 10e9, quick_hz = 4e9, band_hz = 500e6, bin_deg = 0.3;
enum { frequencies = 32 };

typedef struct Reuse {
    RadarTarget   *tank;
    Pool          *pool;
    double         centre_hz;
    TubeConfig     tubes;
    ScatterAntenna look, now; /* of the list, and where the antenna is */
    bool           edges;
    TotalField     field;
    Centres        centres;
    Signature      signature;
    SignatureCells cells;
    ScatterMatrix  s[frequencies];
    Status         status;
} Reuse;

static void trace(void *user)
{
    Reuse *r = user;
    r->status = total_field_trace(&r->field, r->tank, &r->look, &r->look, &r->tubes, r->edges, r->pool);
    bench_keep(r);
}

static void sweep(void *user)
{
    Reuse *r = user;
    if (r->status == STATUS_OK)
        r->status = total_field_sweep(r->s,
                                      &(FrequencySweep){.count = frequencies,
                                                        .first_hz = r->centre_hz - 0.5 * band_hz,
                                                        .step_hz = band_hz / (frequencies - 1),
                                                        .tx = &r->now,
                                                        .rx = &r->now},
                                      &r->field, r->pool);
    bench_keep(r);
}

static void gather(void *user)
{
    Reuse *r = user;
    if (r->status == STATUS_OK) r->status = signature_make(&r->signature, &r->field, NULL, &r->cells);
    if (r->status == STATUS_OK) r->status = centres_make(&r->centres, &r->signature, &r->now, &r->now, r->pool);
    bench_keep(r);
}

static void add_row(Bench *bench, const char *what, void (*run)(void *), Reuse *r, double error, const char *against)
{
    BenchTime       time;
    const BenchWork work = {run, r, 1};
    bench_time(&time, bench, &work, 1);
    BenchRow row = bench_row_of(what, &time, "/s", 1);
    row.error = error, row.error_unit = "%", row.against = against;
    bench_add(bench, &row);
}

/* Prices the edges, and the waves between them, by leaving them out. */
static void edges(Bench *bench, Reuse *r)
{
    ScatterMatrix whole[frequencies];
    const int     pairs = r->tank->pair_count;
    trace(r), sweep(r);
    memcpy(whole, r->s, sizeof whole);
    add_row(bench, "radar: a look at a tank, edges and waves between them", trace, r, 0, "itself");
    r->tank->pair_count = 0;
    trace(r), sweep(r);
    add_row(bench, "radar: the same, edges of first order", trace, r, off_percent(r->s, whole, frequencies),
            "all edges");
    r->tank->pair_count = pairs;
    r->edges = false;
    trace(r), sweep(r);
    add_row(bench, "radar: the same, without edges", trace, r, off_percent(r->s, whole, frequencies), "all edges");
    r->edges = true;
}

/* Compares a list used for an antenna elsewhere with a list of its own. */
static void aspects(Bench *bench, Reuse *r)
{
    static const struct {
        const char *what;
        double      deg;
    } at[] = {{"radar: 32 frequencies of a list 0.05 degrees away", 0.05},
              {"radar: 32 frequencies of a list 0.15 degrees away", 0.15},
              {"radar: 32 frequencies of a list 0.3 degrees away", 0.3},
              {"radar: 32 frequencies of a list 1 degree away", 1}};
    const ScatterAntenna look = r->look;
    for (int i = bench_quick(bench) ? 1 : 0; i < (bench_quick(bench) ? 3 : 4); i++) {
        ScatterMatrix own[frequencies];
        radar_look(&r->look, (20 + at[i].deg) * rad_per_deg, 10 * rad_per_deg, 2000);
        r->now = r->look;
        trace(r), sweep(r);
        memcpy(own, r->s, sizeof own);
        r->look = look;
        trace(r), sweep(r);
        add_row(bench, at[i].what, sweep, r, off_percent(r->s, own, frequencies), "a list of its own, its grid too");
        r->now = look;
    }
}

/* Centres of cells against the hits themselves, at the edge of their bin, over the band. */
static void cells(Bench *bench, Reuse *r)
{
    static const struct {
        const char *what;
        double      rad;
    } at[] = {{"radar: signature of a list, cells of 0.1 rad", 0.1},
              {"radar: signature of a list, cells of 0.2 rad", 0.2},
              {"radar: signature of a list, cells of 0.4 rad", 0.4},
              {"radar: signature of a list, cells of 0.8 rad", 0.8}};
    radar_look(&r->now, (20 + 0.5 * bin_deg) * rad_per_deg, 10 * rad_per_deg, 2000);
    ScatterMatrix want[frequencies], got[frequencies];
    trace(r), sweep(r);
    memcpy(want, r->s, sizeof want);
    for (int i = 0; i < 4; i++) {
        r->cells = signature_default_cells(r->centre_hz, band_hz, bin_deg * rad_per_deg, 0);
        r->cells.path_phase_rad = r->cells.across_phase_rad = at[i].rad;
        gather(r);
        memset(got, 0, sizeof got);
        for (int f = 0; f < frequencies && r->status == STATUS_OK; f++) {
            const double k = 2 * pi_rad * (r->centre_hz + band_hz * ((double)f / (frequencies - 1) - 0.5)) / light_mps;
            for (int c = 0; c < r->centres.count; c++) {
                const ScatterCentre *centre = &r->centres.centre[c];
                const double complex wave = cexp(-I * k * centre->path_m);
                got[f].hh += centre->s.hh * wave, got[f].vv += centre->s.vv * wave;
            }
        }
        add_row(bench, at[i].what, gather, r, off_percent(got, want, frequencies),
                bench_quick(bench) ? "hits and edges, edge of a bin, 500 MHz at 4 GHz"
                                   : "hits and edges, edge of a bin, 500 MHz at 10 GHz");
    }
    r->now = r->look;
}

static Status hits_used_again(Bench *bench, RadarTarget *tank, Pool *pool)
{
    const double centre_hz = bench_quick(bench) ? quick_hz : full_hz;
    Reuse        r = {
               .tank = tank, .pool = pool, .centre_hz = centre_hz, .edges = true, .tubes = tubes_default_config(centre_hz)};
    bench_progress(bench, "reuse of a radar's lists");
    if (bench_quick(bench)) r.tubes.splits = 0;
    radar_look(&r.look, 20 * rad_per_deg, 10 * rad_per_deg, 2000);
    r.now = r.look;
    edges(bench, &r);
    aspects(bench, &r);
    cells(bench, &r);
    total_field_free(&r.field);
    signature_free(&r.signature);
    centres_free(&r.centres);
    return r.status;
}

/* ---- settings of ray tubes -------------------------------------------------------------------- */

/* Rays grow as the target's outline: quick runs look at a smaller one. */
static const double      tank_hz = 16e9;
static const char *const tank_look = "a look at a tank at 16 GHz", *const quick_look = "a look at a jeep at 16 GHz";
enum { looks = 6, quick_looks = 2, tank_settings = 5 };

/* Fields of a tank from some sides. */
typedef struct TankSet {
    const RadarTarget *target;
    Pool              *pool;
    TubeConfig         tubes;
    TubeHits           hits;
    int                looks;
    ScatterMatrix      s[looks];
    Status             status;
} TankSet;

static void look_at_tank(void *user)
{
    TankSet *t = user;
    for (int i = 0; i < t->looks && t->status == STATUS_OK; i++) {
        ScatterAntenna antenna;
        radar_look(&antenna, (20 + 57 * i) * rad_per_deg, (5 + 5 * i) * rad_per_deg, 2000);
        t->status = tubes_trace(&t->hits, t->target, &antenna, &antenna, &t->tubes, t->pool);
        if (t->status == STATUS_OK) t->status = field_at(&t->s[i], t->tubes.frequency_hz, &t->hits, t->pool);
    }
    bench_keep(t);
}

static TankSet tank_set(const RadarModel *model, Pool *pool, double more_rays, bool quick)
{
    TankSet t = {.target = model->target,
                 .pool = pool,
                 .looks = quick ? quick_looks : looks,
                 .tubes = tubes_default_config(tank_hz)};
    t.tubes.rays_per_wavelength *= more_rays;
    t.tubes.rays_per_radius *= more_rays;
    t.tubes.splits = 0; /* as signatures are made */
    return t;
}

static Status time_tank(Bench *bench, TankSet set[], TankSet *fine, const char *const name[], int count, int by_default,
                        const BenchTunable *tunable)
{
    BenchWork    work[tank_settings];
    BenchSetting point[tank_settings] = {0};
    look_at_tank(fine);
    Status status = fine->status;
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        look_at_tank(&set[k]);
        status = set[k].status;
        work[k] = (BenchWork){look_at_tank, &set[k], set[k].looks};
        point[k] = (BenchSetting){.setting = name[k],
                                  .error = off_percent(set[k].s, fine->s, set[k].looks),
                                  .is_default = k == by_default,
                                  .bytes = 75.0 * (double)set[k].hits.count};
    }
    if (status == STATUS_OK) bench_tunable(bench, tunable, work, point, count);
    for (int k = 0; k < count; k++) tubes_free(&set[k].hits);
    tubes_free(&fine->hits);
    return status;
}

static Status tunable_tubes(Bench *bench, const RadarModel *model, Pool *pool)
{
    static const char *const name[tank_settings] = {"0.6", "1.25", "1.8", "2.5", "3.5"};
    static const double      more[tank_settings] = {0.48, 1, 1.44, 2, 2.8};
    const bool               quick = bench_quick(bench);
    const int count = quick ? tank_settings - 1 : tank_settings; /* the last has eight times the default's rays */
    TankSet   set[tank_settings], fine = tank_set(model, pool, quick ? 5 : 8, quick);
    bench_progress(bench, "ray tubes");
    for (int k = 0; k < count; k++) set[k] = tank_set(model, pool, more[k], quick);
    return time_tank(bench, set, &fine, name, count, 1,
                     &(BenchTunable){"ray tubes a wavelength", "render/scattering/field/tubes.h",
                                     quick ? quick_look : tank_look, "%", "field, rms of the looks; 6 tubes or more",
                                     18});
}

/* Measures at 10 GHz, where edges rule; quick runs take one look and leave the last setting out. */
static Status tunable_splits(Bench *bench, const RadarModel *model, Pool *pool)
{
    enum { settings = 4 };
    static const char *const name[settings] = {"0", "1", "2", "3"};
    const bool               quick = bench_quick(bench);
    const int                count = quick ? settings - 1 : settings;
    TankSet                  set[settings], fine = tank_set(model, pool, 1, quick);
    bench_progress(bench, "divisions of ray tubes");
    fine.tubes.frequency_hz = tank_hz / 1.6;
    if (quick) fine.looks = 1;
    fine.tubes.splits = count;
    fine.tubes.cuts_per_radius = 1e6;
    fine.tubes.seed = 1;
    for (int k = 0; k < count; k++) {
        set[k] = fine;
        set[k].tubes.splits = k;
        set[k].tubes.seed = 0;
    }
    return time_tank(bench, set, &fine, name, count, 2,
                     &(BenchTunable){"divisions of ray tubes at edges", "render/scattering/field/tubes.h",
                                     quick ? "a look at a jeep at 10 GHz" : "a look at a tank at 10 GHz", "%",
                                     "field, rms of the looks; another grid, one division more", 12});
}

static Status tunable_mirrors(Bench *bench, const RadarModel *model, Pool *pool)
{
    static const char *const name[tank_settings] = {"2", "3", "5", "8", "16"};
    static const int         mirrors[tank_settings] = {2, 3, 5, 8, 16};
    const bool               quick = bench_quick(bench);
    TankSet                  set[tank_settings], fine = tank_set(model, pool, 1, quick);
    bench_progress(bench, "mirrors of ray tubes");
    fine.tubes.bounces = 40;
    for (int k = 0; k < tank_settings; k++) {
        set[k] = tank_set(model, pool, 1, quick);
        set[k].tubes.bounces = mirrors[k];
    }
    return time_tank(bench, set, &fine, name, tank_settings, 3,
                     &(BenchTunable){"mirrors of a ray tube", "render/scattering/field/tubes.h",
                                     quick ? quick_look : tank_look, "%", "field, rms of the looks; 40 mirrors", 13});
}

Status bench_precision_radar(Bench *bench)
{
    RadarMaterials materials = {0};
    RadarModel     model = {0};
    Pool          *pool = NULL;
    Status         status = radar_materials_load(&materials);
    if (status == STATUS_OK)
        status = radar_model_open(&model, bench_quick(bench) ? "jeep" : "tank", &materials, radar_sag_m(tank_hz));
    if (status == STATUS_OK) status = pool_create(&pool, bench_threads(bench));
    if (status == STATUS_OK) status = tunable_tubes(bench, &model, pool);
    if (status == STATUS_OK) status = tunable_splits(bench, &model, pool);
    if (status == STATUS_OK) status = tunable_mirrors(bench, &model, pool);
    if (status == STATUS_OK) status = hits_used_again(bench, model.target, pool);
    if (status == STATUS_OK) status = faces_in_closed_form(bench, &materials, pool);
    if (status != STATUS_OK) log_error("bench: precision: radar: %s", status_name(status));
    pool_destroy(pool);
    radar_model_close(&model);
    radar_materials_close(&materials);
    return status;
}
