/* tests/bench/entities/stability_models.c: shapes with aspect ratios of a million, and degenerate files: needles,
 * slivers, faces without area, duplicated, or five at one edge. References: analytic areas and volumes, and every
 * vertex of every pose for the bounding spheres. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"
#include "pitviper_output.h"

#include "entities/shapes/mesh_builder.h"
#include "entities/import/model_import.h"
#include "entities/shapes/parametric.h"

#include <stdlib.h>

typedef struct ModelErrors {
    double normal;    /* | |n| - 1 | */
    double outside_m; /* of the sphere about every pose */
    double unsound;   /* models that are not valid; numbers that are none */
} ModelErrors;

static double area_of(const Model *m, int t)
{
    long double ab[3], ac[3];
    for (int i = 0; i < 3; i++) {
        ab[i] = (long double)m->vertex[m->triangle[t][1]][i] - m->vertex[m->triangle[t][0]][i];
        ac[i] = (long double)m->vertex[m->triangle[t][2]][i] - m->vertex[m->triangle[t][0]][i];
    }
    const long double x = ab[1] * ac[2] - ab[2] * ac[1], y = ab[2] * ac[0] - ab[0] * ac[2],
                      z = ab[0] * ac[1] - ab[1] * ac[0];
    return (double)(0.5L * sqrtl(x * x + y * y + z * z));
}

static double model_area(const Model *m)
{
    double sum = 0;
    for (int t = 0; t < m->triangle_count; t++) sum += area_of(m, t);
    return sum;
}

static double model_volume(const Model *m)
{
    long double sum = 0;
    for (int t = 0; t < m->triangle_count; t++) {
        const double *a = m->vertex[m->triangle[t][0]], *b = m->vertex[m->triangle[t][1]],
                     *c = m->vertex[m->triangle[t][2]];
        sum += a[0] * ((long double)b[1] * c[2] - (long double)b[2] * c[1]) +
               a[1] * ((long double)b[2] * c[0] - (long double)b[0] * c[2]) +
               a[2] * ((long double)b[0] * c[1] - (long double)b[1] * c[0]);
    }
    return (double)(sum / 6);
}

/* Sets joints at rest, at random, far beyond their limits, and to values that are no number. */
static void look_at_model(ModelErrors *errors, const Model *m, int poses)
{
    static const double wild[] = {0, 1e300, -1e300, INFINITY, -INFINITY, NAN, 1e-310, 3.4e38};
    NodePose           *pose = calloc((size_t)m->node_count, sizeof *pose);
    double             *value = calloc((size_t)m->node_count, sizeof *value);
    for (int k = 0; k < poses && pose && value; k++) {
        for (int n = 0; n < m->node_count; n++)
            value[n] =
                k < 8 ? wild[(k + (k > 0 ? n : 0)) % 8] : 8 * random_uniform(0x30DE, 1, (uint32_t)k, (uint64_t)n) - 4;
        model_pose(pose, m, k ? value : NULL);
        for (int t = 0; t < m->triangle_count; t++) {
            const NodePose *at = &pose[m->part[m->triangle_part[t]].node];
            for (int c = 0; c < 3; c++) {
                double p[3];
                m3_mul_v3(p, at->r_body_from_node, m->vertex[m->triangle[t][c]]);
                v3_add(p, p, at->p_body);
                bench_worse(&errors->outside_m, fmax(v3_length(p) - m->radius_m, 0));
                errors->unsound += k == 0 && !(p[0] >= m->box_low[0] - 1e-9 && p[1] >= m->box_low[1] - 1e-9 &&
                                               p[2] >= m->box_low[2] - 1e-9 && p[0] <= m->box_high[0] + 1e-9 &&
                                               p[1] <= m->box_high[1] + 1e-9 && p[2] <= m->box_high[2] + 1e-9);
            }
        }
    }
    if (!pose || !value) errors->unsound = INFINITY;
    free(pose);
    free(value);
    for (int v = 0; v < m->vertex_count; v++) {
        const double n[3] = {m->normal[v][0], m->normal[v][1], m->normal[v][2]};
        bench_worse(&errors->normal, v3_length(n) - 1);
        errors->unsound += !v3_is_finite(m->vertex[v]);
    }
    for (int t = 0; t < m->triangle_count; t++) errors->unsound += !(area_of(m, t) > 0 && isfinite(area_of(m, t)));
}

/* ---- built-in models ------------------------------------------------------------------------ */

static void built_in(Bench *bench)
{
    static const char *const names[] = {"tank", "truck",  "helicopter", "missile", "carrier", "launcher", "aircraft",
                                        "ship", "person", "building",   "decoy",   "flare",   "unknown"};
    static const double      sags_m[] = {0.1, 0.0317, 0.005},
                        none[] = {0, -0.0, -1, 9.9e-6, 0.1000001, 1e300, 1e-310, INFINITY, -INFINITY, NAN};
    ModelErrors errors = {0};
    double      taken = 0;
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        for (int s = 0; s < (bench_quick(bench) ? 1 : 3); s++) {
            Model        m = {0};
            const Status status = parametric_build(&m, names[k], sags_m[s]);
            errors.unsound += status != STATUS_OK || model_validate(&m) != STATUS_OK;
            if (status == STATUS_OK) look_at_model(&errors, &m, bench_quick(bench) ? 10 : 60);
            model_destroy(&m);
        }
        for (size_t s = 0; s < sizeof none / sizeof *none; s++) {
            Model m = {0};
            log_suppress(true);
            taken += parametric_build(&m, names[k], none[s]) == STATUS_OK;
            log_suppress(false);
            model_destroy(&m);
        }
    }
    bench_stress(bench, "built-in models, joints anywhere: not valid, or numbers that are none", errors.unsound, 0, "",
                 "model_validate, finite");
    bench_stress(bench, "the same: length of normals", errors.normal, 1e-6, "", "1; floats");
    bench_stress(bench, "the same: vertices outside the sphere about every pose", errors.outside_m, 0, "m",
                 "every vertex of every pose");
    bench_stress(bench, "the same: sags that are none, accepted", taken, 0, "models", "refusal");
}

/* ---- shapes of a million to one ------------------------------------------------------------- */

typedef struct Shape {
    const char *name;
    double      long_m, thin_m;
} Shape;

static const Shape shapes[] = {{"box", 1000, 1e-3},      {"box", 1e-3, 1e-9},      {"box", 1e4, 1e-2},
                               {"cylinder", 1000, 1e-3}, {"cylinder", 1e-3, 1000}, {"cylinder", 1e-2, 1e-8},
                               {"bar", 1000, 1e-3},      {"bar", 1e4, 1e-2},       {"scaled", 1000, 1e-3}};

/* Area and volume of what was built, against a prism with as many sides. */
static void shape_off(double *off, ModelErrors *errors, const Shape *shape)
{
    const double l = shape->long_m, w = shape->thin_m, sag_m = 1e-3;
    MeshBuilder *b = mesh_builder_create("stress", sag_m);
    Model        m = {0};
    double       area, volume;
    if (!b) {
        errors->unsound = INFINITY;
        return;
    }
    mesh_node(b, "hull", -1, 0, 0, 0);
    mesh_part(b, 0, "shape", "paint_olive", HEAT_HULL);
    if (strcmp(shape->name, "box") == 0 || strcmp(shape->name, "scaled") == 0) {
        if (*shape->name == 'b') mesh_box(b, place_at(0, 0, 0), 0, 0, 0, l, w, w);
        else mesh_box(b, place_scaled(place_at(0, 0, 0), l, w, w), 0, 0, 0, 1, 1, 1);
        area = 4 * l * w + 2 * w * w;
        volume = l * w * w;
    } else {
        const int    sides = mesh_circle_sides(w, sag_m);
        const double half = pi_rad / sides, from[3] = {0, 0, 0}, to[3] = {0.6 * l, 0, 0.8 * l};
        if (*shape->name == 'c') mesh_cylinder(b, place_at(0, 0, 0), 0, l, w);
        else mesh_bar(b, from, to, w);
        area = 2 * sides * w * sin(half) * l + sides * w * w * sin(2 * half);
        volume = 0.5 * sides * w * w * sin(2 * half) * l;
    }
    if (mesh_builder_finish(&m, b) != STATUS_OK || model_validate(&m) != STATUS_OK) errors->unsound++;
    else {
        bench_worse(off, model_area(&m) / area - 1);
        bench_worse(off, model_volume(&m) / volume - 1);
        look_at_model(errors, &m, 1);
    }
    model_destroy(&m);
}

static void million_to_one(Bench *bench)
{
    ModelErrors errors = {0};
    double      off = 0;
    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) shape_off(&off, &errors, &shapes[k]);
    bench_stress(bench, "boxes, cylinders, bars of 1e6 to 1: not valid", errors.unsound, 0, "models",
                 "model_validate, finite");
    bench_stress(bench, "the same: normals, and vertices outside their sphere", fmax(errors.normal, errors.outside_m),
                 1e-6, "", "1; floats");
    /* the place of an end, 1e-16 of 1 km, over 1 mm of thickness */
    bench_stress(bench, "the same: area and volume", off, 1e-9, "", "prisms with as many sides");
}

/* ---- files ---------------------------------------------------------------------------------- */

typedef struct ObjFile {
    const char *what, *text;
    double      area_m2; /* NaN: it must be refused; with a line */
} ObjFile;

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
static const ObjFile obj_files[] = {
    {"needle of a million to one", "v 0 0 0\nv 65536 0 0\nv 0 0.0625 0\nf 1 2 3\n", 2048},
    {"no area, twice, five at an edge",
     SQUARE "v 0 0 1\nv 0 -1 0\nv 0 0 -1\nf 1 2 3\nf 1 2 3\nf 1 1 2\nf 2 2 2\nf 1 2 4\nf 1 2 5\nf 1 2 6\nf 1 2 7\n", 3},
    {"numbers that are none", SQUARE "v nan 0 0\nf 1 2 5\n", NAN},
    {"normals that are none",
     SQUARE "vn 0 0 0\nvn nan nan nan\nvn 1e30 0 0\nvn 1e-40 1e-40 0\nf 1//1 2//2 3//3\nf 1//4 3//2 4//1\n", 1},
    /* the rest in full */
    {"all on a line", "v 0 0 0\nv 1 1 1\nv 2 2 2\nv 3 3 3\nf 1 2 3\nf 2 3 4\n", NAN},
    {"all at one place", "v 5 5 5\nv 5 5 5\nv 5 5 5\nf 1 2 3\n", NAN},
    {"larger than 100 km", "v 0 0 0\nv 1e30 0 0\nv 0 1e30 0\nf 1 2 3\n", NAN},
    {"beyond a float", "v 0 0 0\nv 1e300 0 0\nv 0 1e300 0\nf 1 2 3\n", NAN},
    {"infinite", "v 0 0 0\nv inf 0 0\nv 0 -inf 0\nf 1 2 3\n", NAN},
    {"slivers", "v 0 0 0\nv 1024 0 0\nv 512 0.0009765625 0\nv 512 -0.0009765625 0\nf 1 2 3\nf 1 4 2\n", 1},
    {"a micrometre, and 8 km off", "v 8192 0 0\nv 8193 0 0\nv 8192 1 0\nf 1 2 3\nv 8192 0 0.0009765625\nf 1 2 4\n",
     0.50048828125},
    {"a tiny one", "v 0 0 0\nv 0.0000152587890625 0 0\nv 0 0.0000152587890625 0\nf 1 2 3\n", 0.5 * 0x1p-32},
    {"denormals", "v 0 0 0\nv 1e-40 0 0\nv 0 1e-40 0\nf 1 2 3\n", NAN},
    {"no such corner", SQUARE "f 1 2 9\n", NAN},
    {"a face of two corners", SQUARE "f 1 2\n", NAN},
};

static Status obj_imports(Bench *bench)
{
    const int   count = bench_quick(bench) ? 4 : (int)(sizeof obj_files / sizeof *obj_files);
    char        path[temp_path_size];
    ModelErrors errors = {0};
    double      judged = 0, off = 0;
    if (!temp_file(path, ".obj")) return STATUS_IO;
    for (int k = 0; k < count; k++) {
        Model       m = {0};
        ModelImport report;
        FILE       *file = output_file(path, 0);
        bool        written = file && fputs(obj_files[k].text, file) >= 0;
        if (file) written = fclose(file) == 0 && written;
        bench_progress(bench, obj_files[k].what);
        log_suppress(true);
        const Status status = written ? model_import(&m, &report, path) : STATUS_IO;
        log_suppress(false);
        judged += (status == STATUS_OK) == isnan(obj_files[k].area_m2);
        if (status == STATUS_OK) {
            look_at_model(&errors, &m, 2);
            if (!isnan(obj_files[k].area_m2)) bench_worse(&off, model_area(&m) / obj_files[k].area_m2 - 1);
        }
        model_destroy(&m);
    }
    remove(path);
    bench_stress(bench, "model files: needles, slivers, no area: wrongly taken or refused", judged, 0, "files",
                 "what they hold");
    bench_stress(bench, "the same: numbers that are none", errors.unsound, 0, "", "finite, area above 0, in the box");
    bench_stress(bench, "the same: length of normals", errors.normal, 1e-6, "", "1; floats");
    bench_stress(bench, "the same: vertices outside the sphere", errors.outside_m, 0, "m", "every vertex");
    bench_stress(bench, "the same: area", off, 1e-9, "", "paper");
    return STATUS_OK;
}

Status bench_stability_models(Bench *bench)
{
    bench_progress(bench, "models");
    built_in(bench);
    million_to_one(bench);
    return obj_imports(bench);
}
