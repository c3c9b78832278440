/* tests/render/austin.h: the field of a target against the Austin RCS suite: thin plate, NASA almond, PRIME aircraft.
 * Figures by window of angle. */
#ifndef TESTS_RENDER_AUSTIN_H
#define TESTS_RENDER_AUSTIN_H

#include "tests/render/hand_models.h"
#include "tests/render/radar_stage.h"

#include "render/scattering/field/total_field.h"

#include <zlib.h>

static inline double sigma(double complex s) { return 4 * pi_rad * (creal(s) * creal(s) + cimag(s) * cimag(s)); }

/* ---- almond ------------------------------------------------------------------------------------------- */

/* Point and outward normal at x = d t, angle p about the axis. */
static inline void almond_at(double q[3], double n[3], double t, double p)
{
    const double d = 0.252374, back = 0.416667, reach = 2.08335;
    const double y = t < 0 ? 0.193333 * d : 4.83345 * d, z = t < 0 ? 0.064444 * d : 1.61115 * d;
    const double root = sqrt(fmax(0, 1 - pow(t / (t < 0 ? back : reach), 2))), share = t < 0 ? root : root - 0.96;
    const double slope = root > 0 ? -t / pow(t < 0 ? back : reach, 2) / root : 1e9; /* of share in t */
    q[0] = d * t, q[1] = y * share * cos(p), q[2] = z * share * sin(p);
    /* cross product of the derivatives in p and t */
    n[0] = -y * z * slope * share, n[1] = d * z * share * cos(p), n[2] = d * y * share * sin(p);
    if (!v3_normalize(n, n)) n[0] = t < 0 ? -1 : 1, n[1] = n[2] = 0;
}

static inline void build_almond(Model *m)
{
    enum { along = 240, around = 240 };
    hand_model(m, 1, (2 * along + 1) * around, 4 * along * around);
    m->node[0].parent = -1;
    for (int i = 0; i <= 2 * along; i++) {
        const double s = (double)i / along - 1, t = s < 0 ? 0.416667 * -cos(0.5 * pi_rad * (s + 1)) : 0.58333 * s;
        for (int j = 0; j < around; j++) {
            double q[3], n[3];
            almond_at(q, n, t, 2 * pi_rad * j / around);
            const int v = hand_vertex(m, q[0], q[1], q[2]);
            for (int c = 0; c < 3; c++) m->normal[v][c] = (float)n[c];
        }
    }
    for (int i = 0; i < 2 * along; i++)
        for (int j = 0; j < around; j++) {
            const int a = i * around + j, b = i * around + (j + 1) % around;
            hand_triangle(m, 0, a, b, b + around);
            hand_triangle(m, 0, a, b + around, a + around);
        }
    CHECK(model_measure(m) == STATUS_OK);
}

/* ---- PRIME -------------------------------------------------------------------------------------------- */

/* The first file of a zip, as text; the caller frees it. */
static inline char *unzip(const char *path)
{
    char  *zip, *text;
    size_t octets;
    CHECK(text_read_file(&zip, &octets, "test", path, 1 << 26) == STATUS_OK);
    size_t         at = 0;
    uint32_t       packed = 0, whole = 0;
    const uint8_t *b = (const uint8_t *)zip;
    /* sizes are in the central directory: the first record of it */
    for (at = octets - 4; at > 0 && !(b[at] == 'P' && b[at + 1] == 'K' && b[at + 2] == 1 && b[at + 3] == 2); at--) {
    }
    while (at > 0) { /* the largest file */
        const uint32_t p = b[at + 20] | b[at + 21] << 8 | b[at + 22] << 16 | (uint32_t)b[at + 23] << 24;
        const uint32_t w = b[at + 24] | b[at + 25] << 8 | b[at + 26] << 16 | (uint32_t)b[at + 27] << 24;
        const uint32_t o = b[at + 42] | b[at + 43] << 8 | b[at + 44] << 16 | (uint32_t)b[at + 45] << 24;
        if (w > whole) {
            packed = p, whole = w;
            const size_t data = o + 30u + (size_t)(b[o + 26] | b[o + 27] << 8) + (size_t)(b[o + 28] | b[o + 29] << 8);
            memmove(zip, zip + data, packed);
            break;
        }
        at--;
    }
    text = calloc(whole + 1, 1);
    z_stream z = {.next_in = (Bytef *)zip, .avail_in = packed, .next_out = (Bytef *)text, .avail_out = whole};
    CHECK(inflateInit2(&z, -15) == Z_OK && inflate(&z, Z_FINISH) == Z_STREAM_END);
    inflateEnd(&z);
    free(zip);
    return text;
}

/* Normals of corners: the mean, by area, of the facets there that lean less than 30 degrees from the corner's own. */
static inline void smooth_normals(Model *m, const int (*node)[3], int nodes)
{
    int *first = calloc((size_t)nodes + 2, sizeof *first), *of = calloc(3 * (size_t)m->triangle_count, sizeof *of);
    double(*area)[3] = calloc((size_t)m->triangle_count, sizeof *area);
    for (int t = 0; t < m->triangle_count; t++) {
        double ab[3], ac[3];
        v3_sub(ab, m->vertex[3 * t + 1], m->vertex[3 * t]);
        v3_sub(ac, m->vertex[3 * t + 2], m->vertex[3 * t]);
        v3_cross(area[t], ab, ac);
        for (int c = 0; c < 3; c++) first[node[t][c] + 2]++;
    }
    for (int i = 1; i <= nodes + 1; i++) first[i] += first[i - 1];
    for (int t = 0; t < m->triangle_count; t++)
        for (int c = 0; c < 3; c++) of[first[node[t][c] + 1]++] = t;
    for (int t = 0; t < m->triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            double n[3] = {0, 0, 0};
            for (int i = first[node[t][c]]; i < first[node[t][c] + 1]; i++) {
                const double *other = area[of[i]];
                if (v3_dot(other, area[t]) > 0.866 * v3_length(other) * v3_length(area[t])) v3_add(n, n, other);
            }
            if (!v3_normalize(n, n)) n[0] = 1;
            for (int x = 0; x < 3; x++) m->normal[3 * t + c][x] = (float)n[x];
        }
    free(first);
    free(of);
    free(area);
}

static inline void build_prime(Model *m, const char *path, double length_m)
{
    char *text = unzip(path), *at = text;
    long  nodes = strtol(at, &at, 10), triangles = strtol(at, &at, 10);
    CHECK(nodes > 1000 && nodes < 1000000 && triangles > 1000 && triangles < 1000000);
    double(*p)[3] = calloc((size_t)nodes, sizeof *p), low = INFINITY, high = -INFINITY;
    int(*node)[3] = calloc((size_t)triangles, sizeof *node);
    for (long v = 0; v < nodes; v++) {
        for (int c = 0; c < 3; c++) p[v][c] = strtod(at, &at);
        low = fmin(low, p[v][0]), high = fmax(high, p[v][0]);
    }
    hand_model(m, 1, 3 * (int)triangles, (int)triangles);
    m->node[0].parent = -1;
    for (long t = 0; t < triangles; t++) {
        int corner[3];
        for (int c = 0; c < 3; c++) {
            const long i = labs(strtol(at, &at, 10)) - 1;
            CHECK(i >= 0 && i < nodes);
            node[t][c] = (int)i;
            const double s = length_m / (high - low);
            corner[c] = hand_vertex(m, s * p[i][0], s * p[i][1], s * p[i][2]);
        }
        hand_triangle(m, 0, corner[0], corner[1], corner[2]);
    }
    smooth_normals(m, (const int(*)[3])node, (int)nodes);
    free(node);
    free(p);
    free(text);
    CHECK(model_measure(m) == STATUS_OK);
}

/* ---- against the reference ------------------------------------------------------------------------------ */

typedef struct Window {
    double low_deg, high_deg;
    int    count;
    double off_db[2], mean[2], want[2]; /* HH, VV: mean of absolute differences; mean cross sections */
    double each_db[2][400], median_db[2];
} Window;

static inline int by_size(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return p > q ? 1 : p < q ? -1 : 0;
}

/* Every so many rows of the reference that are at this angle and in a window. */
static inline void run(RadarStage *s, const char *file, double theta_deg, Window *window, int windows, int every,
                       bool edges)
{
    TotalField               field = {0};
    static const char *const names[] = {"f_hz", "theta_deg", "phi_deg", "HH_dBsm", "VV_dBsm"};
    char                     path[512], name[96];
    int                      column[5];
    Table                    table;
    snprintf(name, sizeof name, "radar/austin/%s", file);
    if (!reference_path(path, name)) skip();
    CHECK(table_open(&table, path) == STATUS_OK && table_columns(column, &table, names, 5, "test"));
    for (int r = 0; r < table.rows; r += every) {
        double x[5];
        for (int c = 0; c < 5; c++) CHECK(text_to_double(&x[c], table_text(&table, r, column[c])));
        if (fabs(x[1] - theta_deg) > 1e-6) continue;
        s->config.frequency_hz = x[0];
        bool wanted = false;
        for (int w = 0; w < windows; w++) wanted |= x[2] >= window[w].low_deg && x[2] <= window[w].high_deg;
        if (!wanted) continue;
        const double   theta = x[1] * rad_per_deg, phi = x[2] * rad_per_deg;
        ScatterAntenna a = {{sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)}, INFINITY};
        v3_normalize(a.u, a.u);
        ScatterMatrix m;
        CHECK(total_field_trace(&field, s->target, &a, &a, &s->config, edges, s->pool) == STATUS_OK);
        CHECK(total_field_sweep(&m, &(FrequencySweep){.count = 1, .first_hz = x[0]}, &field, s->pool) == STATUS_OK);
        const double got[2] = {sigma(m.hh), sigma(m.vv)};
        for (int w = 0; w < windows; w++) {
            if (!(x[2] >= window[w].low_deg && x[2] <= window[w].high_deg)) continue;
            for (int p = 0; p < 2; p++) {
                const double off_db = fabs(decibels(got[p]) - x[3 + p]);
                window[w].off_db[p] += off_db;
                window[w].each_db[p][window[w].count] = off_db;
                window[w].mean[p] += got[p];
                window[w].want[p] += pow(10, x[3 + p] / 10);
            }
            window[w].count++;
        }
    }
    table_close(&table);
    total_field_free(&field);
    for (int w = 0; w < windows; w++) {
        for (int p = 0; p < 2; p++) {
            window[w].off_db[p] /= window[w].count;
            qsort(window[w].each_db[p], (size_t)window[w].count, sizeof(double), by_size);
            window[w].median_db[p] = window[w].each_db[p][window[w].count / 2];
        }
        printf(
            "%s, %s, phi %g .. %g: HH %.2f, VV %.2f dB on average, %.2f, %.2f in the median; mean cross section off by "
            "%.2f, %.2f dB\n",
            file, edges ? "with edges" : "rays alone", window[w].low_deg, window[w].high_deg, window[w].off_db[0],
            window[w].off_db[1], window[w].median_db[0], window[w].median_db[1],
            decibels(window[w].mean[0] / window[w].want[0]), decibels(window[w].mean[1] / window[w].want[1]));
    }
}

static inline void judge_plate(int every)
{
    RadarStage s;
    Window     window[4] = {{.low_deg = 0, .high_deg = 2},
                            {.low_deg = 0, .high_deg = 40},
                            {.low_deg = 40, .high_deg = 89},
                            {.low_deg = 0, .high_deg = 90}};
    Window     rays[4];
    memcpy(rays, window, sizeof rays);
    stage_open(&s, "plate:0.2667x0.1524", 10e9); /* 7 W / 4 along y, W = 6 in along z */
    run(&s, "IIA_plate_W6in_zy_f11_ref.csv", 90, rays, 4, every, false);
    run(&s, "IIA_plate_W6in_zy_f11_ref.csv", 90, window, 4, every, true);
    CHECK(window[0].off_db[0] <= 0.1 && window[0].off_db[1] <= 0.1);
    CHECK(rays[1].median_db[0] <= 1.2 && rays[1].median_db[1] <= 1.2);
    CHECK(window[1].median_db[0] <= 0.4 && window[1].median_db[1] <= 0.3);
    CHECK(window[2].median_db[0] <= 1.2 && window[2].median_db[1] <= 0.9);
    CHECK(window[3].median_db[0] <= 0.8 && window[3].median_db[1] <= 0.6);
    stage_close(&s);
}

static inline void judge_prime(int every)
{
    RadarStage s = {0};
    char       path[512];
    Window     window[1] = {{.low_deg = 0, .high_deg = 180}};
    Window     rays[1];
    memcpy(rays, window, sizeof rays);
    if (!reference_path(path, "radar/austin/Closed-Duct_PRIME_model_meshBB.zip")) skip();
    build_prime(&s.model, path, 9.1875 * 0.0254);
    stage_target(&s, 10.25e9);
    run(&s, "IVA_PRIMEclosed_L9.1875in_fx3_ref.csv", 90, rays, 1, every, false);
    run(&s, "IVA_PRIMEclosed_L9.1875in_fx3_ref.csv", 90, window, 1, every, true);
    CHECK(rays[0].off_db[0] <= 8 && rays[0].off_db[1] <= 7);
    CHECK(window[0].off_db[0] <= 7.5 && window[0].off_db[1] <= 7);
    CHECK(fabs(decibels(window[0].mean[0] / window[0].want[0])) <= 2.3);
    CHECK(fabs(decibels(window[0].mean[1] / window[0].want[1])) <= 2.3);
    stage_close(&s);
}

#endif
