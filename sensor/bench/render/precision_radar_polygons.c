/* sensor/bench/render/precision_radar_polygons.c: the first bounce off flat faces by ray tubes and in closed form: time
 * of a look against its error. Plates and boxes against their formulas; others against tubes divided to the finest. */
#include "sensor/bench/render/precision_radar.h"

#include "render/scattering/field/radar_model.h"
#include "render/scattering/field/total_field.h"

#include <limits.h>
#include <stdlib.h>

enum { looks = 3 };

typedef struct Case {
    const char *what[2];  /* tubes; closed form */
    const char *name;      /* NULL: a box */
    double      hz;
    double      side_m[3]; /* of a plate across x, or a box; 0: no formula */
    bool        long_run; /* not in quick runs */
} Case;

typedef struct Faces {
    RadarTarget  *target;
    Pool         *pool;
    TubeConfig    tubes;
    TotalField    field;
    ScatterMatrix s[looks];
    Status        status;
} Faces;

static void look_of(ScatterAntenna *antenna, int i)
{
    radar_look(antenna, (3 + 17 * i) * rad_per_deg, (2 + 5 * i) * rad_per_deg, INFINITY);
}

static void run_looks(void *user)
{
    Faces *w = user;
    for (int i = 0; i < looks && w->status == STATUS_OK; i++) {
        ScatterAntenna antenna;
        look_of(&antenna, i);
        w->status = total_field_trace(&w->field, w->target, &antenna, &antenna, &w->tubes, false, w->pool);
        if (w->status == STATUS_OK)
            w->status = total_field_sweep(&w->s[i], 1, w->tubes.frequency_hz, 0, &w->field, NULL, NULL, w->pool);
    }
    bench_keep(w);
}

/* A side of a box, or a plate: its normal's axis, and which way. */
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
    memset(s, 0, looks * sizeof *s);
    for (int i = 0; i < looks; i++) {
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
    ScatterMatrix want[looks];
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
        const BenchWork work = {run_looks, &w, looks};
        BenchTime       time;
        w.tubes.polygon_faces = on ? INT_MAX : 0;
        bench_time(&time, bench, &work, 1);
        BenchRow row = bench_row_of(c->what[on], &time, "/s", 1);
        row.error = precision_radar_off(w.s, want, looks), row.error_unit = "%";
        row.against = known ? "its formula" : "tubes divided further, another grid";
        bench_add(bench, &row);
    }

done:
    total_field_free(&w.field);
    radar_model_close(&model);
    return w.status;
}

Status precision_radar_polygons(Bench *bench, const RadarMaterials *materials, Pool *pool)
{
    static const Case cases[] = {
        {.what = {"radar: a look at a plate of 10 wavelengths, ray tubes", "radar: the same plate, closed form"},
         .name = "plate:0.3x0.2", .hz = 10e9, .side_m = {0, 0.3, 0.2}},
        {.what = {"radar: a look at a plate of 310 wavelengths, 94 GHz, ray tubes",
                  "radar: the same at 94 GHz, closed form"},
         .name = "plate:1x0.7", .hz = 94e9, .side_m = {0, 1, 0.7}},
        {.what = {"radar: a look at a box of 4 m, 10 GHz, ray tubes", "radar: the same box, closed form"},
         .hz = 10e9, .side_m = {4, 2, 1.6}},
        {.what = {"radar: a look at a box of 4 m, 94 GHz, ray tubes", "radar: the same box at 94 GHz, closed form"},
         .hz = 94e9, .side_m = {4, 2, 1.6}},
        {.what = {"radar: a look at a trihedral of squares, 10 GHz, ray tubes",
                  "radar: the same trihedral, its first bounce in closed form"},
         .name = "corner:0.45", .hz = 10e9},
        {.what = {"radar: a look at a tank, 10 GHz, ray tubes",
                  "radar: the same tank, faces wholly seen in closed form"},
         .name = "tank", .hz = 10e9, .long_run = true}};
    Status status = STATUS_OK;
    bench_progress(bench, "flat faces in closed form");
    for (size_t i = 0; i < sizeof cases / sizeof *cases && status == STATUS_OK; i++)
        if (!cases[i].long_run || !bench_quick(bench)) status = run_case(bench, &cases[i], materials, pool);
    return status;
}
