/* Rays against imported meshes, held against two answers our code did not produce:
 *
 * 1. the constructive solids the meshes were made from, in double, from their own library (models/brlcad/hits);
 * 2. every triangle of the OBJ text in turn, read and intersected here in double.
 *
 * The first judges mesh, importer and tracer together. The data's README gives percentiles and counts over 2000 rays
 * that hit; the thousand in hits/ are half of them. So what must hold for the half, whatever the other half does: at
 * most 1 % of 2000 = 20 rays beyond the 99 % figure, 200 beyond the 90 % one, and no more rays 100 mm off, lost, or in
 * another region than the 2000 have. (The percentiles of this half by itself are printed; they are a property of the
 * meshes: 2.1, 9.7, 4.2 and 5.7 mm at 99 %, which the second judge confirms ray by ray.)
 * The second judges importer and tracer alone, and there the tolerance is single-precision vertices: 6e-8 of 20 m,
 * over the sine of the angle of incidence. labels: slow */
#include "tests/check.h"

#include <unistd.h>
#include <zlib.h>

#include "entities/import/model_import.h"
#include "render/trace/parts/parts.h"

enum { most_rays = 8192 };

typedef struct TruthRay {
    double o[3], d[3], dist_m, n[3];
    bool   hit;
    char   region[128];
} TruthRay;

static TruthRay ray[most_rays];

static int read_rays(const char *name)
{
    char path[512], line[2048], *cell[16];
    int  count = 0;
    if (!reference_path(path, name)) return -1;
    gzFile file = gzopen(path, "rb");
    CHECK(file != NULL);
    CHECK(gzgets(file, line, sizeof line) != NULL &&
          strncmp(line, "id,ox_m,oy_m,oz_m,dx,dy,dz,hit,dist_m,nx,ny,nz,", 45) == 0);
    while (gzgets(file, line, sizeof line)) {
        CHECK(count < most_rays);
        line[strcspn(line, "\r\n")] = 0;
        assert_int_equal(text_split(cell, 16, line), 16);
        TruthRay *r = &ray[count++];
        memset(r, 0, sizeof *r);
        for (int i = 0; i < 3; i++)
            CHECK(text_to_double(&r->o[i], cell[1 + i]) && text_to_double(&r->d[i], cell[4 + i]));
        r->hit = cell[7][0] == '1';
        if (!r->hit) continue;
        CHECK(text_to_double(&r->dist_m, cell[8]));
        for (int i = 0; i < 3; i++) CHECK(text_to_double(&r->n[i], cell[9 + i]));
        snprintf(r->region, sizeof r->region, "%s", cell[14] + 1);
    }
    gzclose(file);
    return count;
}

/* ---- the text of an OBJ, every triangle -------------------------------------------------------------- */

typedef struct Obj {
    int vertices, triangles;
    double (*vertex)[3];
    int (*triangle)[3];
} Obj;

static Obj read_obj(const char *path)
{
    Obj    obj = {0};
    char   line[512];
    gzFile file = gzopen(path, "rb");
    CHECK(file != NULL);
    obj.vertex = malloc((size_t)400000 * sizeof *obj.vertex);
    obj.triangle = malloc((size_t)400000 * sizeof *obj.triangle);
    while (gzgets(file, line, sizeof line)) {
        CHECK(obj.vertices < 400000 && obj.triangles < 400000);
        double *v = obj.vertex[obj.vertices];
        int    *t = obj.triangle[obj.triangles];
        if (sscanf(line, "v %lf %lf %lf", v, v + 1, v + 2) == 3) obj.vertices++;
        else if (sscanf(line, "f %d %d %d", t, t + 1, t + 2) == 3) obj.triangles++;
    }
    gzclose(file);
    return obj;
}

/* Nearest triangle ahead; sine: of the angle between ray and triangle there. */
static double nearest(double *sine, const Obj *obj, const double o[3], const double d[3])
{
    double best = INFINITY;
    for (int i = 0; i < obj->triangles; i++) {
        const double *a = obj->vertex[obj->triangle[i][0] - 1];
        double        e1[3], e2[3], p[3], s[3], q[3];
        v3_sub(e1, obj->vertex[obj->triangle[i][1] - 1], a);
        v3_sub(e2, obj->vertex[obj->triangle[i][2] - 1], a);
        v3_cross(p, d, e2);
        const double det = v3_dot(e1, p);
        v3_sub(s, o, a);
        const double u = v3_dot(s, p) / det;
        if (!(u >= 0 && u <= 1)) continue;
        v3_cross(q, s, e1);
        const double v = v3_dot(d, q) / det, t = v3_dot(e2, q) / det;
        if (!(v >= 0 && u + v <= 1 && t > 0 && t < best)) continue;
        double n[3];
        v3_cross(n, e1, e2);
        best = t;
        *sine = fabs(v3_dot(n, d)) / v3_length(n);
    }
    return best;
}

/* ---- ours ------------------------------------------------------------------------------------------------ */

typedef struct Scene {
    Model       model;
    ModelImport report;
    Tracer     *tracer;
    PosedEntity entity;
} Scene;

static void scene_open(Scene *s, const char *path)
{
    static const double origin[3] = {0, 0, 0};
    double              attitude[9];
    assert_int_equal(model_import(&s->model, &s->report, path), STATUS_OK);
    const Model *model = &s->model;
    assert_int_equal(tracer_create_models(&s->tracer, &model, 1, "avx2"), STATUS_OK);
    NodePose *pose = calloc((size_t)model->node_count, sizeof *pose);
    s->entity.node = calloc((size_t)parts_node_count(s->tracer, 0), sizeof *s->entity.node);
    model_pose(pose, model, NULL);
    m3_identity(attitude);
    parts_pose(&s->entity, s->tracer, 0, pose, origin, attitude, 0);
    free(pose);
}

static void scene_close(Scene *s)
{
    tracer_destroy(s->tracer);
    free(s->entity.node);
    model_destroy(&s->model);
}

/* Distance in m, INFINITY for none; the part's name and the outward normal in the file's axes. */
static double trace(const char **part, double n_file[3], const Scene *s, const TruthRay *r)
{
    double  off[3], o[3], d[3], n_geo[3], n[3];
    PartHit hit;
    v3_sub(off, r->o, s->report.p_origin_file);
    m3_mul_v3(o, s->report.r_body_from_file, off);
    m3_mul_v3(d, s->report.r_body_from_file, r->d);
    const double range_m = parts_first_hit(&hit, &s->entity, o, d, INFINITY, false);
    if (isinf(range_m)) return range_m;
    parts_normals(n_geo, n, &s->model, &s->entity, &hit, o, d, range_m);
    m3_tmul_v3(n_file, s->report.r_body_from_file, n_geo);
    *part = s->model.part[s->model.triangle_part[hit.triangle]].name;
    return range_m;
}

static int number_order(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

/* What the data's README says of 2000 rays. */
typedef struct Expected {
    const char *mesh, *hits;
    double      p50_mm, p90_mm, p99_mm;
    int         far_off, missed, other_region;
    double      normal_p90_deg, normal_p99_deg;
} Expected;

/* Returns the distance within which 99 % of the hits are, mm. */
static double against_the_solids(const Expected *want)
{
    static double error_mm[most_rays];
    char          path[512];
    Scene         s = {0};
    int           errors = 0, missed = 0, false_hits = 0, far_off = 0, other = 0, beyond[2] = {0}, tilted[2] = {0};
    const int     count = read_rays(want->hits);
    if (count < 0 || !reference_path(path, want->mesh)) {
        skip();
        return NAN;
    }
    scene_open(&s, path);
    for (int i = 0; i < count; i++) {
        const char  *part = "";
        double       n[3];
        const double range_m = trace(&part, n, &s, &ray[i]);
        if (!ray[i].hit) {
            false_hits += !isinf(range_m);
            continue;
        }
        if (isinf(range_m)) {
            missed++;
            continue;
        }
        const double mm = 1000 * fabs(range_m - ray[i].dist_m),
                     turn_deg = acos(clamp(v3_dot(n, ray[i].n), -1, 1)) / rad_per_deg;
        const size_t length = strcspn(part, "~"); /* an instance of a region is the region */
        error_mm[errors++] = mm;
        far_off += mm > 100;
        beyond[0] += mm > want->p90_mm;
        beyond[1] += mm > want->p99_mm;
        tilted[0] += turn_deg > want->normal_p90_deg;
        tilted[1] += turn_deg > want->normal_p99_deg;
        other +=
            !(strncmp(part, ray[i].region, length) == 0 && (!ray[i].region[length] || ray[i].region[length] == '~'));
    }
    qsort(error_mm, (size_t)errors, sizeof *error_mm, number_order);
    printf("%s: %d hits: 50/90/99 %% within %.5f / %.3f / %.2f mm; beyond README's 90 %% %d, 99 %% %d; >100 mm %d, "
           "missed %d, "
           "false %d, other region %d; normals beyond %d, %d\n",
           s.model.name, errors, error_mm[errors / 2], error_mm[errors * 9 / 10], error_mm[errors * 99 / 100],
           beyond[0], beyond[1], far_off, missed, false_hits, other, tilted[0], tilted[1]);
    assert_int_equal(errors + missed, 1000);
    /* the median is of flat facets, where mesh and solid agree; on curved ones (Havoc) it is the chord tolerance of 1
     * mm */
    CHECK(error_mm[errors / 2] <= want->p50_mm);
    CHECK(beyond[0] <= 200 && beyond[1] <= 20);
    CHECK(tilted[0] <= 200 && tilted[1] <= 20);
    CHECK(far_off <= want->far_off && missed <= want->missed && other <= want->other_region);
    assert_int_equal(false_hits, 0); /* chords lie inside round solids; none was seen */
    scene_close(&s);
    return error_mm[errors * 99 / 100];
}

static const Expected ktank = {
    "models/brlcad/ktank.obj", "models/brlcad/hits/ktank.csv.gz", 0.0004, 0.16, 2.1, 1, 0, 2, 0.26, 5.5};
static const Expected ktank_fine = {
    "models/brlcad/ktank_fine.obj.gz", "models/brlcad/hits/ktank.csv.gz", 0.0004, 0.008, 0.13, 1, 0, 2, 0.08, 1.3};
static const Expected m35 = {
    "models/brlcad/m35.obj.gz", "models/brlcad/hits/m35.csv.gz", 0.0004, 1.1, 7.1, 5, 0, 29, 2.6, 8.8};
/* the median of half the rays cannot be known from that of all: 0.14 there, 0.18 here; a half of the 1 mm tolerance */
static const Expected havoc = {
    "models/brlcad/havoc.obj.gz", "models/brlcad/hits/havoc.csv.gz", 0.5, 1.3, 4.7, 4, 1, 9, 3.9, 14};
static const Expected truck = {
    "models/brlcad/truck.obj.gz", "models/brlcad/hits/truck.csv.gz", 0.0006, 1.3, 4.8, 3, 0, 3, 3.6, 6.5};

static void ktank_is_where_its_solids_are(void **state)
{
    (void)state;
    against_the_solids(&ktank);
}
/* Facets of 0.05 mm: what is left is the tracer's own, and edges. */
static void ktank_in_finer_facets_is_closer(void **state)
{
    (void)state;
    CHECK(against_the_solids(&ktank_fine) <= 0.2); /* 0.13 of all 2000 rays */
}
static void m35_is_where_its_solids_are(void **state)
{
    (void)state;
    against_the_solids(&m35);
}
static void havoc_is_where_its_solids_are(void **state)
{
    (void)state;
    against_the_solids(&havoc);
}
static void truck_is_where_its_solids_are(void **state)
{
    (void)state;
    against_the_solids(&truck);
}

static void every_triangle_of_the_text_says_the_same(void **state)
{
    (void)state;
    static const Expected *const model[4] = {&ktank, &m35, &havoc, &truck};
    for (int m = 0; m < 4; m++) {
        char      path[512];
        Scene     s = {0};
        const int count = read_rays(model[m]->hits);
        if (count < 0 || !reference_path(path, model[m]->mesh)) {
            skip();
            return;
        }
        scene_open(&s, path);
        Obj       obj = read_obj(path);
        const int step = 1 + (int)((double)count * obj.triangles / 4e7); /* a fraction of a second */
        double    worst_m = 0;
        int       compared = 0, apart = 0;
        assert_int_equal(obj.triangles, s.model.triangle_count + s.report.degenerate_triangles);
        for (int i = 0; i < count; i += step, compared++) {
            const char  *part;
            double       n[3], sine = 1;
            const double ours = trace(&part, n, &s, &ray[i]), want = nearest(&sine, &obj, ray[i].o, ray[i].d);
            if (isinf(ours) && isinf(want)) continue;
            /* a ray may pass an edge on the other side of rounded vertices: so it is no worse than one ray in a
             * thousand */
            const double allowed_m = 6e-8 * 20 * 2 / fmax(sine, 1e-6);
            if (!(fabs(ours - want) <= allowed_m)) apart++;
            else worst_m = fmax(worst_m, fabs(ours - want));
        }
        printf("%s: %d rays, %d triangles each: %d apart, the others within %.2g m\n", s.model.name, compared,
               obj.triangles, apart, worst_m);
        CHECK(apart <= compared / 1000);
        CHECK(compared > 100);
        free(obj.vertex);
        free(obj.triangle);
        scene_close(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ktank_is_where_its_solids_are), cmocka_unit_test(ktank_in_finer_facets_is_closer),
        cmocka_unit_test(m35_is_where_its_solids_are),   cmocka_unit_test(havoc_is_where_its_solids_are),
        cmocka_unit_test(truck_is_where_its_solids_are), cmocka_unit_test(every_triangle_of_the_text_says_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
